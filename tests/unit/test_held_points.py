"""Points that alternate between facets of unequal normal: how they are seen, held and named."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.contact import Contact
from anisocontact.contact.held_points import BEYOND, facet_of
from anisocontact.interface import ContactLaw
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import BoxSpec, build_box
from anisocontact.solver.stepping.acceptance import held_points_stray
from anisocontact.solver.stepping.convergence_diagnostics import find_culprits
from anisocontact.solver.stepping.status_watch import StatusWatch

#: Slope of both facets of the base, which fall towards their common side at x = 1.
SLOPE = 0.2


def _over_a_valley() -> tuple[Contact, Any, Any]:
    """A block of a facet above a valley of two, displacements by its place, and the model."""
    boxes = {
        "block": BoxSpec((0.9, 0.4, 0), (0.2, 0.2, 0.2), (1, 1, 1)),
        "base": BoxSpec((0, 0, -1), (2, 1, 1), (2, 1, 1)),
    }
    model = build_box(boxes)
    penalty = 10.0
    law = ContactLaw(
        NormalLaw(penalty=penalty),
        Adhesion(stiffness=(penalty, penalty)),
        Friction(coefficients=(0.3, 0.3)),
    )
    contact = Contact(
        model, "block.bottom", "base.top", law=law, degree=1, reach=1.0, current_area=False
    )
    x = model.space.tabulate_dof_coordinates()
    base = np.unique(contact.master.facets)

    def moved(by: float, up: float) -> np.ndarray:
        u = np.zeros_like(x)
        u[base, 2] = SLOPE * np.abs(x[base, 0] - 1.0)
        u[np.unique(contact.slave_points.nodes)] = [by, 0.0, up]
        return u

    return contact, moved, model


def test_a_held_point_stays_on_its_facet():
    """Beyond the side its gap is that of the facet continued: a plane through it.

    Source: a plane of slope s through the side, gap = (z - s (1 - x)) / sqrt(1 + s^2); the other
    facet would give z - s (x - 1). They differ by 2 s (x - 1) / sqrt(1 + s^2). Tolerance: rounding.
    """
    contact, moved, _ = _over_a_valley()
    contact.update(moved(-0.05, -0.02), 1.0)
    left = contact.projected_facets()
    contact.hold(np.ones(len(left), dtype=bool))
    contact.update(moved(0.05, -0.02), 1.0)
    np.testing.assert_array_equal(contact.projected_facets(), left)
    held = (-0.02 + SLOPE * 0.05) / np.hypot(1.0, SLOPE)
    np.testing.assert_allclose(contact.trial.gap, held, atol=1e-14)
    np.testing.assert_allclose(contact.strayed(), 2 * SLOPE * 0.05 / np.hypot(1.0, SLOPE))
    contact.roll_back()
    contact.update(moved(0.05, -0.02), 1.0)
    assert np.all(contact.projected_facets() != left)
    np.testing.assert_array_equal(contact.strayed(), 0.0)


def test_a_point_far_from_its_facet_is_let_go():
    """Farther than `BEYOND` from the facet it was held on, a point goes to the closest one."""
    contact, moved, _ = _over_a_valley()
    contact.update(moved(-0.05, -0.02), 1.0)
    left = contact.projected_facets()
    contact.hold(np.ones(len(left), dtype=bool))
    contact.update(moved(2.0 * BEYOND, -0.02), 1.0)
    assert np.all(contact.projected_facets() != left)


def test_points_held_beside_their_closest_are_let_go_once():
    """In equilibrium they go to the closest facet; where nothing is found they are held as before.

    Requirement: holding changes the way to a state, not the state. A point that is above the facet
    on which it is held has nothing to be let go for. Tolerance: none, the same operations.
    """
    contact, moved, _ = _over_a_valley()
    contact.update(moved(-0.05, -0.02), 1.0)
    contact.hold(np.ones(len(contact.projected_facets()), dtype=bool))
    assert not contact.trials.improve()
    contact.update(moved(0.05, -0.02), 1.0)
    held, gap = contact.projected_facets(), contact.trial.gap.copy()
    assert contact.trials.improve()
    contact.update(moved(0.05, -0.02), 1.0)
    assert np.all(contact.projected_facets() != held)
    np.testing.assert_array_equal(contact.strayed(), 0.0)
    assert not contact.trials.improve()
    assert contact.trials.soften()
    contact.update(moved(0.05, -0.02), 1.0)
    np.testing.assert_array_equal(contact.projected_facets(), held)
    np.testing.assert_array_equal(contact.trial.gap, gap)
    assert not contact.trials.improve()
    assert not contact.trials.soften()


@pytest.mark.parametrize(("by", "refuses"), [(1e-4, False), (0.05, True)])
def test_states_with_strayed_points_are_refused(by, refuses):
    """An error of the gap beyond a thousandth of a facet is no solution; its place is named.

    By the formula above it is 2e-4 and 0.1 of the facet.
    """
    contact, moved, model = _over_a_valley()
    contact.update(moved(-0.05, -0.001), 1.0)
    contact.hold(np.ones(len(contact.projected_facets()), dtype=bool))
    contact.update(moved(by, -0.001), 1.0)
    comm = SimpleNamespace(allgather=lambda one: [one])
    problem: Any = SimpleNamespace(contacts=[contact], comm=comm, model=model)
    found = held_points_stray(problem, None)
    assert (found is not None) == refuses
    if found is not None:
        assert "1 slave points" in found.reason
        assert "the error of the gap is 0.1 of the facet size" in str(found.culprits[0])


def _contact(codes: list[int]) -> Any:
    held: list[np.ndarray] = []
    trial = SimpleNamespace(status=np.ones(1, dtype=np.int8))
    codes = list(codes)
    return SimpleNamespace(
        trial=trial,
        held=held,
        hold=held.append,
        located=lambda: np.ones(1, dtype=bool),
        projected_facets=lambda: np.array([codes.pop(0)]),
    )


@pytest.mark.parametrize(
    ("codes", "residuals", "alternate"),
    [
        ([3, 6, 3, 6, 6, 6, 6], [1.0, 0.9, 0.9, 0.8, 0.7, 0.6, 0.51], True),
        ([3, 6, 9, 3, 6, 6, 6], [1.0, 0.9, 0.9, 0.8, 0.7, 0.6, 0.51], True),
        ([3, 6, 9, 12, 9, 12, 9], [1.0] * 7, True),
        ([3, 6, 9, 12, 15, 18, 21], [1.0] * 7, False),
        ([3, 6, 3, 3, 3, 3, 3], [1.0] * 7, False),
        ([3, 6, 3, 6, 3, 6, 3], [1.0, 0.9, 0.9, 0.8, 0.7, 0.6, 0.49], False),
        ([3, 6, 3, 6, 3, 6], [1.0, 0.9, 0.98, 0.88, 0.96, 0.86], False),
        ([3, 6, 3, 6], [0.3, 0.2, 0.3, 0.2], True),
        ([6, 6, 3, 6, 3, 6], [9.0, 3.0, 1.0, 0.9995, 0.9995, 0.999], True),
        ([3, 6, 3, 6], [0.3, 0.2, 0.3, 0.1996], False),
        ([3, 6, 3], [0.3, 0.3, 0.3], False),
        ([3, 3, 3, 6], [0.3, 0.2, 0.3, 0.2], False),
    ],
    ids=[
        *("to and fro", "round a corner", "later", "slides on", "once", "halved", "too early"),
        *("repeats", "gains nothing", "falls a little", "three alone", "repeats, but stays"),
    ],
)
def test_points_that_alternate_are_held(codes, residuals, alternate):
    """Two returns to a facet of late, where the residual has not halved in six iterations.

    Or where it repeats every second time, to a thousandth of it: nothing would end that.
    """
    contact = _contact(codes)
    watch = StatusWatch([contact])
    for residual in residuals:
        watch.note(residual)
        watch.hold()
    assert any(flags.any() for flags in contact.held) == alternate
    watch.clear()
    assert not watch.alternating_facets()[0].any()


def test_a_point_that_hops_is_named_with_its_facets():
    """The message has both facets, by their numbers in the group of the master."""
    contact, moved, _ = _over_a_valley()
    watch = StatusWatch([contact])
    facets = set()
    for i in range(6):
        contact.update(moved(0.05 * (-1) ** i, -0.02), 1.0)
        facets.update(facet_of(contact.projected_facets()).tolist())
        watch.note(1.0)
    assert facets == {0, 1}
    comm = SimpleNamespace(allgather=lambda one: [one])
    problem: Any = SimpleNamespace(
        contacts=[contact], comm=comm, inverted_cells=lambda: np.zeros((0, 3))
    )
    (culprit,) = find_culprits(problem, watch, np.zeros(3))
    assert culprit.kind == "alternating facets"
    assert "alternates between the facets 0 and 1 of the master" in str(culprit)
