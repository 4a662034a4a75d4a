"""The cylinder roller of the benchmarks of NAFEMS, on meshes of gmsh, from a case file.

A steel cylinder (R = 50 mm, E = 210 GPa) is pressed on an aluminium block (200 mm wide and high,
E = 70 GPa) by 35 kN in plane strain, without friction. Source: A. W. A. Konter, Advanced Finite
Element Contact Benchmarks, NAFEMS 2006, benchmark 1, whose reference is Hertz,

    p0 = sqrt(F E* / (2 pi B R')) = 3585.4 MPa ,    a = sqrt(8 F R' / (pi B E*)) = 6.21 mm

with E* and R' as there. Requirement: the peak within 1 % with facets of a twelfth of the half-width
for both orders (the block is 32 half-widths wide and no half space), the end of the contact within
a facet of a, the whole force on the block, no cut, and at most 8 iterations for the first increment
of the force with order 1, 18 with order 2, and 6 for each other one (measured: 6, 16 and 5).
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.verification.hard.drawn import drawn

gmsh = pytest.importorskip("gmsh")

PEAK, HALF_WIDTH, FACET = 3585.4, 6.21, 0.5

CASE = """
title = "Cylinder roller"
[idealisation]
kind = "plane-strain"
[mesh]
file = "roller.msh"
[group."cylinder.load"]
by = "box"
low = [-1, 95, -1]
high = [25, 101, 1]
[material.cylinder]
model = "linear-elastic"
E = 210e3
nu = 0.3
[material.block]
model = "linear-elastic"
E = 70e3
nu = 0.3
[[contact]]
slave = "block.top"
master = "cylinder.skin"
friction = { coefficients = 0 }
[[step]]
name = "press"
increments = 5
force = { "cylinder.load" = { y = -17500 } }
[step.displacement]
"block.bottom" = { x = 0, y = 0 }
"block.block-axis" = { x = 0 }
"cylinder.cylinder-axis" = { x = 0 }
"""


def _right_half(path: Path, order: int) -> None:
    """Half of both bodies, with facets of half a millimetre where they meet."""
    with drawn(path, order):
        shapes, field = gmsh.model.occ, gmsh.model.mesh.field
        whole, left = shapes.addDisk(0, 50, 0, 50, 50), shapes.addRectangle(-60, -10, 0, 60, 130)
        cylinder = shapes.cut([(2, whole)], [(2, left)])[0][0][1]
        block = shapes.addRectangle(0, -200, 0, 100, 200)
        shapes.synchronize()
        for surface, name, face, height in (
            (cylinder, "cylinder", "skin", None),
            (block, "block", "top", 0.0),
        ):
            gmsh.model.addPhysicalGroup(2, [surface], name=name)
            for _, curve in gmsh.model.getBoundary([(2, surface)], oriented=False):
                low, high = np.array(gmsh.model.getBoundingBox(1, curve)).reshape(2, 3)
                if high[0] < 1e-3:
                    gmsh.model.addPhysicalGroup(1, [curve], name=f"{name}-axis")
                elif height is None or np.ptp([low[1], high[1], height]) < 1e-3:
                    gmsh.model.addPhysicalGroup(1, [curve], name=face)
                elif high[1] < -199.0:
                    gmsh.model.addPhysicalGroup(1, [curve], name="bottom")
        near = field.add("Ball")
        sizes = {"Radius": 12.0, "VIn": FACET, "VOut": 12.0, "Thickness": 80.0}
        for name, value in sizes.items():
            field.setNumber(near, name, value)
        field.setAsBackgroundMesh(near)
        for name in ("MeshSizeExtendFromBoundary", "MeshSizeFromPoints", "MeshSizeFromCurvature"):
            gmsh.option.setNumber(f"Mesh.{name}", 0)


@pytest.mark.parametrize("order", [1, 2])
def test_cylinder_roller(order: int, tmp_path: Path, to_the_end: Callable[..., Any]) -> None:
    """Peak pressure, half-width and iterations."""
    _right_half(tmp_path / "roller.msh", order)
    run = to_the_end(CASE, most=30_000)
    assert not run.cuts
    first, *rest = [a.iterations for a in run.accepted]
    assert first <= {1: 8, 2: 18}[order]
    assert max(rest) <= 6
    (contact,) = run.problem.contacts
    assert abs(contact.resultant()[0][1]) == pytest.approx(17500.0, rel=1e-6)
    pressure = contact.last.pressure
    assert pressure.max() == pytest.approx(PEAK, rel=0.01)
    assert contact.points[pressure > 0.0, 0].max() == pytest.approx(HALF_WIDTH, abs=FACET)
