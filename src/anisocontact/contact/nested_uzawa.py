"""Multipliers in cycles around Newton's method, of which the last is one semismooth iteration.

The first cycle is a contact with penalties, which a line search leads to equilibrium from far off.
From there most points have the status that they will have, and the semismooth iteration takes the
violations away in a few corrections. Where it does not, cycles go on from where they were.
"""

from __future__ import annotations

from typing import Any, ClassVar, override

from anisocontact.base.array_types import Flags
from anisocontact.contact.contact_trial import ContactTrial
from anisocontact.contact.multipliers import Multipliers
from anisocontact.contact.penalty import PENALTY_FACTOR
from anisocontact.contact.semismooth import Semismooth, Slender
from anisocontact.contact.uzawa import RAISE, Mixing, Uzawa
from anisocontact.interface import State
from anisocontact.interface.augmentation import Augmentation

#: Cycles after which the semismooth iteration is tried.
TRIED_AFTER = (1, 3, 6)


class NestedUzawa(Uzawa):
    """Cycles of `Uzawa` that end in `Semismooth`, made like all `Multipliers`.

    Nothing of them lasts: an increment that was solved like this leaves no level of penalties.

    Args:
        augmentation: What is asked for.
        size: Facet size, length.
        penalties: Normal penalty and least tangential stiffness, stress/length.
        comm: Communicator of the mesh.

    Attributes:
        first: Share of the penalties that suit the bodies with which the first cycle is solved.
        last: The multipliers that follow every correction in the end.
    """

    first: ClassVar[float] = 1.0
    last: ClassVar[type[Semismooth]] = Semismooth

    def __init__(
        self, augmentation: Augmentation, size: float, penalties: tuple[float, float], comm: Any
    ) -> None:
        super().__init__(augmentation, size, penalties, comm)
        self._last = self.last(augmentation, size, penalties, comm)
        self._ends = False
        self._next: State | None = None

    def suit(self, stiffness: float) -> None:
        """Bring the penalties to the stiffness of the bodies: `PENALTY_FACTOR` times of it."""
        Multipliers.suit(self, self.first * PENALTY_FACTOR * stiffness)
        self._last.suit(stiffness)

    @property
    def semismooth(self) -> Semismooth | None:
        """The multipliers that follow every correction, while they do."""
        return self._last if self._ends else None

    @property
    def factors(self) -> tuple[float, float]:
        """What normal penalty and stiffness of adhesion are multiplied with now."""
        return self._last.factors if self._ends else super().factors

    def begin(self, state: State, located: Flags) -> State:
        """What the trials of the next increment start from, see `Multipliers.begin`."""
        self._ends, self._next = False, None
        self._last.begin(state, located)
        return super().begin(state, located)

    def commit(self) -> None:
        """Keep nothing."""

    def improve(self, step: ContactTrial) -> State | None:
        """Better multipliers from a trial in equilibrium, see `Multipliers.improve`."""
        if self._ends:
            return None
        self._next = super().improve(step)
        if self._next is None or len(self._cycles) not in TRIED_AFTER:
            return self._next
        self._ends = True
        return self._last.begin_from(step)

    def soften(self, start: State) -> State | None:
        """After a solution that failed, see `Multipliers.soften`: cycles go on."""
        if not self._ends:
            return super().soften(start)
        self._ends = False
        return self._next


class Graded(NestedUzawa):
    """The same from penalties far softer than what bodies are made of: continuation in the penalty.

    Bending lets a slender body give way much more than its material does. The active set of stiff
    penalties then changes by a point at the edge of the contact in each correction, wherever that
    edge is in the end; soft ones spread the pressure over all points that will touch. They
    are raised with every cycle until they suit the bodies.
    """

    first: ClassVar[float] = 1e-3

    @override
    def begin(self, state: State, located: Flags) -> State:
        start = super().begin(state, located)
        self._full = self.factor / self.first
        return start

    @override
    def _raise(self, correction: float, typical: float) -> None:
        if self.factor >= self._full or self._waits > 1:
            super()._raise(correction, typical)
            return
        self.factor = min(RAISE * self.factor, self._full)
        self._raised, self._mixing = True, Mixing(self._comm)


class GradedSlender(Graded):
    """The same with a last cycle that has the penalties of bodies that bend.

    Where soft penalties are in balance, points press by a multiplier beside a gap. Stiff ones
    would open them, up to all that hold a sheet; those of `Slender` keep them, as cycles have.
    """

    last: ClassVar[type[Semismooth]] = Slender
