"""Prisms, pyramids and cells of several kinds as tetrahedra, which one mesh can have.

Every cell is cut from the corner of the least number to the faces that do not have it; those of
four corners are cut from their corner of the least number, so that cells agree on common faces.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from anisocontact.base.array_types import Floats, Ints
from anisocontact.mesh.elements import COUNTS

#: Corners of the faces of cells in the order of Abaqus, to the left round seen from inside.
FACES = {
    "tetrahedron": ((0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0)),
    "hexahedron": (
        (0, 1, 2, 3),
        (4, 7, 6, 5),
        (0, 4, 5, 1),
        (1, 5, 6, 2),
        (2, 6, 7, 3),
        (3, 7, 4, 0),
    ),
    "prism": ((0, 1, 2), (3, 5, 4), (0, 3, 4, 1), (1, 4, 5, 2), (2, 5, 3, 0)),
    "pyramid": ((0, 1, 2, 3), (0, 4, 1), (1, 4, 2), (2, 4, 3), (3, 4, 0)),
}
#: Corners that the middle nodes lie between, in the order of VTK and of Abaqus.
EDGES: dict[str, list[tuple[int, int]]] = {
    "tetrahedron": [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)],
    "hexahedron": [
        *((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4)),
        *((0, 4), (1, 5), (2, 6), (3, 7)),
    ],
    "prism": [(0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)],
    "pyramid": [(0, 1), (1, 2), (2, 3), (3, 0), (0, 4), (1, 4), (2, 4), (3, 4)],
    "triangle": [(0, 1), (1, 2), (2, 0)],
    "quadrilateral": [(0, 1), (1, 2), (2, 3), (3, 0)],
}
#: Corners of a cell.
COUNT = {cell: COUNTS[cell][0] for cell in FACES}
#: Corners of the diagonals inside a hexahedron.
_THROUGH = ((0, 6), (1, 7), (2, 4), (3, 5))


def tetrahedra(cell: str, corners: Ints, points: Floats) -> tuple[Ints, Ints]:
    """Tetrahedra that fill cells.

    Args:
        cell: Kind of cell.
        corners: Their corners, (n, corners of a cell).
        points: Places of all nodes, length.

    Returns:
        Corners of the tetrahedra, (m, 4), and the cell of each, (m,).
    """
    if cell == "prism":
        corners = _upright(corners, points)
    least = corners.argmin(axis=1)
    found, owners = [np.zeros((0, 4), dtype=np.int64)], [np.zeros(0, dtype=np.int64)]
    for apex in range(corners.shape[1]):
        rows = np.flatnonzero(least == apex)
        for face in (f for f in FACES[cell] if apex not in f):
            for sides in triangles(corners[rows][:, face]):
                found.append(np.hstack([sides, corners[rows, apex][:, None]]))
                owners.append(rows)
    order = np.argsort(np.concatenate(owners), kind="stable")
    return np.concatenate(found)[order], np.concatenate(owners)[order]


def triangles(facets: Ints) -> Sequence[Ints]:
    """Facets by their corners as triangles: those of four are cut at the corner of least number."""
    if facets.shape[1] == 3:
        return [facets]
    turns = (facets.argmin(axis=1)[:, None] + np.arange(4)) % 4
    turned = np.take_along_axis(facets, turns, axis=1)
    return [turned[:, [0, 1, 2]], turned[:, [0, 2, 3]]]


class Middles:
    """Middle nodes between any two corners of cells of order 2.

    Args:
        points: Places of all nodes; those of faces and of the middle of hexahedra are added where
            the shape functions without them have these.
        cells: Kinds and nodes of the cells.

    Attributes:
        points: With the nodes that were added.
    """

    def __init__(self, points: Floats, cells: Sequence[tuple[str, Ints]]) -> None:
        self.points, self._keys = points, np.zeros((0, 2), dtype=np.int64)
        self._middle = np.zeros(0, dtype=np.int64)
        corners, around = [np.zeros((0, 4), dtype=np.int64)], [np.zeros((0, 4), dtype=np.int64)]
        for cell, nodes in cells:
            count = COUNT[cell]
            middle = {frozenset(e): count + k for k, e in enumerate(EDGES[cell])}
            for edge, place in middle.items():
                self._know(nodes[:, sorted(edge)], nodes[:, place])
            for face in (f for f in FACES[cell] if len(f) == 4):
                sides = [middle[frozenset((face[k - 1], face[k]))] for k in range(4)]
                corners.append(nodes[:, face])
                around.append(nodes[:, sides])
            if cell == "hexahedron":
                self._add(nodes[:, :8], nodes[:, 8:20], 0.25, _THROUGH)
        self._add(np.concatenate(corners), np.concatenate(around), 0.5, ((0, 2), (1, 3)))
        order = np.lexsort(self._keys.T[::-1])
        self._keys, self._middle = self._keys[order], self._middle[order]
        self._rows = self._named(self._keys)

    def of(self, corners: Ints) -> Ints:
        """The middle nodes of tetrahedra in the order of VTK, (m, 6)."""
        ends = np.sort(corners[:, EDGES["tetrahedron"]], axis=2).reshape(-1, 2)
        found = self._middle[np.searchsorted(self._rows, self._named(ends))]
        return np.asarray(found.reshape(len(corners), 6))

    def _named(self, pairs: Ints) -> Ints:
        return pairs[:, 0] * (len(self.points) + 1) + pairs[:, 1]

    def _know(self, ends: Ints, middle: Ints) -> None:
        self._keys = np.concatenate([self._keys, np.sort(ends, axis=1)])
        self._middle = np.concatenate([self._middle, middle])

    def _add(
        self, corners: Ints, around: Ints, share: float, diagonals: Sequence[tuple[int, int]]
    ) -> None:
        """Add the middles of faces or cells, one for those of the same corners.

        Args:
            corners: Their corners, a row each.
            around: Middle nodes of their edges.
            share: What these have in the place of the middle.
            diagonals: Columns of the corners whose middle it is.
        """
        _, first, which = np.unique(
            np.sort(corners, axis=1), axis=0, return_index=True, return_inverse=True
        )
        numbers = len(self.points) + which.reshape(-1)
        places = share * self.points[around[first]].sum(axis=1)
        places -= 0.25 * self.points[corners[first]].sum(axis=1)
        self.points = np.concatenate([self.points, places])
        for diagonal in diagonals:
            self._know(corners[:, diagonal], numbers)


def _upright(corners: Ints, points: Floats) -> Ints:
    """Prisms with the second triangle where the normal of the first points to: formats differ."""
    x = points[corners]
    normal = np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
    up = x[:, 3:].mean(axis=1) - x[:, :3].mean(axis=1)
    turned = np.einsum("ni,ni->n", normal, up) < 0.0
    return np.where(turned[:, None], corners[:, [3, 4, 5, 0, 1, 2]], corners)
