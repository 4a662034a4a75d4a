"""Rigid sphere on an elastic, perfectly plastic half-space: first yield and full plasticity.

Source: K. L. Johnson, Contact Mechanics, ch. 6.2 and 6.3: below the surface the von Mises condition
is first met at a peak pressure p0 = 1.60 Y (nu = 0.3), 0.48 a deep; the mean pressure rises from
1.07 Y with `x = E* a / (Y R)` and stays at 2.8 to 3 Y where flow is no longer contained, x > 30.
The body is that of the elastic test beside this file.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.interface import ContactLaw, Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import Model
from anisocontact.solver import Problem, Solver, Step
from anisocontact.surfaces import make_surface

RADIUS, E, NU = 40.0, 1000.0, 0.3
REDUCED = E / (1.0 - NU**2)
#: Cells across a unit of length, the size of the contact.
CELLS = 8


def _pressed(half_spaces: Any, limit: float, ways: list[tuple[float, int]]) -> np.ndarray:
    """Force, contact area, largest plastic strain and its depth after each increment.

    Args:
        half_spaces: Graded bodies.
        limit: Yield stress.
        ways: Approach at the end of each step and its increments.
    """
    body = half_spaces.body("block", CELLS, upper=False, growth=1.35)
    model = Model.from_arrays(body)
    sphere = make_surface(
        "sphere", centre=(0, 0, RADIUS), radius=RADIUS, axis=(1, 0, 0), start=(0, 1, 0)
    )
    law = ContactLaw(
        NormalLaw(penalty=20.0 * E * CELLS),
        Adhesion(stiffness=(1.0, 1.0)),
        Friction(coefficients=(1e-9, 1e-9)),
    )
    contact = Contact(model, "block.contact", Interface(sphere, law), mortar=False)
    steel = make_material("plastic", E=E, nu=NU, yield_stress=limit)
    problem = Problem(model, {"block": steel}, [contact])
    planes = {f"block.{axis}": {axis: 0.0} for axis in "xy"}
    steps = [Step(f"to {way:g}", n, planes | {"block.far": {"z": way}}) for way, n in ways]
    points = problem.bulk.histories["block"]
    found = []
    for _ in Solver(problem, steps).run():
        strain = points._read(points.variables["equivalent_plastic_strain"])
        most = int(strain.argmax())
        area = contact.areas[contact.last.pressure > 0.0].sum()
        force = abs(contact.resultant()[0][2])
        found.append((4.0 * force, 4.0 * area, strain[most], -points.places[most, 2]))
    return np.array(found)


@pytest.mark.slow
def test_first_yield(half_spaces: Any) -> None:
    """Requirement: yield begins at p0 = 1.60 Y, 0.48 a below the surface.

    Tolerance: 4 %, the way from one increment to the next is 2 % in p0, and integration points are
    0.06 a apart; depth to one cell. Measured: between 1.58 and 1.61 Y, 0.474 a deep.
    """
    limit = 2.0 * REDUCED / (np.pi * RADIUS) / 1.6  # at a = 1
    way = 0.93 / RADIUS
    found = _pressed(half_spaces, limit, [(0.8 * way, 1), (1.2 * way, 10)])
    first = int(np.argmax(found[:, 2] > 0.0))
    peaks = (6.0 * found[:, 0] * REDUCED**2 / (np.pi**3 * RADIUS**2)) ** (1.0 / 3.0) / limit
    assert first > 0
    assert peaks[first - 1] < 1.6 * 1.04
    assert peaks[first] > 1.6 * 0.96
    assert found[first, 3] == pytest.approx(0.48, abs=1.0 / CELLS)


@pytest.mark.slow
def test_full_plasticity(half_spaces: Any) -> None:
    """Requirement: the mean pressure rises to 2.8 to 3 Y beyond x = 30.

    Tolerance: that range and 3 %, the mean of all increments beyond: the area is that of points
    under pressure, which come one by one. Measured: 3.02 Y, single increments from 2.89 to 3.11.
    """
    limit = 0.6
    found = _pressed(half_spaces, limit, [(0.018, 18)])
    radius = np.sqrt(found[:, 1] / np.pi)
    x, mean = REDUCED * radius / (limit * RADIUS), found[:, 0] / found[:, 1] / limit
    last = mean[x > 30.0]
    assert last.size > 5
    assert 2.8 * 0.97 < last.mean() < 3.0 * 1.03
