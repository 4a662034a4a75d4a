"""The number of increments changes the result only within the order of the time integration."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest

PAGE = Path(__file__).parents[2] / "docs" / "verification" / "finite-elements.md"
COUNTS = (4, 8, 16, 32, 64)
#: What the error is extrapolated from: the finest of them and twice as many increments.
FINE = (64, 128)
RULES = {"maximum-dissipation": {}, "explicit": {"history": "centre"}, "radial": {}}


@cache  # forces and energies are looked at by a test each
def end_of_path(fe, rule, increments):
    """Contact force and energies after a drag along x and a turn towards y, not yet steady."""
    from anisocontact.solver import Step

    interface = fe.interface(rule=rule, angle=0.5, **RULES[rule])
    block = fe.block(interface, cells=(2, 2, 1), young=1e4)
    steps = [
        Step("press", 4, {"block.top": {"x": 0.0, "y": 0.0, "z": -0.004}}),
        Step("along x", increments, {"block.top": {"x": 0.02}}),
        Step("along y", increments, {"block.top": {"y": 0.01}}),
    ]
    last = block.run(*steps, snes_rtol=1e-10)[-1]
    return last.resultants["block.bottom"][0], last.energies


def errors(fe, rule):
    """Relative error of the force for each number of increments, against infinitely many."""
    fine, finer = (end_of_path(fe, rule, n)[0] for n in FINE)
    limit = 2.0 * finer - fine
    found = [end_of_path(fe, rule, n)[0] for n in COUNTS]
    return [float(np.linalg.norm(f - limit) / np.linalg.norm(limit[:2])) for f in found]


def published(rule):
    """The column of the documentation's table."""
    rows = [r.strip("| \n").split("|") for r in PAGE.read_text().splitlines() if r.startswith("|")]
    head = next(i for i, row in enumerate(rows) if row[0].strip() == "increments of a leg")
    column = [c.strip(" `") for c in rows[head]].index(rule)
    return [float(row[column]) for row in rows[head + 2 : head + 2 + len(COUNTS)]]


@pytest.mark.ci
@pytest.mark.slow
@pytest.mark.parametrize("rule", RULES)
def test_first_order_in_the_increment(fe, rule):
    """Doubling the increments of a path that turns halves the error of the force.

    Requirement: the step count changes the results only within their order, and the table in the
    documentation is true. Source: backward Euler, first order, and the extrapolation
    [Richardson 1911] of two paths to infinitely many increments; from twice as many it is the same
    to 1e-5 of the force. Tolerance: the ratio of two errors tends to 2; the coarsest are not yet in
    the asymptotic range, hence 1.85 to 2.1. The table has two digits.
    """
    found = errors(fe, rule)
    ratios = np.array(found[:-1]) / np.array(found[1:])
    assert np.all((ratios > 1.85) & (ratios < 2.1))
    assert found == pytest.approx(published(rule), rel=0.05)


def test_balance_of_energy_closes_with_the_increment(fe):
    """External work less stored and dissipated energy vanishes as the increments get small.

    Requirement: balance of energy, residual at least of first order in the increment. Source:
    first law; backward Euler for the law, trapezoidal rule for the work, taken along the way where
    points begin to slip, see `contact_work`. Tolerance: the residual falls at least by half for
    twice the increments.
    """
    shares = []
    for n in (*COUNTS, 2 * COUNTS[-1]):
        _, energies = end_of_path(fe, "maximum-dissipation", n)
        shares.append(abs(energies["residual"]) / energies["external"])
    assert np.all(np.array(shares[1:]) < 0.5 * np.array(shares[:-1]))
    assert shares[-1] < 1e-4
