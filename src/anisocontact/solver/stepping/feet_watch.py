"""Slave points that hop between facets of the master from one Newton iteration to the next."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from anisocontact.contact import Contact

Codes = npt.NDArray[np.int64]
Flags = npt.NDArray[np.bool_]

#: Iterations that are remembered.
MEMORY = 8
#: Returns to a facet among them that make a point one that hops.
RETURNS = 2
#: Residual over that of two iterations before that is falling fast.
FALLING = 0.1


class FeetWatch:
    """Remembers what every slave point of this rank had below it over the last iterations.

    Args:
        contacts: The contacts.
    """

    def __init__(self, contacts: Sequence[Contact]) -> None:
        self._contacts = list(contacts)
        self._seen: deque[list[Codes]] = deque(maxlen=MEMORY)
        self._residuals: deque[float] = deque(maxlen=MEMORY)

    def clear(self) -> None:
        """Forget everything: another attempt begins."""
        self._seen.clear()
        self._residuals.clear()

    def note(self, residual: float) -> None:
        """Take the feet of the last evaluation.

        Args:
            residual: Its residual, over the forces at work.
        """
        self._seen.append([contact.footing() for contact in self._contacts])
        self._residuals.append(residual)

    def hold(self) -> None:
        """Hold points that hop on the facet where they are.

        Where the residual falls fast they come to rest by themselves.
        """
        known = self._residuals
        if len(known) < 3 or known[-1] <= FALLING * known[-3]:
            return
        for contact, hops in zip(self._contacts, self.hopping(), strict=True):
            contact.hold(hops)

    def hopping(self) -> list[Flags]:
        """Points of each contact that touch and came back to a facet again and again."""
        if not self._seen:
            return [np.zeros(len(contact.trial.status), bool) for contact in self._contacts]
        return [self._returned(i) >= RETURNS for i in range(len(self._contacts))]

    def history(self, contact: int) -> Codes:
        """What points of a contact had below them, (iterations, points), see `footing`."""
        return np.array([seen[contact] for seen in self._seen])

    def _returned(self, contact: int) -> Codes:
        """How often each touching point came back to what it had below it before."""
        feet = self.history(contact)
        ordered = np.sort(feet, axis=0)
        changes, others = ((a[1:] != a[:-1]).sum(axis=0) for a in (feet, ordered))
        touching = self._contacts[contact].trial.status != 0
        return np.asarray(np.where(touching, changes - others, 0), dtype=np.int64)
