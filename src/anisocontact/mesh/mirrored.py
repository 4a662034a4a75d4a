"""Cells that are numbered the other way round, as MED files and mirrored parts have them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from anisocontact.base.array_types import Floats, Ints
from anisocontact.mesh.tetrahedra import EDGES

#: Corners in the order in which a mirrored cell has them.
CORNERS = {
    "tetrahedron": (0, 2, 1, 3),
    "hexahedron": (0, 3, 2, 1, 4, 7, 6, 5),
    "prism": (0, 2, 1, 3, 5, 4),
    "pyramid": (0, 3, 2, 1, 4),
}
#: Corners between which the three axes of a cell go, from the mean of some to that of others.
AXES: dict[str, tuple[tuple[Sequence[int], Sequence[int]], ...]] = {
    "tetrahedron": (([0], [1]), ([0], [2]), ([0], [3])),
    "hexahedron": (
        ([0, 3, 4, 7], [1, 2, 5, 6]),
        ([0, 1, 4, 5], [2, 3, 6, 7]),
        ([0, 1, 2, 3], [4, 5, 6, 7]),
    ),
    "prism": (([0, 3], [1, 4]), ([0, 3], [2, 5]), ([0, 1, 2], [3, 4, 5])),
    "pyramid": (([0, 3], [1, 2]), ([0, 1], [2, 3]), ([0, 1, 2, 3], [4])),
}


def turned(
    cell: str, nodes: Ints, points: Floats, faces: Sequence[tuple[int, ...]]
) -> tuple[Ints, int]:
    """Cells in space with those turned round whose volume is negative; others as they are.

    Args:
        cell: Kind of cell.
        nodes: Their nodes in the order of VTK, (n, nodes of a cell).
        points: Places of all nodes, length.
        faces: Corners of the faces of a hexahedron that have a middle node, in their order.

    Returns:
        The cells, and how many were turned.

    Example:
        >>> points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
        >>> turned("tetrahedron", np.array([[0, 2, 1, 3]]), points, ())
        (array([[0, 1, 2, 3]]), 1)
    """
    if cell not in AXES:
        return nodes, 0
    axes = [
        points[nodes[:, list(ends)]].mean(axis=1) - points[nodes[:, list(starts)]].mean(axis=1)
        for starts, ends in AXES[cell]
    ]
    wrong = np.einsum("ij,ij->i", np.cross(axes[0], axes[1]), axes[2]) < 0.0
    if not wrong.any():
        return nodes, 0
    found = nodes.copy()
    found[wrong] = nodes[wrong][:, _order(cell, nodes.shape[1], faces)]
    return found, int(wrong.sum())


def _order(cell: str, count: int, faces: Sequence[tuple[int, ...]]) -> list[int]:
    """Nodes of a cell in the order in which the mirrored one has them."""
    corners = CORNERS[cell]
    order = list(corners)
    for parts in (EDGES[cell], faces):
        if len(order) < count:
            places = {frozenset(part): len(order) + k for k, part in enumerate(parts)}
            order += [places[frozenset(corners[k] for k in part)] for part in parts]
    return order + list(range(len(order), count))
