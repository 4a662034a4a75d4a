"""Runs of one problem that are left where they are while another one goes on."""

from __future__ import annotations

import subprocess
import sys
from textwrap import dedent

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.base.errors import InputError
from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.laws import Friction
from anisocontact.mesh import BoxSpec, build_box
from anisocontact.solver import Problem, Solver, Step
from anisocontact.surfaces import make_surface

STEPS = [
    Step("press", 1, {"block.top": {"x": 0.0, "y": 0.0, "z": -0.02}}),
    Step("drag", 4, {"block.top": {"x": 0.01}}),
]


def _solver(strategy: str) -> Solver:
    """A block that is pressed on a plane and dragged on it until it slides."""
    model = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 0.5), (2, 2, 1))})
    plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    contact = Contact(model, "block.bottom", plane, Friction(coefficients=0.3))
    rubber = {"block": make_material("linear-elastic", E=10.0, nu=0.3)}
    return Solver(Problem(model, rubber, [contact]), STEPS, strategy=strategy)


def _seen(accepted) -> list[float]:
    energies = accepted.energies
    return [*accepted.reactions["block.top"], *(energies[n] for n in ("external", "elastic"))]


@pytest.mark.parametrize("strategy", ["direct", "condensed"])
@pytest.mark.parametrize("at", [3, 5])
def test_a_state_restored_in_a_run_ends_it(strategy, at):
    """Requirement: who goes back within a run begins a new one, and has what the run had.

    The run went on from its own increment with the state of an earlier one: the last increment gave
    the forces of the one before, and a warning of a law that gives energy. Behind the last
    increment the state was that of an ended run.
    """
    solver, whole = _solver(strategy), []
    going = solver.run()
    for k in range(at):
        whole.append(_seen(next(going)))
        if k == 1:
            kept = solver.persistent()
    solver.restore(kept)
    with pytest.raises(InputError, match="solver: it was restored, or has begun another run"):
        next(going)
    again = [_seen(accepted) for accepted in solver.run()]
    assert len(again) == 3
    assert np.allclose(again[: at - 2], whole[2:], rtol=1e-9, atol=1e-11)


@pytest.mark.parametrize("strategy", ["direct", "condensed"])
def test_a_second_run_ends_the_first(strategy):
    """Requirement: of two runs of one solver the later goes on, and is right.

    Taken in turns they gave a tangential force of -0.007 for 0.089, without a word.
    """
    whole = [_seen(accepted) for accepted in _solver(strategy).run()]
    solver = _solver(strategy)
    first, second = solver.run(), solver.run()
    found = [_seen(next(first)), _seen(next(second))]
    with pytest.raises(InputError, match="solver: it was restored, or has begun another run"):
        next(first)
    found += [_seen(accepted) for accepted in second]
    assert np.allclose(found, whole, rtol=1e-6, atol=1e-11)


def test_a_run_that_is_closed_late_leaves_the_problem_alone():
    """Requirement: a run that was left and is closed within that of another solver changes nothing.

    It took the condensed bodies of the other one for its own: the balance of energy of the other
    one lost the work of an increment, without a word.
    """
    lift = [Step("lift", 4, {"block.top": {"z": -0.015, "y": 0.05}})]

    def found(late: bool) -> list[list[float]]:
        solver = _solver("condensed")
        left = solver.run()
        next(left), next(left)
        if not late:
            left.close()
        seen = []
        for accepted in Solver(solver.problem, lift, strategy="condensed").run():
            seen.append(_seen(accepted))
            if late and len(seen) == 2:
                left.close()
        return seen

    assert np.array_equal(found(late=True), found(late=False))


def test_a_script_ends_within_a_run():
    """Requirement: a script that has what it wants of a run ends in order.

    The run was closed when the libraries were gone, and the process was aborted.
    """
    script = dedent("""
        from anisocontact.bulk import make_material
        from anisocontact.contact import Contact
        from anisocontact.laws import Friction
        from anisocontact.mesh import BoxSpec, build_box
        from anisocontact.solver import Problem, Solver, Step
        from anisocontact.surfaces import make_surface

        def begun():
            model = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 0.5), (2, 2, 1))})
            rubber = {"block": make_material("linear-elastic", E=10.0, nu=0.3)}
            plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
            contact = Contact(model, "block.bottom", plane, Friction(coefficients=0.3))
            press = Step("press", 2, {"block.top": {"x": 0.0, "y": 0.0, "z": -0.02}})
            return Solver(Problem(model, rubber, [contact]), [press], strategy="condensed")

        solver = begun()
        going = solver.run()
        next(going)
        """)
    command = [sys.executable, "-c", script]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize("strategy", ["direct", "condensed"])
def test_no_state_is_restored_while_an_increment_is_solved(strategy):
    """Requirement: that is refused in one line, and the run ends; then it can be restored."""
    solver = _solver(strategy)
    going = solver.run(on_iteration=lambda _: solver.restore(kept))
    kept = solver.persistent()
    with pytest.raises(InputError, match="solver: it solves an increment: restore it, or begin"):
        next(going)
    solver.restore(kept)
    assert len(list(solver.run())) == 5


@pytest.mark.parametrize("strategy", ["direct", "iterative"])
def test_another_solver_goes_on_behind_an_open_run(strategy):
    """Requirement: it has what one run of all steps had, whatever the open one had reduced.

    Bodies that the open run condensed answered the new one: forces had the other sign.
    """
    expected = [_seen(accepted) for accepted in _solver(strategy).run()]
    first = _solver("condensed")
    going = first.run()
    next(going)
    then = Solver(first.problem, STEPS[1:], strategy=strategy)
    seen = [_seen(accepted) for accepted in then.run()]
    np.testing.assert_allclose(seen, expected[1:], rtol=1e-6, atol=1e-9)
    with pytest.raises(InputError, match="problem: another solver has begun a step"):
        next(going)
