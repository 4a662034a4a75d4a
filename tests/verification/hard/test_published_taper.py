"""A self-locking taper: a cone is pressed into its hub, let go, and pulled out.

Source: R. L. Norton, Machine Design; G. Niemann, Maschinenelemente (taper fits): on a cone of half
angle a the sum N of the normal forces carries

    N (sin a + mu cos a)   as it goes in,   N (mu cos a - sin a)   before it comes out,

and it stays without a load where tan a < mu: friction turns round on its own.

Requirement: both, without a cut, and an end of the last step where all slides, in at most 60
iterations in all; the pull over the push is that of the two formulas. Tolerance: measured
1.3e-4 (the cone turns with the bodies); pull over push 2.3 % less, as the cone is shorter under a
pull and N less. With attempts beyond the limit 450 to 510 iterations.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from tests.verification.hard.drawn import drawn

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.case import load
from anisocontact.case.build import build

SLOPE, FRICTION, PUSH = np.radians(3.0), 0.12, 20_000.0

CASE = """
title = "Taper"
[idealisation]
kind = "axisymmetric"
[mesh]
file = "taper.msh"
[material.shaft]
model = "linear-elastic"
E = 2e5
nu = 0.3
[material.hub]
model = "linear-elastic"
E = 1e5
nu = 0.3
[[contact]]
slave = "{sides[0]}"
master = "{sides[1]}"
friction = {{ coefficients = 0.12 }}
[rigid.head]
faces = ["shaft.top"]
reference = [0, 25, 0]
[[step]]
name = "touch"
increments = 1
displacement = {{ "hub.bottom" = {{ y = 0 }} }}
motion = {{ head = {{ y = -0.01 }} }}
[[step]]
name = "in"
increments = 2
motion = {{ head = {{ y = "free" }} }}
load = {{ head = {{ y = -2e4 }} }}
[[step]]
name = "go"
increments = 2
load = {{ head = {{ y = 0 }} }}
[[step]]
name = "out"
increments = 10
load = {{ head = {{ y = 2e4 }} }}
until = {{ contact = "{sides[0]}", event = "sliding" }}
"""


def mesh(path: Path) -> None:
    """Quadrilaterals of gmsh; 14 facets along the hub, and 18 along the longer shaft."""
    with drawn(path) as gmsh:
        geo = gmsh.model.geo
        cone = {y: 10.0 + np.tan(SLOPE) * y for y in (-5, 0, 20, 25)}
        shaft = ((0, -5), (cone[-5], -5), (cone[25], 25), (0, 25))
        hub = ((cone[0], 0), (20, 0), (20, 20), (cone[20], 20))
        for name, corners, cells, groups in (
            ("shaft", shaft, (6, 18), ("bottom", "cone", "top", "axis")),
            ("hub", hub, (6, 14), ("bottom", "outer", "top", "bore")),
        ):
            points = [geo.addPoint(x, y, 0.0) for x, y in corners]
            lines = [geo.addLine(points[i], points[(i + 1) % 4]) for i in range(4)]
            for i, line in enumerate(lines):
                geo.mesh.setTransfiniteCurve(line, cells[i % 2] + 1)
            face = geo.addPlaneSurface([geo.addCurveLoop(lines)])
            geo.mesh.setTransfiniteSurface(face)
            geo.mesh.setRecombine(2, face)
            geo.synchronize()
            gmsh.model.addPhysicalGroup(2, [face], name=name)
            for line, group in zip(lines, groups, strict=True):
                gmsh.model.addPhysicalGroup(1, [line], name=f"{name}.{group}")


@pytest.mark.parametrize(
    "sides",
    [
        ("hub.bore", "shaft.cone"),
        pytest.param(("shaft.cone", "hub.bore"), marks=pytest.mark.slow),
    ],
)
def test_taper(tmp_path: Path, sides: tuple[str, str]) -> None:
    """Axial force over the normal force, in and out."""
    mesh(tmp_path / "taper.msh")
    (tmp_path / "case.toml").write_text(CASE.format(sides=sides))
    built = build(load(tmp_path / "case.toml"))
    (contact,) = built.problem.contacts
    cuts: list[object] = []
    ratios, iterations = {}, 0
    for part in built.solver.run(on_cut=cuts.append):
        axial = abs(contact.resultant()[0][1])
        ratios[part.step] = axial / (contact.last.pressure * contact.areas).sum()
        iterations += part.iterations
    assert not cuts
    assert part.event
    assert iterations <= 60
    up, down = FRICTION * np.cos(SLOPE) + np.array([1.0, -1.0]) * np.sin(SLOPE)
    assert ratios["in"] == pytest.approx(up, rel=3e-4)
    assert ratios["go"] < 1e-6
    assert ratios["out"] == pytest.approx(down, rel=3e-4)
    assert 0.96 < axial / PUSH / (down / up) < 1.0
