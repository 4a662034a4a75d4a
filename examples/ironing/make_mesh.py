"""Mesh of the ironing example: a soft block and the stiff sole of an iron, a part of a tube (gmsh).

    python examples/ironing/make_mesh.py

writes ironing.msh beside this file. It needs the gmsh package; the mesh is kept in the repository,
so that running the example does not. Lengths in mm.
"""

import math
from pathlib import Path

import gmsh

BLOCK = (48.0, 4.0, 4.0)  # from x = -4, y = -2, z = -4
BLOCK_CELLS = (60, 4, 4)
RADIUS, THICKNESS, HALF_ANGLE = 4.0, 1.0, math.radians(30.0)  # of the die, a part of a tube
LENGTH = 5.0  # of the die, along y
DIE_CELLS = (12, 6, 1)  # around, along y, through


def main() -> None:
    """Both bodies, their names, the mesh."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    block = extruded(rectangle(), BLOCK[1], BLOCK_CELLS[1])
    die = extruded(sector(), LENGTH, DIE_CELLS[1])
    gmsh.model.geo.synchronize()
    name("block", block, {"bottom": 0, "top": 2})
    name("die", die, {"sole": 0, "top": 2})
    gmsh.option.setNumber("Mesh.Binary", 1)
    gmsh.model.mesh.generate(3)
    gmsh.write(str(Path(__file__).with_name("ironing.msh")))
    gmsh.finalize()


def rectangle() -> int:
    """Front face of the block: bottom, right, top, left."""
    x, y, z = -4.0, -BLOCK[1] / 2, -BLOCK[2]
    corners = [(x, z), (x + BLOCK[0], z), (x + BLOCK[0], 0.0), (x, 0.0)]
    points = [gmsh.model.geo.addPoint(a, y, b) for a, b in corners]
    lines = [gmsh.model.geo.addLine(points[i], points[(i + 1) % 4]) for i in range(4)]
    return face(lines, BLOCK_CELLS[0], BLOCK_CELLS[2])


def sector() -> int:
    """Front face of the die: sole, right, top, left; its lowest point is the origin."""
    y = -LENGTH / 2
    centre = gmsh.model.geo.addPoint(0.0, y, RADIUS)
    places = [(RADIUS, -1), (RADIUS, 1), (RADIUS - THICKNESS, 1), (RADIUS - THICKNESS, -1)]
    sine, cosine = math.sin(HALF_ANGLE), math.cos(HALF_ANGLE)
    a, b, c, d = (
        gmsh.model.geo.addPoint(side * r * sine, y, RADIUS - r * cosine) for r, side in places
    )
    geo = gmsh.model.geo
    lines = [
        geo.addCircleArc(a, centre, b),
        geo.addLine(b, c),
        geo.addCircleArc(c, centre, d),
        geo.addLine(d, a),
    ]
    return face(lines, DIE_CELLS[0], DIE_CELLS[2])


def face(lines: list[int], along: int, through: int) -> int:
    """A structured face of quadrilaterals within four lines."""
    geo = gmsh.model.geo
    surface = geo.addPlaneSurface([geo.addCurveLoop(lines)])
    for line, cells in zip(lines, (along, through, along, through), strict=True):
        geo.mesh.setTransfiniteCurve(line, cells + 1)
    geo.mesh.setTransfiniteSurface(surface)
    geo.mesh.setRecombine(2, surface)
    return int(surface)


def extruded(surface: int, length: float, cells: int) -> list[int]:
    """The volume behind a face, then its faces over the lines of that face."""
    made = gmsh.model.geo.extrude(
        [(2, surface)], 0.0, length, 0.0, numElements=[cells], recombine=True
    )
    return [tag for _, tag in made[1:]]


def name(body: str, tags: list[int], groups: dict[str, int]) -> None:
    """Names of the body and of the faces over the lines of given numbers."""
    volume, *faces = tags
    gmsh.model.addPhysicalGroup(3, [volume], name=body)
    for group, line in groups.items():
        gmsh.model.addPhysicalGroup(2, [faces[line]], name=f"{body}.{group}")


if __name__ == "__main__":
    main()
