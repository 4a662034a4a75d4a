"""A rigid wheel that rolls with creep on a bed of bristles: the brush model of a tyre.

Source: H. Fromm, Z. angew. Math. Mech. 7 (1927) 27; H. B. Pacejka, Tyre and Vehicle Dynamics
(2006), sec. 3.2. Bristles are springs of their own, normal to the bed (a penalty e) and along it (a
stiffness of adhesion K): of a contact of half-width a = sqrt(2 R d) they press by
p = e s (2a - s) / 2R, s behind its front, and are carried along by the creepage c, K c s, until
friction lets them go. Alike all ways, with f = R K c / mu e a < 1,

    F = mu P f (3 - 3 f + f^2) .

With two stiffnesses and two coefficients of friction along axes of their own there is no closed
form: traction and slip of one bristle on its way through the contact are integrated here, T = K e,
slip normal to the ellipse of mu p. That is all, as bristles know nothing of each other.

Requirement: forces along and across the way on a stiff block with these penalties, by a node an
increment, over the force as a whole, which with finer facets are half as far off; tractions at all
nodes, root mean square over the largest; corrections. Tolerance: measured 0.5 to 1.1 % with eight
facets across a, 0.5 % with 16 and 0.3 % with eight of order 2, as the front reaches a bristle up to
a facet before an increment ends; tractions 0.06 to 0.5 %, most where they begin to slip. Two
corrections in an increment.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

RADIUS, DEPTH, PENALTY, WAY = 1000.0, 5e-4, 1e3, 3.0
A = np.sqrt(2.0 * RADIUS * DEPTH)

CASE = """
title = "Brush model"
[idealisation]
kind = "plane-strain"
lateral = true
[mesh.rectangle.bed]
origin = [-1.5, -0.5]
size = [{length}, 0.5]
cells = [{cells}, 2]
order = {order}
[material.bed]
model = "linear-elastic"
E = 1e9
nu = 0
[surface.wheel]
shape = "cylinder"
point = [0, 1000, 0]
axis = [0, 0, 1]
radius = 1000
[rigid.wheel]
reference = [0, 1000, 0]
[[contact]]
slave = "bed.top"
master = "wheel"
physical_penalty = true
normal = {{ penalty = 1000 }}
[contact.adhesion]
stiffness = {stiffness}
directions = {{ kind = "constant", vector = [1, 0, 0], angle_deg = {of_adhesion} }}
[contact.friction]
coefficients = {friction}
directions = {{ kind = "constant", vector = [1, 0, 0], angle_deg = {of_friction} }}
[[step]]
name = "press"
increments = 1
displacement = {{ "bed.bottom" = {{ x = 0, y = 0, z = 0 }} }}
motion.wheel = {{ y = -5e-4 }}
[[step]]
name = "roll"
increments = {increments}
motion.wheel = {{ x = {way}, z = {drift!r}, rz_deg = {turn!r} }}
"""


def along(values: tuple[float, float], angle: float) -> np.ndarray:
    """Tensor that has values along axes at an angle in degrees to the way."""
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    axes = np.array([[c, -s], [s, c]])
    return np.asarray(axes @ np.diag(values) @ axes.T)


def bristle(
    stiffness: np.ndarray, friction: np.ndarray, creep: np.ndarray, steps: int = 2000
) -> tuple[np.ndarray, np.ndarray]:
    """Places behind the front, and the traction of a bristle there.

    Args:
        stiffness: K.
        friction: Tensor whose axes and values are those of the friction ellipse.
        creep: What the wheel gains on the bed in a unit of way.
        steps: How many are taken across the contact.
    """
    places = (np.arange(steps) + 0.5) * 2.0 * A / steps
    tractions, elastic = [], np.zeros(2)
    for s in places:
        elastic = elastic + creep * 2.0 * A / steps
        traction = stiffness @ elastic
        pressure = PENALTY * s * (2.0 * A - s) / (2.0 * RADIUS)
        ellipse = np.linalg.inv(pressure**2 * friction @ friction)

        def back(
            slip: float, trial: np.ndarray = traction, shape: np.ndarray = ellipse
        ) -> np.ndarray:
            return np.linalg.solve(np.eye(2) + slip * stiffness @ shape, trial)

        def beyond(slip: float, shape: np.ndarray = ellipse, to: Any = back) -> float:
            return float(to(slip) @ shape @ to(slip)) - 1.0

        if beyond(0.0) > 0.0:
            most = 1e-12
            while beyond(most) > 0.0:
                most *= 10.0
            traction = back(brentq(beyond, 0.0, most, rtol=1e-12))
        elastic = np.linalg.solve(stiffness, traction)
        tractions.append(traction)
    return places, np.array(tractions)


def test_closed_form() -> None:
    """Bristles alike all ways."""
    mu, spring, creep = 0.3, 400.0, 3e-4
    _, tractions = bristle(spring * np.eye(2), mu * np.eye(2), np.array([creep, 0.0]))
    part = RADIUS * spring * creep / (mu * PENALTY * A)
    held = mu * PENALTY * 2.0 * A**3 / (3.0 * RADIUS)
    force = 2.0 * A * tractions[:, 0].mean()
    assert force == pytest.approx(held * part * (3.0 - 3.0 * part + part**2), rel=1e-3)


#: Stiffnesses, their angle, friction coefficients, their angle, creepages.
ALIKE = ((400.0, 400.0), 0.0, (0.3, 0.3), 0.0, (3e-4, 0.0))
ACROSS = ((400.0, 100.0), 30.0, (0.3, 0.1), -20.0, (1e-4, 0.0))
BRAKED = ((400.0, 100.0), 30.0, (0.3, 0.1), 30.0, (-1e-3, 3e-4))


@pytest.mark.parametrize(
    ("bristles", "facets", "order", "error"),
    [
        (ALIKE, 8, 1, 0.008),
        (ACROSS, 8, 1, 0.015),
        pytest.param(BRAKED, 8, 1, 0.01, marks=pytest.mark.slow),
        pytest.param(ACROSS, 16, 1, 0.0075, marks=pytest.mark.slow),
        pytest.param(ACROSS, 8, 2, 0.005, marks=pytest.mark.slow),
    ],
)
def test_rolling_on_bristles(
    to_the_end: Callable[..., Any], bristles: Any, facets: int, order: int, error: float
) -> None:
    """Forces and tractions at the end, when all bristles in the contact have come in rolling."""
    springs, of_adhesion, friction, of_friction, creep = bristles
    run = to_the_end(
        CASE.format(
            length=WAY + 3.0,
            cells=round((WAY + 3.0) * facets),
            order=order,
            stiffness=list(springs),
            of_adhesion=of_adhesion,
            friction=list(friction),
            of_friction=of_friction,
            increments=round(WAY * facets * order),
            way=WAY,
            drift=creep[1] * WAY,
            turn=-float(np.degrees((1.0 - creep[0]) * WAY / (RADIUS - DEPTH))),
        )
    )
    assert not run.cuts
    assert max(part.iterations for part in run.accepted) <= 2
    places, tractions = bristle(
        along(springs, of_adhesion), along(friction, of_friction), np.array(creep)
    )
    exact = 2.0 * A * tractions.mean(axis=0)
    found = run.force("roll")[[0, 2]]
    assert np.abs(found - exact).max() < error * np.linalg.norm(exact)
    (contact,) = run.problem.contacts
    touches = contact.last.pressure > 0.0
    behind = A + WAY - contact.points[touches, 0]
    sought = np.stack([np.interp(behind, places, tractions[:, k]) for k in (0, 1)], axis=1)
    off = contact.last.traction[touches][:, [0, 2]] - sought
    assert np.sqrt(np.mean(off**2)) < 0.006 * np.abs(sought).max()
