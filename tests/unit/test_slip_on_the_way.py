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
