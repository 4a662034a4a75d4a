"""When corrections are found without the factor of an earlier tangent."""

from __future__ import annotations

from anisocontact.solver.strategies.krylov_backoff import KrylovBackoff


def _skipped(backoff: KrylovBackoff) -> int:
    count = 0
    while backoff.skips():
        count += 1
    return count


def test_dear_corrections_in_succession_double_what_is_left_out() -> None:
    """Requirement: no more than a share of a few tries is lost where old factors serve no more.

    Source: doubling, so that n corrections have some log2(n) tries, 16 at most in between for
    bodies that come to rest again. One correction that is dear may be chance.
    """
    backoff = KrylovBackoff()
    found = []
    for _ in range(7):
        backoff.add(2.0, 1.0)
        found.append(_skipped(backoff))
    assert found == [0, 2, 4, 8, 16, 16, 16]


def test_a_cheap_one_ends_it() -> None:
    """What has cost no more than a factorisation of all unknowns has been worth it."""
    backoff = KrylovBackoff()
    for cost in (2.0, 1.0, 2.0):
        backoff.add(cost, 1.0)
    assert _skipped(backoff) == 0
    backoff.add(2.0, 1.0)
    assert _skipped(backoff) == 2


def test_it_goes_on_where_it_was() -> None:
    """A run that goes on after a stop has the corrections of the one that was not stopped."""
    backoff, again = KrylovBackoff(), KrylovBackoff()
    for _ in range(3):
        backoff.add(2.0, 1.0)
    backoff.skips()
    again.restore(backoff.persistent())
    for one in (backoff, again):
        assert _skipped(one) == 3
        one.add(2.0, 1.0)
        assert _skipped(one) == 8
