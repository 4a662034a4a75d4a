"""A rigid cylinder slides on a block: its pressure leans back, as its friction lifts the front.

Source: K. L. Johnson, Contact Mechanics, sec. 7.1 and 8.1 (sliding of unlike bodies): with Dundurs'
constant beta = (1 - 2 nu) / 2 (1 - nu) of a rigid cylinder and tan(pi k) = beta mu, on a contact of
half-width a whose middle is 2 k a behind the axis,

    p = E* cos(pi k) / 2R (a + x)^(1/2 - k) (a - x)^(1/2 + k) ,    P = pi E* a^2 (1 - 4 k^2) / 4R .

The friction has two coefficients along axes at an angle to the way: mu along the way is h, that of
the ellipse, and beside it acts the lateral force of slip normal to it, which the pressure does not
feel [Michalowski, Mroz 1978].

Requirement: pressures at all nodes within 0.85 a are 1.5 % of the largest from it, root mean square
0.7 %, all that touches slides, friction over pressure is h, and in eight increments of the slide
also the lateral one, as points have to turn to it; at most seven corrections an increment.
Tolerance: measured 1.4 and 0.6 % with four facets of order 2 across a, 0.9 and 0.4 % with eight of
order 1, 1e-4, 1.2e-3, and 6 corrections: pressures are 1e-4 of E and the cylinder is 1e4 large, so
that rounding of its surface is not far below them; with rounding of the nodes alone it took 682.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from tests.verification.hard.drawn import graded

RADIUS, EXTENT, ALONG, ACROSS = 1e4, 60.0, 1.0, 0.4

CASE = """
title = "Sliding cylinder"
[idealisation]
kind = "plane-strain"
lateral = true
[mesh.rectangle.base]
origin = [-60, -60]
size = [120, 60]
cells = [{along}, {down}]
planes_x = {x}
planes_y = {y}
order = {order}
[material.base]
model = "linear-elastic"
E = 1000
nu = 0
[surface.roll]
shape = "cylinder"
point = [0, 1e4, 0]
axis = [0, 0, 1]
radius = 1e4
[rigid.roll]
reference = [0, 0, 0]
[[contact]]
slave = "base.top"
master = "roll"
[contact.friction]
coefficients = [{mu_1}, {mu_2}]
directions = {{ kind = "constant", vector = [1, 0, 0], angle_deg = {angle} }}
[[step]]
name = "press"
increments = 1
displacement."base.bottom" = {{ x = 0, y = 0, z = 0 }}
motion.roll = {{ y = -2.7e-4 }}
[[step]]
name = "slide"
increments = 8
motion.roll = {{ x = 4.8e-3 }}
"""


@pytest.mark.parametrize(("angle", "facets", "order"), [(0.0, 8, 1), (35.0, 8, 1), (-60.0, 4, 2)])
def test_pressure(to_the_end: Callable[..., Any], angle: float, facets: int, order: int) -> None:
    """Axes of friction at an angle to the way."""
    x = graded(facets, 8 * facets // 5, EXTENT)
    text = CASE.format(
        along=2 * len(x) - 2,
        down=len(x) - 1,
        x=(0.5 + 0.5 * np.concatenate([-x[:0:-1], x])).tolist(),
        y=(1.0 - x[::-1]).tolist(),
        order=order,
        mu_1=ALONG,
        mu_2=ACROSS,
        angle=angle,
    )
    run = to_the_end(text, most=15_000)
    assert not run.cuts
    assert max(part.iterations for part in run.accepted) <= 7
    (contact,) = run.problem.contacts
    cos, sin = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    h = np.hypot(ALONG * cos, ACROSS * sin)
    drag, pressed, side = run.force("slide") / abs(run.force("slide")[1])
    assert pressed == -1.0
    assert drag == pytest.approx(h, rel=2e-4)
    assert side == pytest.approx((ALONG**2 - ACROSS**2) * cos * sin / h, abs=2e-3)
    k, force = np.arctan(0.5 * h) / np.pi, abs(run.force("slide")[1])
    a = np.sqrt(4.0 * force * RADIUS / (np.pi * 1000.0 * (1.0 - 4.0 * k**2)))
    place, pressure = contact.points[:, 0] + 2.0 * k * a, contact.last.pressure
    assert np.all(contact.last.status[pressure > 0.0] == 2)
    inside = np.abs(place) < 0.85 * a
    ahead, behind = a - place[inside], a + place[inside]
    exact = 1000.0 * np.cos(np.pi * k) / (2.0 * RADIUS) * behind ** (0.5 - k) * ahead ** (0.5 + k)
    error = (pressure[inside] - exact) / pressure.max()
    assert np.abs(error).max() < 0.015
    assert np.sqrt(np.mean(error**2)) < 0.007
