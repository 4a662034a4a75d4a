"""What every system of terms does once it is in equilibrium, or cannot be."""

from __future__ import annotations

from contextlib import AbstractContextManager, nullcontext

from anisocontact.base.array_types import Floats
from anisocontact.base.fenicsx import Vec
from anisocontact.bulk.followed_pressures import FollowedPressures
from anisocontact.solver.system.culprit import Culprit, LostError
from anisocontact.solver.system.force_balance import ForceBalance
from anisocontact.solver.terms.contacts import Contacts
from anisocontact.solver.terms.free_body import FreeBody
from anisocontact.solver.terms.stabilisation import Stabilisation


class AssembledSystem:
    """A system of terms, see `Assembly`.

    Attributes:
        contact_term: Its contacts as one term, with their multipliers.
        outgrown: Whether the last evaluation has no answer since a slave point met a facet out of
            reach, where a system has but some of the unknowns.
    """

    outgrown: bool = False
    contact_term: Contacts
    _balance: ForceBalance
    _aid: Stabilisation | None = None

    @property
    def followed(self) -> FollowedPressures | None:
        """Pressures that follow corrections, if there are any."""
        return None

    def take_elastic_share(self, elastic_share: float) -> None:
        """Let the next tangents have a share of the elastic one where bodies flow; nothing does."""

    def linearised(self) -> AbstractContextManager[None]:
        """Around evaluations in which bodies answer as their last tangent says: linear ones do."""
        return nullcontext()

    def corrected(self, searching: bool) -> AbstractContextManager[bool]:
        """Around Newton's method: whether corrections are to be taken in full."""
        return nullcontext(False)

    def improve(self, x: Vec) -> bool:
        """Better multipliers of contacts, weaker springs of stabilisation; whether any changed.

        Args:
            x: All unknowns in equilibrium, length.

        Raises:
            NotHeldError: They do not converge.
            LostError: Viscous regularisation leads a body to where it cannot be.
        """
        self.evaluate_at(x)
        aid, moved = self._aid, False
        cycles = self.contact_term.in_cycles
        if aid is not None:
            springs = aid.force(self.nodal)
            wrong = self.behind_a_master(x) if aid.regularisation.active else None
            gone = aid.flown_off(self.nodal) if aid.regularisation.active else None
            if gone is not None:
                wrong = _gone(*gone)
            if wrong is not None:
                raise LostError(wrong)
            moved = aid.improve(self.nodal, self.balance.force_scale)
            if moved and aid.regularisation.active:
                return True
            if moved:
                self.contact_term.settle()
        improved = self.contact_term.improve()
        if aid is not None:
            softened = self.contact_term.softened or (cycles and improved)
            through = aid.come_through(self.nodal, springs, softened)
            if through and moved and aid.travels:
                self._go_on(x)
        return improved or moved

    def soften(self) -> bool:
        """After a solution that failed: softer penalties of augmented contacts; whether any.

        Viscous regularisation takes a shorter step in pseudo-time instead.
        """
        if self._aid is not None and self._aid.regularisation.active:
            return self._aid.regularisation.soften()
        return self.contact_term.soften()

    @property
    def balance(self) -> ForceBalance:
        """Forces of the last evaluation."""
        return self._balance

    @property
    def nodal(self) -> Floats:
        """Displacement of the local nodes in the last evaluation, (nodes, 3), length."""
        raise NotImplementedError

    def evaluate_at(self, x: Vec) -> None:
        """Evaluate a state, unless it is that of the last evaluation."""
        raise NotImplementedError

    def behind_a_master(self, x: Vec) -> Culprit | None:
        """A body that is behind its master in equilibrium; None if all are where they may be."""
        raise NotImplementedError

    def _go_on(self, x: Vec) -> None:
        """Take note of an equilibrium on the way to the one that will be accepted."""


def _gone(free: FreeBody, way: float) -> Culprit:
    """A body that has flown off, and how far."""
    x, y, z = free.body.centre.tolist()
    why = f"body {free.body.name!r} has lost all contact, {way:.3g} from where it was: {free.modes}"
    return Culprit("behind", (x, y, z), why, free.contacts[0].name)
