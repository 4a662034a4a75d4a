"""A ring turned on a face with spiral grooves, and with straight ones.

Source: the face clutch [J. E. Shigley, ch. 16] with the friction of every point that of the slip
around the axis, h(q) = |(m1 cos q, m2 sin q)| at the angle q to the first axis under slip normal to
the ellipse of friction [R. Michalowski, Z. Mroz, Arch. Mech. 30, 1978]. Spiral grooves have one
angle everywhere, M = h integral(p r), and push the ring outwards or inwards by the derivative of
h, which cancels over the whole; straight ones have the mean of h over all angles, an elliptic
integral.

Requirement: the torque over the integral of p r to 1e-6 on spiral grooves once the ring turns, 0.2
% on straight ones; no net force. Tolerance: measured 1e-9, as all nodes have slip of one angle to
their grooves, and 0.05 %, of a sum over 48 angles.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.special import ellipe

FIRST, SECOND = 0.3, 0.1

CASE = """
title = "Face clutch"
[mesh.ring.ring]
inner = 1
outer = 2
length = 0.5
cells = [4, 48, 1]
[material.ring]
model = "neo-hookean"
E = 1000
nu = 0
[surface.face]
shape = "plane"
point = [0, 0, 0]
normal = [0, 0, 1]
[rigid.hub]
faces = ["ring.top"]
reference = [0, 0, 0.5]
[[contact]]
slave = "ring.bottom"
master = "face"
friction = {{ coefficients = [0.3, 0.1], directions = {directions} }}
[[step]]
name = "press"
increments = 1
motion = {{ hub = {{ z = -0.001 }} }}
[[step]]
name = "turn"
increments = 3
motion = {{ hub = {{ rz_deg = 20 }} }}
"""


@pytest.mark.parametrize("angle", [30.0, -50.0, None])
def test_face_clutch(angle: float | None, to_the_end: Callable[..., Any]) -> None:
    """Torque over the integral of pressure times radius."""
    if angle is None:
        directions = '{ kind = "constant", vector = [1, 0, 0], angle_deg = 25 }'
        expected = 2.0 / np.pi * FIRST * ellipe(1.0 - (SECOND / FIRST) ** 2)
    else:
        directions = f'{{ kind = "polar", axis = [[0, 0, 0], [0, 0, 1]], angle_deg = {angle} }}'
        expected = np.hypot(FIRST * np.sin(np.radians(angle)), SECOND * np.cos(np.radians(angle)))
    run = to_the_end(CASE.format(directions=directions))
    (contact,) = run.problem.contacts
    force, moment = contact.resultant()[:2]
    radius = np.hypot(*contact.points[:, :2].T)
    pressed = (contact.last.pressure * contact.areas * radius).sum()
    assert abs(moment[2]) / pressed == pytest.approx(expected, rel=2e-3 if angle is None else 1e-6)
    assert np.hypot(*force[:2]) < 1e-8 * force[2]
    assert not run.cuts
