"""What every system of terms answers to Newton's method about its forces and multipliers."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from anisocontact.base.fenicsx import Vec
from anisocontact.solver.system.assembly import ForceBalance
from anisocontact.solver.terms.contacts import Contacts
from anisocontact.solver.terms.stabilisation import Stabilisation

Floats = npt.NDArray[np.float64]


class AssembledSystem:
    """A system of terms, see `Assembly`.

    Attributes:
        terms_of_contact: Its contacts as one term.
        balance: Forces of the last evaluation.
    """

    terms_of_contact: Contacts
    balance: ForceBalance
    _aid: Stabilisation | None = None

    @property
    def force_scale(self) -> float:
        """Norm of the forces at work in the last evaluation, see `ForceBalance`."""
        return self.balance.force_scale

    @property
    def round_off(self) -> float:
        """Residual that floating point leaves in the last evaluation, see `ForceBalance`."""
        return self.balance.round_off

    @property
    def follows(self) -> bool:
        """Whether multipliers follow every correction."""
        return self.terms_of_contact.follows

    def unbalanced(self, norm: float) -> float:
        """Norm of the residual with the multipliers as they are, see `System`."""
        return self.balance.norm if self.follows else norm

    def held(self) -> bool:
        """Whether multipliers that follow are what the last evaluation answers to them."""
        return self.terms_of_contact.held()

    def take_share(self, share: float) -> None:
        """Let multipliers take only a share of the next correction."""
        self.terms_of_contact.take_share(share)

    @property
    def ways(self) -> frozenset[str]:
        """Ways to the multipliers that a contact has, see `Contacts.ways`."""
        return self.terms_of_contact.ways

    def take_way(self, name: str) -> None:
        """Find multipliers in another way in this attempt, see `Contacts.take_way`."""
        self.terms_of_contact.take_way(name)

    def improve(self, x: Vec) -> bool:
        """Better multipliers of contacts, weaker springs of stabilisation; whether any changed.

        Args:
            x: All unknowns in equilibrium, length.

        Raises:
            NotHeldError: They do not converge.
        """
        self._evaluate_at(x)
        aid, moved = self._aid, False
        if aid is not None:
            moved = aid.improve(self._nodal, self.force_scale)
            if moved and (aid.flow.flows or aid.untouched()):
                self._go_on(x)
            if moved and aid.flow.flows:
                return True
        return self.terms_of_contact.improve() or moved

    def soften(self) -> bool:
        """After a solution that failed: softer penalties of augmented contacts; whether any.

        Bodies that flow take a shorter step instead.
        """
        if self._aid is not None and self._aid.flow.flows:
            return self._aid.flow.soften()
        return self.terms_of_contact.soften()

    @property
    def _nodal(self) -> Floats:
        """Displacement of the local nodes in the last evaluation, (nodes, 3), length."""
        raise NotImplementedError

    def _evaluate_at(self, x: Vec) -> None:
        """Evaluate a state, unless it is that of the last evaluation."""
        raise NotImplementedError

    def _go_on(self, x: Vec) -> None:
        """Take note of an equilibrium on the way to the one that will be accepted."""
