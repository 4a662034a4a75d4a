"""Which way the equations are solved, and why."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt

from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import PETSc, Vec
from anisocontact.base.strategies import CONDENSED, DIRECT, ITERATIVE, STRATEGIES
from anisocontact.solver.strategies.condensed import Condensed, CondensedNewton, contact_unknowns
from anisocontact.solver.strategies.costs import factor_bytes, free_memory, memory_needed
from anisocontact.solver.strategies.iterative import IterativeNewton, Patch
from anisocontact.solver.strategies.newton import Newton, NewtonResult, OptionValue
from anisocontact.solver.system.problem import Problem
from anisocontact.solver.terms.persistent import Arrays
from anisocontact.solver.terms.step import Step

#: Contact unknowns beyond which their dense matrix costs more than it saves.
MOST_CONTACT = 8000
#: Unknowns beyond which Krylov iterations are clearly faster than a factorisation.
MOST_FACTORISED = 50_000
#: Share of the unknowns that `iterative` may keep on its coarse level, if nobody asks for it.
MOST_KEPT = 0.25
#: Share of the free memory that dense matrices or a factor may take.
MEMORY_SHARE = 0.5


class AnyNewton(Protocol):
    """What the load steps ask of Newton's method."""

    @property
    def residual(self) -> npt.NDArray[np.float64]:
        """Residual of the unknowns this rank owns at the last iterate."""
        ...

    def solve(
        self, x: Vec, full_steps: bool = False, damping: Callable[[], float] | None = None
    ) -> NewtonResult:
        """Correct `x` until it is in equilibrium or no more can be done."""
        ...

    def persistent(self) -> Arrays:
        """What the next solutions depend on beside the state of the problem."""
        ...

    def close(self) -> None:
        """Give back PETSc's objects."""
        ...


@dataclass(frozen=True)
class Choice:
    """How the equations are solved.

    Attributes:
        name: "direct", "condensed" or "iterative".
        reason: Why, in a line.
    """

    name: str
    reason: str


def choose(
    strategy: str,
    problem: Problem,
    steps: Sequence[Step],
    prefix: str,
    options: Mapping[str, OptionValue],
) -> Choice:
    """Take the strategy asked for, or the one that suits the problem.

    Args:
        strategy: One of `strategies.STRATEGIES`.
        problem: The problem.
        steps: What will be done.
        prefix: Prefix of the PETSc options.
        options: PETSc options without prefix.

    Raises:
        InputError: There is no such strategy, or it cannot solve this problem.
    """
    if strategy not in STRATEGIES:
        raise InputError(f"{strategy!r} given, one of {', '.join(STRATEGIES)} needed", "strategy")
    if strategy in (DIRECT, ITERATIVE):
        return Choice(strategy, "asked for")
    against = next(_obstacles(problem, steps, prefix, options), "")
    if strategy == CONDENSED:
        if against:
            raise InputError(f"'condensed' given, but {against}", "strategy")
        return Choice(CONDENSED, "asked for")
    against = against or next(_costs(problem, steps), "")
    if not against:
        return Choice(CONDENSED, "the bodies are linear: only their contact unknowns change")
    heavy = next(_factor_costs(problem), "")
    if heavy and not next(_iterative_obstacles(problem, steps, prefix, options), ""):
        return Choice(ITERATIVE, f"{heavy}; not condensed: {against}")
    return Choice(DIRECT, against)


def make_newton(
    choice: Choice,
    problem: Problem,
    steps: Sequence[Step],
    prefix: str,
    options: Mapping[str, OptionValue],
    on_iteration: Callable[[int, float], None],
    note: Callable[[str], None],
    kept: Arrays,
) -> AnyNewton:
    """Newton's method for a choice.

    Args:
        choice: The choice.
        problem: The problem.
        steps: What will be done.
        prefix: Prefix of the PETSc options.
        options: PETSc options without prefix.
        on_iteration: Called with the number of the iteration and the residual.
        note: Told what is worth a line in the log.
        kept: What `AnyNewton.persistent` gave in the run that goes on; empty for a new one.
    """
    if not (choice.name == CONDENSED and kept):
        problem.recover()
    if choice.name == CONDENSED:
        condensed = Condensed(problem, steps, note, kept)
        return CondensedNewton(condensed, prefix, options, on_iteration)
    if choice.name == ITERATIVE:
        return IterativeNewton(problem, steps, prefix, options, on_iteration, note)
    problem.look_ahead(steps)
    return Newton(problem, prefix, options, on_iteration)


def _obstacles(
    problem: Problem, steps: Sequence[Step], prefix: str, options: Mapping[str, OptionValue]
) -> Iterator[str]:
    """What `condensed` cannot do."""
    if problem.comm.size > 1:
        yield f"it runs in one process, {problem.comm.size} given"
    if not problem.contacts:
        yield "there is no contact"
    if not problem.linear:
        names = [name for name, law in problem.materials.items() if not law.linear]
        yield f"material.{names[0]} is not linear"
    yield from _asked_solver(prefix, options)


def _asked_solver(prefix: str, options: Mapping[str, OptionValue]) -> Iterator[str]:
    """PETSc options of a linear solver: the user has chosen."""
    given = [*options, *PETSc.Options(prefix).getAll()]
    linear = [name for name in given if name.startswith(("ksp_", "pc_", "mat_"))]
    if linear:
        yield f"the option {linear[0]} asks for a solver of the whole system"


def _factor_costs(problem: Problem) -> Iterator[str]:
    """Why a factorisation of the whole system would not fit or not pay."""
    count = problem.unknowns
    needed, free = factor_bytes(count), free_memory()
    if needed > MEMORY_SHARE * free:
        yield (
            f"a factorisation of {count} unknowns needs about {needed / 1e9:.0f} GB, "
            f"{free / 1e9:.0f} GB are free"
        )
    if count > MOST_FACTORISED:
        yield f"{count} unknowns, more than {MOST_FACTORISED}: Krylov iterations are faster"


def _iterative_obstacles(
    problem: Problem, steps: Sequence[Step], prefix: str, options: Mapping[str, OptionValue]
) -> Iterator[str]:
    """Why `auto` does not take `iterative`."""
    yield from _asked_solver(prefix, options)
    count = int(problem.comm.allreduce(int(Patch(problem, steps).select().sum())))
    if 3 * count > MOST_KEPT * problem.unknowns:
        yield f"{3 * count} of {problem.unknowns} unknowns would stay on the coarse level"


def _costs(problem: Problem, steps: Sequence[Step]) -> Iterator[str]:
    """Why `condensed` would not pay, although it can."""
    if problem.check_held(steps):
        yield "a body is held by contact alone"
    count = contact_unknowns(problem, steps)
    if count > MOST_CONTACT:
        yield f"{count} contact unknowns, more than {MOST_CONTACT}: their dense matrix does not pay"
    needed, free = memory_needed(problem.unknowns, count), free_memory()
    if needed > MEMORY_SHARE * free:
        yield (
            f"condensing on {count} contact unknowns needs {needed / 1e9:.1f} GB, "
            f"{free / 1e9:.1f} GB are free"
        )
    if 2 * count > problem.unknowns:
        yield f"{count} of {problem.unknowns} unknowns are contact unknowns"
