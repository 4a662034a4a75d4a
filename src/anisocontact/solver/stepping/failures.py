"""Why a sub-increment has no solution, as it is said with a cut-back and at the end of a run."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from anisocontact.bulk.material_warnings import STRESSED
from anisocontact.contact.friction_hints import wrong_derivatives
from anisocontact.solver.stepping.attempts import Outcome
from anisocontact.solver.stepping.convergence_diagnostics import NAMED
from anisocontact.solver.stepping.level_nodes import level_nodes
from anisocontact.solver.stepping.loosened import loosened
from anisocontact.solver.stepping.overload import (
    MANY,
    Overload,
    exhausted,
    far_beyond,
    reason_of,
    too_much_load,
)
from anisocontact.solver.stepping.pressed_points import moves
from anisocontact.solver.stepping.pulled_out import pulled_out
from anisocontact.solver.stepping.report import StoppedError
from anisocontact.solver.stepping.run_position import RunPosition
from anisocontact.solver.stepping.unbalanced_loads import unbalanced
from anisocontact.solver.strategies.newton import NewtonResult
from anisocontact.solver.system.problem import Problem
from anisocontact.solver.terms.step import Step


class Failures:
    """What is told of sub-increments that do not converge.

    Args:
        problem: The problem, in the last accepted state whenever something is asked.
        doubtful: What the steps ask for that is doubtful, a line each.
    """

    def __init__(self, problem: Problem, doubtful: Sequence[str]) -> None:
        self._problem, self._doubtful = problem, list(doubtful)

    def hint(self, step: Step, place: RunPosition, cuts: int) -> str:
        """What is told with a cut: which bodies a step leaves free, then what friction holds.

        Args:
            step: The step.
            place: Where in it the sub-increment failed.
            cuts: How often the increment has been cut before.
        """
        if cuts:
            return "; ".join(one.text for one in self._overloads(step, place))
        return "; ".join(self._problem.stabilisation.notes) if place.before is None else ""

    def hopeless(self, step: Step, place: RunPosition, cuts: int, result: NewtonResult) -> bool:
        """Whether no cut-back helps: nothing could hold a body where it touches, or no longer.

        Bodies at rest that nothing but contact holds, and that the first small loads carry through
        what they rest on, fall under smaller ones as well, as loads that grow together point where
        they do from the first.

        Args:
            step: The step.
            place: Where in it the sub-increment failed.
            cuts: How often the increment has been cut before.
            result: What came of the sub-increment.
        """
        if cuts and result.far > 0.0 and self._loosened(step, place):
            return True
        if cuts < MANY:
            return False
        at_rest = place.step == 0 and place.reached(step) == 0.0
        if at_rest and self._falls(result) and not moves(self._problem):
            return True
        end, now = place.control.increment / step.increments, place.reached(step)
        return any(one.certain for one in unbalanced(self._problem, end, now))

    def _falls(self, result: NewtonResult) -> bool:
        """Whether a body that nothing but contact holds has got where it cannot be."""
        lost = {culprit.contact for culprit in result.culprits}
        loose = self._problem.stabilisation.loose
        return any(contact.name in lost for free in loose for contact in free.contacts)

    def stopped(self, step: Step, place: RunPosition, outcome: Outcome, tried: str) -> StoppedError:
        """Say why an increment has no solution.

        Args:
            step: The step.
            place: Where in it the increment failed.
            outcome: What came of the last sub-increment.
            tried: How small the sub-increments were; empty if none was cut.
        """
        outcome = place.lost or outcome
        culprits, found = outcome.culprits, self._overloads(step, place)
        if not found and outcome.result.far > 0.0:
            found = self._loosened(step, place)
        reason = reason_of(outcome.result.reason, outcome.conclusive, found)
        if outcome.result.reason not in reason:
            culprits = ()
        points = np.array([c.position for c in culprits if c.kind == "law"])
        text = f"{tried} of the increment" if tried else ""
        inverted = any(c.kind == "inverted" for c in outcome.culprits)
        causes = [line for line in self._doubtful if inverted and STRESSED in line]
        slopes = wrong_derivatives(self._problem.contacts)
        parts = (text, slopes, outcome.hint, level_nodes(self._problem), *causes)
        text = "; ".join(part for part in parts if part)
        increment = place.control.increment
        stop = StoppedError(step.name, increment, reason, culprits[:NAMED], points, text)
        stop.failed = outcome.failed
        return stop

    def _overloads(self, step: Step, place: RunPosition) -> list[Overload]:
        """Which loads friction cannot hold at the end of the increment, or of the step."""
        end, now = place.control.increment / step.increments, place.reached(step)
        found = too_much_load(self._problem, end, now) or exhausted(self._problem, now)
        found = found or far_beyond(self._problem, end, now)
        found = found or unbalanced(self._problem, end, now)
        return found or pulled_out(self._problem, end, now)

    def _loosened(self, step: Step, place: RunPosition) -> list[Overload]:
        """As of `loosened`, at the end of the increment."""
        end = place.control.increment / step.increments
        return loosened(self._problem, end, place.reached(step))
