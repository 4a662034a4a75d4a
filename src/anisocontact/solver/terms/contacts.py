"""The contacts of a problem as one term, and their multipliers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from typing import override

import numpy as np

from anisocontact.base.array_types import Floats, Ints, Locals
from anisocontact.base.fenicsx import Mat
from anisocontact.contact import Contact
from anisocontact.contact.quadrature import Couplings
from anisocontact.contact.remote_nodes import globally
from anisocontact.contact.trials import Mark
from anisocontact.solver.terms.persistent import Arrays
from anisocontact.solver.terms.term import Term

#: Where the multipliers of all contacts were.
type Marks = list[Mark]


class Contacts(Term):
    """All contacts: tractions at slave points, histories, multipliers of augmented ones.

    Attributes:
        meshed: Those against facets.
        bends: Whether a body that contact alone holds is so slender that it bends before it is
            strained.
        slender: Whether any body with a contact is so slender, where multipliers can follow that.
        compact: Whether no body with a contact is so slender.
        plastic: Whether a body with a contact may yield.
    """

    def __init__(self, contacts: Sequence[Contact]) -> None:
        self._all = list(contacts)
        self._key = object()
        self._trials = [contact.trials for contact in self._all]
        self.meshed = [contact for contact in self._all if contact.meshed]
        self._smooth = [contact for contact in self._all if not contact.meshed]
        self._dt, self.bends, self.slender = 1.0, False, False
        self.plastic, self.compact = False, True
        self._failed = False

    @override
    def set_load_factor(self, factor: float, dt: float) -> None:
        for contact in self._all:
            contact.check_history(self._key, "contact")
        self._dt = dt

    @override
    def add_force(self, u: Floats, out: Floats) -> None:
        self._failed = False
        for contact in self._all:
            self._failed |= bool(contact.update(u, self._dt).failed.any())
            contact.add_force(out)

    @property
    @override
    def failed(self) -> bool:
        return self._failed

    @override
    def lever(self) -> float:
        return float(np.linalg.norm([contact.lever() for contact in self._all]))

    @override
    def blocks(self) -> list[Couplings]:
        return [found for one in self._smooth for found in one.answer.couplings()]

    @override
    def couplings(self) -> list[Couplings]:
        return [found for one in self.meshed for found in one.answer.couplings()]

    @override
    def add_tangent(self, matrix: Mat) -> None:
        for contact in self._smooth:
            for *names, values in contact.answer.couplings():
                rows, columns = (globally(one, contact.space) for one in names)
                contact.unknowns.add_blocks(matrix, rows, columns, values)

    @override
    def accept(self, u: Floats) -> float:
        for contact in self._all:
            contact.commit()
            contact.history_of = self._key
        return 0.0

    @override
    def roll_back(self) -> None:
        for contact in self._all:
            contact.roll_back()

    @override
    def energies(self, u: Floats) -> dict[str, float]:
        found = dict.fromkeys(("adhesion", "normal", "friction", "viscous"), 0.0)
        for contact in self._all:
            for name, value in contact.energies().items():
                found[name] += value
        return found

    @override
    def histories(self) -> list[Arrays]:
        return [contact.persistent() for contact in self._all]

    @override
    def take_histories(self, kept: Iterator[Arrays], u: Floats) -> None:
        for contact in self._all:
            contact.restore(next(kept), u)
            contact.history_of = self._key

    def pass_through(self) -> None:
        """Remember a state that springs let bodies go through, for the work of friction."""
        for contact in self._all:
            contact.pass_through()

    def feet(self) -> Ints:
        """Local nodes of the master facets that are below slave points in the trial."""
        found = [contact.master.feet() for contact in self.meshed]
        return np.concatenate([np.zeros(0, dtype=np.int64), *found])

    def opposite(self) -> list[tuple[Locals, Locals, Floats]]:
        """Slave nodes and what they are held against in the trial, see `Master.opposite`."""
        found = [contact.master.opposite() for contact in self.meshed]
        return [one for one in found if one is not None]

    def beside(self) -> list[tuple[Locals, Locals, Floats]]:
        """Slave nodes whose gaps are theirs less a share of others, see `Contact.beside`."""
        found = [contact.beside() for contact in self._all]
        return [one for one in found if one is not None]

    def improve(self) -> bool:
        """Better multipliers from equilibrium; whether any changed.

        Raises:
            NotHeldError: They do not converge.
        """
        return any([one.improve() for one in self._trials])

    def settle(self) -> None:
        """Let points that came to lie in equilibrium carry friction from there."""
        for one in self._trials:
            one.settle()

    def soften(self) -> bool:
        """After a solution that failed: softer penalties; whether any changed."""
        return any([one.soften() for one in self._trials])

    @property
    def softened(self) -> bool:
        """Whether penalties are a share of those of the laws, on the way to these."""
        return any(one.softened for one in self._trials)

    @property
    def in_cycles(self) -> bool:
        """Whether multipliers stay as they are in Newton's method, which leaves penetrations."""
        return any(one.augmented and not one.simultaneous for one in self._trials)

    @property
    def simultaneous(self) -> bool:
        """Whether multipliers follow every correction of Newton's method."""
        return any(one.simultaneous for one in self._trials)

    @property
    def by_penalties(self) -> bool:
        """Whether there are contacts, and forces of all depend on displacements alone."""
        return bool(self._trials) and not self.simultaneous

    @property
    def faint(self) -> bool:
        """Whether forces hardly tell what multipliers violate: penalties of bodies that bend."""
        return self.bends and any(one.faint for one in self._trials)

    def close_singly(self, sticks: bool) -> bool:
        """Let corrections close one point of a contact at a time; whether they did not before.

        Where metal may yield a point that closes changes more than how bodies bend, as where points
        stick: other penalties lead on sooner, and this is left to the scheme that does it always.

        Args:
            sticks: Whether points have stuck lately.
        """
        return any([one.close_singly(sticks or self.plastic) for one in self._trials])

    def consistent(self) -> bool:
        """Whether multipliers that follow are what the last evaluation answers to them."""
        return all([one.consistent() for one in self._trials])

    def touch(self) -> bool:
        """Whether a point touched in the last evaluation; collective."""
        return self.touching() > 0

    def touching(self) -> int:
        """Points that touched in the last evaluation; collective."""
        counts = [one.counts() for one in self._all]
        return sum(sum(each.values()) - each["open"] for each in counts)

    def sticking(self) -> int:
        """Points that stuck in the last evaluation; collective."""
        return sum(one.counts()["stick"] for one in self._all)

    def statuses(self) -> Locals:
        """Status of the slave points of this rank in the last evaluation."""
        return np.concatenate([one.trial.status for one in self._all]).astype(np.int32)

    def same(self, before: Locals) -> bool:
        """Whether all points have the status that they had before; collective."""
        changed = int((self.statuses() != before).sum())
        return bool(self._all[0].space.mesh.comm.allreduce(changed) == 0)

    @property
    def retraceable(self) -> bool:
        """Whether multipliers that follow can go back where they came from."""
        return all(one.retraceable for one in self._trials)

    def marks(self) -> Marks:
        """What multipliers that follow have to know to go back."""
        return [one.mark() for one in self._trials]

    def go_back(self, marks: Marks) -> None:
        """Go back with the multipliers to where they were with these marks."""
        for one, mark in zip(self._trials, marks, strict=True):
            one.go_back(mark)

    @contextmanager
    def apart(self) -> Iterator[None]:
        """Around trials that are no corrections: multipliers and what is known come back."""
        marks = self.marks()
        with ExitStack() as stack:
            for one in self._trials:
                stack.enter_context(one.apart())
            try:
                yield
            finally:
                self.go_back(marks)

    def damp_correction(self, share: float) -> None:
        """Let multipliers that follow take only a share of the next correction."""
        for one in self._trials:
            one.damp_correction(share)

    def multiplier_residual(self, u: Floats) -> Floats:
        """Forces of the condensed residual of multipliers that follow, (nodes, 3).

        A correction takes them beyond the forces of the trial.
        """
        out = np.zeros(u.shape)
        for one in self._trials:
            one.add_multiplier_residual(out)
        return out

    @property
    def ways(self) -> frozenset[str]:
        """Schemes by which contacts find multipliers, see `MultiplierSchemes.names`."""
        return frozenset(way for one in self._trials for way in one.multipliers.names)

    def take_way(self, name: str) -> None:
        """Find multipliers in another way in this attempt, see `Trials.take_way`."""
        for one in self._trials:
            one.take_way(name)

    def predict(self, ratio: float) -> None:
        """Let trials start anew from extrapolated multipliers.

        Args:
            ratio: Part of the load over the last one where displacements are extrapolated, 0 where
                they start from the accepted state.
        """
        for contact in self._all:
            contact.predict(ratio)
