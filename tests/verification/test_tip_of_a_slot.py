"""A slender slot in a body, whose faces meet at its tips: nothing overlaps there."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.laws import Friction
from anisocontact.mesh import Body, Model, PlaneStrain, make_shape
from anisocontact.solver import Problem, Solver, Step


def _slotted(around: int, half: float) -> Model:
    """A ring from radius 1 to 2, its hole pressed flat to an ellipse of this half height."""
    shape = make_shape("annulus", inner=1.0, outer=2.0, cells=(6, around))
    arrays = Body("ring", shape).arrays()
    x = arrays.points.copy()
    x[:, 1] *= half + (1.0 - half) * (np.hypot(x[:, 0], x[:, 1]) - 1.0)
    hole, rim = arrays.facets["ring.inner"], arrays.facets["ring.outer"]
    above, out = (arrays.points[found].mean(axis=1)[:, 1] for found in (hole, rim))
    facets = arrays.facets | {
        "ring.a": hole[above > 0.0],
        "ring.b": hole[above < 0.0],
        "ring.top": rim[out > 1.4],
        "ring.bottom": rim[out < -1.4],
    }
    return Model.from_arrays(replace(arrays, points=x, facets=facets), idealisation=PlaneStrain())


def _pressed(model: Model, contacts: list[Contact], down: float, increments: int) -> float:
    """Force that moves the top down, length."""
    material = make_material("st-venant-kirchhoff", E=1000.0, nu=0.3)
    problem = Problem(model, {"ring": material}, contacts)
    held = {"ring.top": {"x": 0.0, "y": -down}, "ring.bottom": {"x": 0.0, "y": 0.0}}
    *_, last = Solver(problem, [Step("press", increments, held)]).run()
    return float(last.reactions["ring.top"][1])


def _contact(model: Model, how: str) -> Contact:
    sides: tuple[str, str] = ("ring.inner",) * 2 if how == "self" else ("ring.a", "ring.b")
    given: dict[str, Any] = {"self_contact": True} if how == "self" else {"mortar": True}
    return Contact(model, *sides, Friction(coefficients=0.1), **given)


@pytest.mark.parametrize("how", ["pair", "self"])
@pytest.mark.parametrize(("around", "half"), [(24, 0.02), (48, 0.05), (96, 0.02)])
def test_an_open_slot_has_no_contact_at_its_tips(how: str, around: int, half: float) -> None:
    """A slot that is pressed by an eighth of what closes it, its faces one group or two.

    Requirement: no gap below zero at the start, and the force is that without contact, to 1e-9.
    Source: nothing touches. The line of the facets of one face, gone on with up to the node at the
    tip, overlapped it along the normal of the other: a gap of -0.0018 and a quarter of the force.
    """
    model = _slotted(around, half)
    contact = _contact(model, how)
    assert contact.state["gap"].min() >= 0.0
    force = _pressed(model, [contact], 0.125 * half, 1)
    assert not contact.last.pressure.any()
    assert force == pytest.approx(_pressed(model, [], 0.125 * half, 1), rel=1e-9)


def test_a_slot_that_closes_meets_from_its_middle_on() -> None:
    """A slot pressed by three times its half height, its hole a group that meets itself or two.

    Requirement: the same force, 1e-9, and more than without contact. Source: one solid; only which
    facets may meet is said in two ways. Tolerance: that of equilibrium.
    """
    model = _slotted(24, 0.02)
    alone, pair, own = (
        _pressed(model, [_contact(model, how)] if how else [], 0.06, 3)
        for how in ("", "pair", "self")
    )
    assert own == pytest.approx(pair, rel=1e-9)
    assert own < 1.1 * alone < 0.0
