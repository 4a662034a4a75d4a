"""What a cut, or a run that stops, tells as its reason."""

from __future__ import annotations

from typing import Any

import pytest
from tests.verification.test_sides_kept import _problem

from anisocontact.base.limits import Limits
from anisocontact.solver import Solver, Step, StoppedError
from anisocontact.solver.stepping.attempts import Attempts, Outcome
from anisocontact.solver.strategies.newton import NewtonResult
from anisocontact.solver.system.culprit import Culprit, LostError


def test_bodies_that_flow_in_vain_are_not_the_reason(monkeypatch: pytest.MonkeyPatch) -> None:
    """What was in the way of the attempts before is told, not how the last resort failed."""

    def attempt(_: Attempts, way: Any) -> tuple[NewtonResult, list[Culprit]]:
        reason = "the bodies do not come to rest" if way.regularised else "no convergence"
        flowed.append(way.regularised)
        kind = "inverted" if way.regularised else "chattering"
        return NewtonResult(1, [1.0], reason), [Culprit(kind, (0.0, 0.0, 0.0), "here", "c")]

    flowed: list[bool] = []
    monkeypatch.setattr(Attempts, "_attempt", attempt)
    step = Step("press", 1, {"block.top": {"x": 0.0, "y": 0.0, "z": -0.01}})
    with pytest.raises(StoppedError, match="increment 1: no convergence; the status of 1 slave"):
        list(Solver(_problem("plane"), [step], limits=Limits(smallest=1.0)).run())
    assert flowed[-1]


@pytest.mark.parametrize("accepted", [0, 1])
def test_the_first_cut_of_a_step_tells_which_bodies_it_leaves_free(
    accepted: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Requirement: that a body is free is often why a first part is hard; it is told once.

    Not where parts of the step have been accepted: contact holds the body by then.
    """
    failed = NewtonResult(1, [1.0], "no convergence")
    left, solve = [True] * accepted, Attempts.solve

    def attempt(attempts: Attempts, *given: Any) -> Outcome:
        return solve(attempts, *given) if left and left.pop() else Outcome(failed)

    monkeypatch.setattr(Attempts, "solve", attempt)
    step = Step("press", 2, force={"block.top": {"z": -0.1}})
    told: list[str] = []
    with pytest.raises(StoppedError):
        solver = Solver(_problem("plane"), [step], limits=Limits(smallest=0.05))
        list(solver.run(on_cut=lambda cut: told.append(cut.reason)))
    assert len(told) > 1
    notes = "; body 'block' is free to move: translation along x"
    assert told[0].startswith("no convergence" if accepted else f"no convergence{notes}")
    assert told[accepted == 0 :] == ["no convergence"] * (len(told) - (accepted == 0))


def test_what_a_larger_part_has_shown_is_the_reason(monkeypatch: pytest.MonkeyPatch) -> None:
    """The smallest part fails otherwise: the run still stops because equilibrium was lost."""
    lost = LostError(Culprit("behind", (0.0, 0.0, 0.0), "body 'block' has turned over", "c"))
    over = NewtonResult(1, [1.0], str(lost), (lost.culprit,))
    other = NewtonResult(1, [1.0], "the line search got stuck")
    outcomes = iter([Outcome(over, over.culprits), Outcome(other)])
    monkeypatch.setattr(Attempts, "solve", lambda *_: next(outcomes))
    step = Step("press", 1, {"block.top": {"x": 0.0, "y": 0.0, "z": -0.01}})
    said = "equilibrium is lost, and viscous regularisation goes on until body 'block' has turned"
    with pytest.raises(StoppedError, match=f"contact 'c': {said} over; 1 cuts"):
        list(Solver(_problem("plane"), [step], limits=Limits(smallest=0.25)).run())
