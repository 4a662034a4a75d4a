"""A rigid ball pressed and twisted on a body whose fibres stand on its surface, or lie around them.

Source: H. A. Elliott, Proc. Camb. Phil. Soc. 45 (1949) 621, and M. T. Hanson, J. Appl. Mech. 59
(1992) S123, for bodies alike in all directions around the normal: the pressure is that of Hertz,

    E* = 2 sqrt((C11 C33 - C13^2) / C11 / (1 / C44 + 2 / (sqrt(C11 C33) + C13))) ;

a disc that is turned is held by `16 / 3 G a^3`, G the geometric mean of the shear moduli along and
across the fibres. So the twist is that of J. L. Lubkin, J. Appl. Mech. 18 (1951) 183, with this G:
a sum of discs of the radii from c to a, so that friction holds all that is outside of c,

    twist = mu p0 / 2 G I(c) ,  torque = 8/3 mu p0 (c^3 I(c) + 3 int_c^1 s^2 I(s) ds) ,

`I(s) = K - E` of the parameter 1 - s^2, a = 1. Friction around the normal is 0.3, outwards next to
none, 3e-4, as the smallest ratio that there is: it leaves the pressure of Hertz.

Requirement: pressure at all nodes within 0.85 a but on the axis, over the largest, and the root
mean square of its error; twist at a torque of 0.8 of what friction holds; corrections. Tolerance:
measured 0.9 and 0.6 % with eight facets of order 1, 1.4 and 0.8 % with six of order 2, whose nodes
in the middle of facets are high; 0.2 to 0.7 %; 5. The node on the axis is left out: of order 1 it
is 2.7 % low, and half of that with half the facets, as the cell beside it has one slope.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk
from tests.verification.hard.drawn import graded

RADIUS, SIZE, MU, SHARE = 1000.0, 40.0, 0.3, 0.8

CASE = f"""
title = "Ball on end grain"
[idealisation]
kind = "axisymmetric"
lateral = true
[mesh.rectangle.block]
origin = [0, -{SIZE}]
size = [{SIZE}, {SIZE}]
cells = {{cells}}
planes_x = {{across}}
planes_y = {{down}}
order = {{order}}
[material.block]
model = "transversely-isotropic"
E_along = {{along}}
E_across = {{aside}}
nu_along = {{nu}}
nu_across = 0.3
G_along = 600
along = [0, 1, 0]
[surface.ball]
shape = "sphere"
centre = [0, {RADIUS}, 0]
radius = {RADIUS}
[rigid.ball]
reference = [0, {RADIUS}, 0]
[[contact]]
slave = "block.top"
master = "ball"
[contact.friction]
coefficients = [{1e-3 * MU}, {MU}]
directions = {{{{ kind = "polar", axis = [[0, 0, 0], [0, 1, 0]] }}}}
[[step]]
name = "touch"
increments = 1
displacement = {{{{ "block.bottom" = {{{{ x = 0, y = 0, z = 0 }}}} }}}}
motion.ball = {{{{ y = -0.001 }}}}
[[step]]
name = "press"
increments = 1
motion.ball = {{{{ y = "free" }}}}
load.ball = {{{{ y = {{load!r}} }}}}
[[step]]
name = "twist"
increments = 4
motion.ball = {{{{ ry_deg = "free" }}}}
load.ball = {{{{ ry = {{torque!r}} }}}}
"""


def stiffness(along: float, aside: float, nu: float) -> tuple[float, float]:
    """E* for pressing and G for twisting."""
    compliance = np.diag([1.0 / aside, 1.0 / aside, 1.0 / along])
    compliance[0, 1] = compliance[1, 0] = -0.3 / aside
    compliance[2, :2] = compliance[:2, 2] = -nu / along
    (c11, _, c13), _, (_, _, c33) = np.linalg.inv(compliance)
    mixed = 1.0 / 600.0 + 2.0 / (np.sqrt(c11 * c33) + c13)
    pressed = 2.0 * np.sqrt((c11 * c33 - c13**2) / c11 / mixed)
    return float(pressed), float(np.sqrt(600.0 * aside / 2.6))


def slipped(s: float) -> float:
    """I(s)."""
    return float(ellipk(1.0 - s * s) - ellipe(1.0 - s * s))


def torque(c: float) -> float:
    """Torque over mu p0 for stick to the radius c."""
    rest = quad(lambda s: s * s * slipped(s), c, 1.0)[0]
    return float(8.0 / 3.0 * ((c**3 * slipped(c) if c else 0.0) + 3.0 * rest))


def test_all_slips() -> None:
    """Source: the integral of mu p r over the contact, `pi^2 / 8`."""
    assert torque(0.0) == pytest.approx(np.pi**2 / 8.0, rel=1e-8)


@pytest.mark.parametrize(
    ("along", "aside", "nu", "facets", "order"),
    [(20e3, 1e3, 0.3, 8, 1), (1e3, 2e3, 0.1, 8, 1), (20e3, 1e3, 0.3, 6, 2)],
)
def test_pressed_and_twisted(
    to_the_end: Callable[..., Any], along: float, aside: float, nu: float, facets: int, order: int
) -> None:
    """For a contact of the radius 1."""
    pressed, sheared = stiffness(along, aside, nu)
    force = 4.0 * pressed / (3.0 * RADIUS)
    largest = 1.5 * force / np.pi
    across = graded(facets, round(1.6 * facets), SIZE)
    down = 1.0 - graded(facets, facets, SIZE)[::-1]
    text = CASE.format(
        cells=[len(across) - 1, len(down) - 1],
        across=across.tolist(),
        down=down.tolist(),
        order=order,
        along=along,
        aside=aside,
        nu=nu,
        load=-force,
        torque=float(SHARE * MU * largest * torque(0.0)),
    )
    run = to_the_end(text, most=6500)
    assert not run.cuts
    assert max(part.iterations for part in run.accepted) <= 6
    (contact,), (ball,) = run.problem.contacts, run.problem.rigid.free
    radii = contact.points[:, 0]
    inside = (radii < 0.85) & (radii > 1e-9)
    error = contact.last.pressure[inside] / largest - np.sqrt(1.0 - radii[inside] ** 2)
    assert np.abs(error).max() < 0.02
    assert np.sqrt(np.mean(error**2)) < 0.01
    c = brentq(lambda c: torque(c) - SHARE * torque(0.0), 1e-6, 1.0 - 1e-9)
    twist = MU * largest / (2.0 * sheared) * slipped(c)
    assert ball.accepted.turn[1] == pytest.approx(twist, rel=0.015)
