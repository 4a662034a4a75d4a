"""On which side of their master slave points are: in front of it, or through it.

A law knows the closest point and no way. A body that has turned over hangs below its master with
the slave's facets pressed from behind; one that has been thrown through a thin master finds nothing
near, or the other side. Both are in balance, and neither can be.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from anisocontact.base.array_types import Flags, Floats, Ints
from anisocontact.rigid.rotation import rotation, rotation_vector

#: Cosine of the normals of slave and master above which they point the same way.
SAME_WAY = 0.5
#: Share of the area in contact that may be pressed from behind: facets crushed at an edge.
CRUSHED = 0.1
#: Depth over the facet size that is no penetration of a penalty where the master is lost.
DEEP = 0.25
#: Distance of the places along the way of a point over the facet size, and their largest number.
SPACING, MOST_PLACES = 0.25, 200


@dataclass(frozen=True)
class Seen:
    """A master from some points.

    Attributes:
        on: Whether its closest point is none of its border, (n,).
        gap: Distance from it, negative behind, (n,), length.
        normal: Its normal there, (n, 3).
    """

    on: Flags
    gap: Floats
    normal: Floats


@dataclass(frozen=True)
class SideOfMaster:
    """Slave points of one pass in the frame of the master.

    Attributes:
        before: Where they were in the accepted state, carried along with the master, (n, 3).
        now: Where they are in the trial, (n, 3), length.
        outward: Outward normals of the slave in the trial, (n, 3).
        touched: Whether they were in contact in the accepted state, (n,).
        closed: Whether they are in contact, (n,).
        located: Whether the trial has found the master below them, (n,).
        had: Whether the accepted state had, (n,).
        normal: Normal of the master that was found, (n, 3).
        areas: Area of each, (n,), length^2.
        size: Length of a slave facet.
        reach: Distance within which the master is searched, length.
        look: The master from points, given these and their numbers.
        comm: Communicator of the mesh.
        idle: Whether they are closed as if pressed, and carry nothing, (n,).
    """

    before: Floats
    now: Floats
    outward: Floats
    touched: Flags
    closed: Flags
    located: Flags
    had: Flags
    normal: Floats
    areas: Floats
    size: float
    reach: float
    look: Callable[[Floats, Ints], Seen]
    comm: Any
    idle: Flags

    def from_behind(self) -> Flags:
        """Points in contact whose slave faces the same way as the master; none if they are few."""
        wrong = self.closed & (_cosine(self.outward, self.normal) > SAME_WAY)
        shares = np.array([self.areas[wrong].sum(), self.areas[self.closed].sum()])
        pressed, closed = self.comm.allreduce(shares)
        return wrong if pressed > CRUSHED * closed else np.zeros_like(wrong)

    def with_behind(self, there: Flags, normal: Floats, areas: Floats) -> SideOfMaster:
        """With points as if pressed that lie behind the master and face the same way.

        Args:
            there: Points that lie behind it, (n,).
            normal: Normal of the master at the closest points, (n, 3); NaN where there are none.
            areas: Area that each has where it is in contact, (n,), length^2.
        """
        behind = there & (_cosine(self.outward, np.nan_to_num(normal)) > SAME_WAY)
        return replace(
            self,
            closed=self.closed | behind,
            normal=np.where(behind[:, None], normal, self.normal),
            areas=np.where(behind, areas, self.areas),
            idle=behind & ~self.closed,
        )

    def through(self) -> tuple[Ints, Floats]:
        """Points that have gone through the master since the accepted state, and how far.

        Returns:
            Their numbers and the distance behind it, (k,) each.
        """
        start, turn = self._frame()
        which = np.flatnonzero(self._lost())
        seen = self.look(self.now[which], which)
        beyond = seen.on & ((seen.gap < -DEEP * self.size) | self._same_way(seen, which))
        which, depth = which[beyond], np.abs(seen.gap[beyond])
        crossed = np.zeros(len(which), dtype=bool)
        if len(which):
            crossed = self._crossed(which, start, turn)
        return which[crossed], depth[crossed]

    def inside(self) -> tuple[Ints, Floats]:
        """Points without force that have come to lie deep behind the master from in front of it.

        None where no more of them are than an edge may lose that digs in: few beside those that
        the accepted state had in contact. Without any of those the body may have come by any way.

        Returns:
            Their numbers and the depth of each, (k,) each, length.
        """
        start, turn = self._frame()
        which = np.flatnonzero(self.idle | self._lost())
        seen = self.look(self.now[which], which)
        deep = seen.on & (seen.gap < -DEEP * self.size)
        which, depth = which[deep], -seen.gap[deep]
        crossed = np.zeros(len(which), dtype=bool)
        if len(which):
            crossed = self._crossed(which, start, turn)
        which, depth = which[crossed], depth[crossed]
        counts = self.comm.allreduce(np.array([len(which), np.count_nonzero(self.touched)]))
        few = counts[1] == 0 or counts[0] <= CRUSHED * counts[1]
        return (which[:0], depth[:0]) if few else (which, depth)

    def _lost(self) -> Flags:
        """Open points that have left the side of the master on which they were."""
        moved = np.linalg.norm(self.now - self.before, axis=1)
        away = ~self.located & (self.had | (moved > 2.0 * self.reach))
        turned = self.located & (_cosine(self.outward, self.normal) > SAME_WAY)
        return np.asarray(~self.closed & (away | turned) & np.isfinite(moved))

    def _same_way(self, seen: Seen, which: Ints) -> Flags:
        return np.asarray(_cosine(self.outward[which], seen.normal) > SAME_WAY)

    def _frame(self) -> tuple[Floats, Floats]:
        """Middle of all points before, and the rotation vector of all as one rigid body."""
        count = np.array([float(len(self.now))])
        sums = np.concatenate([self.before.sum(axis=0), self.now.sum(axis=0), count])
        sums = self.comm.allreduce(sums)
        first, last = sums[:3] / max(sums[6], 1.0), sums[3:6] / max(sums[6], 1.0)
        spread = self.comm.allreduce((self.now - last).T @ (self.before - first))
        if not np.isfinite(spread).all() or not spread.any():
            return first, np.zeros(3)
        u, _, v = np.linalg.svd(spread)
        turn = u @ np.diag([1.0, 1.0, np.linalg.det(u @ v)]) @ v
        return first, rotation_vector(turn)

    def _crossed(self, which: Ints, middle: Floats, turn: Floats) -> Flags:
        """Whether points come from in front of the master through it; see `_path`."""
        path = self._path(which, middle, turn)
        begun = self.look(path[0], which)
        floor = np.minimum(np.nan_to_num(begun.gap), 0.0) - DEEP * self.size
        facing = begun.on & ~self._same_way(begun, which)
        crossed = np.zeros(len(which), dtype=bool)
        for x in path[1:]:
            seen = self.look(x, which)
            behind = self._same_way(seen, which) | (seen.gap < floor)
            crossed |= facing & seen.on & behind
            facing = seen.on & ~behind
        return crossed

    def _path(self, which: Ints, middle: Floats, turn: Floats) -> Floats:
        """Places of points on their way, (w, k, 3): they turn as all do, the rest is straight."""
        arms = self.before[which] - middle
        ends = self.now[which]
        longest = float(np.linalg.norm(ends - self.before[which], axis=1).max())
        longest += float(np.linalg.norm(turn) * np.linalg.norm(arms, axis=1).max())
        count = int(min(np.ceil(longest / (SPACING * self.size)) + 1, MOST_PLACES))
        rest = ends - (arms @ rotation(turn).T + middle)
        shares = np.linspace(0.0, 1.0, count + 1)
        turns = np.stack([rotation(share * turn) for share in shares])
        return np.asarray(arms @ turns.swapaxes(1, 2) + middle + shares[:, None, None] * rest)


def turned(outward: Floats, tangents: Floats, now: Floats) -> Floats:
    """Outward normals of a surface that has moved, (n, 3).

    Args:
        outward: In the reference configuration, (n, 3).
        tangents: Tangents there, (n, 2, 3), length.
        now: Tangents now, (n, 2, 3), length.
    """
    first, last = (np.cross(t[:, 0], t[:, 1]) for t in (tangents, now))
    sign = np.sign(_cosine(first, outward))
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.asarray((sign / np.linalg.norm(last, axis=1))[:, None] * last)


def carried(points: Floats, nodes: Floats, moved: Floats) -> Floats:
    """Points carried along with a body that moves from some nodes to others as if rigid, (n, 3).

    Args:
        points: The points, (n, 3), length.
        nodes: Nodes of the body, (m, 3), length.
        moved: Where they are then, (m, 3), length.
    """
    if not len(nodes):
        return points
    first, last = nodes.mean(axis=0), moved.mean(axis=0)
    u, _, v = np.linalg.svd((moved - last).T @ (nodes - first))
    turn = u @ np.diag([1.0, 1.0, np.linalg.det(u @ v)]) @ v
    return np.asarray((points - first) @ turn.T + last)


def _cosine(a: Floats, b: Floats) -> Floats:
    return np.asarray(np.einsum("ni,ni->n", a, b))
