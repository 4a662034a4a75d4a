"""Mesh of the milled block: a steel foot with a boss, its edges rounded (gmsh).

    python examples/milled_block/make_mesh.py

writes block.msh beside this file. It needs the gmsh package; the mesh is kept in the repository,
so that running the example does not. Lengths in mm.
"""

from collections.abc import Callable
from pathlib import Path

import gmsh

LENGTH, WIDTH, THICKNESS = 60.0, 40.0, 10.0  # of the foot
CORNER_RADIUS, EDGE_RADIUS = 8.0, 2.0  # of the foot's vertical and bottom edges
BOSS_RADIUS, BOSS_HEIGHT, BOSS_FILLET = 13.0, 15.0, 3.0
HOLE_RADIUS, HOLE_DEPTH = 6.0, 12.0
TOP = THICKNESS + BOSS_HEIGHT
FINE, COARSE = 3.0, 6.0  # size of the elements at the sole and at the top of the boss

# Lowest and highest corner of an edge or face: x, y, z, x, y, z.
Box = tuple[float, float, float, float, float, float]


def main() -> None:
    """Build, name, mesh, write."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    name_groups(solid())
    mesh()
    gmsh.write(str(Path(__file__).with_name("block.msh")))
    gmsh.finalize()


def solid() -> int:
    """The foot with its sole on z = 0, boss and blind hole around the z axis."""
    occ = gmsh.model.occ
    part = occ.addBox(-LENGTH / 2, -WIDTH / 2, 0.0, LENGTH, WIDTH, THICKNESS)
    part = rounded(part, is_upright, CORNER_RADIUS)
    part = rounded(part, is_below(0.1), EDGE_RADIUS)
    boss = occ.addCylinder(0.0, 0.0, THICKNESS, 0.0, 0.0, BOSS_HEIGHT, BOSS_RADIUS)
    part = occ.fuse([(3, part)], [(3, boss)])[0][0][1]
    part = rounded(part, is_foot_of_boss, BOSS_FILLET)
    hole = occ.addCylinder(0.0, 0.0, TOP - HOLE_DEPTH, 0.0, 0.0, 2.0 * HOLE_DEPTH, HOLE_RADIUS)
    part = occ.cut([(3, part)], [(3, hole)])[0][0][1]
    occ.synchronize()
    return int(part)


def rounded(volume: int, chosen: Callable[[Box], bool], radius: float) -> int:
    """Volume with fillets along the edges whose bounding box is chosen."""
    gmsh.model.occ.synchronize()
    edges = [e for _, e in gmsh.model.getEntities(1) if chosen(gmsh.model.getBoundingBox(1, e))]
    return int(gmsh.model.occ.fillet([volume], edges, [radius])[0][1])


def is_upright(box: Box) -> bool:
    """Whether an edge goes through the whole foot."""
    return box[5] - box[2] > 0.9 * THICKNESS


def is_below(z: float) -> Callable[[Box], bool]:
    """Test of an edge or face that lies below z."""
    return lambda box: box[5] < z


def is_foot_of_boss(box: Box) -> bool:
    """Whether an edge is the circle where the boss stands on the foot."""
    on_foot = max(abs(box[2] - THICKNESS), abs(box[5] - THICKNESS)) < 0.1
    return on_foot and box[3] < 1.1 * BOSS_RADIUS and abs(box[4]) < 1.1 * BOSS_RADIUS


def name_groups(volume: int) -> None:
    """Body "block" with the flat sole "bottom" and the ring "top"."""
    gmsh.model.addPhysicalGroup(3, [volume], name="block")
    faces = {f: gmsh.model.getBoundingBox(2, f) for _, f in gmsh.model.getEntities(2)}
    groups = {
        "bottom": [f for f, box in faces.items() if is_below(0.1)(box)],
        "top": [f for f, box in faces.items() if box[2] > TOP - 0.1],
    }
    for name, tags in groups.items():
        gmsh.model.addPhysicalGroup(2, tags, name=f"block.{name}")


def mesh() -> None:
    """Quadratic tetrahedra, fine at the sole."""
    size = gmsh.model.mesh.field.add("MathEval")
    gmsh.model.mesh.field.setString(size, "F", f"{FINE} + {(COARSE - FINE) / TOP} * z")
    gmsh.model.mesh.field.setAsBackgroundMesh(size)
    for source in ("FromPoints", "FromCurvature", "ExtendFromBoundary"):
        gmsh.option.setNumber(f"Mesh.MeshSize{source}", 0)
    gmsh.option.setNumber("Mesh.OptimizeNetgen", 1)
    gmsh.option.setNumber("Mesh.ElementOrder", 2)
    gmsh.option.setNumber("Mesh.HighOrderOptimize", 2)
    gmsh.option.setNumber("Mesh.Binary", 1)
    gmsh.model.mesh.generate(3)


if __name__ == "__main__":
    main()
