"""Multipliers in cycles around Newton's method: nested Uzawa iteration [Simo Laursen 1992]."""

from __future__ import annotations

from typing import Any

import numpy as np

from anisocontact.base.array_types import Codes, Flags, Floats
from anisocontact.contact.contact_trial import ContactTrial
from anisocontact.contact.frames import Frames
from anisocontact.contact.multipliers import (
    SHARE,
    Multipliers,
    NotHeldError,
)
from anisocontact.contact.penalty import PENALTY_FACTOR
from anisocontact.interface import State
from anisocontact.interface.augmentation import Augmentation

#: Cycles after which an increment is given up.
MOST_CYCLES = 30
#: A cycle is slow where it leaves more than this share of the violation; what the penalties are
#: then multiplied with; the least they come down to before an increment is given up. It is very
#: slow where it leaves more than SOFT.
SLOW, SOFT, RAISE, SOFTEST = 0.3, 0.9, 10.0, 2e-3
#: Cycles before penalties that were too high are raised again.
PATIENCE = 4
#: Values that the mixing keeps, and its directions that count, relative to the largest.
MEMORY, RANK = 6, 1e-12


class Uzawa(Multipliers):
    """Multipliers that are held while Newton's method converges.

    Then lambda_N <- N and lambda_T <- T, extrapolated from the last cycles, until both change by
    less than the tolerance. Where they change too slowly the penalties are raised; the answer does
    not depend on them.

    Args:
        augmentation: What is asked for.
        size: Facet size, length.
        penalties: Normal penalty and least tangential stiffness, stress/length.
        comm: Communicator of the mesh.
    """

    def __init__(
        self, augmentation: Augmentation, size: float, penalties: tuple[float, float], comm: Any
    ) -> None:
        super().__init__(augmentation, size, penalties, comm)
        self._found = 1.0
        self._cycles: list[float] = []
        self._raised, self._waits = False, 0
        self._mixing = Mixing(comm)
        self._status: Codes | None = None

    def suit(self, _: float) -> None:
        """The penalties are those given; the level is found from increment to increment."""

    def begin(self, state: State, located: Flags) -> State:
        """What the trials of the next increment start from, see `Multipliers.begin`."""
        self._cycles = []
        self._raised, self._waits = False, 0
        self._status, self._mixing = None, Mixing(self._comm)
        self.factor = self._found = self.level
        return super().begin(state, located)

    def commit(self) -> None:
        """Keep the level that the increment has shown to be right."""
        self.level = self._found

    def soften(self, start: State) -> State | None:
        """After a solution that failed: take penalties that are easier to solve with.

        Args:
            start: What the trials started from.

        Returns:
            The same, with the multipliers of the last cycle; None if nothing else can be tried.
        """
        if not self._cycles:
            if self._found < SOFTEST * self.level:
                return None
            self.factor = self._found = self._found / RAISE
            return start
        if not self._raised or len(self._cycles) > MOST_CYCLES:
            return None
        self.factor /= RAISE
        self._raised, self._waits = False, PATIENCE
        self._mixing = Mixing(self._comm)
        return start

    def improve(self, step: ContactTrial) -> State | None:
        """Better multipliers from a trial in equilibrium, see `Multipliers.improve`."""
        given, found = self.values(step)
        if self._held(found - given, step):
            return None
        self._settle(step.answer.status)
        better = self._mixing.next(given, found, step.areas)
        better[step.answer.pressure == 0.0] = 0.0
        new = step.start.copy()
        new["multiplier"] = np.maximum(better[:, 0], 0.0)
        if self.tangential:
            new["stored"] = np.einsum("nid,nd->ni", step.before.tangents, better[:, 1:])
        return new

    def _held(self, change: Floats, step: ContactTrial) -> bool:
        changed, carried = self._norms(change, step)
        largest = self._violation(change, step.covered)
        if largest <= self.limit and changed <= SHARE * carried:
            return True
        self._count(largest)
        # an iterate far off may have squeezed all facets flat
        area = max(self._comm.allreduce(float(step.areas.sum())), np.finfo(np.float64).tiny)
        self._raise(largest * max(self._penalties) * self.factor, float(carried / np.sqrt(area)))
        return False

    def _count(self, violation: float) -> None:
        """Count a cycle.

        Raises:
            NotHeldError: There were too many.
        """
        self._cycles.append(violation)
        if len(self._cycles) > MOST_CYCLES:
            raise NotHeldError(
                f"the augmented Lagrangian leaves a violation of {violation:.2g} after "
                f"{MOST_CYCLES} cycles, {self.limit:.2g} asked for"
            )

    def _raise(self, correction: float, typical: float) -> None:
        """Raise the penalties where a cycle was slow and Newton's method can follow.

        It can where the corrections of the multipliers stay below the tractions; where next to
        nothing is gained the penalties are far too soft, and it can as well.
        """
        self._raised = False
        self._waits -= 1
        if len(self._cycles) < 2 or self._waits > 0:
            return
        left = self._cycles[-1] / self._cycles[-2]
        near = RAISE * correction < typical
        if left > (SLOW if near else SOFT) and self._cycles[-1] > self.limit:
            self.factor *= RAISE
            self._found *= 1.0 if near else RAISE
            self._raised = True
            self._mixing = Mixing(self._comm)

    def _settle(self, status: Codes) -> None:
        """Forget earlier cycles where the status of a point has changed: the map has a kink."""
        same = self._status is not None and np.array_equal(self._status, status)
        if self._comm.allreduce(int(not same)) > 0:
            self._mixing = Mixing(self._comm)
        self._status = status


