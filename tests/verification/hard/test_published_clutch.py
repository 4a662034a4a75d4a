"""A cone clutch that is engaged and turned, and a fit that is turned and pulled at once.

Source: friction runs along the slip, so that a cone that turns has none along its generators
[Shigley, ch. 16]; on axes of friction slip is normal to the ellipse [R. Michalowski, Z. Mroz, Arch.
Mech. 30, 1978]: along a slip of the unit vector s

    T / N = (mu1^2 (s . e1) e1 + mu2^2 (s . e2) e2) / h ,
    h^2 = mu1^2 (s . e1)^2 + mu2^2 (s . e2)^2 .

Requirement: torque over N r and axial force over N in steady slip, with the pressures of the run;
corrections. Tolerance: none but that of the solver once what the ring gives way has been used up,
measured 3e-9 on the cone and 4e-5 on the shaft; at most 5 corrections.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

ANGLE, TURN = 12.0, 5.0
INCLINED = float(np.radians(ANGLE))

BODY = """
title = "Slip around and along an axis"
[idealisation]
kind = "axisymmetric"
lateral = true
[material.ring]
model = "{model}"
E = 1000
nu = 0.3
"""
CONE = f"""
[mesh.rectangle.ring]
origin = [0, 0]
size = [4, 4]
cells = [4, 8]
order = {{order}}
rotate = {{{{ axis = [0, 0, 1], angle_deg = {-ANGLE} }}}}
move = [10, 0, 0]
[surface.cone]
shape = "cone"
apex = [0, {-10.0 / float(np.tan(INCLINED))!r}, 0]
axis = [0, 1, 0]
angle_deg = {ANGLE}
[rigid.cone]
reference = [0, 0, 0]
[[contact]]
slave = "ring.left"
master = "cone"
[contact.friction]
coefficients = [0.3, 0.1]
directions = {{{{ kind = "coordinate-lines", angle_deg = {{axes}} }}}}
[[step]]
name = "engage"
increments = 1
displacement = {{{{ "ring.right" = {{{{ x = 0, y = 0, z = 0 }}}} }}}}
motion = {{{{ cone = {{{{ y = -0.1 }}}} }}}}
[[step]]
name = "turn"
increments = 6
motion = {{{{ cone = {{{{ ry_deg = {TURN} }}}} }}}}
"""
FIT = """
[mesh.rectangle.ring]
origin = [10, 0]
size = [10, 20]
cells = [5, 12]
order = {order}
[surface.shaft]
shape = "cylinder"
point = [0, 0, 0]
axis = [0, 1, 0]
radius = 10.01
[rigid.shaft]
reference = [0, 0, 0]
[[contact]]
slave = "ring.left"
master = "shaft"
[contact.friction]
coefficients = [0.3, 0.1]
directions = {{ kind = "constant", vector = [0, 1, 0], angle_deg = {axes} }}
[[step]]
name = "shrink"
increments = 1
displacement = {{ "ring.right" = {{ y = 0, z = 0 }} }}
[[step]]
name = "screw"
increments = 2
motion = {{ shaft = {{ y = 0.5, ry_deg = {turn} }} }}
"""


def friction(first: tuple[float, float], slip: Any) -> Any:
    """T / N around and along the axis, for a first axis and a slip in these components."""
    axes = np.array([first, (-first[1], first[0])])
    force = np.array([0.3, 0.1]) ** 2 * (axes @ slip)
    return axes.T @ force / np.linalg.norm([0.3, 0.1] * (axes @ slip))


def measured(run: Any) -> tuple[float, float]:
    """Torque over N r and axial force over N at the end."""
    (contact,) = run.problem.contacts
    force, moment = run.accepted[-1].resultants[contact.name][:2]
    normal = contact.last.pressure * contact.areas
    radius = np.hypot(*contact.points[:, ::2].T)
    return float(moment[1] / (normal @ radius)), float(force[1] / normal.sum())


@pytest.mark.parametrize(("axes", "order"), [(0.0, 1), (30.0, 1), (-50.0, 2)])
def test_cone_that_turns(to_the_end: Callable[..., Any], axes: float, order: int) -> None:
    """Grooves that wind around the cone draw it in or push it out."""
    run = to_the_end(BODY.format(model="neo-hookean") + CONE.format(axes=axes, order=order))
    assert not run.cuts
    assert max(a.iterations for a in run.accepted) <= 6
    # around the cone and along its generators, about its outward normal
    turned = np.radians(axes)
    around, along = friction((np.cos(turned), np.sin(turned)), np.array([1.0, 0.0]))
    axial = -np.sin(INCLINED) + along * np.cos(INCLINED)
    np.testing.assert_allclose(measured(run), (around, axial), rtol=1e-6)


@pytest.mark.parametrize(("axes", "turn"), [(0.0, 2.86), (40.0, 2.86), (-25.0, 8.0)])
def test_fit_that_is_screwed(to_the_end: Callable[..., Any], axes: float, turn: float) -> None:
    """Pull and torque of a shaft that goes along a helix."""
    run = to_the_end(
        BODY.format(model="linear-elastic") + FIT.format(axes=axes, order=1, turn=turn)
    )
    assert not run.cuts
    assert max(a.iterations for a in run.accepted) <= 5
    slip = np.array([10.01 * np.radians(turn), 0.5])
    turned = np.radians(axes)
    expected = friction((-np.sin(turned), np.cos(turned)), slip / np.linalg.norm(slip))
    np.testing.assert_allclose(measured(run), expected, atol=2e-4)
