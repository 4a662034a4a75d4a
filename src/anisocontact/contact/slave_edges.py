"""Slave nodes on the edges of a mesh in the plane, each with the edges beside it.

Their weights are integrals over the thickness or the circumference. The tangent across the plane is
the mean of those along the edges with the shape function of the node, so that a node on an axis of
revolution has one as well.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from anisocontact.base.array_types import Floats, Ints, Locals
from anisocontact.base.fenicsx import basix
from anisocontact.contact.facet_mesh import FacetMesh
from anisocontact.contact.quadrature import FacetQuadrature
from anisocontact.contact.sharp_edges import Towards, counting
from anisocontact.contact.slave_nodes import (
    LINES,
    ROUND,
    NodesOfFacets,
    Patches,
    patches,
    transformed,
)
from anisocontact.contact.sweep import Sweep

#: Coordinates of the nodes on the reference edge.
NODES = np.array([0.0, 1.0, 0.5])
ACROSS = np.array([0.0, 0.0, 1.0])


def line_shapes(at: Floats, count: int) -> tuple[Floats, Floats]:
    """Shape functions of an edge and their derivatives, (..., k), at coordinates, (...,).

    Args:
        at: Coordinates on the reference edge, 0 to 1.
        count: Number of nodes k: two ends, and the middle.
    """
    s = at[..., None]
    if count == 2:
        return np.concatenate([1.0 - s, s], axis=-1), np.broadcast_to([-1.0, 1.0], (*at.shape, 2))
    value = [(1.0 - s) * (1.0 - 2.0 * s), s * (2.0 * s - 1.0), 4.0 * s * (1.0 - s)]
    slope = [4.0 * s - 3.0, 4.0 * s - 1.0, 4.0 - 8.0 * s]
    return np.concatenate(value, axis=-1), np.concatenate(slope, axis=-1)


def line_rule(order: int) -> tuple[Floats, Floats]:
    """Points and weights on the reference edge for two shape functions times a radius."""
    rule = basix.make_quadrature(basix.CellType.interval, 2 * order + 1)
    return np.asarray(rule[0])[:, 0], np.asarray(rule[1])


@dataclass(frozen=True)
class SlaveEdges:
    """Edges of the slave.

    Args:
        facets: Facets that are swept out of them.
        reference: Positions of the nodes of the mesh in the reference configuration, (nodes, 3).
        towards: As of `nodes_of_facets`.
        chosen: As of `patches`.
    """

    facets: FacetMesh
    reference: Floats
    towards: Towards | None = None
    chosen: Ints | Locals | None = None

    @property
    def sweep(self) -> Sweep:
        """How the facets are swept out of the edges."""
        assert self.facets.sweep is not None
        return self.facets.sweep

    @property
    def nodes(self) -> Locals:
        """Nodes of each edge, (m, 2 or 3)."""
        return self.sweep.edges(self.facets.nodes)

    @property
    def _topology(self) -> str:
        count = self.nodes.shape[1]
        return ROUND if count == 3 and self.sweep.ideal.turn.any() else LINES[count]

    def in_plane(self) -> NodesOfFacets:
        """The edges around each node, the nodes as points, and the mean length of an edge."""
        edges = self.nodes
        around = patches(FacetMesh(self._topology, edges, self.facets.flip), self.chosen)
        counts = counting(around, self._normals, self.reference, self.towards)
        around = replace(around, counts=counts)
        n, k = around.nodes.shape
        owner = np.repeat(np.arange(n), np.diff(around.offsets))
        place = (around.nodes[owner][:, None] == edges[around.facets][:, :, None]).argmax(axis=2)
        single, double = (one[around.facets, around.local] for one in self._moments())
        length = np.bincount(owner, single, minlength=n)
        spread = np.zeros((n, k))
        np.add.at(spread, (owner[:, None], place), double / length[owner][:, None])
        along = np.zeros((n, k))
        np.add.at(along, (owner[:, None], place), self._slopes(around, owner))
        basis = np.zeros((n, k))
        basis[:, : around.support.shape[1]] = around.support
        x = self.reference[around.nodes]
        across = self.sweep.ideal.across(np.einsum("nk,nki->ni", spread, x))
        tangents = np.stack([np.einsum("nk,nki->ni", along, x), across], axis=1)
        points = FacetQuadrature(
            nodes=around.nodes,
            basis=basis[:, None],
            weights=(length * across[:, 2])[:, None],
            reference=np.einsum("nk,nki->ni", basis, x),
            gradient=np.stack([along, np.zeros((n, k))], axis=2)[:, None],
            tangents=tangents[:, None],
            rows=around.support.shape[1],
            turn=self.sweep.ideal.turn,
            spread=spread[:, None],
        )
        # every edge is around each of its nodes once
        count = len(around.facets) / edges.shape[1]
        return around, points, float(length.sum() / max(count, 1.0))

    def in_space(self) -> NodesOfFacets:
        """The same with tangents across the plane by images of the nodes."""
        around, points, size = self.in_plane()
        images, factors = self.sweep.tangents(points.nodes, points.across[:, 0])
        nodes = np.concatenate([points.nodes, images], axis=1)
        rest = np.zeros((len(nodes), 1, images.shape[1]))
        second = np.stack([rest, factors[:, None]], axis=3)
        swept = replace(
            points,
            nodes=nodes,
            basis=np.concatenate([points.basis, rest], axis=2),
            gradient=np.concatenate([points.gradient, second], axis=2),
            turn=None,
            spread=None,
        )
        return replace(around, nodes=nodes), swept, size

    def _moments(self) -> tuple[Floats, Floats]:
        """Integrals of N'_a, (m, k), and N'_a N_b, (m, k, k), over the edges, N' of `transform`."""
        edges = self.nodes
        points, weights = line_rule(edges.shape[1] - 1)
        shape, slope = line_shapes(points, edges.shape[1])
        tangents = slope @ self.reference[edges]
        extent = weights * np.linalg.norm(tangents, axis=2)
        dual = transformed(self._topology, shape)
        return extent @ dual, np.einsum("mq,qa,qb->mab", extent, dual, shape)

    @property
    def _normals(self) -> Floats:
        """Outward normals of the chords of the edges, (m, 3)."""
        ends = self.reference[self.nodes[:, :2]]
        return self._outward(ends[:, 1] - ends[:, 0], np.arange(len(ends), dtype=np.int32))

    def _outward(self, t: Floats, edge: Locals) -> Floats:
        """Outward normals of edges, (n,), from tangents, (n, 3)."""
        sign = np.where(self.facets.flip[edge], -1.0, 1.0)[:, None]
        return np.asarray(sign * np.cross(t, ACROSS) / np.linalg.norm(t, axis=1)[:, None])

    def _slopes(self, around: Patches, owner: Ints) -> Floats:
        """Shares of edges in the derivative at each node along its averaged tangent, (pairs, k)."""
        edges = self.nodes[around.facets]
        slope = line_shapes(NODES[around.local], edges.shape[1])[1]
        t = np.einsum("pk,pki->pi", slope, self.reference[edges])
        normal = self._outward(t, around.facets)
        n, counts = len(around.nodes), around.counts
        count = np.bincount(owner, counts, minlength=n)
        total = np.zeros((n, 3))
        np.add.at(total, owner, counts[:, None] * normal)
        axis = np.cross(ACROSS, total / np.linalg.norm(total, axis=1)[:, None])[owner]
        factor = np.einsum("pi,pi->p", t, axis) / np.einsum("pi,pi->p", t, t)
        factor *= counts / count[owner]
        return np.asarray(factor[:, None] * slope)
