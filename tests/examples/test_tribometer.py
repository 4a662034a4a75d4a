"""A pin under a constant force goes round a circle on a brushed disc."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.special import ellipe

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.results import Results

CASE = Path(__file__).parents[2] / "examples" / "tribometer" / "case.toml"
NORMAL, RADIUS, MU = 50.0, 10.0, (0.12, 0.3)
#: Increments of a turn.
TURN = 64


@pytest.fixture(scope="module")
def results(tmp_path_factory, solved) -> Results:
    """The results folder of the example."""
    return solved(CASE, tmp_path_factory.mktemp("tribometer") / "out")


@pytest.mark.ci
@pytest.mark.slow
def test_work_of_a_turn(results: Results) -> None:
    """Work of the reference point along a turn, and what friction has taken up meanwhile.

    Requirement: `4 N r mu_2 E(1 - (mu_1/mu_2)^2)`. Source: maximum dissipation, integrated round
    the circle. Tolerance: 64 chords for a turn, 0.29 % off, and a quarter of that with 128.
    """
    history = results.history
    place, force = (
        np.column_stack([history[f"rigid.head.{what}.{axis}"] for axis in "xy"])
        for what in ("translation", "support_force")
    )
    work = np.sum(0.5 * (force[1:] + force[:-1]) * np.diff(place, axis=0), axis=1)
    exact = 4.0 * NORMAL * RADIUS * MU[1] * ellipe(1.0 - (MU[0] / MU[1]) ** 2)
    assert work[-TURN:].sum() == pytest.approx(exact, rel=4e-3)
    friction = history["energy.friction"]
    assert friction[-1] - friction[-1 - TURN] == pytest.approx(exact, rel=4e-3)


@pytest.mark.slow
def test_force_and_track(results: Results) -> None:
    """Normal force, circle and friction at every place of the turn.

    Requirement: the force is constant, the way is the circle, and friction is that of maximum
    dissipation against the chord of the increment. Tolerance: Newton, rounding; 1 % of the largest
    friction, over which the pin tilts and elastic slip turns.
    """
    history = results.history
    assert history["rigid.head.force.z"][2:] == pytest.approx(NORMAL, rel=1e-7)
    assert history["contacts.0.force.z"][2:] == pytest.approx(NORMAL, rel=1e-6)
    place = np.column_stack([history[f"rigid.head.translation.{axis}"] for axis in "xy"])
    radius = np.linalg.norm(place[2:] + np.array([RADIUS, 0.0]), axis=1)
    assert radius == pytest.approx(RADIUS, rel=1e-12)
    along = np.diff(place, axis=0)[-TURN:]
    along /= np.linalg.norm(along, axis=1)[:, None]
    weighed = along * np.square(MU)
    exact = -NORMAL * weighed / np.linalg.norm(along * MU, axis=1)[:, None]
    force = np.column_stack([history[f"contacts.0.force.{axis}"] for axis in "xy"])[-TURN:]
    assert np.abs(force - exact).max() < 0.01 * NORMAL * MU[1]


@pytest.mark.slow
def test_sliding_begins_in_its_first_increment(results: Results) -> None:
    """The pin is dragged by 1 mm from rest in the first increment of the turn.

    Requirement: no warning, and less than 4 % of the work open at any time. Source: balance of
    energy; the mean of both ends of the increment left 49 % there. Tolerance: what friction does
    at the points that open at the edge, which carry 6.5 % of the force.
    """
    history = results.history
    assert results.summary["warnings"] == []
    assert np.all(np.abs(history["energy.residual"]) < 0.04 * history["energy.external"])


@pytest.mark.slow
def test_numbers_have_units(results: Results) -> None:
    """Requirement: `[units]` of the case are in the summary, with the stress that follows."""
    assert results.summary["units"] == {"length": "mm", "force": "N", "stress": "MPa"}
