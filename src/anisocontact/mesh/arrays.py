"""A mesh as plain arrays: what the built-in shapes and the readers hand over."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from anisocontact._fenicsx import cell_nodes, facet_nodes, middle_nodes
from anisocontact.errors import InputError

Nodes = npt.NDArray[np.int64]
Floats = npt.NDArray[np.float64]

# Vertices of the facets of a cell, in DOLFINx (tensor) order.
CELL_FACETS: dict[str, Nodes] = {
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
}


@dataclass(frozen=True)
class MeshArrays:
    """Nodes, cells and named groups.

    Attributes:
        cell: "tetrahedron" or "hexahedron".
        degree: Degree of the geometry, 1 or 2.
        points: Coordinates, (nodes, 3), length.
        cells: Node numbers in DOLFINx order, (cells, nodes of a cell).
        bodies: Body name -> cell numbers.
        facets: "body.group" -> node numbers, vertices first, (facets, nodes of a facet).
        order: Order of the displacement.
        linear: Bodies whose displacement is of order 1 in a mesh of order 2.
    """

    cell: str
    degree: int
    points: Floats
    cells: Nodes
    bodies: dict[str, Nodes]
    facets: dict[str, Nodes]
    order: int
    linear: tuple[str, ...] = ()

    @property
    def vertices_per_facet(self) -> int:
        """Corners of a facet: 3 or 4."""
        return int(CELL_FACETS[self.cell].shape[1])


def facet_owners(mesh_cell: str, cells: Nodes, facets: Nodes) -> tuple[Nodes, Nodes]:
    """Which cell each facet bounds.

    Args:
        mesh_cell: "tetrahedron" or "hexahedron".
        cells: Node numbers of the cells, vertices first, (cells, nodes).
        facets: Vertex numbers of the facets, (facets, 3 or 4).

    Returns:
        A cell of each facet (-1: none) and the number of cells that have it.
    """
    local = CELL_FACETS[mesh_cell]
    marked = np.zeros(max(cells.max(initial=0), facets.max(initial=0)) + 1, dtype=bool)
    marked[facets] = True
    # Only cells that touch marked vertices in a whole facet can own one.
    near = np.flatnonzero(marked[cells[:, : local.max() + 1]].sum(axis=1) >= local.shape[1])
    sides = np.sort(cells[near][:, local].reshape(-1, local.shape[1]), axis=1)
    rows = np.concatenate([np.sort(facets, axis=1), sides])
    _, inverse = np.unique(rows, axis=0, return_inverse=True)
    inverse = inverse.reshape(-1)
    asked, found = inverse[: len(facets)], inverse[len(facets) :]
    owner = np.full(int(inverse.max(initial=-1)) + 1, -1, dtype=np.int64)
    owner[found] = np.repeat(near, len(local))
    count = np.bincount(found, minlength=len(owner))
    return owner[asked], count[asked]


def check_boundary(name: str, counts: Nodes) -> None:
    """Refuse a group with facets that do not bound exactly one cell.

    Raises:
        InputError: Names the group and says how many facets are wrong.
    """
    loose, inner = int(np.sum(counts == 0)), int(np.sum(counts > 1))
    if loose:
        raise InputError(
            f"facet group {name!r}: {loose} of {len(counts)} facets belong to no cell of a body"
        )
    if inner:
        raise InputError(
            f"facet group {name!r}: {inner} of {len(counts)} facets lie inside the mesh; "
            "a group must lie on the boundary of a body (bodies in contact share no nodes)"
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
    facets = {}
    for name, nodes in mesh.facets.items():
        body, _, group = name.partition(".")
        facets[f"{names.get(body, body)}.{group}"] = nodes
    return replace(mesh, bodies=bodies, facets=facets)


def merge(parts: Sequence[MeshArrays]) -> MeshArrays:
    """One mesh of several parts that share no nodes.

    Where one part has curved cells, those of the others become cells of that degree with straight
    edges; where one has order 2, the bodies of the others are noted as `linear`.

    Raises:
        InputError: The parts differ in their cells, or two bodies have one name.
    """
    first = parts[0]
    for part in parts[1:]:
        if part.cell != first.cell:
            raise InputError(
                f"bodies {', '.join(first.bodies)} and {', '.join(part.bodies)}: "
                f"all bodies of a mesh need the same cell, not {first.cell} and {part.cell}",
                "mesh",
            )
    names = [name for part in parts for name in part.bodies]
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"two bodies have the name {name!r}", "mesh")
    degree, order = (max(getattr(p, which) for p in parts) for which in ("degree", "order"))
    linear = [name for part in parts if part.order < order for name in part.bodies]
    parts = [lift(part) if part.degree < degree else part for part in parts]
    node = np.cumsum([0] + [len(p.points) for p in parts])
    cell = np.cumsum([0] + [len(p.cells) for p in parts])
    return MeshArrays(
        cell=first.cell,
        degree=degree,
        points=np.concatenate([p.points for p in parts]),
        cells=np.concatenate([p.cells + n for p, n in zip(parts, node[:-1], strict=True)]),
        bodies={
            k: v + c for p, c in zip(parts, cell[:-1], strict=True) for k, v in p.bodies.items()
        },
        facets={
            k: v + n for p, n in zip(parts, node[:-1], strict=True) for k, v in p.facets.items()
        },
        order=order,
        linear=tuple(linear),
    )


def lift(mesh: MeshArrays) -> MeshArrays:
    """Cells of degree 1 as cells of degree 2 with straight edges: middle nodes are put in."""
    corners = mesh.cells
    cells = np.empty((len(corners), len(cell_nodes(mesh.cell, 2))), dtype=np.int64)
    cells[:, : corners.shape[1]] = corners
    points, count = [mesh.points], len(mesh.points)
    for ends, place in middle_nodes(mesh.cell):
        rows = np.sort(corners[:, ends].reshape(-1, ends.shape[1]), axis=1)
        unique, number = np.unique(rows, axis=0, return_inverse=True)
        cells[:, place] = count + number.reshape(len(corners), -1)
        points.append(mesh.points[unique].mean(axis=1))
        count += len(unique)
    if mesh.cell == "hexahedron":
        cells[:, -1] = count + np.arange(len(cells))
        points.append(mesh.points[corners].mean(axis=1))
    facets = {name: _with_middles(mesh, cells, nodes) for name, nodes in mesh.facets.items()}
    return replace(mesh, degree=2, points=np.concatenate(points), cells=cells, facets=facets)


def _with_middles(mesh: MeshArrays, lifted: Nodes, facets: Nodes) -> Nodes:
    """All nodes of facets of which the corners are given, (facets, nodes)."""
    owner, _ = facet_owners(mesh.cell, mesh.cells, facets)
    sides = np.sort(mesh.cells[owner][:, CELL_FACETS[mesh.cell]], axis=2)
    local = np.argmax(np.all(sides == np.sort(facets, axis=1)[:, None], axis=2), axis=1)
    return np.asarray(lifted[owner[:, None], facet_nodes(mesh.cell, 2)[local]])
