"""Slave points whose status alternates from one Newton iteration to the next."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from anisocontact.contact import Contact
from anisocontact.solver.stepping.feet_watch import FeetWatch

Codes = npt.NDArray[np.int8]
Flags = npt.NDArray[np.bool_]

#: Iterations that are remembered.
MEMORY = 8
#: Changes of status among them that make a point one that alternates.
CHANGES = 4


class StatusWatch:
    """Remembers the status of every slave point of this rank over the last iterations.

    Args:
        contacts: The contacts.

    Attributes:
        feet: Remembers what they had below them.
    """

    def __init__(self, contacts: Sequence[Contact]) -> None:
        self._contacts = list(contacts)
        self.feet = FeetWatch(contacts)
        self._seen: deque[list[Codes]] = deque(maxlen=MEMORY)

    def clear(self) -> None:
        """Forget everything: another attempt begins."""
        self._seen.clear()
        self.feet.clear()

    def note(self) -> None:
        """Take the status of the last evaluation."""
        self._seen.append([contact.trial.status.copy() for contact in self._contacts])

    def history(self, contact: int) -> Codes:
        """Status of the points of a contact, (iterations, points), the latest at the end."""
        points = len(self._contacts[contact].trial.status)
        statuses = [seen[contact] for seen in self._seen]
        return np.array(statuses, dtype=np.int8).reshape(len(statuses), points)

    def alternating(self) -> list[Flags]:
        """Points of each contact that changed their status again and again."""
        return [self._changes(i) >= CHANGES for i in range(len(self._contacts))]

    def unsettled(self) -> bool:
        """Whether a point of this rank came back to a status that it has left lately."""
        return any(bool(self._returns(i).any()) for i in range(len(self._contacts)))

    def _changes(self, contact: int) -> npt.NDArray[np.int64]:
        seen = self.history(contact)
        return np.asarray((seen[1:] != seen[:-1]).sum(axis=0), dtype=np.int64)

    def _returns(self, contact: int) -> Flags:
        seen = self.history(contact)[-3:]
        if len(seen) < 3:
            return np.zeros(1, dtype=bool)
        return np.asarray((seen[2] == seen[0]) & (seen[1] != seen[0]))
