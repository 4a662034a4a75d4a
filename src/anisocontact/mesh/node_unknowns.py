"""Where the displacement of nodes is among the unknowns of a system."""

from __future__ import annotations

from functools import cached_property
from typing import Any, override

import numpy as np

from anisocontact.base.array_types import Floats, Ints
from anisocontact.base.fenicsx import Mat, PETSc, la


class NodeUnknowns:
    """Unknowns that are the displacements of nodes, three components one after another.

    Contacts know nodes and their displacements, (nodes, 3); the equations know unknowns. Whoever
    goes from the one to the other asks here.

    Args:
        space: Vector Lagrange space with three components.

    Attributes:
        nodes: Vector space of the nodes, as given.
        comm: Communicator of the mesh.
        owned: Number of unknowns this rank owns.
        node_count: Number of local nodes, with ghosts.
        block: Size of the blocks that unknowns form.
    """

    block = 3

    def __init__(self, space: Any) -> None:
        self.nodes, self.comm = space, space.mesh.comm
        self._index_map, self._size = space.dofmap.index_map, space.dofmap.index_map_bs
        self.owned = int(self._size * self._index_map.size_local)
        self.node_count = int(self._index_map.size_local + self._index_map.num_ghosts)

    @cached_property
    def extent(self) -> float:
        """Longest edge of the box around the nodes of this rank at rest, length."""
        x = self.nodes.mesh.geometry.x
        return float(np.ptp(x, axis=0).max()) if len(x) else 0.0

    def among(self, space: Any) -> bool:
        """Whether they are unknowns of a space."""
        return bool(self.nodes == space)

    def same(self, other: NodeUnknowns) -> bool:
        """Whether others are the same for the same nodes."""
        return bool(self.nodes == other.nodes)

    def nodal(self, values: Floats) -> Floats:
        """Displacement of the local nodes of values of all local unknowns, (nodes, 3)."""
        return values.reshape(-1, 3)

    def own_nodal(self, values: Floats, missing: float = 0.0) -> Floats:
        """The same of the unknowns this rank owns, for its own nodes, (nodes, 3).

        Args:
            values: Of the unknowns this rank owns.
            missing: Value of components that are no unknowns.
        """
        return values.reshape(-1, 3)

    def local(self, nodal: Floats) -> Floats:
        """Values of all local unknowns that have those of the local nodes, others zero."""
        return nodal.reshape(-1)

    def own(self, nodal: Floats) -> Floats:
        """The same of the unknowns this rank owns."""
        return self.local(nodal)[: self.owned]

    def ghosted(self) -> Any:
        """Vector of all local unknowns; it owns the memory of its PETSc vector."""
        return la.vector(self._index_map, self._size)

    def add_blocks(self, matrix: Mat, rows: Ints, columns: Ints, values: Floats) -> None:
        """Add blocks between nodes to a matrix.

        Args:
            matrix: The matrix.
            rows: Nodes by their numbers in the whole mesh, (p, r).
            columns: Likewise, (p, c).
            values: (p, 3 r, 3 c), or single blocks (p, 3, 3).
        """
        sides = (side.astype(PETSc.IntType) for side in (rows, columns))
        matrix.setValuesBlockedRCV(*sides, values, PETSc.InsertMode.ADD_VALUES)

    def blocks(self, rows: Ints, columns: Ints) -> tuple[Ints, Ints]:
        """Rows and columns, in blocks of unknowns, of what couples pairs of nodes, (blocks,).

        Args:
            rows: Nodes by their numbers in the whole mesh, (p,); those beyond it continue them.
            columns: Likewise.
        """
        return rows, columns


class PlacedUnknowns(NodeUnknowns):
    """Displacements among the unknowns of another space: a sub-space of a mixed one, or a plane.

    A component that the space does not have, as the one across a plane, is zero.

    Args:
        nodes: Vector Lagrange space with three components on the same mesh.
        displacement: The displacement, a sub-space or a space with as many components as the mesh
            has dimensions.
    """

    block = 1

    def __init__(self, nodes: Any, displacement: Any) -> None:
        self.nodes, self.comm = nodes, nodes.mesh.comm
        self._displacement, dofmap = displacement, displacement.dofmap
        self._index_map, self._size = dofmap.index_map, dofmap.index_map_bs
        self.owned = int(self._size * self._index_map.size_local)
        own = nodes.dofmap.index_map
        numbers = np.full((own.size_local + own.num_ghosts, 3), -1, dtype=np.int64)
        for i in range(displacement.num_sub_spaces):
            numbers[nodes.dofmap.list, i] = displacement.sub(i).dofmap.list
        self._there = numbers >= 0
        self._numbers = numbers[self._there]
        self._own, self.node_count = own.size_local, len(numbers)

    @override
    def among(self, space: Any) -> bool:
        return bool(space.contains(self._displacement))

    @override
    def same(self, other: NodeUnknowns) -> bool:
        components = np.arange(1.0, 1.0 + 3 * self.node_count).reshape(-1, 3)
        here, there = self.local(components), other.local(components)
        return here.shape == there.shape and bool((here == there).all())

    @override
    def nodal(self, values: Floats) -> Floats:
        out = np.zeros(self._there.shape)
        out[self._there] = values[self._numbers]
        return out

    @override
    def own_nodal(self, values: Floats, missing: float = 0.0) -> Floats:
        there = self._there[: self._own]
        out = np.full(there.shape, missing)
        out[there] = values[self._numbers[: np.count_nonzero(there)]]
        return out

    @override
    def local(self, nodal: Floats) -> Floats:
        out = np.zeros(self._size * (self._index_map.size_local + self._index_map.num_ghosts))
        out[self._numbers] = nodal[self._there]
        return out

    @override
    def own(self, nodal: Floats) -> Floats:
        out = np.zeros(self.owned)
        there = self._there[: self._own]
        out[self._numbers[: np.count_nonzero(there)]] = nodal[: self._own][there]
        return out

    @override
    def add_blocks(self, matrix: Mat, rows: Ints, columns: Ints, values: Floats) -> None:
        places = self._everywhere.astype(PETSc.IntType)
        sides = (places[s].reshape(len(s), 3 * s.shape[1]) for s in (rows, columns))
        matrix.setValuesRCV(*sides, values, PETSc.InsertMode.ADD_VALUES)

    @override
    def blocks(self, rows: Ints, columns: Ints) -> tuple[Ints, Ints]:
        shape = (len(rows), 3, 3)
        r = np.broadcast_to(self._everywhere[rows][:, :, None], shape)
        c = np.broadcast_to(self._everywhere[columns][:, None, :], shape)
        there = (r >= 0) & (c >= 0)
        return r[there], c[there]

    @cached_property
    def _everywhere(self) -> Ints:
        """Unknowns of all nodes of the mesh by their numbers in the whole system, -1 for none."""
        own = np.full((self._own, 3), -1, dtype=np.int64)
        there = self._there[: self._own]
        first = self._size * self._index_map.local_range[0]
        own[there] = first + self._numbers[: np.count_nonzero(there)]
        return np.concatenate(self.comm.allgather(own))
