"""Mortar weights of slave nodes on the edges of a mesh in the plane.

As those on facets (cpp/include/anisocontact/mortar): edges of order 2 are two parts with straight
ends, the overlap of two parts is an interval of the line through the part of the slave, and dual
functions are biorthogonal on what is covered. Integrals are over the thickness, or over the
circumference at the radius of the slave,

    m_ij = int N_i N_j c ds ,   w_ik = int N_i M_k c ds ,   D_i = sum_j m_ij ,   W = D m^-1 w ,

which a rule on the interval integrates exactly.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from anisocontact.base.array_types import Floats, Ints, Locals
from anisocontact.contact.facet_pairs import FacetPairs, FacingSides
from anisocontact.contact.line_overlap import LineOverlap, Number
from anisocontact.contact.slave_edges import line_rule, line_shapes
from anisocontact.contact.slave_nodes import Patches, transformed

#: Ends of the parts of an edge by the number of its nodes, and their coordinates.
_PARTS = {2: ([[0, 1]], [[0.0, 1.0]]), 3: ([[0, 2], [2, 1]], [[0.0, 0.5], [0.5, 1.0]])}
#: Share of a part below which an overlap is rounding, and least pivot of scaled dual functions, as
#: in cpp/include/anisocontact/mortar.
SLIVER, LEAST = 1e-13, 1e-13
#: Shares of its weight that are covered, over the largest, below which a node gives all of its
#: weights away and above which it keeps them, as there.
GIVEN, KEPT = 0.15, 0.25
#: Share of a whole edge that each function makes up, by their number.
_WHOLE = {2: [1 / 2, 1 / 2], 3: [1 / 6, 1 / 6, 2 / 3]}


def _coordinate(share: Number, ends: Floats, count: int) -> tuple[Floats, Floats]:
    """Shape functions of edges, (q, k), and their derivatives, (q, k, 8), at shares of a part."""
    width = ends[:, 1] - ends[:, 0]
    value, slope = line_shapes(ends[:, 0] + width * share.of, count)
    return value, slope[..., None] * (width[:, None] * share.by)[:, None]


@dataclass(frozen=True)
class _Edges:
    """Edges of both sides and where they are.

    Attributes:
        slave: Nodes of those of the slave, (f, k).
        master: Nodes of those of the master, (g, k).
        now: Positions of the nodes in the plane, (nodes, 2), length.
        reference: The same in the reference configuration, where areas are those there.
        across: Length across the plane at x = 0, and its change with x.
        transform: Matrix by which shape functions become those that multipliers are dual to.
    """

    slave: Locals
    master: Locals
    now: Floats
    reference: Floats | None
    across: tuple[float, float]
    transform: Floats

    def integrals(self, f: Ints, g: Ints) -> tuple[Ints, Ints, Floats, Floats]:
        """Integrals over the overlaps of parts of pairs of edges.

        Args:
            f: Slave edges, (p,).
            g: Master edges, (p,).

        Returns:
            Pair of each overlap, (q,), local nodes of its ends, (q, 4), m and w, (q, k, 2 k), and
            their derivatives by these ends, (q, k, 2 k, 8).
        """
        count = self.slave.shape[1]
        ends, at = (np.array(one) for one in _PARTS[count])
        n = len(ends)
        pair, part = np.divmod(np.arange(len(f) * n * n), n * n)
        own, other = np.divmod(part, n)
        local = np.concatenate([ends[own], ends[other]], axis=1)
        nodes = np.concatenate(
            [self.slave[f[pair][:, None], ends[own]], self.master[g[pair][:, None], ends[other]]],
            axis=1,
        )
        overlap = LineOverlap.of(self.now[nodes])
        there = overlap.high.of - overlap.low.of > SLIVER * overlap.length.of
        kept = np.flatnonzero(there)
        overlap, nodes, places = overlap.take(kept), nodes[kept], (at[own[kept]], at[other[kept]])
        values = np.zeros((len(kept), count, 2 * count))
        slopes = np.zeros((*values.shape, 8))
        first, last = overlap.ends
        extent = overlap.high.less(overlap.low)
        for point, weight in zip(*line_rule(count - 1), strict=True):
            s = overlap.low + extent.times(point)
            shares = s / overlap.length, s.less(first) / last.less(first)
            shapes = [_coordinate(*one, count) for one in zip(shares, places, strict=True)]
            area = extent.times(weight) * self._across(shares[0], nodes, overlap.length.of)
            turned = np.einsum("ji,qjv->qiv", self.transform, shapes[0][1])
            own_value, own_by = shapes[0] = shapes[0][0] @ self.transform, turned
            both, by = (np.concatenate(one, axis=1) for one in zip(*shapes, strict=True))
            product = own_value[:, :, None] * both[:, None]
            values += area.of[:, None, None] * product
            rate = own_by[:, :, None] * both[:, None, :, None]
            rate = rate + own_value[:, :, None, None] * by[:, None]
            slopes += area.of[:, None, None, None] * rate
            slopes += product[..., None] * area.by[:, None, None]
        return pair[kept], local[kept], values, slopes

    def _across(self, share: Number, nodes: Locals, length: Floats) -> Number:
        """Length across the plane at points of the slave; of reference per length of now."""
        offset, rate = self.across
        x = self.now if self.reference is None else self.reference
        ends = x[nodes[:, :2]]
        first, step = ends[:, 0, 0], ends[:, 1, 0] - ends[:, 0, 0]
        found = share.times(rate * step)
        found = Number(found.of + offset + rate * first, found.by)
        if self.reference is None:
            found.by[:, 0] += rate * (1.0 - share.of)
            found.by[:, 2] += rate * share.of
            return found
        size = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
        e = (self.now[nodes[:, 1]] - self.now[nodes[:, 0]]) / length[:, None]
        by = np.concatenate([-e, e, np.zeros((len(e), 4))], axis=1)
        return found * (Number(size, np.zeros_like(by)) / Number(length, by))


@dataclass(frozen=True)
class LineWeights:
    """Weights of slave edges and their derivatives: two columns a node of the edge, then a master.

    Attributes:
        masters: Nodes, (f, c), ascending, -1 behind the last.
        area: D, (f, k); zero where nothing is covered.
        weight: W, (f, k, c).
        d_area: (f, k, 2 (k + c)).
        d_weight: (f, k, c, 2 (k + c)).
    """

    masters: Locals
    area: Floats
    weight: Floats
    d_area: Floats
    d_weight: Floats

    def handed_over(self, whole: Floats) -> LineWeights:
        """Without nodes that would be extrapolated to; `whole`, (k,), are those all of which is."""
        share, d_share = self.area / whole, self.d_area / whole[:, None]
        most = share.argmax(axis=1)[:, None]
        covered = np.take_along_axis(share, most, axis=1)
        covered = np.where(covered > 0.0, covered, 1.0)
        share = share / covered
        d_share = d_share - share[..., None] * np.take_along_axis(d_share, most[..., None], axis=1)
        t = np.clip((KEPT - share) / (KEPT - GIVEN), 0.0, 1.0)
        gives = t * t * (3.0 - 2.0 * t)
        d_gives = (-6.0 * t * (1.0 - t) / ((KEPT - GIVEN) * covered))[..., None] * d_share
        rest = ((1.0 - gives) @ whole)[:, None]
        rest[rest == 0.0] = 1.0  # edges of which nothing is covered
        gets = (1.0 - gives) * whole / rest
        d_keeps = -whole[:, None] * d_gives
        d_gets = d_keeps - gets[..., None] * d_keeps.sum(axis=1, keepdims=True)
        d_gets /= rest[..., None]

        def moved(x: Floats, dx: Floats) -> tuple[Floats, Floats]:
            """(1 - lambda_i) x_i + q_i sum_j lambda_j x_j, x of (f, k, c), and its derivative."""
            total = np.einsum("fj,fjc->fc", gives, x)
            d_total = np.einsum("fjv,fjc->fcv", d_gives, x) + np.einsum("fj,fjcv->fcv", gives, dx)
            slope = (1.0 - gives)[..., None, None] * dx
            slope += gets[..., None, None] * d_total[:, None]
            slope += d_gets[:, :, None] * total[:, None, :, None]
            slope -= d_gives[:, :, None] * x[..., None]
            return (1.0 - gives)[..., None] * x + gets[..., None] * total[:, None], slope

        area, d_area = moved(self.area[..., None], self.d_area[:, :, None])
        weight, d_weight = moved(self.weight, self.d_weight)
        return LineWeights(self.masters, area[..., 0], weight, d_area[:, :, 0], d_weight)


def listed(owner: Ints, nodes: Locals, count: int) -> Locals:
    """Nodes of each owner once, (count, c), ascending, -1 behind the last."""
    most = int(nodes.max(initial=0)) + 1
    own, node = np.divmod(np.unique(owner[nodes >= 0] * most + nodes[nodes >= 0]), most)
    first = np.searchsorted(own, np.arange(count + 1))
    out = np.full((count, max(int(np.diff(first).max(initial=0)), 1)), -1, dtype=np.int32)
    out[own, np.arange(len(own)) - first[own]] = node
    return out


def place_in(lists: Locals, nodes: Locals) -> Ints:
    """Places of nodes, (p, j), in lists, (p, c)."""
    return np.asarray((lists[:, None] == nodes[:, :, None]).argmax(axis=2))


def edge_weights(edges: _Edges, f: Ints, g: Ints) -> LineWeights:
    """Weights of slave edges from their overlaps with those of the master, pairs (p,)."""
    pair, local, values, slopes = edges.integrals(f, g)
    owner, below = f[pair], edges.master[g[pair]]
    count, k = edges.slave.shape
    masters = listed(np.repeat(owner, k), below.reshape(-1), count)
    c = masters.shape[1]
    place = place_in(masters[owner], below)
    columns = local.copy()
    columns[:, 2:] = k + np.take_along_axis(place, local[:, 2:].astype(np.int64), axis=1)
    columns = (2 * columns[:, :, None] + np.arange(2)).reshape(-1, 8)
    to = np.concatenate([np.tile(np.arange(k), (len(owner), 1)), k + place], axis=1)
    total = np.zeros((count, k + c, k))
    np.add.at(total, (owner[:, None], to), values.swapaxes(1, 2))
    rates = np.zeros((count, k + c, 2 * (k + c), k))
    at = owner[:, None, None], to[:, :, None], columns[:, None]
    np.add.at(rates, at, slopes.transpose(0, 2, 3, 1))
    return _dual(masters, total.swapaxes(1, 2), np.moveaxis(rates, 3, 1))


def _dual(masters: Locals, total: Floats, rates: Floats) -> LineWeights:
    """W = D m^-1 w and its derivative from (m, w), (f, k, k + c), and theirs."""
    k = total.shape[1]
    m, w, dm, dw = total[..., :k], total[..., k:], rates[:, :, :k], rates[:, :, k:]
    diagonal = np.einsum("fii->fi", m)
    covered = (diagonal > 0.0).all(axis=1)
    unit = 1.0 / np.sqrt(np.where(covered[:, None], diagonal, 1.0))
    scaled = unit[:, :, None] * m * unit[:, None]
    scaled[~covered] = np.eye(k)
    covered &= np.linalg.eigvalsh(scaled)[:, 0] > LEAST
    scaled[~covered] = np.eye(k)
    inverse = unit[:, :, None] * np.linalg.inv(scaled) * unit[:, None]
    inverse[~covered] = 0.0
    z = inverse @ w
    z += inverse @ (w - m @ z)  # near an end functions are close to dependent
    area = np.where(covered[:, None], m.sum(axis=2), 0.0)
    d_area = np.where(covered[:, None, None], dm.sum(axis=2), 0.0)
    right = dw - np.einsum("fijv,fjc->ficv", dm, z)
    d_weight = np.einsum("fij,fjcv->ficv", inverse, right)
    d_weight = area[:, :, None, None] * d_weight + z[..., None] * d_area[:, :, None]
    return LineWeights(masters, area, area[:, :, None] * z, d_area, d_weight)


@dataclass(frozen=True)
class LineNodes:
    """Weights of slave nodes, and their derivatives by the nodes of the patch and the masters.

    Attributes:
        around: The edges around each node.
        masters: As of `MortarWeights`.
        area: As of `MortarWeights`.
        weight: As of `MortarWeights`.
        d_area: (n, 3 c), c nodes of the patch and masters, length.
        d_weight: (n, k, 3 c), length.
    """

    around: Patches
    masters: Locals
    area: Floats
    weight: Floats
    d_area: Floats
    d_weight: Floats

    def tangent(
        self,
        which: Locals,
        by: Floats,
        lift: Floats,
        traction: Floats,
        moving: Sequence[tuple[int, Locals | None, Floats]],
        threads: int,
    ) -> tuple[Floats, Locals, Locals, Floats]:
        """As of `Differentiated`."""
        masters, area, support = self.masters[which], self.area[which], self.around.support[which]
        patch = self.around.nodes[which]
        columns = np.concatenate([patch, masters], axis=1)
        p, c = columns.shape
        sums = np.zeros((p, by.shape[1], c))
        for first, nodes, values in moving:
            own, to = values[which], slice(0, patch.shape[1])
            if nodes is not None:
                there = nodes[which][:, :, None]
                own, to = own @ ((there == masters[:, None]) & (there >= 0)), slice(to.stop, c)
            sums[:, first : first + own.shape[1], to] += own
        d_weight = self.d_weight[which].reshape(p, masters.shape[1], c, 3)
        slopes = np.einsum("pvx,pvc->pcx", by, sums).reshape(p, c, 3, 3)
        slopes += np.einsum("pki,pkcj->pcij", lift, d_weight)
        rows = np.concatenate([patch[:, : support.shape[1]], masters], axis=1)
        weights = np.concatenate([-area[:, None] * support, self.weight[which]], axis=1)
        own = -support[:, :, None] * self.d_area[which][:, None]
        rates = np.concatenate([own.reshape(*support.shape, c, 3), d_weight], axis=1)
        blocks = weights[:, :, None, None, None] * slopes[:, None]
        blocks += traction[:, None, None, :, None] * rates[:, :, :, None]
        return slopes.swapaxes(1, 2), rows, columns, blocks


def line_weights(
    sides: FacingSides,
    around: Patches,
    now: Floats,
    more: Locals,
    pairs: FacetPairs,
    *,
    current_area: bool,
    hand_over: bool,
) -> LineNodes:
    """As of `mortar_weights`."""
    slave, master, sweep = around.mesh, sides.master, sides.master.sweep
    assert sweep is not None
    reference = None if current_area else sides.reference[:, :2]
    across = float(sweep.ideal.offset[2]), float(sweep.ideal.turn[2, 0])
    transform = transformed(slave.topology, np.eye(slave.nodes.shape[1]))
    below = sweep.edges(master.nodes)
    edges = _Edges(slave.nodes, below, now[:, :2], reference, across, transform)
    found = edge_weights(edges, pairs.slave, pairs.master)
    if hand_over:
        found = found.handed_over(_WHOLE[edges.slave.shape[1]] @ transform)
    n, patch = around.nodes.shape
    owner = np.repeat(np.arange(n), np.diff(around.offsets))
    f, i = around.facets, around.local
    below = found.masters[f]
    of = np.repeat(owner, below.shape[1]), np.repeat(np.arange(n), more.shape[1])
    met = below.reshape(-1), more.reshape(-1)
    masters = listed(np.concatenate(of), np.concatenate(met), n)
    place = np.where(below >= 0, place_in(masters[owner], below), 0)
    places = np.concatenate([place_in(around.nodes[owner], edges.slave[f]), patch + place], axis=1)
    columns = (3 * places[:, :, None] + np.arange(2)).reshape(len(f), -1)
    c = masters.shape[1]
    weight, d_area = np.zeros((n, c)), np.zeros((n, 3 * (patch + c)))
    d_weight = np.zeros((n, c, 3 * (patch + c)))
    np.add.at(weight, (owner[:, None], place), found.weight[f, i])
    np.add.at(d_area, (owner[:, None], columns), found.d_area[f, i])
    at = owner[:, None, None], place[:, :, None], columns[:, None]
    np.add.at(d_weight, at, found.d_weight[f, i])
    area = np.bincount(owner, found.area[f, i], minlength=n)
    return LineNodes(around, masters, area, weight, d_area, d_weight)
