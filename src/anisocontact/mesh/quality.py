"""Cells a finite-element mesh can be made of."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from anisocontact._fenicsx import curved_gradients, middle_nodes
from anisocontact.errors import InputError
from anisocontact.mesh.arrays import CELL_FACETS, MeshArrays

# Corners, each with its neighbours in an order that makes a right-handed frame in a sound cell.
_CORNERS = {
    "tetrahedron": np.array([[0, 1, 2, 3]]),
    "hexahedron": np.array(
        [
            [0, 1, 2, 4],
            [1, 3, 0, 5],
            [2, 0, 3, 6],
            [3, 2, 1, 7],
            [4, 6, 5, 0],
            [5, 4, 7, 1],
            [6, 7, 4, 2],
            [7, 5, 6, 3],
        ]
    ),
}
#: Volume at a corner over the largest in the body, below which a cell is flat.
FLAT = 1e-12


def check_cells(mesh: MeshArrays) -> None:
    """Refuse flat or inverted cells, facets of more than two cells, and edges with two middles.

    Args:
        mesh: Mesh with straight or curved cells. The corners are looked at, and inside of curved
            cells the points of a quadrature.

    Raises:
        InputError: Says what is wrong and how often.
    """
    # Sizes whose volumes overflow or underflow count as flat.
    with np.errstate(over="ignore", under="ignore", invalid="ignore"):
        volumes = _corner_volumes(mesh)
        if mesh.degree == 2:
            volumes = np.hstack([volumes, _inner_volumes(mesh)])
    for name, cells in mesh.bodies.items():
        own = volumes[cells]
        sound = own.min(axis=1) > FLAT * np.abs(own).max()
        bad = len(own) - int(sound.sum())
        if bad:
            raise InputError(f"body {name!r}: {bad} of {len(own)} cells are flat or inverted")
    shared = _facets_of_more_than_two(mesh)
    if shared:
        raise InputError(f"{shared} facets belong to more than two cells")
    if mesh.degree == 2 and not _is_conforming(mesh):
        raise InputError("neighbouring cells do not have the same nodes on their common edges")


def _corner_volumes(mesh: MeshArrays) -> npt.NDArray[np.float64]:
    corners = _CORNERS[mesh.cell]
    points = mesh.points[mesh.cells[:, corners]]
    edges = points[:, :, 1:] - points[:, :, :1]
    return np.asarray(np.linalg.det(edges))


def _inner_volumes(mesh: MeshArrays) -> npt.NDArray[np.float64]:
    points = np.ascontiguousarray(mesh.points[mesh.cells].swapaxes(1, 2))
    # One point after the other: all at once would be many times the mesh.
    return np.column_stack([np.linalg.det(points @ g) for g in curved_gradients(mesh.cell)])


def _facets_of_more_than_two(mesh: MeshArrays) -> int:
    local = CELL_FACETS[mesh.cell]
    # The three lowest corners tell a facet from any other.
    rows = np.sort(mesh.cells[:, local].reshape(-1, local.shape[1]), axis=1)[:, :3]
    rows = rows[np.lexsort(rows.T)]
    return int(np.sum(np.all(rows[2:] == rows[:-2], axis=1)))


def _is_conforming(mesh: MeshArrays) -> bool:
    """Whether every node inside an edge or face of quadratic cells belongs to it alone."""
    groups = [np.unique(mesh.cells[:, np.unique(_CORNERS[mesh.cell])])]
    for corners, middle in middle_nodes(mesh.cell):
        entities = np.sort(mesh.cells[:, corners].reshape(-1, corners.shape[1]), axis=1)
        nodes = mesh.cells[:, middle].reshape(-1)
        pairs = np.unique(np.column_stack([entities, nodes]), axis=0)
        groups.append(np.unique(nodes))
        if not len(np.unique(entities, axis=0)) == len(groups[-1]) == len(pairs):
            return False
    return len(np.unique(np.concatenate(groups))) == sum(map(len, groups))
