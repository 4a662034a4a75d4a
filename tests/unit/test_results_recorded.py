"""A script has the results folder that a case file has: files, status and reason."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact import (
    Contact,
    Friction,
    InputError,
    Limits,
    Problem,
    Results,
    Solver,
    Step,
    make_material,
    make_surface,
    recorded,
)
from anisocontact.mesh import BoxSpec, build_box
from anisocontact.solver import StoppedError

HELD = {"x": 0.0, "y": 0.0, "z": -0.01}


def _solver(*steps: Step, **given: Any) -> Solver:
    """A block on a plane, with friction of 0.3."""
    model = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 1), (2, 2, 1))})
    plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    contact = Contact(model, "block.bottom", plane, Friction(coefficients=0.3))
    problem = Problem(model, {"block": make_material("linear-elastic", E=100.0, nu=0.3)}, [contact])
    return Solver(problem, steps, **given)


def test_a_run_of_a_script_has_a_results_folder(tmp_path):
    """Requirement: forces, times and files for ParaView of every increment, status "done"; a second
    run needs to be told to replace the first."""
    folder = tmp_path / "out"
    solver = _solver(
        Step("press", 2, {"block.top": HELD}), Step("drag", 2, {"block.top": {"x": 0.1}})
    )
    done = list(recorded(solver, folder, title="a block", pictures=False))
    results = Results(folder)
    assert [one.increment for one in done] == [1, 2, 1, 2]
    assert (results.summary["status"], results.summary["title"]) == ("done", "a block")
    force = solver.problem.contacts[0].resultant()[0]
    assert np.array_equal(results.summary["contacts"][0]["force"], force)
    assert results.times.tolist() == [0.0, 0.5, 1.0, 1.5, 2.0]
    assert {"fields.pvd", "contact.pvd", "history.csv"} <= {one.name for one in folder.iterdir()}
    again = _solver(Step("press", 1, {"block.top": HELD}))
    with pytest.raises(InputError, match=r"holds an earlier run: give .* overwrite=True"):
        recorded(again, folder)
    assert len(list(recorded(again, folder, pictures=False, overwrite=True))) == 1
    assert Results(folder).times.tolist() == [0.0, 1.0]


def test_a_run_that_stops_says_why_in_its_folder(tmp_path):
    """Requirement: an increment that no correction is allowed for raises as in `run`, and the
    summary has the reason."""
    press = Step("press", 1, {"block.top": HELD})
    solver = _solver(press, options={"snes_max_it": 0}, limits=Limits(cuts=0))
    with pytest.raises(StoppedError) as caught:
        list(recorded(solver, tmp_path, pictures=False))
    summary = Results(tmp_path).summary
    assert (summary["status"], summary["message"]) == ("stopped", str(caught.value))


def test_a_run_that_the_script_leaves_is_stopped(tmp_path):
    """Requirement: what was accepted until then is there, and the status says that there is more
    to come."""
    for _ in recorded(_solver(Step("press", 3, {"block.top": HELD})), tmp_path, pictures=False):
        break
    results = Results(tmp_path)
    assert (results.summary["status"], results.summary["message"]) == (
        "stopped",
        "left by the script",
    )
    assert results.times == pytest.approx([0.0, 1.0 / 3.0])
