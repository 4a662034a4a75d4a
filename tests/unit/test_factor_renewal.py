"""When a kept factor is renewed."""

from __future__ import annotations

import pytest

from anisocontact.solver.strategies.condensed.factor_renewal import FactorRenewal


def _kept(renewal: FactorRenewal, own: float, used: float, most: int = 1000) -> int:
    """Corrections, two decimals each at a cost that does not change, up to a new factor."""
    renewal.begin(own)
    for count in range(1, most + 1):
        renewal.add(used, 1e-2)
        if renewal.due:
            return count
    return most


def test_a_factor_that_was_never_good_is_renewed() -> None:
    """All changes just after it was made, so that its corrections are dear from the first on.

    Requirement: it is kept until what they have cost beyond new ones is what a factor costs, so
    that no more than twice the least possible is lost, whatever follows. Costs do not grow with age
    here, so that their average alone never tells.
    """
    assert _kept(FactorRenewal(1, 1.0), 100.0, 24.0) == 1000
    assert _kept(FactorRenewal(1, 1.0, 2.0), 100.0, 24.0) == 6  # 20 more than four each: beyond 100


def test_renewals_that_do_not_help_become_rare() -> None:
    """Where every correction changes all anew, a new factor gains nothing: twice as long each."""
    renewal = FactorRenewal(1, 1.0, 2.0)
    assert [_kept(renewal, 100.0, 24.0) for _ in range(4)] == [6, 6, 11, 21]
    again = FactorRenewal(1, 1.0, 2.0)
    again.restore(renewal.persistent())
    assert _kept(again, 100.0, 24.0) == _kept(renewal, 100.0, 24.0)


@pytest.mark.parametrize("used", [1.0, 4.0])
def test_a_good_factor_is_kept(used: float) -> None:
    """Corrections as with a new one: nothing to gain."""
    assert _kept(FactorRenewal(1, 1.0, 2.0), 100.0, used) == 1000
