"""Which process gets which cells: planes halve the bodies and what touches, again and again."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from anisocontact.base.array_types import Flags, Floats, Ints
from anisocontact.mesh.arrays import CELL_FACETS, MeshArrays

#: Tilt of a plane, which splits a layer of cells that it goes through.
TILT = 1e-3
#: Halvings of the interval in which a plane is looked for.
HALVINGS = 60


def owners(mesh: MeshArrays, count: int, touching: Sequence[str]) -> Ints:
    """Process of each cell of this one; the call is collective.

    Recursive coordinate bisection [Berger and Bokhari 1987] of all bodies at once: each plane
    leaves every process its share of cells. Of the planes across the axes the one is taken that
    splits facets in contact best and has few cells beside it. Bodies that meet are so cut together,
    where a partition of the graph of cells, which has no edge between them, hands out whole bodies.

    Args:
        mesh: The mesh, of which each process has a share.
        count: Processes that get the cells.
        touching: Facet groups in contact; names that the mesh does not have count for nothing.

    Returns:
        Their numbers, (cells,).
    """
    corners = mesh.cells[:, : CELL_FACETS[mesh.cell].max() + 1]
    x = mesh.node_split.fetch(mesh.points, corners)
    named = [mesh.facets[name] for name in touching if name in mesh.facets]
    facets = [nodes[:, : mesh.vertices_per_facet] for nodes in named]
    rows = np.concatenate([np.zeros((0, mesh.vertices_per_facet), dtype=np.int64), *facets])
    faces = mesh.node_split.fetch(mesh.points, rows).mean(axis=1)
    bisection = _Bisection(mesh, x.mean(axis=1), np.ptp(x, axis=1), faces)
    bisection.share(np.arange(len(x)), np.arange(len(faces)), 0, count)
    return bisection.owner


class _Bisection:
    """Cells and facets handed out to processes.

    Args:
        mesh: The mesh.
        centres: Centres of the cells, (cells, 3), length.
        sizes: Their extents, (cells, 3), length.
        faces: Centres of facets in contact, (facets, 3), length.
    """

    def __init__(self, mesh: MeshArrays, centres: Floats, sizes: Floats, faces: Floats) -> None:
        self._mesh, self._centres, self._sizes, self._faces = mesh, centres, sizes, faces
        self.owner: Ints = np.zeros(len(centres), dtype=np.int64)

    def share(self, cells: Ints, faces: Ints, first: int, count: int) -> None:
        """Hand out cells to processes from the first one on, and count facets to them."""
        if count == 1:
            self.owner[cells] = first
            return
        lower = count // 2
        low, high = self._box(cells)
        tried = [
            self._cut(cells, faces, lower / count, _direction(axis, high - low), axis)
            for axis in np.flatnonzero(high > low).tolist()
        ]
        if tried:
            _, below, faces_below = min(tried, key=lambda one: one[0])
        else:  # no cells, or all of them in one place
            below, faces_below = np.zeros(len(cells), dtype=bool), np.zeros(len(faces), dtype=bool)
        self.share(cells[below], faces[faces_below], first, lower)
        self.share(cells[~below], faces[~faces_below], first + lower, count - lower)

    def _box(self, cells: Ints) -> tuple[Floats, Floats]:
        comm, x = self._mesh.comm, self._centres[cells]
        low = np.min(comm.allgather(x.min(axis=0, initial=np.inf)), axis=0)
        return low, np.max(comm.allgather(x.max(axis=0, initial=-np.inf)), axis=0)

    def _cut(
        self, cells: Ints, faces: Ints, share: float, direction: Floats, axis: int
    ) -> tuple[float, Flags, Flags]:
        """Cost of a plane; which cells and facets are below it."""
        along, of_faces = self._centres[cells] @ direction, self._faces[faces] @ direction
        level = self._level(along, share)
        below = of_faces <= level
        beside = np.abs(along - level) < self._sizes[cells, axis]
        counts = [len(cells), np.count_nonzero(beside), len(faces), np.count_nonzero(below)]
        all_cells, layer, all_faces, under = np.sum(self._mesh.comm.allgather(counts), axis=0)
        cost = layer / max(all_cells, 1) + abs(under / max(all_faces, 1) - share)
        return float(cost), along <= level, below

    def _level(self, along: Floats, share: float) -> float:
        """Height of the plane that has a share of the cells of all processes below it."""
        comm = self._mesh.comm
        wanted = round(share * self._mesh.sum(len(along)))
        low = min(comm.allgather(along.min(initial=np.inf)))
        high = max(comm.allgather(along.max(initial=-np.inf)))
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            found = self._mesh.sum(int(np.count_nonzero(along <= middle)))
            if found == wanted:
                return float(middle)
            low, high = (middle, high) if found < wanted else (low, middle)
        return float(high)


def _direction(axis: int, size: Floats) -> Floats:
    """Normal of a plane across an axis, tilted by little of the extents of the cells."""
    tilt = TILT ** ((np.arange(3) - axis) % 3)
    return np.where(size > 0.0, tilt * size[axis] / np.where(size > 0.0, size, 1.0), 0.0)
