"""How points of a contact change between corrections, where multipliers follow these."""

from __future__ import annotations

from typing import Any

from anisocontact.base.array_types import Flags
from anisocontact.contact.active_set import Active, ActiveSet
from anisocontact.contact.history import Snapshot
from anisocontact.contact.linearised import Linearised
from anisocontact.contact.moved_master import followed
from anisocontact.contact.multipliers import Multipliers
from anisocontact.contact.slip_reversals import SlipReversals
from anisocontact.interface import Response, State


class PointChanges:
    """What is known of the changes of points in an increment, and what these may be.

    Args:
        comm: Communicator of the mesh.

    Attributes:
        needed: Whether contact alone holds a body here.
        reversals: Which points slide to and fro.
    """

    def __init__(self, comm: Any) -> None:
        self._comm, self._fresh = comm, False
        self.needed = False
        self._active = ActiveSet(comm)
        self.reversals = SlipReversals(comm)

    def begin(self) -> None:
        """Forget all of another increment."""
        self._active, self._fresh = ActiveSet(self._comm, self.needed), False
        self.reversals.begin()

    def expect_motion(self) -> None:
        """Take it that the next trial is where the master has moved and no node has yet."""
        self._fresh = True

    def close_singly(self, own: Multipliers | None, sticks: bool) -> bool:
        """Let corrections close one point at a time; whether that is something else, collective.

        Args:
            own: Multipliers without a layer, if there are any.
            sticks: Whether points have stuck lately.
        """
        before = self._active.singly
        self._active.singly |= own is not None and own.closes_singly(sticks)
        return self._active.singly is not before

    def with_master(
        self, start: State, trial: Snapshot, accepted: Snapshot, own: Multipliers | None
    ) -> State | None:
        """Let points go with a master that has moved; collective.

        Args:
            start: What a trial started from.
            trial: The points in it.
            accepted: The points at the last accepted increment.
            own: Multipliers without a layer, if there are any.

        Returns:
            The start with other multipliers; None where it stays.
        """
        fresh, self._fresh = self._fresh, False
        if not fresh or own is None:
            return None
        return followed(start, own, trial.response.gap, accepted.response.gap, self._comm)

    def restrained(
        self,
        start: State,
        trial: Snapshot,
        about: Linearised | None,
        fixed: Flags,
        own: Multipliers | None,
    ) -> State | None:
        """Let points change as they may, see `ActiveSet`; collective.

        Args:
            start: What a trial started from.
            trial: The points in it.
            about: What the correction was linear about, if there was one.
            fixed: Points left to their penalty, (n,).
            own: Multipliers without a layer, if there are any.

        Returns:
            The start with other multipliers; None where it stays.
        """
        if about is None or own is None:
            return None
        gap, pressure = trial.response.gap, trial.response.pressure
        return self._active.restrained(start, gap, pressure, about.active, fixed, own)

    def settled(self, trial: Snapshot, about: Linearised | None) -> bool:
        """Whether the last correction has changed the status of no point; collective.

        Args:
            trial: The points in a trial.
            about: What the correction was linear about, if there was one.
        """
        changed = about is None or bool((about.status != trial.response.status).any())
        return not self._comm.allreduce(int(changed))

    def active(self, answer: Response) -> Active:
        """The active set of an answer."""
        return Active.of(answer, self._active.kept)
