"""A pad with grooves in its sole that crawls: pushed, turned, pulled back and turned back.

Source: slip normal to the ellipse of friction, under a force that has no part sideways
[R. Michalowski, Z. Mroz, Arch. Mech. 30, 1978]: the pad drifts by -M_xy / M_xx of its way along y,
M with the squares of both coefficients along the grooves, as a snake on its scales [D. L. Hu et
al., PNAS 106 (2009) 10081], both from memory. On the way back the grooves are at the opposite
angle, so that the drift goes on; turned about its middle the pad stays.

Requirement: net way of a cycle, multipliers and penalties, at nodes and at points, orders 1 and 2.
Tolerance: measured 8e-5 at most, what the pad shears at each reversal. Corrections: measured 7 to
9, with order 2 15.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

EASY, HARD, ANGLE = 0.1, 0.3, 30.0
CASE = f"""
title = "Crawling pad"
[mesh.box.pad]
origin = [-1, -1, 0]
size = [2, 2, 0.5]
cells = [{{cells}}, {{cells}}, 2]
order = {{order}}
[material.pad]
model = "neo-hookean"
E = 1e4
nu = 0.2
[surface.floor]
shape = "plane"
point = [0, 0, 0]
normal = [0, 0, 1]
[rigid.head]
faces = ["pad.top"]
reference = [0, 0, 0.5]
[[contact]]
slave = "pad.bottom"
master = "floor"
{{given}}
[contact.friction]
coefficients = [{EASY}, {HARD}]
directions = {{{{ kind = "constant", vector = [0, 1, 0], angle_deg = {ANGLE} }}}}
directions_on = "slave"
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
name = "there"
increments = 2
motion.head = {{{{ y = 1, x = "free" }}}}
[[step]]
name = "turn"
increments = 4
motion.head = {{{{ rz_deg = {-2.0 * ANGLE} }}}}
[[step]]
name = "back"
increments = 2
motion.head = {{{{ y = 0 }}}}
[[step]]
name = "return"
increments = 4
motion.head = {{{{ rz_deg = 0 }}}}
"""


@pytest.mark.parametrize(
    ("cells", "order", "given"),
    [(4, 1, ""), (4, 2, ""), (4, 1, 'method = "penalty"'), (4, 1, 'pass = "single"')],
)
def test_net_way(to_the_end: Callable[..., Any], cells: int, order: int, given: str) -> None:
    """Where the pad is after a cycle."""
    run = to_the_end(CASE.format(cells=cells, order=order, given=given))
    assert not run.cuts
    assert max(part.iterations for part in run.accepted) <= 18
    turned = np.radians(ANGLE)
    grooves = np.array([[-np.sin(turned), np.cos(turned)], [np.cos(turned), np.sin(turned)]])
    squares = grooves.T @ np.diag([EASY**2, HARD**2]) @ grooves
    (head,) = run.problem.rigid.bodies
    drift = -squares[0, 1] / squares[0, 0]
    assert head.accepted.translation[:2] == pytest.approx([2.0 * drift, 0.0], abs=2e-4)
