"""Where a mortar contact evaluates the law: slave nodes, weighted by their dual functions."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any, override

import numpy as np
import numpy.typing as npt

from anisocontact import _core
from anisocontact.base.array_types import Flags, Floats, Ints, Locals
from anisocontact.base.fenicsx import basix
from anisocontact.base.peaks import PEAK
from anisocontact.contact.facet_mesh import (
    FacetMesh,
    FacetShapes,
    facet_corners,
    facet_rule,
    isoparametric,
    node_coordinates,
    outward_normals,
)
from anisocontact.contact.history import Snapshot
from anisocontact.contact.integration_points import IntegrationPoints
from anisocontact.contact.near_facets import NearFacets
from anisocontact.contact.quadrature import FacetQuadrature
from anisocontact.contact.sharp_edges import Towards, beside_edges, counting
from anisocontact.contact.whole_facets import WholeFacets
from anisocontact.surfaces import FacetSets

#: Share of the nodes of the edges that the vertices of a tri6 take, whose own functions have no
#: mass [Popp Wohlmuth Gitterle Wall 2012, sec. 3.2]; as in cpp/include/anisocontact/mortar. An edge
#: of order 2 that ends on an axis of revolution has none there either.
EDGE_SHARE = 0.2
#: Edges by their number of nodes, and those of order 2 of a body of revolution.
LINES, ROUND = {2: "line2", 3: "line3"}, "line3 of revolution"
#: Times the pressure of a node at the edge of contact, over that beside it, with which it counts:
#: so the area of a Hertz contact is right to 2 % at 4 facets across its radius.
EDGE = 3.0
#: Difference of the components of a unit vector that is none.
ROUNDING = 1e-6
#: Nodes that give a share, and the vertices that take it.
_GIVING = {"tri6": {3: (1, 2), 4: (0, 2), 5: (0, 1)}, ROUND: {2: (0, 1)}}
#: Nodes around the pieces of a facet that have nodes at their corners alone.
_PIECES = {
    "tri3": [[0, 1, 2]],
    "tri6": [[0, 5, 4], [1, 3, 5], [2, 4, 3], [3, 4, 5]],
    "quad4": [[0, 1, 3, 2]],
    "quad9": [[0, 4, 8, 5], [4, 1, 6, 8], [5, 8, 7, 2], [8, 6, 3, 7]],
    "line2": [[0, 1]],
    "line3": [[0, 2], [2, 1]],
    ROUND: [[0, 2], [2, 1]],
}


@dataclass(frozen=True)
class Patches:
    """The facets around slave nodes, and the nodes of these.

    Attributes:
        mesh: All facets around the nodes.
        offsets: Where the facets of each node begin, (n + 1,).
        facets: Facets around the nodes, one list after the other.
        local: Number of the node in each of these facets.
        nodes: Nodes of the facets around each, (n, k): those of its support first, filled up with
            itself to r, then the others, and itself again to k.
        support: Values at the first nodes whose combination is the slave point, (n, r).
        counts: Whether a facet counts for the averaged normal of a node, 1 or 0, see `counting`.
        memory: Of tangents, from one evaluation to the next.
    """

    mesh: FacetMesh
    offsets: Ints
    facets: Locals
    local: Locals
    nodes: Locals
    support: Floats
    counts: Floats
    memory: _core.MortarMemory = field(default_factory=_core.MortarMemory)


def patches(mesh: FacetMesh, chosen: Ints | Locals | None = None) -> Patches:
    """The facets around the nodes of a surface, nodes in ascending order.

    Args:
        mesh: The facets.
        chosen: Nodes that are looked at; all if None.
    """
    k = mesh.nodes.shape[1]
    flat = mesh.nodes.reshape(-1)
    order = np.argsort(flat, kind="stable")
    if chosen is not None:
        order = order[np.isin(flat[order], chosen)]
    nodes, first = np.unique(flat[order], return_index=True)
    offsets = np.append(first, len(order)).astype(np.int64)
    facets, local = np.divmod(order, k)
    support = [_support(mesh, int(facets[a]), int(local[a])) for a in offsets[:-1]]
    rows = max((len(one) for one, _ in support), default=1)
    lists = []
    for node, a, b, (own, _) in zip(nodes, offsets[:-1], offsets[1:], support, strict=True):
        around = sorted({*mesh.nodes[facets[a:b]].ravel().tolist()} - {*own})
        lists.append([*own, *[node] * (rows - len(own)), *around, node])
    width = max((len(one) - 1 for one in lists), default=1)
    padded = np.array([[*one[:-1], *[one[-1]] * (width + 1 - len(one))] for one in lists])
    values = np.zeros((len(nodes), rows))
    for i, (_, value) in enumerate(support):
        values[i, : len(value)] = value
    return Patches(
        mesh,
        offsets,
        facets.astype(np.int32),
        local.astype(np.int32),
        padded.astype(np.int32).reshape(len(nodes), width),
        values,
        np.ones(len(facets)),
    )


def _support(mesh: FacetMesh, facet: int, local: int) -> tuple[list[int], list[float]]:
    """Nodes whose displacements make that of a slave point, and their shares."""
    nodes, giving = mesh.nodes[facet], _GIVING.get(mesh.topology, {})
    if local not in giving:
        return [int(nodes[local])], [1.0]
    scale = 1.0 / (1.0 - 2.0 * EDGE_SHARE)
    ends = [int(nodes[v]) for v in giving[local]]
    return [int(nodes[local]), *ends], [scale, -EDGE_SHARE * scale, -EDGE_SHARE * scale]


def transformed(topology: str, shape: Floats) -> Floats:
    """Shape functions that the multipliers are dual to, (..., k), from those of the facet."""
    out = shape.copy()
    for node, ends in _GIVING.get(topology, {}).items():
        for v in ends:
            out[..., v] += EDGE_SHARE * shape[..., node]
        out[..., node] = (1.0 - 2.0 * EDGE_SHARE) * shape[..., node]
    return out


def nodal_quadrature(around: Patches, reference: Floats) -> FacetQuadrature:
    """Slave nodes as points of a quadrature, each with the nodes around it.

    The weight of a node is the integral of its dual function, that of the shape function. Tangents
    are means of those of the facets around it in the directions of a plane, weighted with the
    angles of the facets at the node: their normal is the averaged normal.

    Args:
        around: The facets around each node.
        reference: Positions of the nodes in the reference configuration, (nodes, 3), length.
    """
    mesh, (n, k) = around.mesh, around.nodes.shape
    rule = facet_rule(mesh.topology, 2 * FacetShapes(mesh.topology).order)
    facets = isoparametric(mesh, rule, reference)
    mass = np.einsum("mq,mqa->ma", facets.weights, transformed(mesh.topology, facets.basis))
    owner = np.repeat(np.arange(n), np.diff(around.offsets))
    weights = np.bincount(owner, mass[around.facets, around.local], minlength=n)
    basis = np.zeros((n, 1, k))
    basis[:, 0, : around.support.shape[1]] = around.support
    gradient = _plane_gradients(around, owner, reference)
    tangents = gradient.swapaxes(1, 2) @ reference[around.nodes]
    return FacetQuadrature(
        nodes=around.nodes,
        basis=basis,
        weights=weights[:, None],
        reference=np.einsum("nqk,nki->ni", basis, reference[around.nodes]),
        gradient=gradient[:, None],
        tangents=tangents[:, None],
        rows=around.support.shape[1],
    )


#: The facets around each node, the nodes as points, and the length of a facet.
type NodesOfFacets = tuple[Patches, FacetQuadrature, float]


def nodes_of_facets(
    whole: WholeFacets, reference: Floats, comm: Any, towards: Towards | None = None
) -> NodesOfFacets:
    """The facets around each node, the nodes as points, and the length of a facet; collective.

    Args:
        whole: Facets of the slave.
        reference: Positions of the nodes in the reference configuration, (nodes, 3), length.
        comm: Communicator of the mesh.
        towards: Normals of the master, which tell the faces beside a sharp edge apart.
    """
    around = patches(whole.mesh, whole.nodes)
    normals = outward_normals(whole.mesh, reference)
    around = replace(around, counts=counting(around, normals, reference, towards))
    points = nodal_quadrature(around, reference)
    # every facet is around each of its nodes once
    facets = len(around.facets) / whole.mesh.nodes.shape[1]
    area, facets = comm.allreduce(np.array([points.weights.sum(), facets]))
    return around, points, float(np.sqrt(area / max(facets, 1.0)))


def _plane_gradients(around: Patches, owner: Ints, reference: Floats) -> Floats:
    """Mean gradients along two axes of a plane at each node, (n, k, 2)."""
    mesh, (n, k) = around.mesh, around.nodes.shape
    shapes = FacetShapes(mesh.topology)
    corners = np.asarray(basix.geometry(shapes.cell))
    local = node_coordinates(mesh.topology, corners)
    by_facet = shapes.at(local)[1][around.local]  # (pairs, facet nodes, 2)
    x = reference[mesh.nodes[around.facets]]
    t = by_facet.swapaxes(1, 2) @ x
    cross = np.cross(t[:, 0], t[:, 1])
    sign = np.where(mesh.flip[around.facets], -1.0, 1.0)[:, None]
    normal = sign * cross / np.linalg.norm(cross, axis=1)[:, None]
    share = around.counts * _angles(mesh.topology, around.local, t)
    total = np.zeros((n, 3))
    np.add.at(total, owner, share[:, None] * normal)
    axes = _axes(total)
    # derivative along an axis: gradient on the facet, contracted with the dual tangents
    metric = np.linalg.inv(t @ t.swapaxes(1, 2))
    dual = metric @ t
    along = by_facet @ (dual @ axes[owner].swapaxes(1, 2))
    sums = np.zeros(n)
    np.add.at(sums, owner, share)
    along *= (share / sums[owner])[:, None, None]
    gradient = np.zeros((n, k, 2))
    place = (around.nodes[owner][:, None] == mesh.nodes[around.facets][:, :, None]).argmax(axis=2)
    np.add.at(gradient, (owner[:, None], place), along)
    return gradient


def _angles(topology: str, local: Locals, t: Floats) -> Floats:
    """Angle of each facet at its node: that of a corner, else a half or a whole turn, (pairs,)."""
    size = np.linalg.norm(t, axis=2)
    cosine = np.einsum("pi,pi->p", t[:, 0], t[:, 1]) / (size[:, 0] * size[:, 1])
    between = np.arccos(np.clip(cosine, -1.0, 1.0))
    if topology.startswith("tri"):
        third = t[:, 1] - t[:, 0]
        length = np.linalg.norm(third, axis=1)
        first = np.einsum("pi,pi->p", -t[:, 0], third) / (size[:, 0] * length)
        second = np.einsum("pi,pi->p", t[:, 1], third) / (size[:, 1] * length)
        at = [between, np.arccos(np.clip(first, -1.0, 1.0)), np.arccos(np.clip(second, -1.0, 1.0))]
        corner = np.choose(np.minimum(local, 2), at)
    else:
        corner = np.where((local == 1) | (local == 2), np.pi - between, between)
    count = len(facet_corners(topology))
    return np.where(local < count, corner, np.where(local == 8, 2.0 * np.pi, np.pi))


def _axes(normal: Floats) -> Floats:
    """Two axes across each vector, right-handed with it, (n, 2, 3)."""
    n = normal / np.linalg.norm(normal, axis=1)[:, None]
    sizes = np.abs(n)
    # the first of those that are as small as each other but for rounding
    least = np.eye(3)[(sizes <= sizes.min(axis=1, keepdims=True) + ROUNDING).argmax(axis=1)]
    first = np.cross(least, n)
    first /= np.linalg.norm(first, axis=1)[:, None]
    return np.stack([first, np.cross(n, first)], axis=1)


def _pieces(mesh: FacetMesh, whole: WholeFacets) -> Locals:
    """Pieces of the facets with straight edges, (m, corners).

    Args:
        mesh: The facets; in the plane the edges.
        whole: Which of them are in the mesh; corners have numbers of its nodes, after which come
            those of its others.
    """
    nodes, flip = mesh.nodes[: whole.drawn], mesh.flip[: whole.drawn]
    pieces = nodes[:, _PIECES[mesh.topology]]
    pieces = np.where(flip[:, None, None], pieces[..., ::-1], pieces)
    named = np.concatenate([whole.nodes, whole.beside])
    order = np.argsort(named)
    numbers = order[np.searchsorted(named, pieces, sorter=order)]
    return numbers.reshape(-1, pieces.shape[2]).astype(np.int32)


class SlaveNodes(IntegrationPoints):
    """Slave nodes of one pass: one point each, with the averaged normal of the facets around it.

    Args:
        nodes: The facets around each node, the nodes as points, and the length of a facet.
        whole: Facets of the slave.
        reference: Positions of the nodes in the reference configuration, (nodes, 3), length.
        current_area: Whether the area of a node is that of now or of the reference.

    Attributes:
        around: The facets around each node.
        far: Nodes of them that are not local.
        keys: Numbers of `facet_keys` of the facets.
        across: Facets beside a sharp edge that meet what faces them well alone, (m,).
    """

    at_nodes = True

    def __init__(
        self,
        nodes: NodesOfFacets,
        whole: WholeFacets,
        reference: Floats,
        *,
        current_area: bool,
        comm: Any,
    ) -> None:
        self.around, quadrature, size = nodes
        self.far, self.keys, self._others = whole.far, whole.keys, whole.others
        self._following = whole.beside
        self._whole = whole.mesh
        flip = np.zeros(len(quadrature.nodes), dtype=bool)
        super().__init__(quadrature, flip, current_area=current_area, comm=comm)
        self.facet = self.around.facets[self.around.offsets[:-1]].astype(np.int64)
        self.size = size
        sweep, near = whole.mesh.sweep, quadrature.nodes
        near = near if sweep is None else sweep.in_plane(near)
        away = reference[near] - quadrature.reference[:, None]
        self.spread = float(np.linalg.norm(away, axis=2).max(initial=0.0))
        if (quadrature.rows or 1) > 1:  # nodes of edges of a tri6, see `EDGE_SHARE`
            self.beside = float(np.linalg.norm(away[:, 0], axis=1).max(initial=0.0))
        self.across = beside_edges(self.around, whole.keys, comm)
        self._pieces = pieces = _pieces(self.around.mesh, whole)
        self.polygons = pieces[(pieces < len(self.facet)).all(axis=1)]

    @override
    def everywhere(self, nodal: Floats) -> Floats:
        return self.far.everywhere(nodal)

    def led(self, nodal: Floats) -> Floats:
        """Values of nodes, with those that follow others on cut faces as of these; collective."""
        found, owned = nodal.copy(), nodal[: self.far.owned]
        found[self._following] = self._others.everywhere(owned)[len(owned) :]
        return found

    @override
    def coupled(self, nodes: Locals) -> Locals:
        return self.far.coupled(nodes)

    @override
    def searched(self, slave: FacetMesh) -> FacetMesh:
        return self._whole

    @override
    def unseen(self, near: NearFacets) -> FacetSets:
        around = self.around
        return near.unseen_from(around.offsets, around.facets, around.counts > 0.0)

    @override
    def peaks(self, areas: Floats) -> Flags:
        """Nodes with more than 5 % of their weight: others carry next to no force."""
        return np.asarray(areas > PEAK * self.quadrature.areas)

    @override
    def touching(self, now: Snapshot) -> Floats:
        """As of `IntegrationPoints`; nodes at the edge of contact touch in part.

        Such a node is up to a third of a facet outside of the edge, or two thirds inside, and the
        nearer it is the smaller its pressure. It counts with `EDGE` times its pressure over the
        largest of its neighbours, at most wholly.
        """
        corners = self._pieces
        touches = self._around(now.response.status != 0)
        pressure = np.where(touches, self._around(now.response.pressure), 0.0)
        beside, at_edge = np.zeros(len(touches)), np.zeros(len(touches), dtype=bool)
        for node in corners.T:
            np.maximum.at(beside, node, pressure[corners].max(axis=1))
            np.logical_or.at(at_edge, node, ~touches[corners].all(axis=1))
        share = np.divide(EDGE * pressure, beside, out=np.ones(len(beside)), where=beside > 0.0)
        part = np.where(at_edge, share.clip(0.0, 1.0), 1.0)
        return np.asarray(now.areas * (touches * part)[: len(now.areas)])

    def _around[T: np.generic](self, values: npt.NDArray[T]) -> npt.NDArray[T]:
        """Values of the slave nodes, (n,), then of others on the facets around them; collective."""
        owned = np.zeros(self.far.owned, dtype=values.dtype)
        owned[self.nodes[:, 0]] = values
        return np.concatenate([values, self._others.everywhere(owned)[len(owned) :]])

    @override
    def covered(self, areas: Floats) -> Floats:
        return np.asarray(areas / self.quadrature.areas)
