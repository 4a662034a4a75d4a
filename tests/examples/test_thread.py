"""A ring on a screw, against the closed form of the spiral cylinder."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.case import load
from anisocontact.case.build import build
from anisocontact.cli import main
from anisocontact.results import Results
from anisocontact.solver import Solver

FOLDER = Path(__file__).parents[2] / "examples" / "thread"

RADIUS, PITCH = 10.0, 40.0
MU = np.array([0.1, 0.3])  # along the grooves and across
ALONG = np.array([RADIUS, PITCH / (2.0 * np.pi)]) / np.hypot(RADIUS, PITCH / (2.0 * np.pi))
# Rows: along the grooves and across them, as components around the bar and along it.
AXES = np.array([ALONG, [-ALONG[1], ALONG[0]]])


def path(before: np.ndarray, after: np.ndarray) -> np.ndarray:
    """Mean angle of turn and mean displacement along z of points on the ring."""
    turn = [np.arctan2(x[:, 1], x[:, 0]) for x in (before, after)]
    return np.array(
        [np.angle(np.exp(1j * (turn[1] - turn[0]))).mean(), (after - before)[:, 2].mean()]
    )


def slip_under_axial_force() -> float:
    """Angle of turn over displacement along z where the force is along z: slip along F T."""
    slip = AXES.T @ (AXES @ [0.0, 1.0] / MU**2)
    return float(slip[0] / slip[1] / RADIUS)


def force_under_axial_slip() -> np.ndarray:
    """T/N around and along the bar where the slip is along z: -F^-1 e / sqrt(e.F^-1 e)."""
    e = AXES @ [0.0, 1.0]
    return -AXES.T @ (MU**2 * e) / np.linalg.norm(MU * e)


def test_the_ring_turns() -> None:
    """Pushed along z and free to turn: angle over displacement is f^12/f^22, f^22 the force.

    Over the last of the first 2 mm, when all of the ring slides. 0.1 %; 0.01 % measured. The issue
    of the chord for the arc of an increment is 1e-4.
    """
    built = build(load(FOLDER / "case.toml"))
    begin, pushing = built.steps
    pushed = replace(pushing, increments=8, displacement={"ring.bottom": {"z": 2.0}})
    contact = built.problem.contacts[0]
    places = [contact.points.copy() for _ in Solver(built.problem, [begin, pushed]).run()]
    turn, length = path(places[4], places[-1])
    assert turn / length == pytest.approx(slip_under_axial_force(), rel=1e-3)
    force, moment = contact.resultant()
    # ... and no torque: nothing but the bar could take it.
    assert abs(moment[2]) < 1e-6 * RADIUS * abs(force[2])


@pytest.mark.slow
def test_the_path_of_the_whole_run(tmp_path: Path) -> None:
    """63 degrees of turn over 10 mm, from the start, within 0.2 %; demanded is 1 %."""
    assert main(["run", str(FOLDER / "case.toml"), "-o", str(tmp_path / "out")]) == 0
    results = Results(tmp_path / "out")
    before, after = (np.asarray(results.contact(i).points) for i in (0, -1))
    turn, length = path(before, after)
    assert length == pytest.approx(10.0, rel=2e-3)
    assert turn / length == pytest.approx(slip_under_axial_force(), rel=2e-3)
    assert results.history["newton_iterations"].mean() <= 7.0


def test_the_torque_of_the_held_ring(tmp_path: Path, solved) -> None:
    """Held against turning: torque and axial force of slip along z, within 0.1 %.

    Over the sum of the pressures, so that each is compared by itself. Demanded is 1 % of their
    ratio.
    """
    results = solved(FOLDER / "held.toml", tmp_path / "out")
    points = results.contact()
    normal = points.point_data["pressure"] @ points.point_data["area"]
    contact = results.summary["contacts"][0]
    measured = np.array([contact["moment"][2] / RADIUS, contact["force"][2]]) / normal
    assert np.allclose(measured, force_under_axial_slip(), rtol=1e-3)
