"""Linear bodies condensed once for the whole run, Newton's method on what can be touched."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from anisocontact.base.strategies import CONDENSED, strategy_entry
from anisocontact.solver.strategies.condensed.condensed import Condensed
from anisocontact.solver.strategies.condensed.newton import CondensedNewton
from anisocontact.solver.strategies.condensed.reach import contact_unknowns
from anisocontact.solver.strategies.costs import memory_needed, too_large
from anisocontact.solver.strategies.strategy import Task
from anisocontact.solver.terms.persistent import Arrays

#: Contact unknowns beyond which their dense matrix costs more than it saves.
MOST_CONTACT = 8000


class CondensedStrategy:
    """Static condensation of linear bodies."""

    entry = strategy_entry(CONDENSED)
    merit = "the bodies are linear: only their contact unknowns change"
    reduces = True

    def obstacles(self, task: Task) -> Iterator[str]:
        """What it cannot do."""
        problem = task.problem
        if problem.comm.size > 1:
            yield f"it runs in one process, {problem.comm.size} given"
        if not problem.contacts:
            yield "there is no contact"
        if not problem.linear:
            names = [name for name, law in problem.materials.items() if not law.linear]
            yield f"material.{names[0]} is not linear"
        if problem.rigid.faces:
            yield "a face follows a rigid body"
        yield from task.asked_solver()

    def costs(self, task: Task) -> Iterator[str]:
        """Why it would not pay."""
        problem = task.problem
        if problem.check_held(task.steps):
            yield "a body is held by contact alone"
        count = contact_unknowns(problem, task.steps)
        if count > MOST_CONTACT:
            yield (
                f"{count} contact unknowns, more than {MOST_CONTACT}: their dense matrix does not "
                "pay"
            )
        needed = memory_needed(problem.unknowns, count)
        yield from too_large(f"condensing on {count} contact unknowns", needed)
        if 2 * count > problem.unknowns:
            yield f"{count} of {problem.unknowns} unknowns are contact unknowns"

    def solver(
        self,
        task: Task,
        on_iteration: Callable[[int, float], None],
        note: Callable[[str], None],
        kept: Arrays,
    ) -> CondensedNewton:
        """Newton's method on the contact unknowns."""
        condensed = Condensed(task.problem, task.steps, note, kept)
        return CondensedNewton(condensed, task.prefix, task.options, on_iteration)
