"""A mesh as plain arrays: what the built-in shapes and the readers hand over."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

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
    """

    cell: str
    degree: int
    points: Floats
    cells: Nodes
    bodies: dict[str, Nodes]
    facets: dict[str, Nodes]
    order: int

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


def merge(parts: list[MeshArrays]) -> MeshArrays:
    """One mesh of several parts that share no nodes.

    Raises:
        InputError: The parts differ in cell or order.
    """
    first = parts[0]
    for part in parts[1:]:
        if (part.cell, part.degree, part.order) != (first.cell, first.degree, first.order):
            raise InputError(
                f"bodies {', '.join(first.bodies)} and {', '.join(part.bodies)}: "
                "all bodies of a mesh need the same cell and order, "
                f"not {first.cell} of order {first.order} and {part.cell} of order {part.order}"
            )
    node = np.cumsum([0] + [len(p.points) for p in parts])
    cell = np.cumsum([0] + [len(p.cells) for p in parts])
    return MeshArrays(
        cell=first.cell,
        degree=first.degree,
        points=np.concatenate([p.points for p in parts]),
        cells=np.concatenate([p.cells + n for p, n in zip(parts, node[:-1], strict=True)]),
        bodies={
            k: v + c for p, c in zip(parts, cell[:-1], strict=True) for k, v in p.bodies.items()
        },
        facets={
            k: v + n for p, n in zip(parts, node[:-1], strict=True) for k, v in p.facets.items()
        },
        order=first.order,
    )
