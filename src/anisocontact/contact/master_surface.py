"""Facets of a master on every rank, wherever their nodes live."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from anisocontact._fenicsx import facet_keys
from anisocontact.contact.facet_mesh import FacetMesh, facet_mesh, node_positions

Ints = npt.NDArray[np.int32]
Keys = npt.NDArray[np.int64]
Floats = npt.NDArray[np.float64]


class MasterSurface:
    """All facets of a group, in an order that does not depend on how the mesh is distributed.

    On one process its nodes are those of the mesh and nothing is copied. On several the surface is
    gathered: every rank knows all facets and the positions of their nodes, which are numbered after
    its local nodes. A node of the surface that a rank has itself has two numbers there.

    Args:
        space: Vector Lagrange space of the displacement.
        facets: Local facets on the boundary.

    Attributes:
        facets: All facets of the group; their nodes are numbered as in `reference`.
        reference: Positions in the reference configuration of the local nodes, then of those
            gathered, (nodes, 3), length.
    """

    def __init__(self, space: Any, facets: Ints) -> None:
        own = facet_mesh(space, facets)
        self._comm = space.mesh.comm
        keys = facet_keys(space.mesh, np.sort(facets))
        self._keys = np.concatenate(self._comm.allgather(keys))
        order = np.argsort(self._keys)
        self._keys = self._keys[order]
        self.reference = node_positions(space)
        self._local = len(self.reference)
        self._distributed = self._comm.size > 1
        flip = np.concatenate(self._comm.allgather(own.flip))[order]
        nodes = self._gather(space, own, order) if self._distributed else own.nodes[order]
        self.facets = FacetMesh(own.topology, np.ascontiguousarray(nodes), flip)
        if self._distributed:
            self.reference = self.everywhere(self.reference)

    def _gather(self, space: Any, own: FacetMesh, order: Keys) -> Ints:
        """Number the nodes of the surface by the facets they come with; who sends which of them."""
        comm, index_map = self._comm, space.dofmap.index_map
        mine = np.unique(own.nodes)
        globally = index_map.local_to_global
        each = comm.allgather(globally(own.nodes.reshape(-1)).reshape(own.nodes.shape))
        by_facet = np.concatenate(each)[order]
        numbers, first, node = np.unique(by_facet, return_index=True, return_inverse=True)
        rank = np.argsort(first)
        place = np.empty(len(rank), dtype=np.int64)
        place[rank] = np.arange(len(rank))
        #: Global number of each node of the surface.
        self._numbers = numbers[rank]
        had = place[np.searchsorted(numbers, globally(mine))]
        sender = np.full(len(numbers), comm.size, dtype=np.int64)
        for other, places in enumerate(comm.allgather(had)):
            np.minimum.at(sender, places, other)
        sent = sender[had] == comm.rank
        #: Local nodes that this rank sends, and their places in the surface.
        self._sent, self._places = mine[sent], had[sent]
        self._counts = np.bincount(sender, minlength=comm.size)
        self._received = np.concatenate(comm.allgather(self._places))
        return (self._local + place[node]).reshape(by_facet.shape).astype(np.int32)

    def number(self, facets: Keys) -> Ints:
        """Numbers on this surface of facets that are part of it.

        Args:
            facets: Facets of `facet_keys`, (n,).

        Returns:
            Numbers, (n,).
        """
        return np.searchsorted(self._keys, facets).astype(np.int32)

    def everywhere(self, nodal: Floats) -> Floats:
        """Vectors of the local nodes, then those of the surface's nodes of all ranks.

        Args:
            nodal: Of the local nodes, ghosts up to date, (local nodes, 3).

        Returns:
            Numbered as `reference`, (nodes, 3); on one process the same array.
        """
        if not self._distributed:
            return nodal
        out = np.empty((self._local + len(self._numbers), 3))
        out[: self._local] = nodal
        got = np.empty((len(self._numbers), 3))
        counts = (3 * self._counts).tolist()
        self._comm.Allgatherv(np.ascontiguousarray(nodal[self._sent]), [got, counts])
        out[self._local + self._received] = got
        return out

    def zeros(self, out: Floats) -> Floats:
        """Where to add forces, numbered as `reference`; on one process `out` itself."""
        return np.zeros(self.reference.shape) if self._distributed else out

    def hand_back(self, forces: Floats, out: Floats) -> None:
        """Add forces that all ranks have for the nodes of the surface where these nodes live.

        Args:
            forces: What `zeros` gave, with forces of this rank, (nodes, 3).
            out: Forces of the local nodes, whose sum over the ranks counts, (local nodes, 3).
        """
        if not self._distributed:
            return
        out += forces[: self._local]
        total = np.empty((len(self._numbers), 3))
        self._comm.Allreduce(np.ascontiguousarray(forces[self._local :]), total)
        out[self._sent] += total[self._places]

    def coupled(self, nodes: Ints) -> Ints:
        """Nodes as `Couplings` name them: gathered ones by their number in the whole mesh.

        Args:
            nodes: Numbered as `reference`, -1 for none.

        Returns:
            The same for local nodes, the number of local nodes plus the global number for others.
        """
        if not self._distributed:
            return nodes
        far = nodes >= self._local
        named = nodes.copy()
        named[far] = self._local + self._numbers[nodes[far] - self._local]
        return named
