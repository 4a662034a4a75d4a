"""A hub shrunk on a hollow shaft with spiral grooves that is pulled out: a sector in space.

Hub and shaft are one of twelve sectors with cyclic symmetry, whose cut faces are apart by 7 degrees
so that each body meets what goes on beyond its own. Source: friction of slip normal to its ellipse
[R. Michalowski, Z. Mroz, Arch. Mech. 30, 1978]: a shaft that is free to turn does so along the
grooves and has no torque, and its force along the axis over that which presses it is

    1 / sqrt(F_zz) ,  F_zz = (h^2 / mu_1^2 + R^2 / mu_2^2) / (R^2 + h^2) ,

with h the pitch over 2 pi; without grooves it is the coefficient.

Requirement: force over pressure to 1e-3, torque below 1e-4 of it with grooves; with and without,
either side as the slave; at most 8 corrections, no cut. Tolerance: measured 5e-4 with grooves,
as R is where the bodies meet, 2e-5 without them; 3e-6; 6 corrections.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

RADIUS, PITCH, FRICTION, GROOVES = 10.0, 60.0, 0.2, (0.3, 0.1)

CASE = """
title = "Grooved fit, a sector"
[mesh.ring.shaft]
inner = 4
outer = 10.01
length = 20
start_deg = 0
end_deg = 30
cells = [3, 2, 4]
order = 2
[mesh.ring.hub]
inner = 10
outer = 20
length = 14
start_deg = 7
end_deg = 37
cells = [4, 3, 3]
order = 2
move = [0, 0, 3]
[material.shaft]
model = "neo-hookean"
E = 210e3
nu = 0.3
[material.hub]
model = "neo-hookean"
E = 70e3
nu = 0.3
[[cyclic]]
slave = "shaft.end"
master = "shaft.start"
sectors = 12
[[cyclic]]
slave = "hub.end"
master = "hub.start"
sectors = 12
[[contact]]
slave = "{sides[0]}"
master = "{sides[1]}"
friction = {{ coefficients = {friction} }}
[[step]]
name = "shrink"
increments = 1
displacement = {{ "hub.bottom" = {{ z = 0 }} }}
[step.cylindrical]
"hub.outer" = {{ tangential = 0 }}
"shaft.bottom" = {{ axial = 0{turn} }}
[[step]]
name = "pull"
increments = 3
cylindrical = {{ "shaft.bottom" = {{ axial = -0.05 }} }}
"""
SIDES = ("hub.inner", "shaft.outer")
SPIRAL = f'directions = {{ kind = "spiral", axis = [[0, 0, 0], [0, 0, 1]], pitch = {PITCH} }}'


@pytest.mark.slow
@pytest.mark.parametrize("grooves", [True, False])
@pytest.mark.parametrize("sides", [SIDES, SIDES[::-1]])
def test_pulled_out(to_the_end: Callable[..., Any], sides: tuple[str, str], grooves: bool) -> None:
    """Force along the axis and torque over what presses the shaft, in the last increment."""
    friction = f"[{GROOVES[0]}, {GROOVES[1]}], {SPIRAL}" if grooves else str(FRICTION)
    turn = "" if grooves else ", tangential = 0"
    text = CASE.format(sides=sides, friction=friction, turn=turn)
    run = to_the_end(text, most=5000)
    assert not run.cuts
    assert max(part.iterations for part in run.accepted) <= 8
    (contact,) = run.problem.contacts
    areas, traction = contact.areas, contact.last.traction
    normal = contact.last.pressure @ areas
    around = np.cross([0.0, 0.0, 1.0], contact.points * [1.0, 1.0, 0.0])
    around /= np.linalg.norm(around, axis=1)[:, None]
    along, torque = (abs(x @ areas) / normal for x in (traction[:, 2], (traction * around).sum(1)))
    if grooves:
        h = PITCH / (2.0 * np.pi)
        f = np.array([h, RADIUS]) / np.hypot(RADIUS, h) / GROOVES
        assert along == pytest.approx(1.0 / np.hypot(*f), rel=1e-3)
        assert torque < 1e-4
    else:
        assert along == pytest.approx(FRICTION, rel=1e-3)
