"""A block dragged while it is shaken across, and a pad that turns with the disc it rubs on.

Source: vibration across a way turns friction aside and lowers its mean along it [W. Littmann, H.
Storck, J. Wallaschek, Arch. Appl. Mech. 71 (2001) 549]; on axes of friction a slip q has the
friction N M q / sqrt(q M q), M with the squares of both coefficients along them [R. Michalowski, Z.
Mroz, Arch. Mech. 30, 1978]. So with q = (1, z cos(t)) its mean over a period, here with a part
across. A pad that turns about its own axis as fast as the disc below it about another one slips the
same way everywhere, at an angle to the grooves that turns with both, as in lapping.

Requirement: means over a period of 24 and 48 increments; friction of every increment, for grooves
on the disc and on the pad, orders 1 and 2, and no moment about the axis of the pad beyond that of
the normal forces; corrections. Tolerance: measured 3.1e-3 and 8e-4, of second order, as friction is
that of the chord of an increment; 8e-5, what the pad gives way as friction turns; 5 corrections,
then 3.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad

FIRST, SECOND, ANGLE = 0.3, 0.1, float(np.radians(30.0))
SHAKEN, APART = 3.0, 4.0
CASE = f"""
title = "Shaken drag"
{{shape}}
[material.pad]
model = "neo-hookean"
E = 1e4
nu = 0.2
[surface.disc]
shape = "plane"
point = [0, 0, 0]
normal = [0, 0, 1]
[rigid.disc]
reference = [0, 0, 0]
[rigid.head]
faces = ["pad.top"]
reference = [{{place}}, 0, 1]
[amplitude.shake]
kind = "sine"
period = 1
[[contact]]
slave = "pad.bottom"
master = "disc"
[contact.friction]
coefficients = [{FIRST}, {SECOND}]
directions = {{{{ kind = "constant", vector = [1, 0, 0], angle_deg = 30 }}}}
directions_on = "{{on}}"
[[step]]
name = "touch"
increments = 1
motion.head = {{{{ z = -1e-3 }}}}
[[step]]
name = "press"
increments = 1
motion.head = {{{{ z = "free" }}}}
load.head = {{{{ z = -20 }}}}
[[step]]
name = "slide"
increments = {{increments}}
{{way}}
"""
BLOCK = "[mesh.box.pad]\norigin = [-1, -1, 0]\nsize = [2, 2, 1]\ncells = [3, 3, 2]"
PAD = f"[mesh.cylinder.pad]\nradius = 1.5\nlength = 1\nmove = [{APART}, 0, 0]"
SHAKE = f"""
duration = 2
motion.head = {{ x = 2, y = {{ amplitude = "shake", value = {SHAKEN / (2.0 * np.pi)} }} }}
"""
TURN = "motion.head = { rz_deg = 180 }\nmotion.disc = { rz_deg = 180 }"


def friction(slip: Any, angle: float) -> Any:
    """Friction against a slip over the normal force, for grooves at an angle."""
    along = np.array([np.cos(angle), np.sin(angle)])
    grooves = np.array([along, [-along[1], along[0]]])
    squares = grooves.T @ np.diag([FIRST**2, SECOND**2]) @ grooves
    return squares @ slip / np.sqrt(slip @ squares @ slip)


@pytest.mark.parametrize(("increments", "tolerance"), [(24, 4e-3), (48, 1.2e-3)])
def test_mean_of_a_period(
    to_the_end: Callable[..., Any], increments: int, tolerance: float
) -> None:
    """Drag and the part across in the second of two periods."""
    text = CASE.format(shape=BLOCK, place=0, on="master", increments=2 * increments, way=SHAKE)
    run = to_the_end(text)
    assert not run.cuts
    assert max(part.iterations for part in run.accepted[3:]) <= 4
    (contact,) = run.problem.contacts
    forces = np.array([part.resultants[contact.name][0] for part in run.accepted[-increments:]])
    found = -(forces[:, :2] / forces[:, 2:]).mean(axis=0)
    turns = [0.5 * np.pi, 1.5 * np.pi]
    for one in range(2):

        def part(t: float, one: int = one) -> float:
            return float(friction(np.array([1.0, SHAKEN * np.cos(t)]), ANGLE)[one])

        mean = quad(part, 0.0, 2.0 * np.pi, points=turns, limit=200)[0] / (2.0 * np.pi)
        assert found[one] == pytest.approx(mean, rel=tolerance)


@pytest.mark.parametrize(("on", "order"), [("master", 1), ("slave", 1), ("master", 2)])
def test_pad_that_turns_with_its_disc(to_the_end: Callable[..., Any], on: str, order: int) -> None:
    """Friction in every increment of half a turn, and its moment at the end."""
    cells = [12, 3, 1] if order == 1 else [8, 2, 1]
    shape = f"{PAD}\ncells = {cells}\norder = {order}"
    run = to_the_end(CASE.format(shape=shape, place=APART, on=on, increments=18, way=TURN))
    assert not run.cuts
    assert max(part.iterations for part in run.accepted[3:]) <= 4
    (contact,) = run.problem.contacts
    turn = np.pi / 18
    for i, part in enumerate(run.accepted[2:]):
        force = part.resultants[contact.name][0]
        # the slip is the chord of the way over the disc, and grooves are those at the end
        half = 0.5 * turn
        chord = np.array([np.sin(half), -np.cos(half)])
        expected = -friction(chord, ANGLE + (i + 1) * turn)
        assert force[:2] / force[2] == pytest.approx(expected, abs=2e-4)
    force, moment = run.accepted[-1].resultants[contact.name][:2]
    normal = contact.last.pressure * contact.areas
    middle = normal @ contact.points / normal.sum()
    about = moment - np.cross(middle, force)
    assert abs(about[2]) < 1e-4 * np.hypot(*force[:2])
