"""A rigid sphere turned on a block until all slides, with axes of friction in one direction.

Source: under slip normal to the ellipse of friction [R. Michalowski, Z. Mroz, Arch. Mech. 30, 1978]
a point dissipates p h(q), h^2 = (m1 cos q)^2 + (m2 sin q)^2 for slip at the angle q to the first
axis. A turn slips at every angle alike, so that the torque is the mean of h over the circle times
the integral of p r,

    M = (2 / pi) m1 E(1 - m2^2 / m1^2) integral(p r) ,

with the complete elliptic integral of parameter 1 - m2^2 / m1^2. Slip along the force
(`coaxial`) has the mean of 1 / sqrt((cos q / m1)^2 + (sin q / m2)^2) in its place.

Requirement: the torque, with the pressures of the run; no cut, at most six iterations in an
increment. Tolerance: measured 0.01 to 0.12 %, with four facets of order 1 across the radius.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.special import ellipe

FIRST, SECOND = 0.3, 0.1
PLANES = [0, 0.1, 0.2, *np.round(np.linspace(0.3, 0.7, 11), 9).tolist(), 0.8, 0.9, 1]

CASE = f"""
title = "Twist"
[mesh.box.block]
origin = [-3, -3, -3]
size = [6, 6, 3]
cells = [16, 16, 5]
planes_x = {PLANES}
planes_y = {PLANES}
ratio = [1, 1, 0.2]
[material.block]
model = "{{model}}"
E = 1000
nu = 0.3
[surface.ball]
shape = "sphere"
centre = [0, 0, 10]
radius = 10
[rigid.ball]
reference = [0, 0, 10]
[[contact]]
slave = "block.top"
master = "ball"
[contact.friction]
coefficients = [{FIRST}, {SECOND}]
sliding_rule = "{{rule}}"
directions = {{{{ kind = "constant", vector = [1, 0, 0], angle_deg = 30 }}}}
[[step]]
name = "press"
increments = 1
displacement = {{{{ "block.bottom" = {{{{ x = 0, y = 0, z = 0 }}}} }}}}
motion = {{{{ ball = {{{{ z = -0.1 }}}} }}}}
[[step]]
name = "turn"
increments = 3
motion = {{{{ ball = {{{{ rz_deg = 9 }}}} }}}}
"""


def mean(rule: str) -> float:
    """Friction over pressure along the slip, the mean over all directions of slip."""
    if rule == "maximum-dissipation":
        return float(2.0 / np.pi * FIRST * ellipe(1.0 - (SECOND / FIRST) ** 2))
    q = np.linspace(0.0, 2.0 * np.pi, 400, endpoint=False)
    return float(np.mean(1.0 / np.hypot(np.cos(q) / FIRST, np.sin(q) / SECOND)))


@pytest.mark.parametrize(
    ("rule", "model"),
    [
        ("maximum-dissipation", "linear-elastic"),
        ("coaxial", "linear-elastic"),
        ("maximum-dissipation", "neo-hookean"),
    ],
)
def test_twist(to_the_end: Callable[..., Any], rule: str, model: str) -> None:
    """Torque over the integral of pressure times radius."""
    run = to_the_end(CASE.format(rule=rule, model=model), most=8000)
    assert not run.cuts
    assert max(part.iterations for part in run.accepted) <= 6
    (contact,) = run.problem.contacts
    force, moment = contact.resultant()[:2]
    radius = np.hypot(*contact.points[:, :2].T)
    expected = mean(rule) * (contact.last.pressure * contact.areas * radius).sum()
    assert abs(moment[2]) == pytest.approx(expected, rel=3e-3)
    assert np.hypot(*force[:2]) < 0.01 * abs(force[2])
