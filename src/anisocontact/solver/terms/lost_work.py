"""Work of loads on the way on which springs let bodies go that only contact can hold."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from anisocontact.base.array_types import Flags, Floats
from anisocontact.solver.terms.free_body import FreeBody, closed_points


class LostWork:
    """Work that springs take up and dissipate in an attempt, from one equilibrium to the next.

    It is counted where loads carry a body: what these work there is lost. Bodies that touch, and on
    which springs stand against nothing but contact, slide with what moves them.

    Args:
        comm: Communicator of the mesh.

    Attributes:
        driven: Whether loads carry a body in this attempt.
        fell: Whether a body was in the air where it began.
        spent: What it comes to so far, force times length.
    """

    def __init__(self, comm: Any) -> None:
        self._comm = comm
        self.driven = self.fell = False
        self.spent = 0.0
        self._free: Sequence[FreeBody] = ()
        self._place: Floats = np.zeros(0)
        self._carried: Floats = np.zeros(0)
        self._before: dict[int, tuple[Flags, Floats]] = {}

    def start(self, free: Sequence[FreeBody], u: Floats) -> None:
        """Begin an attempt; collective.

        Args:
            free: Bodies with springs.
            u: Accepted displacement of the local nodes, (nodes, 3), length.
        """
        self._free, self.spent = free, 0.0
        self.go_on(u, np.zeros_like(u))
        self._before = {
            id(c): (np.zeros(len(c.state), dtype=np.bool_), np.zeros_like(u))
            for one in free
            if not one.touched()
            for c in one.contacts
        }
        self.driven = self.fell = any([not one.touched(at_start=True) for one in free])

    def look(self, force: Floats) -> None:
        """Find out whether loads carry a body, in the first equilibrium: later springs fade.

        Args:
            force: Of the springs, (nodes, 3).
        """
        self.driven |= any([one.against_loads(force) for one in self._free])

    def count(self, u: Floats, force: Floats) -> None:
        """Count the way to an equilibrium; collective.

        Args:
            u: Displacement of the local nodes there, (nodes, 3), length.
            force: Of the springs, (nodes, 3).
        """
        # what springs have carried is let go where the next equilibrium starts
        against = 0.5 * (self._carried + force + self._stopping(u))
        if self.driven:
            self.spent -= self._comm.allreduce(float((against * (u - self._place)).sum()))

    def go_on(self, u: Floats, force: Floats) -> None:
        """Take it that the next way starts here, where the springs carry this, (nodes, 3)."""
        self._place, self._carried = u.copy(), force

    def _stopping(self, u: Floats) -> Floats:
        """What contacts have come to carry where bodies came down on the way to here, (nodes, 3).

        Nothing carried them on that way: what it leaves of the work of loads is lost.
        """
        out = np.zeros_like(u)
        for contact in {id(c): c for one in self._free for c in one.contacts}.values():
            closed, force = closed_points(contact), np.zeros_like(u)
            contact.add_force(force)
            before = self._before.get(id(contact))
            if before is not None and self._comm.allreduce(int((closed & ~before[0]).any())):
                out += force - before[1]
            self._before[id(contact)] = closed, force
        return out
