"""Two half passes: forces of slave points on the master, by the overlaps of the facets.

Where meshes do not match, the shape functions of the master have kinks inside a slave facet and
the points of the slave do not integrate them. The traction, as a polynomial through its values at
the points of a facet, is integrated over the overlaps instead: of the force F_g of a point the
share omega_gs acts at point s of the overlaps, on the node b of the master facet there

    f_b = - sum_s M_b(xi_s) sum_g omega_gs F_g ,    sum_s omega_gs = 1 ,

so that forces balance, and a uniform traction gives the nodes of the master what they need. Moments
balance by the couple of what is between the points, see `Couples`.

Gaps and slips are those of the points. What F_g works on the difference of the displacements of
the master, sum_s omega_gs u_m(xi_s) - u_m(xi_g), is neither stored nor dissipated in the law; it is
booked as the energy of the transfer, with the stored energy of points that cross an end of the
master. Both are errors of the discretisation and fall with the size of the facets.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import scipy

from anisocontact.contact.couples import Couples
from anisocontact.contact.facet_mesh import FacetShapes
from anisocontact.contact.overlap import Overlaps, largest_radius, overlaps
from anisocontact.contact.quadrature import Couplings
from anisocontact.contact.sides import Sides
from anisocontact.surfaces.facets import FEATURES, FacetProjections

Ints = npt.NDArray[np.int32]
Floats = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]


@dataclass(frozen=True)
class _Trial:
    """Points of the overlaps on facets in contact, at one state."""

    points: npt.NDArray[np.int64]  # which of all points
    hit: FacetProjections
    position: Floats  # of the points, (s, 3)
    force: Floats  # of the slave points, (facets, q, 3)
    sums: Any  # sparse (pairs of facets, s): which pair a point counts for
    owner: npt.NDArray[np.int64]  # slave facet of each pair
    facet: Ints  # master facet of each pair
    couples: Couples


class Transfer:
    """Shares of the forces of slave points that act on the nodes of the master.

    The overlaps are those of the committed state: in an increment their points move with the
    slave, and the master's shape functions are taken where they are now, so that the tangent is
    exact. A facet that the master does not cover hands its forces over at its own points.

    Args:
        sides: Slave and master.

    Attributes:
        handed: Points whose forces on the master the last trial has handed over, (n,).
    """

    def __init__(self, sides: Sides) -> None:
        self._slave, self._rule = slave, rule = sides.slave, sides.rule
        self._comm, self._reach = sides.comm, sides.reach
        self._master, self._surface, self._excluded = sides.master, sides.surface, sides.near
        self._shapes = FacetShapes(slave.topology)
        self._degree = min(rule.degree // 2, self._shapes.order)
        self._at_points = self._shapes.moments(rule.points, self._degree)
        self._trial: _Trial | None = None
        self.handed: Mask = np.zeros(len(slave.nodes) * len(rule.weights), dtype=bool)
        self._parts: Overlaps | None = None

    def facets(self) -> list[Ints]:
        """Facets of the master that the overlaps lie on, as arrays that can be numbered anew."""
        return [] if self._parts is None else [self._parts.facet, self._facet]

    def place(self, now: Floats) -> None:
        """Put the overlaps where the facets are; the surface has to be there already.

        Args:
            now: Positions of the nodes, (nodes, 3), length.
        """
        # the same on all ranks, so that no facet counts on one number of them and not on another
        reach = self._reach + max(self._comm.allgather(largest_radius(self._slave, now)))
        self._parts = parts = overlaps(
            self._slave, self._master, self._surface, now, reach, self._excluded
        )
        self._shape, self._gradient = self._shapes.at(parts.at)
        moments = self._shapes.moments(parts.at, self._degree)
        shares = parts.weight[:, None] * (moments @ self._at_points.T)
        count = len(self._slave.nodes)
        sums = np.ones((count, shares.shape[1]))
        for g in range(shares.shape[1]):
            found = np.bincount(parts.owner, weights=shares[:, g], minlength=count)
            sums[parts.covered, g] = found[parts.covered]
        self._share = shares / sums[parts.owner]
        # points of the slave less the mean of where their forces act, by the nodes of their facets
        mean = np.zeros((count, *self._rule.shape.shape))
        np.add.at(mean, parts.owner, self._share[:, :, None] * self._shape[:, None])
        self._off = self._rule.shape - mean
        self._facet = parts.facet.copy()

    def gathered(self, sides: Sides) -> None:
        """Go on with other facets of the master, in which `facets` are; the trial is forgotten."""
        self._master, self._surface, self._excluded = sides.master, sides.surface, sides.near
        self._trial = None

    def roll_back(self) -> None:
        """Forget the trial: the next one starts from the overlaps, whatever was tried before."""
        self._trial = None
        if self._parts is not None:
            self._facet = self._parts.facet.copy()

    def update(self, now: Floats, force: Floats, active: Mask) -> Mask:
        """Take the forces of a trial.

        Args:
            now: Positions of the nodes, (nodes, 3), length.
            force: Forces of the slave points on the slave, (n, 3).
            active: Whether a point is in contact, (n,).

        Returns:
            Points whose forces on the master this gives, (n,).
        """
        parts, q = self._parts, len(self._rule.weights)
        self._trial = None
        if parts is None:
            return np.zeros(len(force), dtype=bool)
        touching = parts.covered & active.reshape(-1, q).any(axis=1)
        points = np.flatnonzero(touching[parts.owner])
        x, hit = self._project(now, parts.owner[points], points)
        touching[parts.owner[points[hit.facet < 0]]] = False
        kept = np.flatnonzero(touching[parts.owner[points]])
        points, x, hit = points[kept], x[kept], hit.take(kept)
        if points.size:
            self._facet[points] = hit.facet
            count = len(self._master.nodes)
            pair, place = np.unique(parts.owner[points] * count + hit.facet, return_inverse=True)
            entries = (np.ones(len(points)), (place.reshape(-1), np.arange(len(points))))
            sums = scipy.sparse.csr_array(entries, shape=(len(pair), len(points)))
            owner, facet = np.divmod(pair, count)
            forces = force.reshape(-1, q, 3)
            facet = facet.astype(np.int32)
            off = np.einsum("mgk,mki->mgi", self._off, now[self._slave.nodes])
            couples = self._couples(points, x, hit, off[parts.owner[points]], forces)
            self._trial = _Trial(points, hit, x, forces, sums, owner, facet, couples)
        self.handed = np.repeat(touching, q)
        return self.handed

    def _project(
        self, now: Floats, owner: npt.NDArray[np.int64], points: npt.NDArray[np.int64]
    ) -> tuple[Floats, FacetProjections]:
        """Positions of points of the overlaps and their closest points of the master."""
        x = np.einsum("sk,ski->si", self._shape[points], now[self._slave.nodes[owner]])
        excluded = None if self._excluded is None else self._excluded.take(owner)
        hint = self._facet[points]
        return x, self._surface.project(x, hint, self._reach, excluded)

    def add_force(self, out: Floats, force: Floats | None = None) -> None:
        """Add forces on the master to the local nodes, (nodes, 3), force.

        Args:
            out: Forces of the nodes.
            force: Forces of the slave points on the slave, (n, 3); those of the trial if not given.
        """
        if (t := self._trial) is None:
            return
        points = t.force if force is None else force.reshape(t.force.shape)
        couples = t.couples
        if force is not None:
            couples = self._couples(t.points, t.position, t.hit, t.couples.off, points)
        forces = -np.einsum("pgb,pgi->pbi", self._shares(t), points[t.owner], optimize=True)
        forces += _summed(t, np.einsum("sbj,sji->sbi", self._first(t), couples.on_tangents()))
        np.add.at(out, self._master.nodes[t.facet], forces)

    def couplings(self, nodes: Ints, derivative: Floats, active: Mask) -> list[Couplings]:
        """Where `-d force / d u` on the master has entries, and the entries.

        Args:
            nodes: Nodes that the force of each slave point depends on, (n, c), -1 for none.
            derivative: Derivative of the force of each slave point, (n, 3, 3 c).
            active: Whether a point is in contact, (n,).

        Returns:
            For the change of the forces, and for that of the places where they act.
        """
        if (t := self._trial) is None:
            return []
        q = len(self._rule.weights)
        pair, g = np.nonzero(active.reshape(-1, q)[t.owner])
        point = t.owner[pair] * q + g
        shares = self._shares(t)[pair, g][:, :, None, None] * np.eye(3)
        for other in range(q):
            by_force = t.couples.by_force(self._share[t.points, other], other)
            levers = _summed(t, np.einsum("sbj,sjik->sbik", self._first(t), by_force))
            shares[g == other] -= levers[pair[g == other]]
        blocks = shares @ derivative[point][:, None]
        blocks = blocks.reshape(len(pair), 3 * shares.shape[1], derivative.shape[2])
        return [(self._master.nodes[t.facet[pair]], nodes[point], blocks), self._moving(t)]

    def _shares(self, t: _Trial) -> Floats:
        """Share of each slave point on the nodes of each pair of facets, (pairs, q, k)."""
        value, _, _ = self._surface.shapes(t.hit.facet, t.hit.xi)
        value = value[:, : self._master.nodes.shape[1]]
        share = self._share[t.points]
        return np.stack(
            [t.sums @ (share[:, g, None] * value) for g in range(share.shape[1])], axis=1
        )

    def _couples(
        self,
        points: npt.NDArray[np.int64],
        x: Floats,
        hit: FacetProjections,
        off: Floats,
        force: Floats,
    ) -> Couples:
        """Couples at points of the overlaps, `off` from where forces of slave points act."""
        parts = self._parts
        assert parts is not None
        jet = self._surface.jet(hit.facet, hit.xi)
        shared = self._share[points][:, :, None] * force[parts.owner[points]]
        return Couples(
            jet,
            x - jet.position,
            hit.feature == FEATURES.index("interior"),
            shared.sum(axis=1),
            np.einsum("sgi,sgj->sij", off, shared),
            off,
        )

    def _first(self, t: _Trial) -> Floats:
        """Derivatives of the shape functions of the master, (s, k, 2)."""
        _, first, _ = self._surface.shapes(t.hit.facet, t.hit.xi)
        return np.asarray(first[:, : self._master.nodes.shape[1]])

    def _moving(self, t: _Trial) -> Couplings:
        """Change of the places at which the forces act, and of their couples."""
        parts = self._parts
        assert parts is not None
        km, k = self._master.nodes.shape[1], self._slave.nodes.shape[1]
        value, first, second = (a[:, :km] for a in self._surface.shapes(t.hit.facet, t.hit.xi))
        shift = self._shift(t, value, first)
        owner = parts.owner[t.points]
        pull = np.einsum("sg,sgi->si", self._share[t.points], t.force[owner], optimize=True)
        along = pull[:, None, None] * first.swapaxes(1, 2)[..., None]  # (s, 2, km, 3)
        bent = second[:, :, [[0, 1], [1, 2]]]
        along -= np.einsum("sbjl,sji->slbi", bent, t.couples.on_tangents(), optimize=True)
        by_slave, by_master, by_xi = t.couples.by_place(
            self._shape[t.points],
            value,
            first,
            self._share[t.points],
            self._off[owner],
            t.force[owner],
        )
        along -= np.einsum("sbj,sjli->slbi", first, by_xi, optimize=True)
        blocks = np.einsum("slbi,slc->sbic", along, shift, optimize=True)
        by_nodes = np.concatenate([by_slave, by_master], axis=2)  # (s, j, nodes, 3, 3)
        levers = np.einsum("sbj,sjnik->sbink", first, by_nodes, optimize=True)
        blocks -= levers.reshape(blocks.shape)
        summed = _summed(t, blocks).reshape(len(t.owner), 3 * km, 3 * (k + km))
        rows = self._master.nodes[t.facet]
        return rows, np.concatenate([self._slave.nodes[t.owner], rows], axis=1), summed

    def _shift(self, t: _Trial, value: Floats, first: Floats) -> Floats:
        """Derivative of the coordinates of the projections, (s, 2, 3 columns)."""
        jet = self._surface.jet(t.hit.facet, t.hit.xi)
        apart = t.position - jet.position
        bent = np.einsum("si,ski->sk", apart, jet.d2)[:, [[0, 1], [1, 2]]]
        metric = jet.d1 @ jet.d1.swapaxes(1, 2) - bent
        inverse = _inverse(t.hit, metric)
        slave = self._shape[t.points]
        along = np.concatenate([slave, -value], axis=1)
        right = along[:, None, :, None] * jet.d1[:, :, None, :]
        right[:, :, slave.shape[1] :] += first.swapaxes(1, 2)[..., None] * apart[:, None, None]
        return np.asarray(inverse @ right.reshape(len(apart), 2, 3 * right.shape[2]))


def _summed(t: _Trial, values: Floats) -> Floats:
    """Values at the points of a trial summed over the pairs of facets."""
    flat = t.sums @ values.reshape(len(values), math.prod(values.shape[1:]))
    return np.asarray(flat.reshape(len(t.owner), *values.shape[1:]))


def _inverse(hit: FacetProjections, metric: Floats) -> Floats:
    """Inverse of the equations of the projections: of both, of that along an edge, of none."""
    out = np.zeros_like(metric)
    interior = hit.feature == FEATURES.index("interior")
    out[interior] = np.linalg.inv(metric[interior])
    edge = hit.feature == FEATURES.index("edge")
    e = hit.edge[edge]
    slope = np.einsum("si,sij,sj->s", e, metric[edge], e)
    out[edge] = np.einsum("si,sj->sij", e, e) / slope[:, None, None]
    return out
