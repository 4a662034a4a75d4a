"""What friction dissipates where springs have let a body go on its way to equilibrium."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.contact.history import Slid, dissipated
from anisocontact.interface.states import STATE


def _state(slip, work, touching=(1, 1, 1)):
    """Three points: each has slipped so far, and friction has dissipated so much."""
    state = np.zeros(3, dtype=STATE)
    state["slip_accumulated"], state["dissipation"], state["status"] = slip, work, touching
    return state


def test_the_way_is_taken_piece_by_piece():
    """Three points that have slipped by 5 before, with 7 dissipated.

    Requirement: each piece of the way has the mean of the forces at both of its ends; a point that
    begins to slip has the force at which it yields; one that opens dissipates nothing more. Source:
    the trapezoidal rule by hand: 2 on a way of 1, then from 2 to 4 on a way of 2; 3 on a way of 2;
    2 on a way of 1. All of the end would be 12, 6 and 4. Tolerance: rounding.
    """
    start = _state((5, 5, 5), (7, 7, 7))
    way = Slid.of(_state((6, 5, 6), (9, 7, 9)))
    end = _state((8, 7, 7), (19, 13, 11), touching=(2, 2, 0))
    found = dissipated(start, [way], end, 1.0)
    np.testing.assert_allclose(found, [7 + 2 + 6, 7 + 6, 7 + 2], rtol=1e-14)
    np.testing.assert_allclose(dissipated(start, [], end, 0.5), [13, 10, 9], rtol=1e-14)


def test_a_point_that_closes_on_the_way_begins_without_force():
    """Requirement: friction of a point that was open grows from nothing as its pressure does.

    With the force of the end of the first piece two blocks that touched at the start dissipated
    twice as much in their first increment, 2.3 % of the work, where springs let them go as where
    none did. Source: the trapezoidal rule by hand: from 0 to 2 on a way of 1, then from 2 to 4 on
    a way of 2; nothing, then from 0 to 3 on a way of 2 of a point that closes in the end; a point
    that closes on the way and slips then from its force at yield, 3 on a way of 2.
    """
    start = _state((5, 5, 5), (7, 7, 7), touching=(0, 0, 0))
    way = Slid.of(_state((6, 5, 5), (9, 7, 7), touching=(2, 0, 1)))
    end = _state((8, 7, 7), (19, 13, 13), touching=(2, 2, 2))
    found = dissipated(start, [way], end, 1.0)
    np.testing.assert_allclose(found, [7 + 1 + 6, 7 + 3, 7 + 6], rtol=1e-14)
