"""Facets of a master near the slave points of a process, wherever their nodes live."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from anisocontact.base.array_types import Floats, Ints, Locals
from anisocontact.base.fenicsx import facet_keys
from anisocontact.contact.beyond_cuts import BeyondCuts
from anisocontact.contact.facet_mesh import FacetMesh, facet_mesh, node_positions
from anisocontact.contact.images import Images
from anisocontact.contact.quadrature import Couplings
from anisocontact.contact.remote_nodes import (
    NONE,
    RemoteNodes,
    globally,
    node_count,
    owned_among,
)
from anisocontact.contact.sweep import Sweep
from anisocontact.mesh.connected_components import component_of_nodes
from anisocontact.mesh.split import Route, Split, arranged


class MasterSurface:
    """Facets of a group, in an order that does not depend on how the mesh is distributed.

    On one process these are all of them, with the nodes of the mesh, and nothing is copied. On
    several each has those that it has gathered: their nodes are numbered after its local nodes, and
    a node that it has itself has two numbers there. Facets are then numbered twice as well: among
    those of the process, in the same order, and in the whole group.

    Args:
        space: Vector Lagrange space of the displacement.
        facets: Local facets on the boundary.
        sweep: Of a mesh in the plane, on one process: "nodes" are then images of its nodes.
        beside: Nodes of the whole mesh that each process has beside, before those it gathers.
        beyond: What goes on beyond cut faces, on one process: images as well.

    Attributes:
        own: Facets of the group on this process, with its local nodes.
        facets: Facets that it has of the group; their nodes are numbered as in `reference`.
        numbers: Number of each in the whole group, ascending.
        reference: Positions in the reference configuration of the local nodes, then of those
            gathered, (nodes, 3), length.
        comm: Communicator of the mesh.
        distributed: Whether there are several processes.
    """

    def __init__(
        self,
        space: Any,
        facets: Locals,
        sweep: Sweep | None = None,
        beside: Ints = NONE,
        beyond: BeyondCuts | None = None,
    ) -> None:
        self._space, self._beside = space, beside
        self.own = own = facet_mesh(space, facets, sweep)
        self.comm = comm = space.mesh.comm
        self.distributed = bool(comm.size > 1)
        self._images: Images | None = sweep if beyond is None else beyond.images
        x = node_positions(space)
        #: Positions of the local nodes in the reference configuration, of all images of them.
        self.start = self.reference = x if self._images is None else self._images.positions(x)
        keys = facet_keys(space.mesh, np.sort(facets))
        self._ranks = _Ranks(comm, keys)
        self._own_numbers = self._ranks.find(keys)
        if self.distributed:
            # All facets, an even share of them on every process, for those who ask.
            index_map = space.dofmap.index_map
            nodes = index_map.local_to_global(own.nodes.reshape(-1)).reshape(own.nodes.shape)
            total = comm.allreduce(len(nodes))
            self._table = arranged(comm, total, self._own_numbers, nodes, own.flip)
            self._rows = Split(comm, len(self._table[0]))
            self.gather(NONE)
        else:
            order = np.argsort(keys)
            nodes = np.ascontiguousarray(own.nodes[order])
            all_of_it = FacetMesh(own.topology, nodes, own.flip[order], sweep)
            self.facets = all_of_it if beyond is None else beyond.whole(all_of_it)
            self.numbers, self._far = np.arange(len(self.facets.nodes)), RemoteNodes(space, NONE)

    def connected_to(self, other: FacetMesh) -> bool:
        """Whether a connected part of the mesh has these facets and others; collective.

        Args:
            other: Facets that this rank owns, with its local nodes.
        """
        label = component_of_nodes(self._space)
        # images of nodes have the numbers after them, row by row, see `Sweep`
        pieces = [set(label[mesh.nodes % len(label)].flat) for mesh in (self.own, other)]
        everywhere = self._space.mesh.comm.allgather(pieces)
        first, second = (set().union(*found) for found in zip(*everywhere, strict=True))
        return not first.isdisjoint(second)

    def gather(self, numbers: Ints) -> None:
        """Have these facets instead of those before; collective.

        Args:
            numbers: Numbers in the whole group, ascending, (n,).
        """
        nodes, flip = (self._rows.fetch(values, numbers) for values in self._table)
        found, node = np.unique(nodes, return_inverse=True)
        self._far = RemoteNodes(self._space, np.concatenate([self._beside, found]))
        self.numbers = numbers
        first = len(self.start) + len(self._beside)
        named = (first + node.reshape(nodes.shape)).astype(np.int32)
        self.facets = FacetMesh(self.own.topology, named, flip)
        self.reference = self.everywhere(self.start)

    def within(self, low: Floats, high: Floats, now: Floats) -> Ints:
        """Facets that may reach into a box; collective.

        Args:
            low: Lowest corner of the box of this process, (3,), length; infinite for none.
            high: Its highest corner.
            now: Positions of the local nodes, (nodes, 3), length.

        Returns:
            Their numbers in the whole group, ascending.
        """
        x = now[self.own.nodes]
        ends = x.min(axis=1), x.max(axis=1)
        # The interior of a curved facet goes beyond its nodes, by less than its size.
        more = ends[1] - ends[0] if self.own.nodes.shape[1] > 4 else 0.0
        ends = ends[0] - more, ends[1] + more
        to, found = [NONE], [NONE]
        for rank, (first, last) in enumerate(self.comm.allgather((low, high))):
            inside = np.all((ends[0] <= last) & (ends[1] >= first), axis=1)
            found.append(self._own_numbers[inside])
            to.append(np.full(len(found[-1]), rank))
        return np.unique(Route(self.comm, np.concatenate(to)).there(np.concatenate(found)))

    def number(self, facets: Ints) -> Locals:
        """Numbers among those of this process of facets that it has, -1 for others; collective.

        Args:
            facets: Facets of `facet_keys`, (n,).
        """
        return self.renumbered(self.in_group(facets))

    def in_group(self, facets: Ints) -> Ints:
        """Numbers in the whole group of facets of `facet_keys`, -1 for others; collective."""
        return self._ranks.find(facets)

    def owned(self, nodes: Locals) -> Locals:
        """Nodes of the mesh that this process owns, among those any process names; collective.

        Args:
            nodes: Some of its local nodes, or images of them.
        """
        return owned_among(self._space, nodes[nodes < node_count(self._space)])

    def renumbered(self, numbers: npt.NDArray[Any]) -> Locals:
        """Numbers among those of this process of facets that it has; -1 for others.

        Args:
            numbers: In the whole group, -1 for none, (n,).
        """
        if not len(self.numbers):
            return np.full(len(numbers), -1, dtype=np.int32)
        place = np.minimum(np.searchsorted(self.numbers, numbers), len(self.numbers) - 1)
        return np.where(self.numbers[place] == numbers, place, -1).astype(np.int32)

    def globally(self, facets: npt.NDArray[Any]) -> Locals:
        """Numbers in the whole group of facets of this process, -1 for none, (n,)."""
        return np.asarray(np.append(self.numbers, -1)[facets], dtype=np.int32)

    def names(self, nodes: Locals) -> Locals:
        """Nodes of facets of this process by the first of these and their place on it.

        Images go by the node of the mesh and their row: facets of order 1 in the plane have none
        of the nodes themselves.

        Args:
            nodes: Numbered as `reference`, -1 for none.

        Returns:
            Numbers that do not depend on how the mesh is distributed, -1 for none.
        """
        there = nodes >= 0
        row, of_mesh = self._row_and_node(nodes[there])
        known, first = np.unique(self._row_and_node(self.facets.nodes)[1], return_index=True)
        facet, place = np.divmod(first[np.searchsorted(known, of_mesh)], self._width)
        names = np.full_like(nodes, -1)
        names[there] = self._of_node * (self._width * self.numbers[facet] + place) + row
        return names

    def of_names(self, names: Locals) -> Locals:
        """Nodes of `names`, whose facets this process has."""
        there = names >= 0
        nodes = np.full_like(names, -1)
        place, row = np.divmod(names[there], self._of_node)
        facet = self.renumbered(self.facets_of_names(names[there]))
        _, of_mesh = self._row_and_node(self.facets.nodes[facet, place % self._width])
        nodes[there] = row * node_count(self._space) + of_mesh
        return nodes

    def facets_of_names(self, names: Locals) -> Locals:
        """Numbers in the whole group of the facets of `names`, -1 for none."""
        return names // (self._width * self._of_node)

    def _row_and_node(self, nodes: Locals) -> tuple[Locals, Locals]:
        """Row of images that nodes are in, and the nodes of the mesh that they are images of."""
        of_mesh = self.local_names(nodes)
        return (nodes - of_mesh) // node_count(self._space), of_mesh

    @property
    def _of_node(self) -> int:
        """How many images a node of the mesh has, itself among them."""
        return 1 if self._images is None else self._images.rows

    @property
    def _width(self) -> int:
        return int(self.own.nodes.shape[1])

    def everywhere[T: np.generic](self, nodal: npt.NDArray[T]) -> npt.NDArray[T]:
        """Values of the local nodes, then of those that were gathered, see `RemoteNodes`."""
        return self._far.everywhere(nodal)

    def local(self, nodal: Floats) -> Floats:
        """Of what `everywhere` gave, that of the local nodes."""
        return nodal[: len(self.start)]

    def zeros(self, out: Floats) -> Floats:
        """Where to add forces, numbered as `reference`; on one process `out` itself."""
        own = self.distributed or self._images is not None
        return np.zeros(self.reference.shape) if own else out

    def hand_back(self, forces: Floats, out: Floats) -> None:
        """Add forces that all processes have for nodes they gathered where these nodes live.

        Args:
            forces: What `zeros` gave, with forces of this process, (nodes, 3).
            out: Forces of the local nodes, whose sum over the processes counts, (local nodes, 3).
        """
        if self._images is not None:
            self._images.fold(forces, out)
        self._far.hand_back(forces, out)

    def coupled(self, nodes: Locals) -> Locals:
        """Nodes as `Couplings` name them: gathered ones by their number in the whole mesh.

        Args:
            nodes: Numbered as `reference`, -1 for none.

        Returns:
            The same for local nodes, the number of local nodes plus the global number for others.
        """
        if self._images is not None:
            return self._images.named(nodes)
        return self._far.coupled(nodes)

    def in_mesh(self, nodes: Locals) -> Ints:
        """Numbers in the whole mesh of nodes numbered as `reference`, -1 for none."""
        there = nodes >= 0
        numbers = np.full(nodes.shape, -1, dtype=np.int64)
        numbers[there] = globally(self.coupled(nodes[there]), self._space)
        return numbers

    def moved(self, u: Floats) -> Floats:
        """Displacements of the nodes as they are numbered here, from those of the mesh."""
        return u if self._images is None else self._images.moved(u)

    def local_names(self, nodes: Locals) -> Locals:
        """Nodes of which some are images as those of the mesh."""
        return nodes if self._images is None else self._images.named(nodes)

    def couplings(self, found: Couplings) -> Couplings:
        """Blocks with the names of `coupled`."""
        if self._images is not None:
            return self._images.folded(found)
        rows, columns, blocks = found
        return self.coupled(rows), self.coupled(columns), blocks


class _Ranks:
    """Places of keys in the order of those of all processes; collective, as is `find`.

    Args:
        comm: Communicator.
        keys: Keys of this process, each on one of them.
    """

    def __init__(self, comm: Any, keys: Ints) -> None:
        self._comm, self._end = comm, max(comm.allgather(int(keys.max(initial=-1)))) + 1
        self._there = np.sort(self._route(keys).there(keys))
        self._first = Split(comm, len(self._there)).first

    def find(self, keys: Ints) -> Ints:
        """Place of each of some keys, -1 for one that is not there, (n,)."""
        route = self._route(keys)
        asked = route.there(keys)
        place = np.searchsorted(self._there, asked)
        known = np.append(self._there, -1)[place] == asked
        return route.back(np.where(known, self._first + place, -1))

    def _route(self, keys: Ints) -> Route:
        size = self._comm.size
        return Route(self._comm, np.minimum(keys * size // max(self._end, 1), size - 1))
