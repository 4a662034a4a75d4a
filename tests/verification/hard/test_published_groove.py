"""A block dragged along a V groove whose walls have friction that depends on the direction.

Both walls lean by 45 degrees, and axes of friction 0.3 and 0.1 are turned by a on either of them,
mirrored. Source: normality of slip to the ellipse of friction, R. Michalowski, Z. Mroz, Associated
and non-associated sliding rules in contact friction problems, Arch. Mech. 30 (1978). With N what
presses both walls in sum, and the way along the groove,

    F_x / N = -h ,  F_z / N = (1 - (m1^2 - m2^2) sin a cos a / h) / sqrt(2) ,

h^2 = (m1 cos a)^2 + (m2 sin a)^2: what friction does across the groove lifts the block, or pulls it
in.

Requirement: both, and at most 50 iterations in five increments, no cut; the upper edges of both
sides follow the head, which presses them into the walls. Tolerance: measured 7e-7, points have slid
for forty times what they were pressed by, and their tractions are aligned.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

FIRST, SECOND, SLOPE = 0.3, 0.1, float(np.sqrt(0.5))

CASE = """
title = "Groove"
[mesh.box.block]
origin = [-1, 0, 0]
size = [2, 1, 1]
cells = [4, 3, 3]
rotate = {{ axis = [1, 0, 0], angle_deg = 45 }}
[material.block]
model = "{model}"
E = 1000
nu = 0.3
[join]
"block.head" = ["block.top", "block.back"]
[rigid.head]
faces = ["block.head"]
reference = [0, 0, 1]
{walls}
[[step]]
name = "press"
increments = 1
motion = {{ head = {{ z = -0.01 }} }}
[[step]]
name = "drag"
increments = 4
motion = {{ head = {{ x = 0.4 }} }}
"""
WALL = """
[surface.{name}]
shape = "plane"
point = [0, 0, 0]
normal = [0, {across}, 1]
[[contact]]
slave = "block.{slave}"
master = "{name}"
[contact.friction]
coefficients = [0.3, 0.1]
directions = {{ kind = "constant", vector = [1, 0, 0], angle_deg = {angle} }}
"""


@pytest.mark.parametrize(
    ("model", "angle"), [("linear-elastic", 0), ("linear-elastic", 50), ("neo-hookean", -30)]
)
def test_groove(to_the_end: Callable[..., Any], model: str, angle: float) -> None:
    """Drag and lift over what presses the walls."""
    walls = WALL.format(name="right", across=-1, slave="bottom", angle=angle)
    walls += WALL.format(name="left", across=1, slave="front", angle=-angle)
    run = to_the_end(CASE.format(model=model, walls=walls))
    assert not run.cuts
    assert sum(part.iterations for part in run.accepted) <= 50
    assert not any(part.relaxed for part in run.accepted)
    right, left = (run.force("drag", i) for i in range(2))
    pressed = right @ [0, -SLOPE, SLOPE] + left @ [0, SLOPE, SLOPE]
    a = np.radians(angle)
    h = np.hypot(FIRST * np.cos(a), SECOND * np.sin(a))
    lift = (FIRST**2 - SECOND**2) * np.sin(a) * np.cos(a) / h
    force = (right + left) / pressed
    np.testing.assert_allclose(force, [-h, 0.0, SLOPE * (1.0 - lift)], atol=1e-5)
