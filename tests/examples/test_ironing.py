"""Ironing: a stiff die in a soft block, slid over it."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.base.errors import ModelWarning
from anisocontact.case import load
from anisocontact.case.build import build
from anisocontact.cli import main
from anisocontact.results import Results
from anisocontact.solver import Progress, Solver

CASE = Path(__file__).parents[2] / "examples" / "ironing" / "case.toml"
DIE_WIDTH = 4.0

MU = np.array([0.1, 0.3])  # along the grain and across
ANGLE = np.radians(30.0)
# Rows: directions of the axes on the block.
AXES = np.array([[np.cos(ANGLE), np.sin(ANGLE)], [-np.sin(ANGLE), np.cos(ANGLE)]])


def steady_slip() -> np.ndarray:
    """T/N in steady slip along x: -F^-1 e / sqrt(e.F^-1 e), maximum dissipation."""
    e = AXES @ [1.0, 0.0]
    return -AXES.T @ (MU**2 * e) / np.linalg.norm(MU * e)


def test_newton_converges_quadratically() -> None:
    """On the press and the first increments of the slide, with exact corrections (`direct`).

    The residuals r, relative to the forces at work, fulfil r_n <= 10 r_(n-1)^2, up to round-off of
    2e-11, after the last two corrections of every increment; measured is 8 r_(n-1)^2. One of them
    all may not, in which a point that presses changes its status or comes to another facet, where
    forces have a kink. With linear convergence the last residual, from 1e-6 or so, would be far
    above 1e-11.
    """
    built = build(load(CASE))
    slide = replace(built.steps[1], increments=6, displacement={"die.inner": {"x": 2.4}})
    with pytest.warns(ModelWarning, match="the slave is .* times as stiff as the master"):
        solver = Solver(built.problem, [built.steps[0], slide], strategy="direct")
    (contact,) = built.problem.contacts
    seen: list[tuple[np.ndarray, ...]] = []

    def look(progress: Progress) -> None:
        status = contact.trial.status.copy()
        seen.append((status, np.where(status > 0, contact.projected_facets(), -1)))

    slower = 0
    for accepted in solver.run(on_iteration=look):
        r, states = accepted.residuals[-3:], seen[-3:]
        assert len(r) == 3
        assert r[-1] < 1e-8
        for i, (before, after) in enumerate(pairwise(states)):
            if r[i + 1] > 10.0 * r[i] ** 2 + 2e-11:
                assert not all(np.array_equal(*pair) for pair in zip(before, after, strict=True))
                slower += 1
    assert slower <= 1


@pytest.mark.slow
def test_ten_widths(tmp_path: Path) -> None:
    """The whole run: at most seven iterations an increment, and the force of steady slip.

    Drag and lateral force over the normal force are those of slip along x on a plane, to 3 % of
    the friction: the block is a trough under the die, which tilts its surface by up to 20 degrees
    and adds a little to the drag.
    """
    assert main(["run", str(CASE), "-o", str(tmp_path / "out")]) == 0
    history = Results(tmp_path / "out").history
    assert history["displacements.die.inner.x"][-1] == pytest.approx(10.0 * DIE_WIDTH)
    assert history["newton_iterations"].mean() <= 7.0
    force = np.column_stack([history[f"contacts.0.force.{axis}"] for axis in "xyz"])
    way = history["displacements.die.inner.x"]
    steady = force[(way > 8.0) & (way < 36.0)].mean(axis=0)
    assert np.allclose(
        steady[:2] / steady[2], steady_slip(), atol=0.03 * np.linalg.norm(steady_slip())
    )
