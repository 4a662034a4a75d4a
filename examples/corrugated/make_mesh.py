"""Mesh of two corrugated sheets that lie on each other with their waves crossed (gmsh).

    python examples/corrugated/make_mesh.py

writes corrugated.msh beside this file. It needs the gmsh package; the mesh is kept in the
repository, so that running the example does not. Lengths in mm.
"""

import math
from dataclasses import dataclass
from pathlib import Path

import gmsh
import numpy as np

WAVELENGTH, AMPLITUDE, THICKNESS = 2.5, 0.1, 0.5


@dataclass(frozen=True)
class Sheet:
    """A sheet around the origin: lengths and cells along x and y, and the angle of its crests.

    `side` is 1 where the sheet lies above z = 0 and touches with its lower face, -1 where it lies
    below.
    """

    name: str
    lengths: tuple[float, float]
    cells: tuple[int, int]
    crests: float
    side: int


SHEETS = (
    Sheet("lower", (8.0, 7.0), (32, 28), math.radians(15.0), -1),
    Sheet("upper", (6.0, 6.0), (24, 24), math.radians(-45.0), 1),
)


def main() -> None:
    """Flat sheets as gmsh's structured boxes, then every node moved onto the waves."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    volumes = [flat(sheet) for sheet in SHEETS]
    gmsh.option.setNumber("Mesh.Binary", 1)
    gmsh.model.mesh.generate(3)
    for sheet, volume in zip(SHEETS, volumes, strict=True):
        wave(sheet, volume)
    gmsh.write(str(Path(__file__).with_name("corrugated.msh")))
    gmsh.finalize()


def flat(sheet: Sheet) -> int:
    """The sheet before it is bent; its face of contact on z = 0, named with its back."""
    geo = gmsh.model.geo
    a, b = (0.5 * length for length in sheet.lengths)
    points = [geo.addPoint(x, y, 0.0) for x, y in ((-a, -b), (a, -b), (a, b), (-a, b))]
    lines = [geo.addLine(points[i], points[(i + 1) % 4]) for i in range(4)]
    face = geo.addPlaneSurface([geo.addCurveLoop(lines)])
    for line, cells in zip(lines, 2 * sheet.cells, strict=True):
        geo.mesh.setTransfiniteCurve(line, cells + 1)
    geo.mesh.setTransfiniteSurface(face)
    geo.mesh.setRecombine(2, face)
    made = geo.extrude([(2, face)], 0, 0, sheet.side * THICKNESS, [1], recombine=True)
    (_, back), (_, volume), *_ = made
    geo.synchronize()
    gmsh.model.addPhysicalGroup(3, [volume], name=sheet.name)
    gmsh.model.addPhysicalGroup(2, [face], name=f"{sheet.name}.face")
    gmsh.model.addPhysicalGroup(2, [back], name=f"{sheet.name}.back")
    return int(volume)


def wave(sheet: Sheet, volume: int) -> None:
    """Move the nodes of a sheet up and down; the highest crests stay where they are."""
    tags, x, _ = gmsh.model.mesh.getNodes(3, volume, includeBoundary=True)
    x = x.reshape(-1, 3)
    across = x @ (-math.sin(sheet.crests), math.cos(sheet.crests), 0.0)
    depth = AMPLITUDE * (1.0 - np.cos(2.0 * math.pi * across / WAVELENGTH))
    for tag, point in zip(tags, x + sheet.side * depth[:, None] * (0.0, 0.0, 1.0), strict=True):
        gmsh.model.mesh.setNode(tag, point, [])


if __name__ == "__main__":
    main()
