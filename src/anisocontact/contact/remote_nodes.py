"""Nodes of other processes that this one needs beside its own."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from anisocontact.base.array_types import Flags, Floats, Ints, Locals
from anisocontact.mesh.split import Route, Split

NONE: Ints = np.zeros(0, dtype=np.int64)


class RemoteNodes:
    """Nodes of the whole mesh, numbered after the local ones; collective, as are its exchanges.

    Args:
        space: Vector Lagrange space of the displacement.
        numbers: Their numbers in the whole mesh, (n,); none on one process.

    Attributes:
        numbers: As given.
        owned: How many of the local nodes, which come first, this process owns.
    """

    def __init__(self, space: Any, numbers: Ints) -> None:
        index_map = space.dofmap.index_map
        self._comm, self.owned = space.mesh.comm, int(index_map.size_local)
        self._local = node_count(space)
        self.numbers = numbers
        owners = Split(self._comm, index_map.size_local)
        self._route = Route(self._comm, owners.owner(numbers))
        #: Local nodes that other processes have asked for.
        self._requested = self._route.there(numbers) - owners.first

    def everywhere[T: np.generic](self, nodal: npt.NDArray[T]) -> npt.NDArray[T]:
        """Values of the local nodes, then of these, (nodes, ...); on one process the same array."""
        if self._comm.size == 1:
            return nodal
        return np.concatenate([nodal, self._route.back(nodal[self._requested])])

    def hand_back(self, forces: Floats, out: Floats) -> None:
        """Add forces that all processes have for these nodes where these live.

        Args:
            forces: Of this process, numbered as of `everywhere`, (nodes, 3).
            out: Forces of the local nodes, whose sum over the processes counts, (local nodes, 3).
        """
        if self._comm.size == 1:
            return
        out += forces[: self._local]
        np.add.at(out, self._requested, self._route.there(forces[self._local :]))

    def coupled(self, nodes: Locals) -> Locals:
        """Nodes as `Couplings` name them: these by their number in the whole mesh.

        Args:
            nodes: Numbered as of `everywhere`, -1 for none.

        Returns:
            The same for local nodes, the number of local nodes plus the global number for others.
        """
        far = nodes >= self._local
        named = nodes.copy()
        named[far] = self._local + self.numbers[nodes[far] - self._local]
        return named


def node_count(space: Any) -> int:
    """Number of local nodes of a space: those that a process owns, and ghosts."""
    index_map = space.dofmap.index_map
    return int(index_map.size_local + index_map.num_ghosts)


def globally(nodes: npt.NDArray[Any], space: Any) -> Ints:
    """Numbers in the whole mesh of nodes that `RemoteNodes.coupled` has named.

    Args:
        nodes: The names, of any shape.
        space: Vector Lagrange space of the displacement.
    """
    found = nodes.astype(np.int64) - node_count(space)
    near = found < 0
    found[near] = space.dofmap.index_map.local_to_global(nodes[near].astype(np.int32))
    return found


def owned_among(space: Any, nodes: Locals) -> Locals:
    """Nodes of this process, among those that any process names; collective.

    Args:
        space: Vector Lagrange space of the displacement.
        nodes: Local nodes.

    Returns:
        Their local numbers, ascending.
    """
    index_map = space.dofmap.index_map
    named = index_map.local_to_global(np.unique(nodes).astype(np.int32))
    marked = Split(space.mesh.comm, index_map.size_local).marked(named)
    return np.flatnonzero(marked).astype(np.int32)


def marked_nodes(space: Any, named: Locals) -> Flags:
    """Local nodes among those that any process names; collective.

    Args:
        space: Vector Lagrange space of the displacement.
        named: Names of `RemoteNodes.coupled`, of any shape.

    Returns:
        Flags of the local nodes with ghosts, (local nodes,).
    """
    index_map = space.dofmap.index_map
    owners = Split(space.mesh.comm, index_map.size_local)
    own = owners.marked(globally(np.unique(named), space))
    return with_ghosts(space, own)


def all_marked(space: Any, flags: Flags, named: Locals) -> bool:
    """Whether all nodes that any process names are marked; collective.

    Args:
        space: Vector Lagrange space of the displacement.
        flags: Of the local nodes, (local nodes,).
        named: Names of `RemoteNodes.coupled`, (n,).
    """
    comm, owned = space.mesh.comm, space.dofmap.index_map.size_local
    found = Split(comm, owned).fetch(flags[:owned], globally(named, space))
    return all(comm.allgather(bool(found.all())))


def with_ghosts[T: np.generic](space: Any, nodal: npt.NDArray[T]) -> npt.NDArray[T]:
    """Values of local nodes with those of ghosts as their owners have them; collective.

    Args:
        space: Vector Lagrange space of the displacement.
        nodal: Of the local nodes, (local nodes, ...).
    """
    index_map = space.dofmap.index_map
    own = nodal[: index_map.size_local]
    owners = Split(space.mesh.comm, index_map.size_local)
    if space.mesh.comm.size == 1:
        return nodal
    return np.concatenate([own, owners.fetch(own, index_map.ghosts)])
