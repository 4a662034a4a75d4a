"""Contact planes at the slave nodes of a mortar contact: what the laws see of both bodies there.

The plane of a node has the averaged normal n of the slave, towards the slave, and passes through
the mean of the master that is opposite, with the weights of the node,

    y_i = sum_k W_ik y_k / D_i ,    g_i = n . (x_i - y_i) .

Material tangents of the master, at the place closest to the node, are turned from its normal to n.
The slip of an increment is that of x_i against the material points that were opposite at its
beginning, sum_k W_ik y_k / D_i with the weights of then, so that it is objective
[Puso Laursen 2004; Popp Gitterle Gee Wall 2010]. To the laws the two planes are facets of three
nodes, so that history is transported and tangents are exact as on any facet.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property

import numpy as np

from anisocontact import _core
from anisocontact.base.array_types import Flags, Floats, Locals
from anisocontact.contact.plane_axes import (
    CarriedAxes,
    TurnedTangents,
    dual,
    in_tangents,
    unit_normal,
)
from anisocontact.contact.supported_share import add_direction

#: Nodes that stand for a slave node and its planes: the slave with two tangents, the plane of now
#: and that of the accepted increment.
NODES = 9
#: Lean to held directions, and distance along them over the size of the facets, that are none: what
#: is rounding stays, so that a run that goes on within a step keeps its bits.
ROUNDING = 1e-12
#: Share of a direction along the normal, or along others, up to which it counts as across them.
ACROSS = 0.3


@dataclass(frozen=True)
class Opposite:
    """Material of the master opposite to slave nodes.

    Attributes:
        masters: Nodes, (n, k), -1 for none.
        shares: Of each in the mean position, (n, k).
        facet: Facet at which tangents are taken, (n,), -1 for none.
        nodes: Its nodes, (n, j).
        shape: Its shape functions at the place of the tangents, (n, j).
        gradient: Their derivatives, (n, 2, j).
        second: Their second derivatives, (n, 2, 2, j).
        edge: Direction of the edge on which the place is, in coordinates, (n, 2); not a number
            inside a facet, zero at a vertex.
        around: Nodes that the material tangents depend on, (n, i), -1 for none.
        along: What they are made of, (n, 2, i), see `SurfaceGradient.tangents`.
        bending: How that changes with the coordinates, (n, 2, 2, i).
        carried: Axes of the contact plane in both tangents and their normal, (n, 2, 3).
    """

    masters: Locals
    shares: Floats
    facet: Locals
    nodes: Locals
    shape: Floats
    gradient: Floats
    second: Floats
    edge: Floats
    around: Locals
    along: Floats
    bending: Floats
    carried: Floats

    @classmethod
    def none(cls, n: int, width: int) -> Opposite:
        """Nothing opposite to n slave nodes, on facets of so many nodes."""
        none = np.full((n, 1), -1, dtype=np.int32)
        return cls(
            none,
            np.zeros((n, 1)),
            none[:, 0],
            np.zeros((n, width), dtype=np.int32),
            np.zeros((n, width)),
            np.zeros((n, 2, width)),
            np.zeros((n, 2, 2, width)),
            np.zeros((n, 2)),
            none,
            np.zeros((n, 2, 1)),
            np.zeros((n, 2, 2, 1)),
            np.tile(np.eye(2, 3), (n, 1, 1)),
        )

    def with_axes(self, plane: TurnedTangents) -> Opposite:
        """The same, to carry the axes of a plane along with the master."""
        return replace(self, carried=plane.carried)

    def with_rows(self, which: Flags, other: Opposite) -> Opposite:
        """The same with what is opposite to some nodes, (n,), from another one."""
        pair = (other, self)
        masters = max(one.masters.shape[1] for one in pair)
        around = max(one.around.shape[1] for one in pair)
        both = [one.as_wide(masters, around) for one in pair]
        rows = {
            f.name: np.where(
                which.reshape(-1, *[1] * (getattr(self, f.name).ndim - 1)),
                *(getattr(one, f.name) for one in both),
            )
            for f in fields(self)
        }
        return Opposite(**rows)

    def in_order(self, names: Locals | None = None) -> Opposite:
        """The same with the nodes that have a share alone, all in ascending order.

        So sums over them have the same bits in a run that goes on.

        Args:
            names: Other names of those that have a share, (n, k).
        """
        names = np.where(self.shares != 0.0, self.masters if names is None else names, -1)
        count = max(int((names >= 0).sum(axis=1).max(initial=0)), 1)
        order = np.argsort(np.where(names < 0, np.iinfo(np.int32).max, names), axis=1)[:, :count]
        masters = np.take_along_axis(names, order, axis=1).astype(np.int32)
        shares = np.take_along_axis(self.shares, order, axis=1)
        return replace(self, masters=masters, shares=shares).around_in_order(self.around)

    def around_in_order(self, names: Locals) -> Opposite:
        """The same with the nodes around in ascending order of names, (n, i), -1 for none."""
        count = max(int((names >= 0).sum(axis=1).max(initial=0)), 1)
        order = np.argsort(np.where(names < 0, np.iinfo(np.int32).max, names), axis=1)[:, :count]
        around = np.take_along_axis(names, order, axis=1).astype(np.int32)
        there = around[:, None] >= 0
        along = np.take_along_axis(self.along, order[:, None], axis=2)
        bending = np.take_along_axis(self.bending, order[:, None, None], axis=3)
        return replace(
            self,
            around=around,
            along=np.where(there, along, 0.0),
            bending=np.where(there[:, None], bending, 0.0),
        )

    def as_wide(self, masters: int, around: int) -> Opposite:
        """The same with places for so many masters and nodes around."""
        more, beside = masters - self.masters.shape[1], around - self.around.shape[1]
        return replace(
            self,
            masters=np.pad(self.masters, [(0, 0), (0, more)], constant_values=-1),
            shares=np.pad(self.shares, [(0, 0), (0, more)]),
            around=np.pad(self.around, [(0, 0), (0, beside)], constant_values=-1),
            along=np.pad(self.along, [(0, 0), (0, 0), (0, beside)]),
            bending=np.pad(self.bending, [(0, 0), (0, 0), (0, 0), (0, beside)]),
        )

    def mean(self, x: Floats) -> Floats:
        """Mean position, (n, 3), length, of nodes at x, (nodes, 3)."""
        return _core.node_sums(self.masters, self.shares[:, None], x)[:, 0]

    def tangents(self, x: Floats) -> Floats:
        """Material tangents, (n, 2, 3), length, of nodes at x, (nodes, 3)."""
        found = _core.node_sums(self.around, self.along, x)
        found[self.facet < 0] = np.eye(3)[:2]
        return found

    def named(self) -> Locals:
        """All nodes of these, (n, k + j + i), -1 for none."""
        none = self.facet[:, None] < 0
        found = [np.where(none, np.int32(-1), one) for one in (self.nodes, self.around)]
        return np.concatenate([self.masters, *found], axis=1).astype(np.int32)


@dataclass(frozen=True)
class ContactPlanes:
    """Slave nodes with their planes, of now and of the accepted increment.

    Attributes:
        slave: Positions of the slave points, (n, 3), length.
        tangents: Tangents of the slave there, (n, 2, 3), length.
        mean: Mean position of the master opposite, (n, 3), length.
        now: Its tangents, turned.
        mean_then: Mean position now of what was opposite at the accepted increment, (n, 3), length.
        then: Axes of the plane of then, carried along with the master.
        held: Projection on directions along which slave and master do not move, (n, 3, 3): along
            these both means are where the slave point is.
    """

    slave: Floats
    tangents: Floats
    mean: Floats
    now: TurnedTangents
    mean_then: Floats
    then: CarriedAxes
    held: Floats

    @classmethod
    def at(
        cls,
        now: Floats,
        slave: Floats,
        tangents: Floats,
        opposite: tuple[Opposite, Opposite],
        held: Floats,
    ) -> ContactPlanes:
        """Planes where the nodes are.

        Args:
            now: Positions of the nodes, (nodes, 3), length.
            slave: Those of the slave points, (n, 3), length.
            tangents: Tangents of the slave there, (n, 2, 3), length.
            opposite: What is opposite now, and what was at the accepted increment.
            held: As of the attribute.
        """
        normal = across(held, averaged_normal(tangents))
        means = (one.mean(now) for one in opposite)
        mean, mean_then = (y + along(held, slave - y) for y in means)
        turned = TurnedTangents(opposite[0].tangents(now), normal)
        carried = CarriedAxes(opposite[1].tangents(now), opposite[1].carried)
        return cls(slave, tangents, mean, turned, mean_then, carried, held)

    @property
    def normal(self) -> Floats:
        """Averaged normal, from the master to the slave, (n, 3)."""
        return self.now.normal

    @cached_property
    def gap(self) -> Floats:
        """Weighted gap over the weight, (n,), length."""
        return np.asarray(np.einsum("ni,ni->n", self.slave - self.mean, self.normal))

    @cached_property
    def xi(self) -> Floats:
        """Coordinates of the slave point in the axes of the plane, (n, 2)."""
        away = self.slave - self.mean
        return np.asarray(np.einsum("nai,ni->na", dual(self.now.axes), away, order="C"))

    def points(self, facet: Locals, xi: Floats) -> tuple[Floats, Floats]:
        """Points in the planes, (n, 3), length, and the axes of these, (n, 2, 3).

        Args:
            facet: Numbers of the planes, of now or behind them of then, (n,); -1 for none.
            xi: Coordinates, (n, 2).
        """
        then = (facet >= len(facet))[:, None]
        axes = np.where(then[:, :, None], self.then.axes, self.now.axes)
        axes[facet < 0] = np.eye(3)[:2]
        return np.where(then, self.mean_then, self.mean) + np.einsum("na,nai->ni", xi, axes), axes

    def slid(self, xi: Floats) -> Floats:
        """Way from points in the planes of then to the feet of now, (n, 3), length.

        Args:
            xi: Coordinates in the planes of then, (n, 2).
        """
        before = self.mean_then + np.einsum("na,nai->ni", xi, self.then.axes)
        return np.asarray(self.slave - self.gap[:, None] * self.normal - before)

    def upright(self, xi: Floats, size: float) -> tuple[Floats, Floats] | None:
        """The planes of then as supports hold the nodes now.

        The accepted increment may have known other supports: its planes lean to the directions
        that are held now, along which nothing turns or slips.

        Args:
            xi: Coordinates in their axes, (n, 2).
            size: Of the facets, length.

        Returns:
            Coordinates in planes that contain held directions, of what is across these, and the
            axes of these planes as `CarriedAxes.by_master`; None where all is as it should be.
        """
        axes = self.then.axes
        normal, away = unit_normal(axes), np.einsum("na,nai->ni", xi, axes)
        upright, kept = across(self.held, normal), along(self.held, away)
        far = np.linalg.norm(kept, axis=1) > ROUNDING * size
        new = far | (np.linalg.norm(upright - normal, axis=1) > ROUNDING)
        if not new.any():
            return None
        axes = TurnedTangents(axes, upright).axes
        coordinates = np.einsum("nai,ni->na", dual(axes), away - kept)
        by_master = np.where(
            new[:, None, None], in_tangents(self.then.tangents, axes), self.then.by_master
        )
        return np.where(new[:, None], coordinates, xi), by_master

    def nodes(self) -> Floats:
        """The nodes that stand for all this, (9 n, 3), length.

        The slave point and with its tangents added, the same of the plane of now and of that of
        then.
        """
        parts = (
            (self.slave, self.tangents),
            (self.mean, self.now.axes),
            (self.mean_then, self.then.axes),
        )
        found = [np.concatenate([p[:, None], p[:, None] + t], axis=1) for p, t in parts]
        return np.ascontiguousarray(np.concatenate(found, axis=1).reshape(-1, 3))


def held_directions(
    resting: Sequence[tuple[Flags, Floats]], nodes: Locals, below: Locals, normal: Floats
) -> Floats:
    """Directions in the contact plane along which supports hold slave nodes and the master.

    A node on a plane of symmetry has its dual function on one side of it alone, where the master
    moves across it; by symmetry it does not, and the supports carry what would follow from that.

    Args:
        resting: Nodes that are held along directions.
        nodes: The slave nodes, (n,).
        below: Nodes of the master below them, (n, j), -1 for none.
        normal: Averaged normals, (n, 3).

    Returns:
        The projection on them, (n, 3, 3).
    """
    out = np.zeros((len(nodes), 3, 3))
    for there, direction in resting:
        held = there[np.maximum(below, 0)] & (below >= 0)
        across = np.abs(normal @ direction) < ACROSS
        which = np.flatnonzero(there[nodes] & held.any(axis=1) & across)
        add_direction(out, which, direction, ACROSS)
    return out


def averaged_normal(tangents: Floats) -> Floats:
    """Normal towards the slave from its tangents, which turn about the outward one, (n, 3)."""
    return -unit_normal(tangents)


def across(held: Floats, normal: Floats) -> Floats:
    """Normals without what is along held directions, (n, 3): by symmetry nothing is there."""
    rest = normal - along(held, normal)
    return np.asarray(rest / np.linalg.norm(rest, axis=1)[:, None])


def along(held: Floats, vectors: Floats) -> Floats:
    """What of vectors, (n, 3), is along held directions, (n, 3)."""
    return np.asarray(np.einsum("nij,nj->ni", held, vectors))
