"""Rigid bodies that roll past more than one slave node in an increment.

A slave point that comes to a rigid body which is free to turn carries no friction in that
increment, see `Multipliers.coming_to`. Where a wheel sticks and several nodes come to it one after
the other in an increment, those that came first lack the shear that they would have by then.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from anisocontact.base.array_types import Flags, Floats
from anisocontact.contact import Contact
from anisocontact.rigid import RigidBody
from anisocontact.solver.system.problem import Problem

#: Way of an increment over the distance of nodes from which on several come one after the other:
#: a node an increment is a way of one, but for rounding and what the body is deformed.
SEVERAL = 1.3
#: Points of a process, about, whose distance from the next one is measured.
ASKED = 16


@dataclass(frozen=True)
class Stride:
    """How far a rigid body has rolled in an increment.

    Attributes:
        body: Its name.
        way: The way, length.
        spacing: Distance of slave nodes along it, where they came to the body, length.
    """

    body: str
    way: float
    spacing: float

    def __str__(self) -> str:
        """What is wrong with it, and what to do."""
        return (
            f"rigid body {self.body!r}, which is free to turn, rolls by {self.way:.3g} in an "
            f"increment, {self.way / self.spacing:.2g} times the distance of the slave nodes that "
            "it comes to: these carry no friction in that increment, so that shear scatters from "
            "node to node and the turn is off by some percent; let it roll by no more than that "
            "distance in an increment"
        )


class RollingWatch:
    """Says which bodies roll past several nodes in an increment; made before a run goes on.

    Args:
        problem: The problem.
    """

    def __init__(self, problem: Problem) -> None:
        self._comm = problem.comm
        self._before: dict[str, tuple[Flags, Floats]] = {}
        self._watched = [
            (contact, body)
            for contact in problem.contacts
            if (body := contact.master.body) is not None and contact.trials.augmented
        ]

    def strides(self) -> dict[str, Stride]:
        """Of the accepted increment, by contact; none where nothing rolls so far; collective."""
        found = {}
        for contact, body in self._watched:
            now = contact.last.pressure > 0.0, body.accepted.translation.copy()
            before = self._before.get(contact.name)
            self._before[contact.name] = now
            if before is None or not body.turns_freely or contact.trials.does_work:
                continue
            stride = self._stride(contact, body, before, now)
            if stride is not None and stride.way > SEVERAL * stride.spacing:
                found[contact.name] = stride
        return found

    def _stride(
        self,
        contact: Contact,
        body: RigidBody,
        before: tuple[Flags, Floats],
        now: tuple[Flags, Floats],
    ) -> Stride | None:
        """None where the body does not roll: points come, others go, and most of them stick."""
        came, went = now[0] & ~before[0], before[0] & ~now[0]
        counts = contact.counts()
        comm = self._comm
        rolls = bool(comm.allreduce(int(came.any())) and comm.allreduce(int(went.any())))
        if not rolls or counts["stick"] <= counts["slip"]:
            return None
        normal = comm.allreduce(contact.last.normal[now[0]].sum(axis=0))
        normal /= np.linalg.norm(normal) or 1.0
        moved = now[1] - before[1]
        moved -= (moved @ normal) * normal
        way = float(np.linalg.norm(moved))
        if way == 0.0:
            return None
        # those of a process alone: where a border of processes is near, others tell as much
        every = comm.allgather(_spacings(contact.points, came, moved / way))
        spacings = np.concatenate(every)
        return Stride(body.name, way, float(np.median(spacings))) if len(spacings) else None


def _spacings(points: Floats, came: Flags, along: Floats) -> Floats:
    """Distance of points to the next one ahead along a direction, length.

    Args:
        points: Where points are, (n, 3), length.
        came: Of which of them, (n,).
        along: The direction, (3,).

    Returns:
        Of some of them, but those that have none ahead.
    """
    rows = np.flatnonzero(came)
    some = points[rows[:: max(1, len(rows) // ASKED)]]
    arms = points[None] - some[:, None]
    ahead = arms @ along
    beside = np.linalg.norm(arms - ahead[..., None] * along, axis=-1)
    ahead[beside >= ahead] = np.inf
    nearest = ahead.min(axis=1, initial=np.inf)
    return np.asarray(nearest[np.isfinite(nearest)])
