"""Krylov iterations on the whole system with levels whose last one is factorised."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

from anisocontact.base.strategies import ITERATIVE, strategy_entry
from anisocontact.solver.strategies.costs import factor_bytes, too_large
from anisocontact.solver.strategies.iterative.patch import Patch
from anisocontact.solver.strategies.strategy import Task
from anisocontact.solver.terms.persistent import Arrays

if TYPE_CHECKING:
    from anisocontact.solver.strategies.iterative.newton import IterativeNewton

#: Stiffness against changes of volume over the rest from which on a factorisation of all unknowns,
#: if it fits, takes no longer: at nu = 0.499, which is 84 for hexahedra of order 1, Krylov
#: iterations are up to 46, at 0.4999, 844, up to 105, and some tangents are factorised in the end.
HARDEST = 200.0
#: Share of the unknowns that may stay on the coarse level, if nobody asks for it.
MOST_KEPT = 0.25


class IterativeStrategy:
    """Newton's method with FGMRES; memory grows with the unknowns alone."""

    entry = strategy_entry(ITERATIVE)
    merit = "Krylov iterations are faster"
    reduces = False

    def obstacles(self, task: Task) -> Iterator[str]:
        """None."""
        yield from ()

    def costs(self, task: Task) -> Iterator[str]:
        """Why it is not taken by itself."""
        yield from task.asked_solver()
        problem = task.problem
        room = not any(too_large("", factor_bytes(problem.solved_for)))
        if problem.bulk.hardness > HARDEST and room:
            yield "bodies all but keep their volume: Krylov iterations would be very many"
        kept = Patch(problem, task.steps).select()
        count = int(problem.comm.allreduce(int(kept.sum())))
        if 3 * count > MOST_KEPT * problem.unknowns:
            yield f"{3 * count} of {problem.unknowns} unknowns would stay on the coarse level"

    def solver(
        self,
        task: Task,
        on_iteration: Callable[[int, float], None],
        note: Callable[[str], None],
        kept: Arrays,
    ) -> IterativeNewton:
        """Newton's method with levels whose last one is factorised."""
        from anisocontact.solver.strategies.iterative.newton import IterativeNewton

        problem, steps, options = task.problem, task.steps, task.options
        return IterativeNewton(problem, steps, task.prefix, options, on_iteration, note)
