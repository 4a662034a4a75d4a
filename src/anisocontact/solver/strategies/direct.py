"""One factorisation of the whole system in every Newton iteration."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from anisocontact.base.strategies import DIRECT, strategy_entry
from anisocontact.solver.strategies.costs import factor_bytes, too_large
from anisocontact.solver.strategies.krylov import krylov_pays
from anisocontact.solver.strategies.newton import Newton
from anisocontact.solver.strategies.strategy import Task
from anisocontact.solver.terms.persistent import Arrays

#: Unknowns of bodies in space beyond which Krylov iterations are clearly faster than one.
MOST_FACTORISED = 50_000
#: Dimension of the mesh of bodies in space.
SPACE = 3


class DirectStrategy:
    """Newton's method with sparse LU; what every problem can be solved by."""

    entry = strategy_entry(DIRECT)
    merit = "asked for"
    reduces = False

    def obstacles(self, task: Task) -> Iterator[str]:
        """None."""
        yield from ()

    def costs(self, task: Task) -> Iterator[str]:
        """Why a factorisation of the whole system would not fit or not pay.

        On meshes of two dimensions it always does: factors have n log n entries [George 1973].
        """
        count = task.problem.solved_for
        if task.problem.model.idealisation.dim < SPACE:
            return
        yield from too_large(f"a factorisation of {count} unknowns", factor_bytes(count))
        if count > MOST_FACTORISED:
            yield f"{count} unknowns, more than {MOST_FACTORISED}: Krylov iterations are faster"
            return
        yield from krylov_pays(task)

    def solver(
        self,
        task: Task,
        on_iteration: Callable[[int, float], None],
        note: Callable[[str], None],
        kept: Arrays,
    ) -> Newton:
        """Newton's method on the whole system."""
        task.problem.predict_contact(task.steps)
        return Newton(task.problem, task.prefix, task.options, on_iteration)
