"""A block on an incline whose friction depends on the direction: where slip starts, and which way.

The weight of a block of no Poisson's ratio presses it uniformly on a plane; what acts along the
plane is raised, at an angle to the axes of friction, until all of it slides. Nothing else holds
the block, so there is no equilibrium beyond. Source: the ellipse of friction, R. Michalowski, Z.
Mroz, Associated and non-associated sliding rules in contact friction problems, Arch. Mech. 30
(1978): with T at the angle p to the first axis,

    T / N = 1 / sqrt((cos p / m1)^2 + (sin p / m2)^2) ,    tan q = (m1 / m2)^2 tan p

for the way q in which it starts to slip, normal to the ellipse.

Requirement: the step ends there, without a cut. Tolerance: the event is met to a thousandth of an
increment, 2.5e-4 to 5e-4 of the limit; the direction is that of the last two parts, 0.05 degrees.
On an elastic foundation a block with Poisson's ratio rubs outwards as it is pressed, and points
slide before their tractions are aligned: within 2 %.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.case import load
from anisocontact.case.build import build
from anisocontact.solver.stepping.overload import Overload

FIRST, SECOND = 0.3, 0.1

CASE = """
title = "Incline"
[mesh.box.block]
origin = [-0.5, -0.5, 0]
size = [1, 1, 0.1]
cells = [4, 4, 1]
[material.block]
model = "linear-elastic"
E = 1e5
nu = {nu}
{table}
[[contact]]
slave = "block.bottom"
master = "{master}"
[contact.friction]
coefficients = [0.3, 0.1]
directions = {{ kind = "constant", vector = [1, 0, 0], angle_deg = {axis} }}
[[step]]
name = "press"
increments = 1
body_force = {{ block = {{ z = -100 }} }}
{held}
[[step]]
name = "tilt"
increments = 20
body_force = {{ block = {{ x = {x!r}, y = {y!r}, z = -100 }} }}
until = {{ contact = "block.bottom", event = "sliding" }}
"""
PLANE = """
[surface.table]
shape = "plane"
point = [0, 0, 0]
normal = [0, 0, 1]
"""
BASE = """
[mesh.box.base]
origin = [-1, -1, -0.5]
size = [2, 2, 0.5]
cells = [7, 7, 2]
[material.base]
model = "linear-elastic"
E = 1e5
nu = 0.3
"""


def incline(angle: float, axis: float, **places: Any) -> str:
    """The case with a load at an angle to x and the first axis at another, degree."""
    x, y = 50.0 * np.cos(np.radians(angle)), 50.0 * np.sin(np.radians(angle))
    return CASE.format(axis=axis, x=float(x), y=float(y), **places)


def limit(angle: float) -> float:
    """T / N at an angle to the first axis, degree."""
    p = np.radians(angle)
    return float(1.0 / np.hypot(np.cos(p) / FIRST, np.sin(p) / SECOND))


def slid(path: Path, text: str) -> tuple[Any, list[Any], list[Any], np.ndarray]:
    """Problem, accepted parts, cuts, and how the lower face has moved in the last part."""
    path.write_text(text)
    built = build(load(path))
    nodes = np.unique(built.problem.contacts[0].slave_points.nodes[:, 0])
    cuts: list[Any] = []
    accepted, places = [], []
    for part in built.solver.run(on_cut=cuts.append):
        accepted.append(part)
        places.append(built.problem.nodal[nodes].mean(axis=0))
    return built.problem, accepted, cuts, places[-1] - places[-2]


@pytest.mark.parametrize(("angle", "axis"), [(0, 0), (30, 0), (70, 0), (90, 0), (45, 25)])
def test_rigid_plane(angle: float, axis: float, tmp_path: Path) -> None:
    """Limit and direction of slip."""
    text = incline(angle, axis, nu=0.0, table=PLANE, master="table", held="")
    problem, accepted, cuts, way = slid(tmp_path / "case.toml", text)
    assert not cuts
    assert accepted[-1].event
    force = problem.contacts[0].resultant()[0]
    assert np.hypot(*force[:2]) / force[2] == pytest.approx(limit(angle - axis), rel=5e-4)
    p = np.radians(angle - axis)
    q = np.degrees(np.arctan2((FIRST / SECOND) ** 2 * np.sin(p), np.cos(p))) + axis
    assert np.degrees(np.arctan2(way[1], way[0])) == pytest.approx(q, abs=0.05)
    assert sum(part.iterations for part in accepted) <= 80


def test_a_limit_at_the_end_of_an_increment(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Friction holds no load any more, that of now included, from 0.4 of the tilt on.

    Requirement: the event is found there, in as many looks at the limit as halve an increment down
    to rounding (30) and those of the increments before; parts were halved without end.
    """
    looked: list[float] = []

    def beyond(problem: Any, end: float, now: float, *_: Any) -> list[Overload]:
        looked.append(end)
        assert len(looked) < 60
        return [Overload("", told=True, certain=True)] if now > 0.39 else []

    monkeypatch.setattr("anisocontact.solver.stepping.solver.too_much_load", beyond)
    text = incline(0, 0, nu=0.0, table=PLANE, master="table", held="")
    _, accepted, cuts, _ = slid(tmp_path / "case.toml", text)
    assert not cuts
    assert accepted[-1].event
    assert accepted[-1].time - accepted[-2].time < 1e-8


@pytest.mark.parametrize(("angle", "axis"), [(0, 0), pytest.param(45, 25, marks=pytest.mark.slow)])
def test_elastic_foundation(angle: float, axis: float, tmp_path: Path) -> None:
    """The limit on facets that do not match; what smaller parts do not meet is met later."""
    held = 'displacement = { "base.bottom" = { x = 0, y = 0, z = 0 } }'
    text = incline(angle, axis, nu=0.3, table=BASE, master="base.top", held=held)
    problem, accepted, cuts, _ = slid(tmp_path / "case.toml", text)
    assert not cuts
    assert accepted[-1].event
    force = problem.contacts[0].resultant()[0]
    assert np.hypot(*force[:2]) / force[2] == pytest.approx(limit(angle - axis), rel=0.02)
    assert len(accepted) <= 40
    assert sum(part.iterations for part in accepted) <= 150
