"""A thin ring between rigid plates, from the first touch to where it lifts off in the middle.

Requirement: no cut, at most 100 corrections in all; at half the way the same force there and back;
at first that of linear theory. Source: a ring pinched by P gives way by P R^3 (pi / 4 - 2 / pi) /
(E I) [Timoshenko, Strength of Materials]; without friction there is one equilibrium. Tolerance:
measured 64 corrections, 6e-8 and 0.4 %, as the first way is 0.5 % of the radius. Points by the
edge of the contact, where gap and pressure are both about zero, opened and closed in turn, and a
correction that bends ended all contact.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

E, THICK = 1e6, 0.02

CASE = f"""
title = "Ring between plates"
[idealisation]
kind = "plane-strain"
[mesh.annulus.ring]
inner = {1 - THICK / 2}
outer = {1 + THICK / 2}
cells = [1, 24]
start_deg = -90
end_deg = 0
order = 2
[material.ring]
model = "neo-hookean"
E = {E}
nu = 0.0
[surface.plate]
shape = "plane"
point = [0, {-1 - THICK / 2}, 0]
normal = [0, 1, 0]
[rigid.plate]
reference = [0, -1, 0]
[[contact]]
slave = "ring.outer"
master = "plate"
friction = {{ coefficients = 0 }}
[[step]]
name = "pinch"
increments = 1
displacement = {{ "ring.start" = {{ x = 0 }}, "ring.end" = {{ y = 0 }} }}
motion = {{ plate = {{ y = 0.005 }} }}
[[step]]
name = "half"
increments = 1
motion = {{ plate = {{ y = 0.3 }} }}
[[step]]
name = "press"
increments = 1
motion = {{ plate = {{ y = 0.6 }} }}
[[step]]
name = "back"
increments = 1
motion = {{ plate = {{ y = 0.3 }} }}
"""


def test_pressed_until_it_lifts_off_and_let_go(to_the_end: Callable[..., Any]) -> None:
    """Forces on the quarter on the way there and back, without friction."""
    run = to_the_end(CASE)
    pinch, there, _, back = (run.force(step)[1] for step in ("pinch", "half", "press", "back"))
    assert not run.cuts
    assert sum(a.iterations for a in run.accepted) <= 100
    np.testing.assert_allclose(back, there, rtol=1e-6)
    linear = 0.01 * E * THICK**3 / 12.0 / (np.pi / 4.0 - 2.0 / np.pi) / 2.0
    np.testing.assert_allclose(pinch, linear, rtol=0.012)
