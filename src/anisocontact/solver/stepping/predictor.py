"""The state from which the next part of an increment is sought."""

from __future__ import annotations

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.fenicsx import Vec
from anisocontact.contact import Contact
from anisocontact.rigid import RigidBody
from anisocontact.solver.system.problem import Problem

#: Way of a free body over what it touches in a part, over the length that it touches along the way,
#: from which on too many other points are pressed in the next one.
TRAVELS = 0.15


class Predictor:
    """Extrapolates what has happened in the last part to the end of the next one.

    Where a free rigid body rolls or slides over a deformable one, other points are pressed next:
    extrapolated displacements would press those that it leaves, and contact is lost. There rigid
    bodies go on as they did, and deformable ones start from where they are.

    Attributes:
        travels: Whether a free rigid body has travelled over what it touches in the last part.
    """

    def __init__(self, problem: Problem) -> None:
        self._problem, self.travels = problem, False
        self._points: dict[Contact, Floats] = {}
        self._places: dict[RigidBody, Floats] = {}

    def begin(self) -> None:
        """Take note of where everything is in the accepted state."""
        rigid = self._problem.rigid
        self._places = {body: body.accepted.translation for body in rigid.free}
        self._points = {one: one.points for body in rigid.free for one in rigid.contacts[body]}

    def accept(self) -> None:
        """Take note of a part that has been accepted; collective."""
        rigid = self._problem.rigid
        ways = [self._way(body, one) for body in rigid.free for one in rigid.contacts[body]]
        self.travels = any(way > TRAVELS for way in ways)
        self.begin()

    def state(self, last: Vec, before: Vec, ratio: float) -> tuple[Vec, float]:
        """Where to start, and by what part of the last change multipliers go on from there.

        Args:
            last: Accepted state.
            before: The accepted state before it.
            ratio: Size of the next part over that of the last one.
        """
        first = (1.0 + ratio) * last - ratio * before
        if not self.travels:
            return first, ratio
        owned = self._problem.layout.owned
        first.array[:owned] = last.array_r[:owned]
        return first, 0.0

    def _way(self, body: RigidBody, contact: Contact) -> float:
        """Way of a body along what it touches in the last part, over the length that it touches."""
        comm, touching = self._problem.comm, contact.last.status != 0
        points = contact.points[touching]
        moved = (points - self._points[contact][touching]).sum(axis=0)
        normal = contact.last.normal[touching].sum(axis=0)
        total = np.asarray(comm.allreduce(np.array([*moved, *normal, len(points)])))
        moved, normal, count = total[:3], total[3:6], total[6]
        way = body.accepted.translation - self._places[body] - moved / max(count, 1.0)
        along = way - (way @ normal) / max(float(normal @ normal), _TINY) * normal
        size = float(np.linalg.norm(along))
        places = points @ along / max(size, _TINY)
        ends = comm.allgather((places.min(initial=np.inf), places.max(initial=-np.inf)))
        least, most = np.min(ends, axis=0)[0], np.max(ends, axis=0)[1]
        return size / (contact.facet_size + float(most - least)) if count else 0.0


_TINY = float(np.finfo(np.float64).tiny)
