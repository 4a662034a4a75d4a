"""Steps in increments: start, Newton, accept or stop."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace

from anisocontact._fenicsx import Vec
from anisocontact.solver.loads import check_steps
from anisocontact.solver.newton import Newton, NewtonResult, OptionValue
from anisocontact.solver.problem import Problem
from anisocontact.solver.steps import Accepted, Progress, Step, StoppedError


class Solver:
    """Runs the steps of a problem.

    Args:
        problem: The problem, in any accepted state.
        steps: What to do, in order.
        options_prefix: Prefix of the PETSc options of the Newton solver.
        options: PETSc options without prefix, such as {"snes_rtol": 1e-10}.

    Raises:
        InputError: A step names an unknown facet group, or shared nodes get two values.
    """

    def __init__(
        self,
        problem: Problem,
        steps: Sequence[Step],
        options_prefix: str = "anisocontact_",
        options: Mapping[str, OptionValue] | None = None,
    ) -> None:
        self.problem = problem
        self.steps = list(steps)
        check_steps(problem.model, self.steps)
        self._prefix = options_prefix
        self._options = dict(options or {})
        self._on_iteration: Callable[[Progress], None] | None = None
        self._where = ("", 0)

    def run(self, on_iteration: Callable[[Progress], None] | None = None) -> Iterator[Accepted]:
        """Solve increment by increment.

        Args:
            on_iteration: Called at the start of each increment and after each Newton iteration.

        Yields:
            Every accepted increment; the problem holds its state until the next one.

        Raises:
            StoppedError: An increment did not converge; the problem holds the last accepted one.
        """
        self._on_iteration = on_iteration
        newton = Newton(self.problem, self._prefix, self._options, self._report)
        try:
            yield from self._steps(newton)
        finally:
            newton.close()

    def _steps(self, newton: Newton) -> Iterator[Accepted]:
        time = 0.0
        for index, step in enumerate(self.steps):
            self.problem.begin(step)
            dt = step.duration / step.increments
            before: Vec | None = None
            for increment in range(1, step.increments + 1):
                self._where = (step.name, increment)
                self.problem.set_level(increment / step.increments, dt)
                last = self.problem.accepted()
                result = self._increment(newton, last, before)
                before = last
                yield self._accepted(index, step, increment, time + increment * dt, result)
            time += step.duration

    def _increment(self, newton: Newton, last: Vec, before: Vec | None) -> NewtonResult:
        """Solve an increment from the extrapolated state, else from the last with full steps."""
        spent = 0
        first = last if before is None else 2.0 * last - before
        for start, full_steps in ((first, False), (last, True)):
            x = start.copy()
            try:
                result = newton.solve(x, full_steps)
                spent += result.iterations
                if not result.reason:
                    self.problem.commit(x)
                    return replace(result, iterations=spent)
                failed = StoppedError(*self._where, result.reason, self.problem.failed_points())
            finally:
                self.problem.roll_back()
        raise failed

    def _report(self, iteration: int, residual: float) -> None:
        if self._on_iteration is not None:
            counts = {c.name: c.counts() for c in self.problem.contacts}
            self._on_iteration(Progress(*self._where, iteration, residual, counts))

    def _accepted(
        self, index: int, step: Step, increment: int, time: float, result: NewtonResult
    ) -> Accepted:
        contacts = self.problem.contacts
        return Accepted(
            step=step.name,
            step_index=index,
            increment=increment,
            time=time,
            iterations=result.iterations,
            residuals=result.residuals,
            contacts={c.name: c.counts() for c in contacts},
            resultants={c.name: c.resultant() for c in contacts},
            reactions=self.problem.reactions(),
            energies=self.problem.energies(),
        )
