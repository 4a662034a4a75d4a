"""Facet groups that every process has whole, for what is done once at the start."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from anisocontact.base.array_types import Flags, Ints
from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import basix, facet_sides, scalar_element
from anisocontact.contact.facet_mesh import FacetMesh, facet_mesh, node_positions
from anisocontact.contact.sweep import Sweep
from anisocontact.mesh import Model


@dataclass(frozen=True)
class WholeGroup:
    """A facet group with the cells behind it.

    Attributes:
        facets: Its facets; in the plane they are swept out of edges, with images of the nodes.
        cells: Nodes of the cell behind each facet, (m, k).
    """

    facets: FacetMesh
    cells: Ints


class WholeGroups:
    """Some facet groups over all processes, with nodes in one numbering of their own.

    Args:
        model: Mesh with the groups.
        names: The groups.

    Attributes:
        model: As given.
        nodes: Number in the whole mesh of each node of the cells behind the groups, ascending;
            on one process of every node.
        x: Where they are in the first configuration, (n, 3), length.
        groups: The groups by name.
        gradient: Derivatives of the functions of a cell at its middle, on the reference cell,
            (k, dimension).
        sweep: How facets are swept out of edges; None of facets in space.

    Raises:
        InputError: A mesh of two dimensions on several processes.
    """

    def __init__(self, model: Model, names: Iterable[str]) -> None:
        space, comm = model.space, model.mesh.comm
        self.model, self.sweep = model, Sweep.of(model)
        if self.sweep is not None and comm.size > 1:
            text = f"given on {comm.size} processes: in two dimensions ties need a single one"
            raise InputError(text, "tie")
        self._map = space.dofmap.index_map
        own = {name: self._own(name) for name in names}
        if comm.size == 1:
            self.x = node_positions(space)
            self.nodes = np.arange(len(self.x))
            self.groups = own
        else:
            self._gather(comm, own)
        element = scalar_element(space)
        middle = np.asarray(basix.geometry(element.cell_type)).mean(axis=0)
        self.gradient = np.asarray(element.tabulate(1, middle[None]))[1:, 0, :, 0].T

    def local(self) -> Ints:
        """Local number of each node, -1 of those that are not on this rank, (n,)."""
        return np.asarray(self._map.global_to_local(self.nodes), dtype=np.int64)

    def owned(self) -> Flags:
        """Whether each node is this rank's own, (n,)."""
        first, last = self._map.local_range
        return np.asarray((self.nodes >= first) & (self.nodes < last))

    def placed(self, nodes: Ints) -> Ints:
        """Places among `nodes` of numbers in the whole mesh; -1 of others."""
        at = np.minimum(np.searchsorted(self.nodes, nodes), max(len(self.nodes) - 1, 0))
        return np.where(self.nodes[at] == nodes, at, -1)

    def own_nodes(self, members: Ints) -> Ints:
        """Local numbers of those nodes this rank owns, of places among `nodes`."""
        own = members[self.owned()[members]]
        return np.asarray(self.nodes[own] - self._map.local_range[0])

    def everywhere[T: np.generic](self, own: npt.NDArray[T], nothing: float) -> npt.NDArray[T]:
        """Values of all nodes of the groups from those of the nodes of each rank; collective.

        Args:
            own: Values of the nodes this rank owns, (m, ...).
            nothing: Value of nodes that no rank owns.

        Returns:
            Values, (n, ...).
        """
        here, comm = self.owned(), self.model.mesh.comm
        values = np.full((len(self.nodes), *own.shape[1:]), nothing, dtype=own.dtype)
        values[here] = own[self.nodes[here] - self._map.local_range[0]]
        owner = np.asarray(comm.allgather(here)).argmax(axis=0)
        every = np.asarray(comm.allgather(values))
        return np.asarray(every[owner, np.arange(len(owner))])

    def _own(self, name: str) -> WholeGroup:
        space = self.model.space
        facets = np.sort(self.model.facets(name))
        cells = space.dofmap.list[facet_sides(space.mesh, facets)[0]]
        mesh = replace(facet_mesh(space, facets, self.sweep), sweep=None)
        return WholeGroup(mesh, cells.astype(np.int64))

    def _gather(self, comm: Any, own: dict[str, WholeGroup]) -> None:
        """Have all facets of the groups, with their nodes."""
        numbers = self._map.local_to_global(np.arange(self._map.size_local + self._map.num_ghosts))
        mine = {
            name: (numbers[one.facets.nodes], one.facets.flip, numbers[one.cells])
            for name, one in own.items()
        }
        used = np.unique(
            np.concatenate([np.zeros(0, int), *(g.cells.ravel() for g in own.values())])
        )
        x = self.model.positions
        everywhere = comm.allgather((mine, numbers[used], x[used]))
        found, first = np.unique(np.concatenate([one[1] for one in everywhere]), return_index=True)
        self.nodes = found.astype(np.int64)
        self.x = np.concatenate([one[2] for one in everywhere])[first]
        self.groups = {}
        for name, group in own.items():
            nodes, flip, cells = (
                np.concatenate([one[0][name][i] for one in everywhere]) for i in range(3)
            )
            named = np.searchsorted(self.nodes, nodes).astype(np.int32)
            mesh = FacetMesh(group.facets.topology, named, flip)
            self.groups[name] = WholeGroup(mesh, np.searchsorted(self.nodes, cells))
