"""Slave points that come to no rest from one Newton iteration to the next."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence

import numpy as np

from anisocontact.base.array_types import Flags, Ints
from anisocontact.contact import Contact
from anisocontact.solver.strategies.residual_history import repeats

#: Iterations that are remembered.
MEMORY = 8
#: Changes of status among them that make a point one that alternates.
CHANGES = 4
#: Returns to a facet among them that make a point one that alternates between facets.
RETURNS = 2
#: Iterations over which a residual that does not fall to `GAIN` of what it was has come to a halt.
HALT, GAIN = 6, 0.5
#: So many residuals that repeat every second time never fall.
REPEATED = 4


class StatusWatch:
    """Remembers status and foot of every slave point of this rank over the last iterations."""

    def __init__(self, contacts: Sequence[Contact]) -> None:
        self._contacts = list(contacts)
        self._statuses: deque[list[Ints]] = deque(maxlen=MEMORY)
        self._feet: deque[list[Ints]] = deque(maxlen=MEMORY)
        self._above: deque[list[Ints]] = deque(maxlen=MEMORY)
        self._residuals: deque[float] = deque(maxlen=MEMORY)

    def clear(self) -> None:
        """Forget everything: another attempt begins."""
        for memory in (self._statuses, self._feet, self._above, self._residuals):
            memory.clear()

    def note(self, residual: float) -> None:
        """Take status and feet of the last evaluation.

        Args:
            residual: Its residual, over the forces at work.
        """
        self._statuses.append([c.trial.status.astype(np.int64) for c in self._contacts])
        self._feet.append([contact.projected_facets() for contact in self._contacts])
        self._above.append([contact.located().astype(np.int64) for contact in self._contacts])
        self._residuals.append(residual)

    def hold(self) -> None:
        """Hold points that alternate between facets where they are, if that keeps the residual up.

        While it falls they may come to rest by themselves, at the closest facet.
        """
        if not self._halted() and not self._repeats():
            return
        for contact, alternate in zip(self._contacts, self.alternating_facets(), strict=True):
            contact.hold(alternate)

    def _halted(self) -> bool:
        """Whether the residual has not fallen to its share over some corrections."""
        known = self._residuals
        return len(known) > HALT and known[-1] > GAIN * known[-1 - HALT]

    def _repeats(self) -> bool:
        """Whether corrections go to and fro, or gain nothing."""
        last = list(self._residuals)[-REPEATED:]
        return len(last) == REPEATED and repeats(last)

    def history(self, contact: int) -> Ints:
        """Status of the points of a contact, (iterations, points), the latest at the end."""
        return self._of(self._statuses, contact)

    def feet(self, contact: int) -> Ints:
        """What they had below them, see `projected_facets`, (iterations, points)."""
        return self._of(self._feet, contact)

    def on_border(self, contact: int) -> Flags:
        """Points of a contact that were above the master and beside it, (points,)."""
        above = self._of(self._above, contact)
        return np.asarray(above.any(axis=0) & ~above.all(axis=0))

    def chattering(self) -> list[Flags]:
        """Points of each contact that changed their status again and again."""
        return [_changes(self.history(i)) >= CHANGES for i in range(len(self._contacts))]

    def alternating_facets(self) -> list[Flags]:
        """Points of each contact that touch and came back to a facet again and again."""
        return [self._returned(i) >= RETURNS for i in range(len(self._contacts))]

    def unsettled(self) -> bool:
        """Whether a point of this rank came back to a status that it has left lately."""
        lately = [self.history(i)[-3:] for i in range(len(self._contacts))]
        return any(
            bool(((seen[2] == seen[0]) & (seen[1] != seen[0])).any())
            for seen in lately
            if len(seen) == 3
        )

    def _returned(self, contact: int) -> Ints:
        """How often each touching point came back to what it had below it before."""
        feet = self.feet(contact)
        touching = self._contacts[contact].trial.status != 0
        returned = _changes(feet) - _changes(np.sort(feet, axis=0))
        return np.asarray(np.where(touching, returned, 0), dtype=np.int64)

    def _of(self, memory: deque[list[Ints]], contact: int) -> Ints:
        points = len(self._contacts[contact].trial.status)
        seen = [codes[contact] for codes in memory]
        return np.array(seen, dtype=np.int64).reshape(len(seen), points)


def _changes(seen: Ints) -> Ints:
    """How often each point changed from one iteration to the next, (points,)."""
    return np.asarray((seen[1:] != seen[:-1]).sum(axis=0), dtype=np.int64)
