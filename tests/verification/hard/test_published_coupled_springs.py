"""A stiff block on springs that couple normal and shear, with friction that is critical or not.

Source: A. Klarbring, Examples of non-uniqueness and non-existence of solutions to quasistatic
contact problems with friction, Ing. Archiv 60 (1990) 529; J. R. Barber, Contact Mechanics (2018)
ch. 14 (both from memory). Of a point with the stiffness K along a plane and normal to it each
increment has one solution where f < K_tt / |K_tn|; above it there may be three: it sticks, slips,
or has come off. They are written down here, in closed form.

Requirement: normal and shear force of every increment of two cycles that stick, slip and open,
orders 1 and 2, multipliers and penalties, those of the one solution; above the critical friction a
point that still sticks goes on sticking, and where none sticks or slips it opens. Tolerance: 2e-4
of the load, what the block gives way; 5e-4 where it sticks at one corner. Corrections: measured 9,
with order 2 38 where it comes down again; where it snaps open the increment is cut.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

STIFF, SOFT, PRESSED = 1000.0, 10.0, 10.0
CASE = """
title = "Coupled springs"
[idealisation]
kind = "plane-strain"
[mesh.rectangle.block]
origin = [-0.5, 0]
size = [1, 1]
cells = [2, 2]
order = {order}
rotate = {{ axis = [0, 0, 1], angle_deg = 45 }}
[material.block]
model = "linear-elastic"
E = 1e7
nu = 0.2
[surface.plane]
shape = "plane"
point = [0, 0, 0]
normal = [-1, 1, 0]
[rigid.head]
faces = ["block.top"]
reference = [0, 0, 0]
springs = {{ x = 1000, y = 10 }}
[[contact]]
slave = "block.bottom"
master = "plane"
method = "{method}"
friction = {{ coefficients = {friction} }}
[[step]]
name = "touch"
increments = 1
motion.head = {{ x = 0, y = 0, rz_deg = 0 }}
"""
TURN = np.array([[1.0, 1.0], [-1.0, 1.0]]) * np.sqrt(0.5)  # along the plane, normal to it
COUPLED = TURN @ np.diag([STIFF, SOFT]) @ TURN.T


def _solutions(friction: float, stuck: float, load: Any) -> dict[str, Any]:
    """Place along the plane, shear and normal force of all solutions of an increment."""
    found: dict[str, Any] = {}
    along, off = np.linalg.solve(COUPLED, load)
    if off >= 0.0:
        found["open"] = (along, 0.0, 0.0)
    shear, normal = COUPLED[:, 0] * stuck - load
    if normal >= 0.0 and abs(shear) <= friction * normal:
        found["stick"] = (stuck, shear, normal)
    for way in (1.0, -1.0):
        drag = way * friction
        along = (load[0] + drag * load[1]) / (COUPLED[0, 0] + drag * COUPLED[1, 0])
        normal = COUPLED[1, 0] * along - load[1]
        if normal >= 0.0 and way * (along - stuck) > 0.0:
            found[f"slip {way}"] = (along, -drag * normal, normal)
    return found


def _run(to_the_end: Callable[..., Any], text: str, ends: list[float], *opens: Any) -> Any:
    """Loads and forces at the ends of increments; only those in which it snaps open may be cut."""
    loads = [(0.0, -PRESSED * share) for share in (1.0 / 3.0, 2.0 / 3.0, 1.0)]
    for i, (start, end) in enumerate(zip([0.0, *ends[:-1]], ends, strict=True)):
        free = 'x = "free", y = "free"'
        if i == 0:
            text += f'[[step]]\nname = "press"\nincrements = 3\nmotion.head = {{ {free} }}\n'
            text += "load.head = {{ x = {:.17g}, y = {:.17g} }}\n".format(*TURN.T @ loads[-1])
        x, y = TURN.T @ (end, -PRESSED)
        text += f'[[step]]\nname = "shear {i}"\nincrements = 3\n'
        text += f"load.head = {{ x = {x:.17g}, y = {y:.17g} }}\n"
        loads += [(start + (end - start) * k / 3.0, -PRESSED) for k in (1, 2, 3)]
    run = to_the_end(text)
    assert {(cut.step, cut.increment) for cut in run.cuts} <= set(opens)
    (contact,) = run.problem.contacts
    parts = [part for part in run.accepted[1:] if part.done == 1.0]
    forces = [TURN @ part.resultants[contact.name][0][:2] for part in parts]
    return np.array(loads), [(*force, part) for force, part in zip(forces, parts, strict=True)]


@pytest.mark.parametrize(
    ("order", "method", "most"), [(1, "augmented", 12), (2, "augmented", 45), (1, "penalty", 12)]
)
def test_one_solution(to_the_end: Callable[..., Any], order: int, method: str, most: int) -> None:
    """Forces of every increment."""
    text = CASE.format(order=order, method=method, friction=0.5)
    loads, found = _run(to_the_end, text, [12.0, -12.0, 12.0, -12.0])
    stuck, met = 0.0, set()
    for load, (shear, normal, part) in zip(loads, found, strict=True):
        assert part.iterations <= most
        ((name, (stuck, *expected)),) = _solutions(0.5, stuck, load).items()
        met.add(name)
        assert [shear, normal] == pytest.approx(expected, abs=2e-4 * PRESSED)
    assert met == {"stick", "slip 1.0", "slip -1.0", "open"}


def test_above_the_critical_friction(to_the_end: Callable[..., Any]) -> None:
    """It sticks where two more solutions are, and opens where it can neither stick nor slip."""
    text = CASE.format(order=1, method="augmented", friction=1.5)
    loads, found = _run(to_the_end, text, [12.0, 24.0], ("shear 1", 1))
    several = _solutions(1.5, 0.0, loads[5])
    assert set(several) == {"open", "stick", "slip 1.0"}
    for load, (shear, normal, _) in zip(loads[:6], found[:6], strict=True):
        assert [shear, normal] == pytest.approx([-load[0], -load[1]], abs=5e-4 * PRESSED)
    assert set(_solutions(1.5, 0.0, loads[6])) == {"open"}
    assert np.allclose([force[:2] for force in found[6:]], 0.0, atol=1e-9)