class Penalties(Uzawa):
    """A single cycle from no multipliers: a penalty carries the pressure.

    Penalties about multipliers of the accepted state would hold bodies that lose their balance.
    """

    def suit(self, stiffness: float) -> None:
        """Bring the penalties to the stiffness of the bodies: `PENALTY_FACTOR` times of it."""
        Multipliers.suit(self, PENALTY_FACTOR * stiffness)

    def commit(self) -> None:
        """Keep nothing."""

    def begin(self, state: State, located: Flags) -> State:
        """What the trials of the next increment start from, see `Multipliers.begin`."""
        start = super().begin(state, located)
        start["multiplier"] = 0.0
        return start

    def extrapolated(self, start: State, change: Floats, frames: Frames) -> State:
        """What the trials start from: the multipliers of `begin`, which are none."""
        return start

    def improve(self, _: ContactTrial) -> State | None:
        """What equilibrium with penalties leaves stays."""
        return None

    def beyond(self, step: ContactTrial) -> Flags:
        """No point has anything else than its penalty."""
        return np.zeros(len(step.start), dtype=bool)

    def soften(self, _: State) -> State | None:
        """Nothing softer stands for a contact that does not penetrate."""
        return None


class Mixing:
    """Anderson mixing: the fixed point of a map from its last few values [Walker Ni 2011].

    Args:
        comm: Communicator over whose ranks the points are spread.
    """

    def __init__(self, comm: Any) -> None:
        self._comm = comm
        self._seen: list[tuple[Floats, Floats]] = []

    def next(self, given: Floats, found: Floats, weights: Floats) -> Floats:
        """Best guess of the fixed point.

        Args:
            given: Argument, (n, k).
            found: Value of the map there, (n, k).
            weights: Weight of each of the n in the norm, (n,).

        Returns:
            The next argument, (n, k).
        """
        self._seen = [*self._seen[-MEMORY + 1 :], (found, found - given)]
        values = np.array([value for value, _ in self._seen])
        rests = np.array([rest for _, rest in self._seen])
        if len(values) == 1:
            return found.copy()
        steps = np.diff(rests, axis=0)
        weighted = steps * weights[:, None]
        gram = self._comm.allreduce(np.einsum("ink,jnk->ij", weighted, steps))
        right = self._comm.allreduce(np.einsum("ink,nk->i", weighted, rests[-1]))
        share = np.linalg.lstsq(gram, right, rcond=RANK)[0]
        return np.asarray(found - np.einsum("i,ink->nk", share, np.diff(values, axis=0)))
