"""When corrections are found without the factor of an earlier tangent."""

from __future__ import annotations

from anisocontact.solver.strategies.trust import Trust


def _skipped(trust: Trust) -> int:
    count = 0
    while trust.skips():
        count += 1
    return count


def test_dear_corrections_in_succession_double_what_is_left_out() -> None:
    """Requirement: no more than a share of a few tries is lost where old factors serve no more.

    Source: doubling, so that n corrections have some log2(n) tries, 16 at most in between for
    bodies that come to rest again. One correction that is dear may be chance.
    """
    trust = Trust()
    found = []
    for _ in range(7):
        trust.add(2.0, 1.0)
        found.append(_skipped(trust))
    assert found == [0, 2, 4, 8, 16, 16, 16]


def test_a_cheap_one_ends_it() -> None:
    """What has cost no more than a factorisation of all unknowns has been worth it."""
    trust = Trust()
    for cost in (2.0, 1.0, 2.0):
        trust.add(cost, 1.0)
    assert _skipped(trust) == 0
    trust.add(2.0, 1.0)
    assert _skipped(trust) == 2


def test_it_goes_on_where_it_was() -> None:
    """A run that goes on after a stop has the corrections of the one that was not stopped."""
    trust, again = Trust(), Trust()
    for _ in range(3):
        trust.add(2.0, 1.0)
    trust.skips()
    again.restore(trust.persistent())
    for one in (trust, again):
        assert _skipped(one) == 3
        one.add(2.0, 1.0)
        assert _skipped(one) == 8
