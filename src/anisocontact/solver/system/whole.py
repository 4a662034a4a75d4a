"""The bulk with all unknowns, not condensed; a checkpoint may lack its interior at first."""

from __future__ import annotations

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.fenicsx import Vec
from anisocontact.solver.system.accepted import AcceptedState
from anisocontact.solver.system.configuration import Configuration
from anisocontact.solver.system.ends_work import EndsWork
from anisocontact.solver.system.evaluation import Evaluation
from anisocontact.solver.system.interior import with_interior
from anisocontact.solver.system.parts import ProblemParts
from anisocontact.solver.system.rotations import BodyRotation, Rotations
from anisocontact.solver.terms.persistent import Arrays


class Whole:
    """Bulk of which all unknowns are kept up to date; see `Reduction`."""

    whole = True

    def __init__(
        self,
        evaluation: Evaluation,
        parts: ProblemParts,
        bodies: Configuration,
        accepted: AcceptedState,
    ) -> None:
        self._evaluation, self._parts = evaluation, parts
        self._bodies, self._accepted = bodies, accepted
        self._pending: Arrays = {}

    def commit(self, x: Vec) -> EndsWork:
        """As of `Reduction`."""
        balance = self._evaluation.at(x)
        self._accepted.go_on(x, balance.outside)
        self._accepted.take(balance.outside, balance.load)
        return self._accepted.way_work

    def nodal(self, x: Vec) -> Floats:
        """As of `Reduction`."""
        self._evaluation.at(x)
        return self._bodies.nodal

    def displacement(self, x: Vec) -> Floats:
        """As of `Reduction`."""
        return self.nodal(x)

    def pending(self) -> Arrays:
        """As of `Reduction`."""
        return self._pending

    def take_pending(self, pending: Arrays) -> None:
        """Begin with the interior to be solved for; nothing if it is known."""
        self._pending = pending

    def recover(self) -> None:
        """Solve for an interior that is not known."""
        if self._pending:
            known, self._pending = self._pending, {}
            load, contact = (known[name].reshape(-1) for name in ("load", "contact_force"))
            given = np.repeat(known["in_reach"], 3)
            given[self._parts.supports.unknowns] = True
            values, bulk = self._accepted.displacement, self._parts.bulk
            self.complete(with_interior(bulk, given, values, load + contact), contact, load)

    def complete(self, u: Floats, contact_force: Floats, load: Floats) -> None:
        """Bring the accepted state of all unknowns up to date.

        Args:
            u: Displacements this rank owns, length.
            contact_force: Forces of contact on them, force.
            load: Loads on them, force.
        """
        self._accepted.x.array[: self._parts.layout.owned] = u
        trial = self._bodies.take(self._accepted.x)
        self._accepted.take(*self._from_outside(trial.nodal, contact_force, load))

    def reactions(self, x: Vec | None = None) -> dict[str, Floats]:
        """As of `Reduction`."""
        if x is None:
            self.recover()
            force = self._accepted.reaction
        else:
            balance = self._evaluation.at(x)
            force = balance.outside - balance.load
        return self._reactions(force)

    def reactions_at(self, nodal: Floats, contact_force: Floats, load: Floats) -> dict[str, Floats]:
        """The same where displacements and forces are known without an evaluation.

        Args:
            nodal: Displacement of the local nodes, (nodes, 3), length.
            contact_force: Forces of contact on the displacements this rank owns, force.
            load: Loads on them, force.
        """
        outside, load = self._from_outside(nodal, contact_force, load)
        return self._reactions(outside - load)

    def _from_outside(
        self, nodal: Floats, contact_force: Floats, load: Floats
    ) -> tuple[Floats, Floats]:
        """All forces but those of contact, and of these the loads, as constraints hand them on."""
        assembly = self._parts.assembly
        tied = assembly.constraints.tied
        return tied(-(assembly.bodies.internal_force(nodal) + contact_force)), tied(load)

    def _reactions(self, supporting: Floats) -> dict[str, Floats]:
        """What all supports carry, by facet group."""
        across, rest = self._parts.inclined.forces(supporting)
        sums = self._parts.supports.reactions(rest)
        for name, force in across.items():
            sums[name] = sums.get(name, 0.0) + force
        return sums

    def elastic(self) -> float:
        """As of `Reduction`."""
        self.recover()
        return self._parts.assembly.bodies.energy(self._bodies.nodal)

    def mean(self, group: str, weights: Floats, x: Vec | None = None) -> Floats:
        """As of `Reduction`."""
        if x is None:
            self.recover()
        else:
            self._evaluation.at(x)
        return np.asarray(self._parts.layout.comm.allreduce(weights @ self._bodies.nodal))

    def turned(self, rotations: Rotations, x: Vec, last: bool) -> dict[str, BodyRotation]:
        """As of `Reduction`."""
        return rotations.at(self.nodal(x))
