"""Bodies are where they may be: in front of their masters.

Balance of forces does not say so. A block that has turned over hangs below its plane by its bottom;
one that has been thrown through a thin plate is free of it. Such states are found here.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from anisocontact.base.array_types import Floats, Ints
from anisocontact.base.arrays import by_place
from anisocontact.contact import Contact
from anisocontact.contact.side_of_master import CRUSHED, SideOfMaster
from anisocontact.solver.system.culprit import Culprit
from anisocontact.solver.terms.free_modes import ConnectedBody, sides_of

#: Most nodes of a body on a rank that are looked at.
MOST_NODES = 200
#: Share of them behind the master beyond which a body is behind it.
MOST_BEHIND = 0.5
#: Share of them with which a body that is pressed from behind hangs behind its master; with less of
#: it an edge has dug in and is folded over.
HANGING = 0.3
#: Depth over the size of the body that is not penetration of a penalty.
DEEP = 0.05
#: Share of a body that deep behind its master that is worth a word.
WORTH_A_WORD = 0.03


@dataclass(frozen=True)
class Behind:
    """A body of which a part lies behind its master, where faces that are no slaves have got to.

    Attributes:
        body: Its name.
        share: Part of its nodes.
        depth: How far the farthest of them is behind, length.
        master: What is meant to stop it.
    """

    body: str
    share: float
    depth: float
    master: str

    def __str__(self) -> str:
        """In a line, with what may be the cause."""
        return (
            f"{self.share:.0%} of body {self.body!r} lies behind its master {self.master!r}, up to "
            f"{self.depth:.3g}: only its slave meets it, other faces go through; let all faces "
            "that may come to it be slaves, unless the way there leads around it"
        )


@dataclass(frozen=True)
class _Watched:
    """Nodes of a slave's body that were not behind the master at first.

    Attributes:
        one: The contact.
        body: The body; None where slave and master are one.
        nodes: Nodes of this rank.
        places: Where they were, (n, 3), length.
        touchable: Nodes of the body that the contact acts on, of those this rank owns.
        arms: Their places relative to the centre over the size of the body, (m, 3).
    """

    one: Contact
    body: ConnectedBody | None
    nodes: Ints
    places: Floats
    touchable: Ints
    arms: Floats

    def carried(self, u: Floats) -> Floats:
        """Displacement of the nodes where those that can be touched alone are known, (n, 3).

        The body is taken to go with them as a rigid one, in the sense of least squares; what it
        is strained is small where displacements inside of it are not known.

        Args:
            u: Displacement of the local nodes, (nodes, 3), length.
        """
        assert self.body is not None
        motions = _motions(self.arms)
        square = np.einsum("mij,mik->jk", motions, motions)
        right = np.einsum("mij,mi->j", motions, u[self.touchable])
        total = self.one.space.mesh.comm.allreduce(np.column_stack([square, right]))
        motion = np.linalg.lstsq(total[:, :6], total[:, 6], rcond=1e-10)[0]
        arms = (self.places - self.body.centre) / self.body.size
        moved: Floats = _motions(arms) @ motion
        return moved


class SidesKept:
    """Finds bodies that have got behind their masters.

    Args:
        contacts: The contacts, in the reference configuration.
        groups: Bodies in which slaves and masters are looked for; a slave of several is of all.

    Attributes:
        partly: Bodies of which a part was behind their masters in the state looked at last.
    """

    def __init__(self, contacts: Sequence[Contact], groups: Sequence[ConnectedBody]) -> None:
        self.partly: list[Behind] = []
        self._reported: set[tuple[str, str]] = set()
        sides = sides_of(groups, contacts)
        self._watched = [
            one
            for number, contact in enumerate(contacts)
            for one in _watched(contact, _slaves(groups, [of[number] for of in sides]))
        ]

    def objection(self, u: Floats, whole: bool = True) -> Culprit | None:
        """The first body that is not where it may be, the same on all ranks; None if all are.

        Args:
            u: Displacement of the local nodes in the state evaluated last, (nodes, 3), length.
            whole: Whether it is true for all nodes, not for those that can be touched alone.
        """
        self.partly = []
        for watched in self._watched:
            found = list(self._objections(watched, u, whole))
            if found:
                return found[0]
        return None

    def fresh(self) -> list[Behind]:
        """Those of `partly` that this has not given before, by body and master."""
        found = [one for one in self.partly if (one.body, one.master) not in self._reported]
        self._reported |= {(one.body, one.master) for one in found}
        return found

    def _objections(self, watched: _Watched, u: Floats, whole: bool) -> Iterator[Culprit]:
        """All of them, as every rank has to ask all."""
        where = watched.one.side_of_master(u)
        comm = where.comm
        name = watched.one.slave.partition(".")[0]
        behind, depth, place = self._behind(watched, u, whole)
        # nodes beside pressed points of a soft penalty are as deep as these
        if behind > WORTH_A_WORD and (pressed_in := _pressed_in(where)) > 0.0:
            beyond = self._behind(watched, u, whole, pressed_in)[0]
        else:
            beyond = behind
        if beyond > WORTH_A_WORD:
            self.partly.append(Behind(name, beyond, depth, watched.one.name.split(" on ")[-1]))
        pressed = where.from_behind()
        gone, inside = where.through(), where.inside()
        far = f", the farthest of it {depth:.3g} behind" if depth > 0.0 else ""
        counts = np.array([np.count_nonzero(pressed), len(gone[0]), len(inside[0]), len(pressed)])
        turned, through, sunk, points = (int(n) for n in comm.allreduce(counts))
        known = watched.body is not None and whole
        if turned and (behind > HANGING or not known):
            text = f"body {name!r} has turned over: {turned} slave points are pressed from behind"
            yield self._culprit(watched, text + far, np.flatnonzero(pressed))
        many = through > CRUSHED * points
        if many or sunk:
            lost, below = gone if many else inside
            deepest = max(comm.allgather(float(below.max(initial=0.0))))
            text = f"body {name!r} has gone through its master: {through if many else sunk} slave"
            yield self._culprit(watched, f"{text} points are up to {deepest:.3g} behind it", lost)
        # out of contact a body may be anywhere that it has not come to through the master
        if comm.allreduce(int(np.count_nonzero(where.closed))) and behind > MOST_BEHIND:
            text = f"body {name!r} is behind its master with {behind:.0%} of it"
            yield Culprit("behind", place, text + far, watched.one.name)

    def _behind(
        self, watched: _Watched, u: Floats, whole: bool, pressed_in: float = 0.0
    ) -> tuple[float, float, tuple[float, float, float]]:
        """Share of a body behind the master that was not at first, how far at most, and where.

        Args:
            watched: The body and its contact.
            u: Displacement of the local nodes, (nodes, 3), length.
            whole: Whether it is true for all nodes, not for those that can be touched alone.
            pressed_in: Depth beyond which nodes count, besides a share of the body, length.
        """
        if watched.body is None:
            return 0.0, 0.0, (0.0, 0.0, 0.0)
        comm = watched.one.space.mesh.comm
        x = watched.places + (u[watched.nodes] if whole else watched.carried(u))
        seen = watched.one.master.look(x)
        depth = np.where(seen.on, -seen.gap, 0.0)
        behind = depth > pressed_in + DEEP * watched.body.size
        count, total = comm.allreduce(np.array([float(behind.sum()), float(len(behind))]))
        deepest = (0.0, [0.0, 0.0, 0.0])
        if len(depth):
            first = int(np.argmax(depth))
            deepest = (float(depth[first]), x[first].tolist())
        most, (x0, x1, x2) = max(comm.allgather(deepest))
        return float(count / max(total, 1.0)), most, (x0, x1, x2)

    def _culprit(self, watched: _Watched, why: str, points: Ints) -> Culprit:
        """With the first of the points by its place, over all ranks."""
        one, local = watched.one, None
        if len(points):
            first = int(points[by_place(one.current.points[points])[0]])
            x, y, z = one.current.points[first].tolist()
            local = ((x, y, z), first, int(one.slave_points.facet[first]))
        known = [place for place in one.space.mesh.comm.allgather(local) if place is not None]
        position, point, facet = known[by_place([place for place, *_ in known])[0]]
        return Culprit("behind", position, why, watched.one.name, point, facet)


def _pressed_in(where: SideOfMaster) -> float:
    """Depth of the deepest point in contact, the same on all ranks, length."""
    closed = np.flatnonzero(where.closed & ~where.idle)
    seen = where.look(where.now[closed], closed)
    depth: list[float] = where.comm.allgather(float((-seen.gap[seen.on]).max(initial=0.0)))
    return max(depth)


def _motions(arms: Floats) -> Floats:
    """Translations and turns of unit size at places relative to a centre, (n, 3, 6)."""
    still = np.broadcast_to(np.eye(3), (len(arms), 3, 3))
    return np.concatenate([still, np.cross(np.eye(3), arms[:, None, :]).swapaxes(1, 2)], axis=2)


def _slaves(
    groups: Sequence[ConnectedBody], sides: Sequence[tuple[bool, ...]]
) -> list[ConnectedBody]:
    """The bodies of a slave that are not its master's too."""
    both = zip(groups, sides, strict=True)
    return [group for group, (slave, *masters) in both if slave and not any(masters)]


def _watched(one: Contact, bodies: Sequence[ConnectedBody]) -> list[_Watched]:
    """Those bodies of a slave; its points alone if there are none."""
    found = [_body(one, body) for body in bodies]
    nodes, places = np.zeros(0, dtype=np.int64), np.zeros((0, 3))
    return found or [_Watched(one, None, nodes, places, nodes, places)]


def _body(one: Contact, body: ConnectedBody) -> _Watched:
    places = np.asarray(one.space.tabulate_dof_coordinates())
    nodes = body.nodes[:: max(1, len(body.nodes) // MOST_NODES)]
    seen = one.master.look(places[nodes])
    nodes = nodes[~seen.on | (seen.gap > -DEEP * body.size)]
    touchable = np.isin(body.nodes, one.couplable())
    return _Watched(one, body, nodes, places[nodes], body.nodes[touchable], body.arms[touchable])
