"""Which points a correction may open and close where multipliers follow the displacements.

A primal-dual active set changes at all points at once that a correction presses or pulls. The
matrix of a beam in contact is no M-matrix, and such changes may lead round in circles: points by
the edge of the contact, where gap and pressure are both about zero, open and close in turn. Where
they do, block changes give way to one point at a time, as in block principal pivoting
[Judice Pires 1994] with the rule of Murty (1974) to fall back on: all points that are pulled open,
and when there are none, the one that is deepest in the master closes.

Neither does one correction end all contact. Bending turns what it pushes, and to the square of
the turn a correction strains a slender body along itself: that asks for a pull at the contact,
which the next correction at the same points takes away. Without contact the body would spring back
to where it was, far inside the master. A body that contact alone holds would have nothing left to
be in balance with: there points that are pressed stay, wherever the correction has led them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from anisocontact.base.array_types import Flags, Floats
from anisocontact.contact.multipliers import Multipliers
from anisocontact.interface import Response, State

#: Pressure of a point that is kept in contact, as a share of what the multiplier and the gap bring.
SLIGHTLY = 1e-12
#: Gap over the facet size of points that a correction has brought to the master.
NEAR = 1e-4


@dataclass(frozen=True)
class Active:
    """The active set of a trial.

    Attributes:
        closed: Points that are pressed, (n,).
        kept: Whether the correction had ended all contact, which was kept.
    """

    closed: Flags
    kept: bool = False

    @classmethod
    def of(cls, answer: Response, kept: bool) -> Active:
        """That of an answer; whether contact was kept there."""
        return cls(answer.pressure > 0.0, kept)


class ActiveSet:
    """Restrains how the points of a contact change from one correction to the next.

    Args:
        comm: Communicator over whose ranks the points are spread.
        needed: Whether contact alone holds a body here.

    Attributes:
        needed: As given.
        singly: Whether corrections close one point at a time.
        kept: Whether the last correction had ended all contact, which was kept.
    """

    def __init__(self, comm: Any, needed: bool = False) -> None:
        self._comm, self.needed = comm, needed
        self.singly = self.kept = False

    def restrained(
        self,
        start: State,
        gap: Floats,
        pressure: Floats,
        before: Active,
        fixed: Flags,
        own: Multipliers,
    ) -> State | None:
        """What a trial starts from so that points change as they may; collective.

        A point is held open by a multiplier that pulls as much as the penalty of its gap presses,
        kept closed by one that takes away what the gap pulls: the next correction is the same as
        with the force that it would have.

        Args:
            start: What it started from, with the multipliers.
            gap: Of the trial, (n,), length.
            pressure: That it answers, (n,), stress.
            before: Active set of the trial that the correction was linear about.
            fixed: Points left to their penalty, which change as they will, (n,).
            own: The multipliers.

        Returns:
            The start with other multipliers; None if all changes are as they may be.
        """
        self.kept, now = False, pressure > 0.0
        penalty = float(own.penalties[0])
        closes = now & ~before.closed & ~fixed
        touches = before.closed & ~fixed & self._near(start, gap, own.size)
        deep = np.where(closes, -gap, -np.inf)
        counts = [now.sum(), touches.sum(), (before.closed & ~now).sum(), closes.sum()]
        found = self._comm.allgather([*map(float, counts), float(deep.max(initial=-np.inf))])
        pressed, touching, opened, closing = np.sum([one[:4] for one in found], axis=0)
        if touching and not pressed and (self.needed or not before.kept):
            self.kept = True
            return self._with(start, touches, self._closed(start, penalty * gap))
        if not self.singly or not closing or (closing == 1 and not opened):
            return None
        deepest = np.inf if opened else max(one[4] for one in found)
        held = closes & (deep < deepest)
        return self._with(start, held, self._open(start, penalty * gap))

    def _near(self, start: State, gap: Floats, size: float) -> Flags:
        """Points that a correction has brought to the master, (n,).

        Where contact alone holds a body so are those that it presses, up to a facet from it: their
        gap is what the correction has left to the square of a turn, which the next one takes away.
        """
        pressed = self.needed & (start["multiplier"] > 0.0)
        return np.asarray(gap <= np.where(pressed, size, NEAR * size))

    @staticmethod
    def _with(start: State, points: Flags, multiplier: Floats) -> State:
        new = start.copy()
        new["multiplier"][points] = multiplier[points]
        return new

    @staticmethod
    def _closed(start: State, lift: Floats) -> Floats:
        """Multipliers with which points just press, whose gaps pull by so much, (n,), stress."""
        return np.asarray(lift + SLIGHTLY * (np.abs(lift) + np.abs(start["multiplier"])))

    @staticmethod
    def _open(start: State, lift: Floats) -> Floats:
        """Multipliers with which points that would be pressed do not press, (n,), stress."""
        return np.asarray(2.0 * np.minimum(lift, 0.0) - np.maximum(start["multiplier"], 0.0))
