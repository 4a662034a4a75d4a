"""A metal sheet, clamped at one end, that a punch wipes over a round shoulder.

Source: the plastic moment of a wide sheet in bending (plane strain, von Mises; Marciniak Duncan Hu
2002, ch. 6), h thick, with linear hardening H,

    M(kappa) = 2/sqrt(3) (Y h^2 / 4 + 2/sqrt(3) H kappa h^3 / 12) .

Requirement: about the shoulder the force of the punch has a moment between that of the sheet
as it starts to flow throughout, `kappa = 0`, and that of one which lies on the shoulder, whose
middle then has the radius of the shoulder and half of the thickness; and all seven increments
take at most 150 corrections (measured 108; 268 before contact was settled in each). One node
touches on each side, and slides. Tolerance of the moment: 5 %, as the node that the
shoulder presses may be a quarter of a facet beside the place where the sheet would leave it,
on a lever of five (measured 2.5 %).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

YIELD, HARDENING, THICK, SHOULDER = 194.0, 500.0, 1.0, 4.0

CASE = f"""
title = "Sheet wiped over a shoulder"
[idealisation]
kind = "plane-strain"
[mesh.rectangle.sheet]
origin = [0, 0]
size = [40, {THICK}]
cells = [40, 2]
order = 2
[material.sheet]
model = "plastic"
E = 70.5e3
nu = 0.342
strain = "logarithmic"
yield_stress = {YIELD}
hardening = {HARDENING}
[surface.punch]
shape = "cylinder"
point = [29.2, 5, 0]
axis = [0, 0, 1]
radius = 4
[rigid.punch]
reference = [29.2, 5, 0]
[surface.shoulder]
shape = "cylinder"
point = [20, -{SHOULDER}, 0]
axis = [0, 0, 1]
radius = {SHOULDER}
[[contact]]
slave = "sheet.top"
master = "punch"
friction = {{ coefficients = 0.1 }}
[[contact]]
slave = "sheet.bottom"
master = "shoulder"
friction = {{ coefficients = 0.1 }}
[[step]]
name = "wipe"
increments = 7
displacement = {{ "sheet.left" = {{ x = 0, y = 0 }} }}
motion = {{ punch = {{ y = -4.9 }} }}
"""


@pytest.mark.ci
@pytest.mark.slow
def test_sheet_wiped_over_a_shoulder(to_the_end: Callable[..., Any]) -> None:
    """Moment of the punch about the shoulder, and all corrections."""
    run = to_the_end(CASE)
    punch, shoulder = run.problem.contacts
    lever = _centre(punch) - _centre(shoulder)
    force = run.accepted[-1].resultants[punch.name][0]
    moment = abs(lever[0] * force[1] - lever[1] * force[0])
    around = 1.0 / (SHOULDER + 0.5 * THICK)
    assert 0.95 * _moment(0.0) <= moment <= 1.05 * _moment(around)
    assert sum(part.iterations for part in run.accepted) <= 150


def _moment(curvature: float) -> float:
    """Of the sheet where it flows throughout, force x length / length."""
    wide = 2.0 / np.sqrt(3.0)
    hard = wide * HARDENING * curvature * THICK**3 / 12.0
    return float(wide * (YIELD * THICK**2 / 4.0 + hard))


def _centre(contact: Any) -> Any:
    """Where the pressure of a contact acts, (3,)."""
    return np.average(contact.points, axis=0, weights=contact.areas * contact.last.pressure)
