"""What a strategy is: it says whether it can solve a problem, what it costs, and solves."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

from anisocontact.base.array_types import Floats
from anisocontact.base.fenicsx import PETSc, Vec
from anisocontact.base.registry import Entry
from anisocontact.solver.strategies.database import OptionValue
from anisocontact.solver.strategies.newton import NewtonResult
from anisocontact.solver.system.problem import Problem
from anisocontact.solver.terms.persistent import Arrays
from anisocontact.solver.terms.step import Step


@dataclass(frozen=True)
class Task:
    """What is to be solved.

    Attributes:
        problem: The problem.
        steps: What will be done.
        prefix: Prefix of the PETSc options.
        options: PETSc options without prefix.
    """

    problem: Problem
    steps: Sequence[Step]
    prefix: str
    options: Mapping[str, OptionValue]

    def asked_solver(self) -> Iterator[str]:
        """PETSc options of a linear solver: the user has chosen, in a line."""
        given = [*self.options, *PETSc.Options(self.prefix).getAll()]
        linear = [name for name in given if name.startswith(("ksp_", "pc_", "mat_"))]
        if linear:
            yield f"the option {linear[0]} asks for a solver of the whole system"


class IncrementSolver(Protocol):
    """Finds equilibrium at given loads; see `Newton`."""

    @property
    def residual(self) -> Floats:
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


class Strategy(Protocol):
    """A way to solve the equations.

    Attributes:
        entry: Name to ask for it, and what it does in a line.
        merit: Why it is taken where nothing speaks against it, in a line.
        reduces: Whether it goes on from states that are known without the interior of the bodies.

    Example:
        Newton's method with a tangent that stays what it was for three corrections:

        >>> from anisocontact.base.registry import Entry
        >>> from anisocontact.solver import Newton
        >>> class Lazy:
        ...     entry = Entry("lazy", "strategy", "Newton's method with old tangents", ())
        ...     merit, reduces = "asked for", False
        ...     def obstacles(self, task):
        ...         yield from ()
        ...     def costs(self, task):
        ...         yield "more corrections than with the tangent of now"
        ...     def solver(self, task, on_iteration, note, kept):
        ...         options = {"snes_lag_jacobian": 3, **task.options}
        ...         return Newton(task.problem, task.prefix, options, on_iteration)

        `register_strategy(Lazy)` lets it be asked for.
    """

    entry: Entry
    merit: str
    reduces: bool

    def obstacles(self, task: Task) -> Iterator[str]:
        """Why it cannot solve the problem, a line each; collective.

        Args:
            task: What is to be solved.

        Yields:
            A line for each reason; none where it can.
        """
        ...

    def costs(self, task: Task) -> Iterator[str]:
        """Why it would not pay or not fit, although it can, a line each; collective.

        Args:
            task: What is to be solved.

        Yields:
            A line for each reason; none where it pays.
        """
        ...

    def solver(
        self,
        task: Task,
        on_iteration: Callable[[int, float], None],
        note: Callable[[str], None],
        kept: Arrays,
    ) -> IncrementSolver:
        """Who solves.

        Args:
            task: What is to be solved.
            on_iteration: Called with the number of the iteration and the residual.
            note: Called with lines for the log.
            kept: What `IncrementSolver.persistent` gave in the run that goes on; empty for a new
                one.

        Returns:
            What solves increments until it is closed.
        """
        ...
