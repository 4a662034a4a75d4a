"""The first iterate of the next sub-increment."""

from __future__ import annotations

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.fenicsx import Vec
from anisocontact.bulk import small_strain
from anisocontact.contact import Contact
from anisocontact.rigid import RigidBody
from anisocontact.solver.stepping.increment_control import IncrementControl
from anisocontact.solver.stepping.rigid_extrapolation import turned_on
from anisocontact.solver.system.problem import Problem
from anisocontact.solver.terms.free_modes import bodies
from anisocontact.solver.terms.persistent import Persistent

#: Way of a free body over what it touches in a sub-increment, over the length that it touches along
#: the way, from which on too many other points are pressed in the next one.
TRAVELS = 0.15


class Predictor:
    """Extrapolates what has happened in the last sub-increment to the end of the next one.

    Where an equilibrium further on is known, which was refused as its sub-increment was too large,
    smaller sub-increments are sought on the way to it: after a change of direction what has
    happened before says little.

    Where a free rigid body rolls or slides over a deformable one, other points are pressed next:
    extrapolated displacements would press those that it leaves, and contact is lost. There rigid
    bodies go on as they did, and deformable ones start from where they are.

    Attributes:
        travels: Whether a free rigid body has travelled over what it touches in the last
            sub-increment.
    """

    def __init__(self, problem: Problem) -> None:
        self._problem, self.travels = problem, False
        #: Those that a turn does not strain: at small strain it would.
        self._turning = [
            body
            for body in bodies(problem.model)
            if not any(small_strain(problem.materials[part]) for part in body.parts)
        ]
        #: Whether a turn about each axis is a rigid motion.
        motions = problem.model.idealisation.motions
        self._rigid = np.array([turn in motions for turn in ("rx", "ry", "rz")])
        #: The equilibrium further on, and how far on it is, share of an increment.
        self._ahead: Vec | None = None
        self._left = 0.0
        self._points: dict[Contact, Floats] = {}
        self._places: dict[RigidBody, Floats] = {}

    def begin(self) -> None:
        """Take note of where everything is in the accepted state."""
        rigid = self._problem.rigid
        self._places = {body: body.accepted.translation for body in rigid.free}
        self._points = {one: one.points for body in rigid.free for one in rigid.contacts[body]}

    def forget(self) -> None:
        """Take it that another step begins: nothing further on is known."""
        self._ahead, self._left = None, 0.0

    def refuse(self, state: Vec | None, part: float) -> None:
        """Take note of an equilibrium that was refused as its sub-increment is too large.

        Args:
            state: The equilibrium; None where none was found.
            part: Size of the sub-increment that leads to it, share of an increment.
        """
        if state is not None:
            self._ahead, self._left = state, part

    def accept(self, part: float) -> None:
        """Take note of a sub-increment that has been accepted; collective.

        Args:
            part: Its size, share of an increment.
        """
        self._left -= part
        if self._left <= _ROUNDING:
            self.forget()
        rigid = self._problem.rigid
        ways = [self._way(body, one) for body in rigid.free for one in rigid.contacts[body]]
        self.travels = any(way > TRAVELS for way in ways)
        self.begin()

    def state(self, last: Vec, before: Vec | None, control: IncrementControl) -> tuple[Vec, float]:
        """Where to start, and by what part of the last change multipliers go on from there.

        Args:
            last: Accepted state.
            before: The accepted state before it; None where there is none to extrapolate from.
            control: Sizes of the next sub-increment and of the last one.
        """
        ratio = 0.0 if before is None else control.part / control.last
        if self._ahead is not None and control.part <= self._left + _ROUNDING:
            share = control.part / self._left
            return (1.0 - share) * last + share * self._ahead, ratio
        if before is None:
            return last, ratio
        first = (1.0 + ratio) * last - ratio * before
        if not self.travels:
            self._turn_on(first, last, before, ratio)
            return first, ratio
        owned = self._problem.layout.owned
        first.array[:owned] = last.array_r[:owned]
        return first, 0.0

    def persistent(self, kept: Persistent) -> None:
        """Put what the next state depends on to what is kept."""
        kept.common["predictor"] = np.array([self.travels, self._left])
        if self._ahead is not None:
            kept.nodal["ahead"], kept.common["ahead"] = self._problem.layout.split(self._ahead)

    def restore(self, kept: Persistent, states: bool) -> None:
        """Go on from what `persistent` gave.

        Args:
            kept: What was kept.
            states: Whether states that were kept can be started from.
        """
        travels, left = kept.common["predictor"]
        self.travels = bool(travels)
        self.forget()
        if states and "ahead" in kept.nodal:
            ahead = self._problem.layout.joined(kept.nodal["ahead"], kept.common["ahead"])
            self.refuse(ahead, float(left))

    def _turn_on(self, first: Vec, last: Vec, before: Vec, ratio: float) -> None:
        """Let bodies that turn go on about their axes, see `turned_on`; collective."""
        layout, at_rest = self._problem.layout, self._problem.model.positions
        (now, _), (then, _) = layout.split(last), layout.split(before)
        to = first.array[: layout.owned].reshape(-1, 3)
        for body in self._turning:
            own = body.nodes
            x = at_rest[own]
            found = turned_on(x + then[own], x + now[own], ratio, layout.total, self._rigid)
            if found is not None:
                to[own] = found - x

    def _way(self, body: RigidBody, contact: Contact) -> float:
        """Last path of a body along what it touches, over the length that it touches."""
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


#: Rounding of sizes of sub-increments.
_ROUNDING = 1e-9
_TINY = float(np.finfo(np.float64).tiny)
