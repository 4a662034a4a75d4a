"""How points open and close from one correction to the next where multipliers follow.

Source: complementarity, N >= 0, g >= 0, N g = 0, and the changes that the rules of
`contact/active_set.py` allow. Exact: what is asked is which points press, but for the forces that
held points are said not to have, 1e-12 of what the penalty makes of the gap.
"""

from __future__ import annotations

import numpy as np
import pytest
from mpi4py import MPI

from anisocontact.base.array_types import Floats
from anisocontact.contact.active_set import Active, ActiveSet
from anisocontact.contact.multipliers import Multipliers
from anisocontact.interface.augmentation import Augmentation
from anisocontact.interface.states import STATE, State

PENALTY = 1e3


def changed(
    multiplier: list[float],
    gap: list[float],
    before: list[int],
    *,
    singly: bool,
    kept: bool = False,
    fixed: tuple[int, ...] = (),
    needed: bool = False,
) -> tuple[list[int] | None, Floats]:
    """Points that press after they are restrained, None if they are not; and their pressures."""
    start = np.zeros(len(gap), dtype=STATE)
    start["multiplier"] = multiplier
    gaps = np.array(gap)
    pressure = pressures(start, gaps)
    numbers = np.arange(len(gap))
    active = ActiveSet(MPI.COMM_SELF, needed)
    active.singly = singly
    own = Multipliers(Augmentation(), 1.0, (PENALTY, PENALTY), MPI.COMM_SELF)
    about, free = Active(np.isin(numbers, before), kept), np.isin(numbers, fixed)
    new = active.restrained(start, gaps, pressure, about, free, own)
    if new is None:
        return None, pressure
    assert active.kept == (not (pressure > 0.0).any())
    found = pressures(new, gaps)
    return np.flatnonzero(found > 0.0).tolist(), found


def pressures(state: State, gap: Floats) -> Floats:
    """As the projections of Alart and Curnier answer."""
    return np.asarray(np.maximum(state["multiplier"] - PENALTY * gap, 0.0))


def test_the_deepest_point_closes_alone() -> None:
    """Points 1 and 2 go into the master, 2 deeper, while 0 stays: one after the other, or both."""
    multiplier, gap = [5.0, 0.0, 2.0], [0.0, -1e-3, -2e-3]
    assert changed(multiplier, gap, [0], singly=False)[0] is None
    assert changed(multiplier, gap, [0], singly=True)[0] == [0, 2]


def test_points_open_before_any_closes() -> None:
    """Point 0 is pulled off: it opens, and 2, which is in the master, waits."""
    assert changed([-5.0, 3.0, 0.0], [0.0, 0.0, -1e-3], [0, 1], singly=True)[0] == [1]


def test_a_point_that_closes_alone_is_no_matter() -> None:
    """Nor are points that are left to their penalty."""
    assert changed([5.0, 0.0], [0.0, -1e-3], [0], singly=True)[0] is None
    gap = [0.0, -1e-3, -1e-2]
    assert changed([5.0, 0.0, 0.0], gap, [0], singly=True, fixed=(2,))[0] is None


@pytest.mark.parametrize("gap", [0.0, 5e-5, -5e-5])
def test_a_correction_does_not_end_all_contact(gap: float) -> None:
    """Points that a correction has brought to the master are kept, with no force, and once."""
    found, pressure = changed([-5.0, 0.0], [gap, 0.1], [0], singly=False)
    assert found == [0]
    assert pressure[0] < 1e-11
    assert changed([-5.0, 0.0], [gap, 0.1], [0], singly=False, kept=True)[0] is None


def test_points_that_have_gone_away_are_let_go() -> None:
    """Beyond a share of a facet, 1e-4, the correction has not brought them to the master."""
    assert changed([-5.0, 0.0], [2e-4, 0.1], [0], singly=False)[0] is None


@pytest.mark.parametrize("kept", [False, True])
def test_a_body_that_contact_alone_holds_keeps_what_presses(kept: bool) -> None:
    """All open, 0 and 1 are pressed, 1 more than a facet away: 0 stays, also the next time."""
    multiplier, gap = [5.0, 5.0, -5.0], [0.02, 2.0, 1e-5]
    assert changed(multiplier, gap, [0, 1], singly=False, needed=True, kept=kept)[0] == [0]
    assert changed(multiplier, gap, [0, 1], singly=False, kept=kept)[0] is None
