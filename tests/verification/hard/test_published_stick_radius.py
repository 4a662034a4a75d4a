"""Tools of revolution pressed on a block with friction: the radius within which points stick.

Source: D. A. Spence, The Hertz contact problem with finite friction, J. Elasticity 5 (1975) 297;
K. L. Johnson, Contact Mechanics, sec. 5.4: under any profile r^n the middle sticks from the first
touch on to one share k = c / a of the contact, that of a flat punch. With Dundurs' constant beta,
of a rigid tool `(1 - 2 nu) / 2 (1 - nu)`,

    (1 / 2 k) ln((1 + k) / (1 - k)) = mu / beta K(sqrt(1 - k^2)) .

Requirement: what sticks and what slips is right at every node, but for those within half a facet
of c and at the edge, under a cone, a sphere and the fourth power of r, facets of order 1 and 2; at
most six corrections an increment. Tolerance: what the shear does to the pressure is left out of the
closed form; it makes k less by 0.02 (the coupled equations, solved by Abel's transform). Slopes of
the tools are 1e-4: the pressure on them acts along the face as friction does.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import ellipk
from tests.verification.hard.drawn import graded

NU, SLOPE, SIZE, INCREMENTS = 0.35, 1e-4, 30.0, 8
BETA = (1.0 - 2.0 * NU) / (2.0 * (1.0 - NU))

CASE = """
title = "Stick under a tool"
[idealisation]
kind = "axisymmetric"
[mesh.rectangle.block]
origin = [0, -{size}]
size = [{size}, {size}]
cells = [{cells}, {cells}]
planes_x = {across}
planes_y = {down}
order = {order}
[material.block]
model = "linear-elastic"
E = 1000
nu = {nu}
[surface.tool]
{tool}
[rigid.tool]
reference = [0, 0, 0]
[amplitude.grown]
kind = "table"
time = {times}
value = {values}
[[contact]]
slave = "block.top"
master = "tool"
friction = {{ coefficients = {mu!r} }}
[[step]]
name = "press"
increments = {increments}
displacement."block.bottom" = {{ x = 0, y = 0 }}
motion.tool = {{ y = {{ value = {depth!r}, amplitude = "grown" }} }}
"""

_R = np.linspace(0.0, 2.0, 41)
_FOURTH = np.column_stack([_R, SLOPE * _R**4]).tolist()
#: Power of the profile, surface, and depth of a contact of radius 1 without friction [Sneddon].
TOOLS = {
    "cone": (
        1,
        f'shape = "cone"\napex = [0, 0, 0]\naxis = [0, 1, 0]\n'
        f"angle_deg = {90.0 - float(np.degrees(SLOPE))!r}",
        0.5 * np.pi * SLOPE,
    ),
    "sphere": (
        2,
        f'shape = "sphere"\ncentre = [0, {1.0 / SLOPE!r}, 0]\nradius = {1.0 / SLOPE!r}',
        SLOPE,
    ),
    "quartic": (
        4,
        'shape = "revolution"\npoint = [0, 0, 0]\naxis = [0, 1, 0]\nspline = true\n'
        f"profile = {_FOURTH}",
        8.0 / 3.0 * SLOPE,
    ),
}


def stick(mu: float) -> float:
    """Radius of stick over that of contact."""

    def apart(k: float) -> float:
        return float(0.5 / k * np.log((1.0 + k) / (1.0 - k)) - mu / BETA * ellipk(1.0 - k * k))

    return float(brentq(apart, 1e-6, 1.0 - 1e-12))


@pytest.mark.parametrize(
    ("tool", "facets", "order", "share"),
    [("cone", 8, 1, 0.7), ("sphere", 8, 1, 0.5), ("sphere", 4, 2, 1.0), ("quartic", 8, 1, 0.7)],
)
def test_stick_radius(
    to_the_end: Callable[..., Any], tool: str, facets: int, order: int, share: float
) -> None:
    """Facets across the contact, friction over Dundurs' constant."""
    power, surface, depth = TOOLS[tool]
    x, times = graded(facets, 5 * facets // 4, SIZE), np.linspace(0.0, 1.0, INCREMENTS + 1)
    text = CASE.format(
        size=SIZE,
        cells=len(x) - 1,
        across=x.tolist(),
        down=(1.0 - x[::-1]).tolist(),
        order=order,
        nu=NU,
        tool=surface,
        times=times.tolist(),
        values=(times**power).tolist(),
        mu=share * BETA,
        increments=INCREMENTS,
        depth=-depth,
    )
    run = to_the_end(text, most=5000)
    assert not run.cuts
    assert max(part.iterations for part in run.accepted) <= 6
    (contact,) = run.problem.contacts
    r, status, half = contact.points[:, 0], contact.last.status, 0.5 / facets
    k = stick(share * BETA)
    assert np.all(status[r > 1.0 + 2.0 * half] == 0)
    assert np.all(status[r < k - half] == 1)
    assert np.all(status[(r > k + half) & (r < 1.0 - half)] == 2)
