"""A block whose friction is oblique to a support slides along the support.

Source: R. L. Michalowski, Z. Mroz, Associated and non-associated sliding rules in contact friction
problems (Arch. Mech. 30, 1978): slip e along the support is normal to the ellipse of friction, so
that tractions are

    p A e / sqrt(e . A e),    A = sum of mu_i^2 a_i a_i ,

also across the support, where nothing moves. Multipliers along it follow from how points slip, and
not from any equilibrium there.

Requirement: force of the contact as all points slide, to and fro; corrections of an increment.
Tolerance: along the support 1e-6, as contacts are exact to 1e-8 of the forces; across it 1e-4, as
nodes beside the support slide ever more along it (1.4e-5 measured, 3.1e-5 after 0.4 of the way).
At most 7 corrections were measured.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from tests.verification.hard.case_texts import on_a_floor

ANGLE, MU, LOAD = 35.0, (0.6, 0.1), 10.0
HELD = '"block.front" = { y = 0 }'
LAWS = f"""
[contact.friction]
coefficients = {list(MU)}
directions = {{ kind = "constant", vector = [1, 0, 0], angle_deg = {ANGLE} }}
[[step]]
name = "press"
increments = 1
displacement = {{ {HELD} }}
pressure = {{ "block.top" = {LOAD} }}
"""
WAY = """
[[step]]
name = "{}"
increments = 3
displacement = {{ {}, "block.right" = {{ x = {} }} }}
pressure = {{ "block.top" = {} }}
"""


@pytest.mark.parametrize("order", [1, 2])
def test_slides_along_the_support(to_the_end: Callable[..., Any], order: int) -> None:
    """Both components of friction are those of the ellipse, whichever way the block goes."""
    text = on_a_floor("block", [2, 0.5, 0.5], [8, 2, 2], 1000, nu=0.3, order=order) + LAWS
    for name, way in (("drag", 0.25), ("back", -0.25)):
        text += WAY.format(name, HELD, way, LOAD)
    run = to_the_end(text)
    assert not run.cuts
    assert max(part.iterations for part in run.accepted) <= 10
    c, s = np.cos(np.radians(ANGLE)), np.sin(np.radians(ANGLE))
    a = MU[0] ** 2 * np.outer([c, s], [c, s]) + MU[1] ** 2 * np.outer([-s, c], [-s, c])
    friction = LOAD * a[0] / np.sqrt(a[0, 0])
    for step, sign in (("drag", -1.0), ("back", 1.0)):
        along, across = run.force(step)[:2]
        assert along == pytest.approx(sign * friction[0], rel=1e-6)
        assert across == pytest.approx(sign * friction[1], rel=1e-4)
