"""A clamped round plate that pressure bends on a floor under it: all contact in one increment.

Source: S. P. Timoshenko, S. Woinowsky-Krieger, Theory of Plates and Shells, ch. 3: outside of the
radius b a plate under the pressure q is

    w = q r^4 / 64 D + c1 + c2 ln r + c3 r^2 + c4 r^2 ln r ,

with w = w' = 0 at its clamped edge, and w = g, w' = w'' = 0 at b, where it comes to lie flat on the
floor under the gap g; that gives b too. The floor carries -8 pi D c4, a good deal of it as a line
force at b. So it is in membranes of pressure sensors that touch their base.

Requirement: the force of the floor and b with multipliers and with penalties, with friction and
without, from the first touch to contact all but at the edge, where half of all nodes and more close
in one increment; no cut. Tolerances: measured 1e-5 of the force with 60 cells of order 2 along a
radius of 50 thicknesses, 3e-3 under the largest pressure, where the free ring is nine thicknesses
wide and its shear counts; b to a cell. Corrections 52 at most.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq
from tests.verification.hard.case_texts import on_a_floor

EDGE, THICK, GAP, YOUNG, NU = 20.0, 0.4, 0.2, 1e5, 0.3
STIFF = YOUNG * THICK**3 / 12.0 / (1.0 - NU**2)

LOADED = """
{method}
friction = {{ coefficients = {friction} }}
[[step]]
name = "press"
increments = 1
displacement = {{ "plate.right" = {{ x = 0, y = 0 }} }}
pressure = {{ "plate.top" = {load} }}
"""


def exact(load: float) -> tuple[float, float]:
    """Radius of the contact, and force of the floor."""

    def terms(r: float) -> np.ndarray:
        """Deflection and two derivatives, of each constant and of the load."""
        own = load / STIFF * np.array([r**4 / 64.0, r**3 / 16.0, 3.0 * r**2 / 16.0])
        logs = np.array([np.log(r), 1.0 / r, -1.0 / r**2])
        both = np.array([r**2 * np.log(r), 2.0 * r * np.log(r) + r, 2.0 * np.log(r) + 3.0])
        return np.column_stack([[1.0, 0.0, 0.0], logs, [r**2, 2.0 * r, 2.0], both, own])

    def solved(b: float) -> np.ndarray:
        rows = np.concatenate([terms(EDGE)[:2], terms(b)[:2]])
        return np.asarray(np.linalg.solve(rows[:, :4], [0.0, 0.0, GAP, 0.0] - rows[:, 4]))

    def moment(b: float) -> float:
        return float(terms(b)[2] @ [*solved(b), 1.0])

    b = float(brentq(moment, 0.02 * EDGE, 0.98 * EDGE))
    return b, -8.0 * np.pi * STIFF * float(solved(b)[3])


PENALTY = 'method = "penalty"'
POINTS = 'method = "penalty"\npass = "single"'


@pytest.mark.parametrize(
    ("load", "method", "friction", "error"),
    [
        (0.1, "", 0.0, 2e-3),
        (0.5, "", 0.0, 1e-4),
        (0.5, "", 0.3, 1e-4),
        (50.0, "", 0.3, 6e-3),
        (0.5, PENALTY, 0.0, 1e-4),
        (0.5, POINTS, 0.3, 2e-4),
    ],
)
def test_touching_plate(
    to_the_end: Callable[..., Any], load: float, method: str, friction: float, error: float
) -> None:
    """Force of the floor, and radius of the contact."""
    cells = 120 if load > 1.0 else 60
    plate = on_a_floor(
        "plate", (EDGE, THICK), (cells, 1), YOUNG, kind="axisymmetric", nu=NU, order=2, gap=GAP
    )
    run = to_the_end(plate + LOADED.format(load=load, method=method, friction=friction))
    assert not run.cuts
    assert run.accepted[0].iterations <= 58
    b, force = exact(load)
    assert run.force("press")[1] == pytest.approx(force, rel=error)
    (contact,) = run.problem.contacts
    touching = contact.points[contact.last.pressure > 0.0, 0]
    assert touching.max() == pytest.approx(b, abs=1.2 * EDGE / cells + THICK * (load > 1.0))
