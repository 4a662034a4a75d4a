"""Mesh of the belts: two thin strips, each hung over the upper half of a drum (gmsh).

    python examples/belt/make_mesh.py

writes belt.msh beside this file. It needs the gmsh package; the mesh is kept in the repository, so
that running the example does not. The axis of the drum is y. Lengths in mm.
"""

import math
from pathlib import Path

import gmsh

RADIUS, THICKNESS, WIDTH, HANGING = 50.0, 0.5, 10.0, 20.0
FRONT = {"along": -14.0, "across": 4.0}  # of each belt: its lowest y
AROUND, DOWN, WIDE = 36, 4, 2  # cells around the drum, down each end, over the width


def main() -> None:
    """Both belts, their names, quadratic hexahedra."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    for name, y in FRONT.items():
        belt(name, y)
    gmsh.option.setNumber("Mesh.Binary", 1)
    gmsh.model.mesh.generate(3)
    gmsh.model.mesh.setOrder(2)
    gmsh.write(str(Path(__file__).with_name("belt.msh")))
    gmsh.finalize()


def belt(name: str, y: float) -> None:
    """One belt: the cross-section of its held end, swept up, over the drum and down."""
    tail = head = section(y)
    volumes, inner = [], []
    for sweep in (up, over, over, down):
        # The face at the end, the volume, the sides over the lines of the face at the start.
        (_, head), (_, volume), (_, side), *_ = sweep(head)
        volumes.append(volume)
        inner.append(side)
    gmsh.model.geo.synchronize()
    gmsh.model.addPhysicalGroup(3, volumes, name=name)
    for group, faces in (("tail", [tail]), ("head", [head]), ("inner", inner)):
        gmsh.model.addPhysicalGroup(2, faces, name=f"{name}.{group}")


def up(face: int) -> list[tuple[int, int]]:
    """Sweep along the part that hangs on the left."""
    return straight(face, HANGING)


def down(face: int) -> list[tuple[int, int]]:
    """Sweep along the part that hangs on the right."""
    return straight(face, -HANGING)


def straight(face: int, length: float) -> list[tuple[int, int]]:
    """Sweep along z."""
    return list(gmsh.model.geo.extrude([(2, face)], 0, 0, length, [DOWN], recombine=True))


def over(face: int) -> list[tuple[int, int]]:
    """Sweep over a quarter of the drum."""
    quarter = (0, 0, 0, 0, 1, 0, math.pi / 2)
    return list(gmsh.model.geo.revolve([(2, face)], *quarter, [AROUND // 2], recombine=True))


def section(y: float) -> int:
    """The end face: its first line lies on the drum's side."""
    geo = gmsh.model.geo
    x, z = -RADIUS, -HANGING
    corners = [(x, y), (x, y + WIDTH), (x - THICKNESS, y + WIDTH), (x - THICKNESS, y)]
    points = [geo.addPoint(a, b, z) for a, b in corners]
    lines = [geo.addLine(points[i], points[(i + 1) % 4]) for i in range(4)]
    face = geo.addPlaneSurface([geo.addCurveLoop(lines)])
    for line, cells in zip(lines, (WIDE, 1, WIDE, 1), strict=True):
        geo.mesh.setTransfiniteCurve(line, cells + 1)
    geo.mesh.setTransfiniteSurface(face)
    geo.mesh.setRecombine(2, face)
    return int(face)


if __name__ == "__main__":
    main()
