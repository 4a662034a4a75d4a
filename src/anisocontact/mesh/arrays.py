"""A mesh as plain arrays: what the built-in shapes and the readers hand over."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from anisocontact.base.array_types import Floats, Ints
from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import MPI
from anisocontact.mesh.split import Route, Split, share_of

#: What a group with facets inside a mesh is told.
ON_THE_BOUNDARY = "a group must lie on the boundary of a body (bodies in contact share no nodes)"

# Vertices of the facets of a cell, in DOLFINx (tensor) order.
CELL_FACETS: dict[str, Ints] = {
    "tetrahedron": np.array([[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]]),
    "hexahedron": np.array(
        [
            [0, 1, 2, 3],
            [0, 1, 4, 5],
            [0, 2, 4, 6],
            [1, 3, 5, 7],
            [2, 3, 6, 7],
            [4, 5, 6, 7],
        ]
    ),
    "triangle": np.array([[1, 2], [0, 2], [0, 1]]),
    "quadrilateral": np.array([[0, 1], [0, 2], [1, 3], [2, 3]]),
}


@dataclass(frozen=True)
class MeshArrays:
    """Nodes, cells and named groups.

    On several processes each has a share: a row of the nodes and one of the cells, those of the
    first process first, and some of the facets. Nodes are numbered over all processes.

    Attributes:
        cell: "tetrahedron" or "hexahedron", of a mesh in the plane "triangle" or "quadrilateral".
        degree: Degree of the geometry, 1 or 2.
        points: Coordinates, (nodes, 3), length.
        cells: Node numbers in DOLFINx order, (cells, nodes of a cell).
        bodies: Body name -> rows of `cells`.
        facets: "body.group" -> node numbers, vertices first, (facets, nodes of a facet).
        order: Order of the displacement.
        linear: Bodies whose displacement is of order 1 in a mesh of order 2.
        nodes: Points and edges: "body.group" -> places of their nodes, all on every process,
            (nodes, 3), length.
        notes: What a reader has made of the mesh of a file, a line each.
        torn: Bodies that end where the mesh of their file goes on, a line each.
        comm: Processes that share the mesh; properties and functions of it are collective.
    """

    cell: str
    degree: int
    points: Floats
    cells: Ints
    bodies: dict[str, Ints]
    facets: dict[str, Ints]
    order: int
    linear: tuple[str, ...] = ()
    nodes: dict[str, Floats] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    torn: tuple[str, ...] = ()
    comm: Any = field(default_factory=lambda: MPI.COMM_SELF)

    @property
    def vertices_per_facet(self) -> int:
        """Corners of a facet: 2, 3 or 4."""
        return int(CELL_FACETS[self.cell].shape[1])

    @cached_property
    def node_split(self) -> Split:
        """Which process has which nodes."""
        return Split(self.comm, len(self.points))

    @cached_property
    def cell_split(self) -> Split:
        """Which process has which cells."""
        return Split(self.comm, len(self.cells))

    @property
    def labels(self) -> Ints:
        """Number of the body of each cell of this process, (cells,)."""
        out = np.full(len(self.cells), -1, dtype=np.int64)
        for number, rows in enumerate(self.bodies.values()):
            out[rows] = number
        return out

    def with_points(self) -> MeshArrays:
        """The cells of this process with all of their nodes, as a mesh of one process."""
        if self.comm.size == 1:
            return self
        nodes, cells = np.unique(self.cells, return_inverse=True)
        points = self.node_split.fetch(self.points, nodes)
        cells = cells.reshape(self.cells.shape)
        return replace(self, points=points, cells=cells, facets={}, comm=MPI.COMM_SELF)

    def shared(self, comm: Any) -> MeshArrays:
        """Shares of a mesh that each process of `comm` has as a whole; itself if it is shared."""
        if self.comm.size == comm.size:
            return self
        nodes, cells = (slice(*share_of(comm, len(rows))) for rows in (self.points, self.cells))
        labels = self.labels[cells]
        facets = {
            name: rows[slice(*share_of(comm, len(rows)))] for name, rows in self.facets.items()
        }
        return replace(
            self,
            points=self.points[nodes],
            cells=self.cells[cells],
            bodies={name: np.flatnonzero(labels == i) for i, name in enumerate(self.bodies)},
            facets=facets,
            comm=comm,
        )

    def sum(self, count: int) -> int:
        """Sum of a number over the processes."""
        return int(self.comm.allreduce(count))


def facet_owners(mesh: MeshArrays, facets: Ints) -> tuple[Ints, Ints]:
    """Which cell each facet bounds.

    Args:
        mesh: The cells.
        facets: Vertex numbers of the facets, (facets, 2, 3 or 4).

    Returns:
        A cell of each facet, numbered over all processes (-1: none), and the number of cells that
        have it.
    """
    local = CELL_FACETS[mesh.cell]
    nodes = mesh.node_split
    # Only cells that touch marked vertices in a whole facet can own one.
    touched = nodes.fetch(nodes.marked(facets), mesh.cells[:, : local.max() + 1])
    near = np.flatnonzero(touched.sum(axis=1) >= local.shape[1])
    sides = np.sort(mesh.cells[near][:, local].reshape(-1, local.shape[1]), axis=1)
    wanted = np.sort(facets, axis=1)
    # A facet is looked up on the process that has its first vertex.
    question, known = (Route(mesh.comm, nodes.owner(rows[:, 0])) for rows in (wanted, sides))
    cell = known.there(np.repeat(mesh.cell_split.first + near, len(local)))
    rows = np.concatenate([question.there(wanted), known.there(sides)])
    _, inverse = np.unique(rows, axis=0, return_inverse=True)
    inverse = inverse.reshape(-1)
    asked, found = inverse[: len(rows) - len(cell)], inverse[len(rows) - len(cell) :]
    owner = np.full(int(inverse.max(initial=-1)) + 1, -1, dtype=np.int64)
    owner[found] = cell
    count = np.bincount(found, minlength=len(owner))
    return question.back(owner[asked]), question.back(count[asked])


def check_boundary(mesh: MeshArrays, name: str, counts: Ints) -> None:
    """Refuse a group with facets that do not bound exactly one cell.

    Raises:
        InputError: Names the group and says how many facets are wrong.
    """
    loose, inner = mesh.sum(int(np.sum(counts == 0))), mesh.sum(int(np.sum(counts > 1)))
    total = mesh.sum(len(counts))
    if loose:
        raise InputError(
            f"facet group {name!r}: {loose} of {total} facets belong to no cell of a body"
        )
    if inner:
        raise InputError(
            f"facet group {name!r}: {inner} of {total} facets lie inside the mesh; "
            f"{ON_THE_BOUNDARY}"
        )


def check_has_cells(name: str, lost: int, total: int, bodies: Collection[str]) -> None:
    """Refuse a group of facets of which some have nodes that no cell of the file has.

    All of its facets may: those of a surface that bounds no body, if the name does not say which.

    Args:
        name: Name of the group in the file.
        lost: How many of its facets have such nodes.
        total: How many facets it has.
        bodies: Names of the bodies that are taken.

    Raises:
        InputError: Names the group and says how many facets these are.

    Example:
        >>> check_has_cells("skin of a tool", 4, 4, ["block"])
    """
    if lost and (lost < total or name.partition(".")[0] in bodies):
        raise InputError(
            f"facet group {name!r}: {lost} of {total} facets have nodes that no cell has; merge "
            "nodes that lie on each other"
        )


def rename_bodies(mesh: MeshArrays, names: Mapping[str, str]) -> MeshArrays:
    """The mesh with other names of bodies; their facet groups follow.

    Args:
        mesh: The mesh.
        names: Name of a body -> its new name.

    Raises:
        InputError: No such body, a name with a dot, or two bodies of one name.
    """
    for old, new in names.items():
        if old not in mesh.bodies:
            raise InputError(f"no body {old!r}; there are: {', '.join(mesh.bodies)}", "rename")
        if not new or "." in new:
            raise InputError(f"{new!r} given, a name without a dot needed", "rename")
    bodies = {names.get(name, name): cells for name, cells in mesh.bodies.items()}
    if len(bodies) < len(mesh.bodies):
        given = ", ".join(names.get(name, name) for name in mesh.bodies)
        raise InputError(f"two bodies of one name: {given}", "rename")

    def renamed(name: str) -> str:
        body, _, group = name.partition(".")
        return f"{names.get(body, body)}.{group}"

    facets = {renamed(name): found for name, found in mesh.facets.items()}
    nodes = {renamed(name): places for name, places in mesh.nodes.items()}
    return replace(mesh, bodies=bodies, facets=facets, nodes=nodes)


def face_mesh(mesh: MeshArrays, group: str, cell: str) -> MeshArrays:
    """Facets of one group as a mesh of two dimensions; where others meet them are its facets.

    Args:
        mesh: The cells of one body, all on this process.
        group: Facet group "body.group".
        cell: Cell that the facets are.
    """
    cells = mesh.facets[group]
    used, local = np.unique(cells, return_inverse=True)
    number = np.full(len(mesh.points), -1, dtype=np.int64)
    number[used] = np.arange(len(used))
    facets = {}
    for name, nodes in mesh.facets.items():
        rows = number[nodes]
        # those that share an edge, and of these the nodes on it, corners first
        edge = (rows >= 0).sum(axis=1) == mesh.degree + 1
        if name != group and edge.any():
            rows = rows[edge]
            facets[name] = rows[rows >= 0].reshape(-1, mesh.degree + 1)
    return replace(
        mesh,
        cell=cell,
        points=mesh.points[used],
        cells=local.reshape(cells.shape),
        bodies={name: np.arange(len(cells)) for name in mesh.bodies},
        facets=facets,
    )
