"""Gradients on a surface of facets that are continuous across their edges.

Facets that meet are stretched and turned by unequal amounts. The gradient of a field at a vertex is
the mean of those of the facets around it, weighted with their angles there, and between vertices of
a facet it is interpolated [Zienkiewicz Zhu 1992]. Across an edge at which the surface is sharp in
the reference configuration nothing is averaged.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from anisocontact import _core
from anisocontact.base.array_types import Floats, Ints, Locals
from anisocontact.base.arrays import connected
from anisocontact.contact.facet_mesh import FacetMesh, facet_corners
from anisocontact.surfaces import default_threads
from anisocontact.surfaces.facets import FacetSurface

#: Cosine of the angle of the normals of two facets beyond which the edge between them is sharp.
SHARP = np.cos(np.radians(40.0))
#: Coordinates of the vertices of a facet by their number, in the order of its nodes.
VERTICES = {
    3: np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]),
    4: np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]]),
}


@dataclass(frozen=True)
class SurfaceGradient:
    """The gradient of nodal values f_m in the reference configuration, grad f = sum_m f_m B_m.

    Attributes:
        nodes: Nodes around each facet, those of the facet among them, (m, j), -1 behind the last.
        at_vertices: B at the vertices of the facet, (m, c, j, 3), 1/length.
        normals: Averaged normals at the vertices, (m, c, 3).
    """

    nodes: Locals
    at_vertices: Floats
    normals: Floats

    @classmethod
    def of(cls, mesh: FacetMesh, reference: Floats) -> SurfaceGradient:
        """Gradients on facets.

        Args:
            mesh: The facets.
            reference: Positions of the nodes in the reference configuration, (nodes, 3), length.
        """
        vertices = _vertices(mesh)
        corners = vertices.shape[1]
        slots = _Slots.of(mesh, reference, vertices)
        group = _smooth(mesh.topology, slots.normals, vertices)
        count = int(group.max(initial=-1)) + 1
        total = np.bincount(group, slots.angles, minlength=count)
        weight = slots.angles / total[group]
        owner = np.repeat(group, mesh.nodes.shape[1])
        # sums in an order that does not depend on how a mesh is distributed: that of the facets
        known, first, which = np.unique(mesh.nodes, return_index=True, return_inverse=True)
        order = np.argsort(first)
        ranks = np.argsort(order)[which].reshape(mesh.nodes.shape).astype(np.int32)
        nodes, place = _listed(owner, np.repeat(ranks, corners, axis=0).reshape(-1), count)
        at_groups = np.zeros((*nodes.shape, 3))
        rates = weight[:, None, None] * slots.gradients
        np.add.at(at_groups, (owner, place), rates.reshape(-1, 3))
        normals = np.zeros((count, 3))
        np.add.at(normals, group, weight[:, None] * slots.normals)
        # of the vertices of a facet: their nodes, each once
        by_facet = group.reshape(-1, corners)
        named = nodes[by_facet]
        there = named >= 0
        facet = np.broadcast_to(np.arange(len(named))[:, None, None], named.shape)
        around, place = _listed(facet[there], named[there], len(named))
        at_vertices = np.zeros((len(named), corners, around.shape[1], 3))
        vertex = np.broadcast_to(np.arange(corners)[None, :, None], named.shape)
        at_vertices[facet[there], vertex[there], place] = at_groups[by_facet][there]
        around = np.where(around >= 0, known[order][around], np.int32(-1))
        return cls(around, at_vertices, normals[by_facet])

    def tangents(
        self, facet: Locals, xi: Floats, own: Floats, bend: Floats
    ) -> tuple[Floats, Floats]:
        """How two tangents in the reference configuration move with the nodes around.

        The tangents d_a of the facet are brought into the plane of the averaged normal N,

            T_a = d_a - (d_a . N) N ,    t_a = sum_m x_m (B_m . T_a) ,

        so that both ends of an edge say the same of what the surface does along it.

        Args:
            facet: Facets, (n,).
            xi: Coordinates on them, (n, 2).
            own: Tangents of the facet there in the reference configuration, (n, 2, 3), length.
            bend: Their derivatives by the coordinates, (n, 2, 2, 3), length.

        Returns:
            B_m . T_a, (n, 2, j), and its derivatives by the coordinates, (n, 2, 2, j).
        """
        found: tuple[Floats, Floats] = _core.surface_tangents(
            self.at_vertices, self.normals, facet, xi, own, bend, default_threads()
        )
        return found


@dataclass(frozen=True)
class _Slots:
    """Facets at their vertices, one after the other: vertices of a facet follow one another.

    Attributes:
        gradients: Of the shape functions, (s, k, 3), 1/length.
        normals: Outward, (s, 3).
        angles: Of the facets, (s,).
    """

    gradients: Floats
    normals: Floats
    angles: Floats

    @classmethod
    def of(cls, mesh: FacetMesh, reference: Floats, vertices: Locals) -> _Slots:
        (m, k), corners = mesh.nodes.shape, vertices.shape[1]
        surface = FacetSurface(reference, mesh.nodes, mesh.topology, mesh.flip)
        facet = np.repeat(np.arange(m, dtype=np.int32), corners)
        slope = surface.shapes(facet, np.tile(VERTICES[corners], (m, 1)))[1][:, :k]
        tangents = np.einsum("ska,ski->sai", slope, reference[mesh.nodes[facet]])
        metric = tangents @ tangents.swapaxes(1, 2)
        gradients = slope @ np.linalg.solve(metric, tangents)
        cross = np.cross(tangents[:, 0], tangents[:, 1])
        size = np.linalg.norm(cross, axis=1)
        ends = _sides(reference[vertices], mesh.topology).reshape(-1, 2, 3)
        cosine = np.einsum("si,si->s", ends[:, 0], ends[:, 1])
        return cls(gradients, cross / size[:, None], np.arccos(np.clip(cosine, -1.0, 1.0)))


def _sides(x: Floats, topology: str) -> Floats:
    """Unit vectors from each vertex, at x, (m, c, 3), along both edges there, (m, c, 2, 3)."""
    once = facet_corners(topology)
    ring = x[:, once]
    ends = np.stack([np.roll(ring, -1, axis=1), np.roll(ring, 1, axis=1)], axis=2)
    out = np.zeros((*x.shape[:2], 2, 3))
    out[:, once] = ends - ring[:, :, None]
    return np.asarray(out / np.linalg.norm(out, axis=3, keepdims=True))


def _vertices(mesh: FacetMesh) -> Locals:
    """Nodes at `VERTICES`, (m, c): coordinates of facets that are flipped change places."""
    corners = 3 if mesh.topology.startswith("tri") else 4
    nodes = mesh.nodes[:, :corners]
    return np.where(mesh.flip[:, None], nodes[:, [0, 2, 1, 3][:corners]], nodes)


def _smooth(topology: str, normals: Floats, nodes: Locals) -> Ints:
    """Groups of facets at a vertex between which the surface is smooth, (s,)."""
    once = facet_corners(topology)
    first, second = once, once[1:] + once[:1]
    vertices = nodes.astype(np.int64)
    slot = vertices.shape[1] * np.arange(len(vertices))[:, None]
    edge = np.stack([vertices[:, first], vertices[:, second]], axis=2).reshape(-1, 2)
    place = np.stack([slot + first, slot + second], axis=2).reshape(-1, 2)
    back = edge[:, 0] > edge[:, 1]
    edge[back], place[back] = edge[back, ::-1], place[back, ::-1]
    order = np.lexsort((edge[:, 1], edge[:, 0]))
    edge, place = edge[order], place[order]
    same = np.flatnonzero((edge[1:] == edge[:-1]).all(axis=1))
    one, other = place[same].reshape(-1), place[same + 1].reshape(-1)
    fits = np.einsum("si,si->s", normals[one], normals[other]) > SHARP
    return connected(vertices.size, np.stack([one[fits], other[fits]], axis=1))


def _listed(owner: Ints, nodes: Locals, count: int) -> tuple[Locals, Ints]:
    """Nodes of each owner once, (count, j), -1 behind the last, and the place of each given one."""
    most = int(nodes.max(initial=0)) + 1
    keys, inverse = np.unique(owner.astype(np.int64) * most + nodes, return_inverse=True)
    own, node = np.divmod(keys, most)
    first = np.searchsorted(own, np.arange(count + 1))
    place = np.arange(len(own)) - first[own]
    out = np.full((count, max(int(np.diff(first).max(initial=0)), 1)), -1, dtype=np.int32)
    out[own, place] = node
    return out, np.asarray(place[inverse].reshape(-1), dtype=np.int64)
