"""A brake with a pivoted shoe on a drum with grooves that wind around it.

The shoe is stiff and turns about its pivot under a moment M; its lining, a normal penalty, gives
way. Source: the theory of the long shoe on a drum [Shigley, Mechanical Engineering Design, ch. 16].
The pressure goes with how far a place of the lining comes towards the drum, p = c (z x a) . e_r
with its arm a from the pivot, and so do drag and side force. Where the grooves are turned out of
the way around the drum, friction is normal to its ellipse: T / p = -(mu1^2 c1 a1 + mu2^2 c2 a2) / h
with the slip c1 a1 + c2 a2 and h^2 = (mu1 c1)^2 + (mu2 c2)^2. Then

    M_drum / M = -R int p T_t dA / int (a x (p e_r + p T_t e_t + p T_z e_z))_z dA .

Requirement: torque and side force, the drum turning towards the pivot (it helps the moment) and
away from it, adhesion along other axes than friction. Tolerance: measured 5e-5; 1e-4, the stiffness
of the shoe over that of the lining. Friction takes no less than nothing, and what is lost in a turn
of steady sliding is the work of the drum.
"""

from __future__ import annotations

import numpy as np
import pytest

RADIUS, WIDTH, PIVOT, MOMENT = 100.0, 20.0, (0.0, -120.0), 1e5
ENDS = np.radians([-50.0, 55.0])

CASE = """
title = "Brake"
[idealisation]
kind = "plane-strain"
thickness = 20
lateral = true
[mesh.annulus.shoe]
inner = 100
outer = 105
cells = [1, 24]
start_deg = -50
end_deg = 55
order = 2
[material.shoe]
model = "neo-hookean"
E = 2e6
nu = 0.2
[surface.drum]
shape = "cylinder"
point = [0, 0, 0]
axis = [0, 0, 1]
radius = 100
[rigid.drum]
reference = [0, 0, 0]
[rigid.shoe]
faces = ["shoe.outer"]
reference = [0, -120, 0]
[[contact]]
slave = "shoe.inner"
master = "drum"
method = "penalty"
normal = {{ penalty = 50 }}
[contact.adhesion]
stiffness = [400, 100]
directions = {{ kind = "coordinate-lines", angle_deg = 20 }}
[contact.friction]
coefficients = {friction}
directions = {{ kind = "coordinate-lines", angle_deg = {angle} }}
[[step]]
name = "touch"
increments = 1
motion = {{ shoe = {{ rz_deg = 0.05 }} }}
[[step]]
name = "press"
increments = 2
motion = {{ shoe = {{ rz_deg = "free" }} }}
load = {{ shoe = {{ rz = 1e5 }} }}
[[step]]
name = "turn"
increments = 4
motion = {{ drum = {{ rz_deg = {turn} }} }}
[[step]]
name = "go on"
increments = 4
motion = {{ drum = {{ rz_deg = {twice} }} }}
"""


def torque_and_side(
    friction: tuple[float, float], angle: float, turn: float
) -> tuple[float, float]:
    """Moment of the lining on the drum, and its force along the axis on the shoe."""
    first = np.array([np.cos(angle), np.sin(angle)])  # around the drum, along it
    axes = np.array([first, [-first[1], first[0]]])
    slip = axes @ [-np.sign(turn), 0.0]
    around, along = -axes.T @ (np.square(friction) * slip) / np.linalg.norm(friction * slip)
    a = np.linspace(*ENDS, 20001)
    out, tangent = np.array([np.cos(a), np.sin(a)]), np.array([-np.sin(a), np.cos(a)])
    arm = RADIUS * out - np.array(PIVOT)[:, None]
    pressure = arm[1] * out[0] - arm[0] * out[1]  # of a turn of 1 in the positive sense
    force = pressure * (out + around * tangent)
    moment = np.trapezoid(arm[0] * force[1] - arm[1] * force[0], a)
    share = -MOMENT / moment  # what the lining does to the shoe balances the moment
    total = share * np.trapezoid(pressure, a)
    return -total * around * RADIUS, total * along


@pytest.mark.parametrize("turn", [0.4, -0.4], ids=["helped", "hindered"])
@pytest.mark.parametrize(("friction", "angle"), [((0.3, 0.1), 35.0), ((0.5, 0.2), -60.0)])
def test_torque_of_a_brake_with_grooves(to_the_end, friction, angle, turn):
    run = to_the_end(
        CASE.format(friction=list(friction), angle=angle, turn=turn, twice=2 * turn), most=1000
    )
    drum, side = torque_and_side(friction, np.radians(angle), turn)
    rigid = run.problem.rigid
    (body,) = (body for body in rigid.bodies if body.name == "drum")
    assert rigid.contact_force(body)[5] == pytest.approx(drum, rel=1e-4)
    assert run.force("go on")[2] == pytest.approx(side, rel=1e-4)
    steady = [run.ends[step].energies for step in ("turn", "go on")]
    lost = steady[1]["friction"] - steady[0]["friction"]
    assert all(a.energies["friction"] >= 0.0 for a in run.accepted)
    assert lost == pytest.approx(abs(drum * np.radians(turn)), rel=1e-4)
