"""What acts on bodies: one protocol for all of it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from typing import override

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.fenicsx import Mat, PETSc
from anisocontact.contact.quadrature import Couplings
from anisocontact.solver.terms.persistent import Arrays
from anisocontact.solver.terms.step import Step


class SingularError(RuntimeError):
    """The tangent has no inverse, and the system of equations knows why."""


class Term:
    """Something that acts on the bodies of a system of equations.

    What a kind of term does not have stays as it is here: nothing. `begin` takes over a step,
    `set_load_factor` goes to a place along it, `add_force` evaluates a trial state. The tangent is
    that of the last evaluation; `accept` makes it the accepted state and `roll_back` forgets it.
    Displacements `u` and forces are those of the local nodes, (nodes, 3).
    """

    def begin(self, step: Step, released: Floats) -> None:
        """Take over a step from the accepted state.

        Args:
            step: The step.
            released: Forces that supports which let go carried, (3 nodes,), force.

        Raises:
            InputError: The step names something that is not there.
        """

    def set_load_factor(self, factor: float, dt: float) -> None:
        """Go to a fraction of the step, 0 to 1, and take the time increment to there."""

    def add_force(self, u: Floats, out: Floats) -> None:
        """Add the forces on the bodies at the displacement `u`, force."""

    def end_at(self, factor: float) -> None:
        """The step ends at a fraction of it: prescribed values stay as they are."""

    def force(self, u: Floats) -> Floats:
        """The forces on the bodies at the displacement `u`, (nodes, 3), force."""
        out = np.zeros(u.shape)
        self.add_force(u, out)
        return out

    @property
    def failed(self) -> bool:
        """Whether the last evaluation has no answer on this rank."""
        return False

    def lever(self) -> float:
        """Forces that would move all of it to the origin, norm over this rank: see `round_off`."""
        return 0.0

    def blocks(self) -> Sequence[Couplings]:
        """`-d force / d u` between nodes of one cell."""
        return []

    def couplings(self) -> Sequence[Couplings]:
        """`-d force / d u` between other nodes, numbered as `CoupledTangent` has them."""
        return []

    def add_tangent(self, matrix: Mat) -> None:
        """Add what `blocks` has to the matrix of the system."""
        for rows, columns, values in self.blocks():
            matrix.setValuesBlockedLocalRCV(rows, columns, values, PETSc.InsertMode.ADD_VALUES)

    def accept(self, u: Floats) -> float:
        """Accept the last evaluation.

        Returns:
            Work from outside since the last accepted state that forces on the nodes do not tell.
        """
        return 0.0

    def roll_back(self) -> None:
        """Return to the accepted state."""

    def energies(self, u: Floats) -> dict[str, float]:
        """Energies of the accepted state over all ranks by name, force times length."""
        return {}

    def persistent(self) -> Arrays:
        """What the next increments depend on, the same on every rank."""
        return {}

    def restore(self, kept: Arrays) -> None:
        """Go on from what `persistent` gave, among other things."""

    def histories(self) -> list[Arrays]:
        """Values at points of this rank that the next increments depend on; see `Persistent`."""
        return []

    def take_histories(self, kept: Iterator[Arrays], u: Floats) -> None:
        """Go on from what `histories` gave, in the accepted state `u`."""


class TermGroup(Term):
    """Terms as one.

    Args:
        terms: The terms, in the order in which they are asked.
    """

    def __init__(self, terms: Iterable[Term]) -> None:
        self.terms = list(terms)

    def __bool__(self) -> bool:
        return bool(self.terms)

    @override
    def begin(self, step: Step, released: Floats) -> None:
        for term in self.terms:
            term.begin(step, released)

    @override
    def set_load_factor(self, factor: float, dt: float) -> None:
        for term in self.terms:
            term.set_load_factor(factor, dt)

    @override
    def end_at(self, factor: float) -> None:
        for term in self.terms:
            term.end_at(factor)

    @override
    def add_force(self, u: Floats, out: Floats) -> None:
        for term in self.terms:
            term.add_force(u, out)

    @property
    @override
    def failed(self) -> bool:
        return any(term.failed for term in self.terms)

    @override
    def lever(self) -> float:
        return math.hypot(*(term.lever() for term in self.terms))

    @override
    def blocks(self) -> list[Couplings]:
        return [found for term in self.terms for found in term.blocks()]

    @override
    def couplings(self) -> list[Couplings]:
        return [found for term in self.terms for found in term.couplings()]

    @override
    def add_tangent(self, matrix: Mat) -> None:
        for term in self.terms:
            term.add_tangent(matrix)

    @override
    def accept(self, u: Floats) -> float:
        return sum(term.accept(u) for term in self.terms)

    @override
    def roll_back(self) -> None:
        for term in self.terms:
            term.roll_back()

    @override
    def energies(self, u: Floats) -> dict[str, float]:
        found: dict[str, float] = {}
        for term in self.terms:
            for name, value in term.energies(u).items():
                found[name] = found.get(name, 0.0) + value
        return found

    @override
    def persistent(self) -> Arrays:
        return {name: value for term in self.terms for name, value in term.persistent().items()}

    @override
    def restore(self, kept: Arrays) -> None:
        for term in self.terms:
            term.restore(kept)

    @override
    def histories(self) -> list[Arrays]:
        return [found for term in self.terms for found in term.histories()]

    @override
    def take_histories(self, kept: Iterator[Arrays], u: Floats) -> None:
        for term in self.terms:
            term.take_histories(kept, u)
