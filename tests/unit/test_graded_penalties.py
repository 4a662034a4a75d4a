"""Penalties that are tried one after the other; their effect: hard/test_published_lifted_strip.py.

Source: continuation in the penalty, by tens; a raise that fails by its square root.
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.base.fenicsx import PETSc
from anisocontact.solver.stepping.graded_penalties import SOFT, GradedPenalties
from anisocontact.solver.strategies.newton import NewtonResult


def tried(largest: float) -> tuple[list[float], NewtonResult]:
    """Shares of the penalties where raises up to `largest` converge, in three corrections each."""
    shares: list[float] = []
    converged = [SOFT / largest]

    def solve(x: Any, full_steps: bool) -> NewtonResult:
        assert full_steps
        fails = shares[-1] > 1.001 * largest * converged[-1]
        x.array[:] = -1.0 if fails else shares[-1]
        if not fails:
            converged.append(shares[-1])
        return NewtonResult(3, [], "no convergence" if fails else "")

    trials = SimpleNamespace(by_penalty=True, soften_laws=shares.append)
    contacts: Any = [SimpleNamespace(trials=trials)]
    newton: Any = SimpleNamespace(solve=solve)
    result = GradedPenalties(contacts, newton).solve(PETSc.Vec().createSeq(1))
    assert shares[-1] == 1.0  # of the law, whatever came of it
    return shares[:-1], result


def test_penalties_are_raised_by_tens() -> None:
    shares, result = tried(10.0)
    assert shares == pytest.approx([1e-4, 1e-3, 1e-2, 1e-1, 1.0])
    assert (result.reason, result.iterations) == ("", 15)


def test_a_raise_that_fails_is_halved_in_its_exponent() -> None:
    shares, result = tried(4.0)
    root = 10.0**0.5
    assert shares == pytest.approx([1e-4, 1e-3, *(1e-4 * root**k for k in range(1, 9))])
    assert (result.reason, result.iterations) == ("", 30)


def test_raises_that_all_fail_end() -> None:
    shares, result = tried(1.2)
    assert shares == pytest.approx([1e-4, *(1e-4 * 10.0**k for k in (1.0, 0.5, 0.25))])
    assert result.reason
