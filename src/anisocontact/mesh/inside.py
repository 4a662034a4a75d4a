"""Facets that a file names one by one and that lie between two cells."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from anisocontact.base.array_types import Ints
from anisocontact.base.errors import InputError
from anisocontact.mesh.arrays import ON_THE_BOUNDARY
from anisocontact.mesh.tetrahedra import EDGES, FACES

#: Faces of cells by their corners, in the order of Abaqus; of those in the plane their edges.
SIDES = FACES | {cell: tuple(EDGES[cell]) for cell in ("triangle", "quadrilateral")}


def told_inside(
    name: str,
    facets: Sequence[Ints],
    named: Sequence[Ints] | None,
    cells: Iterable[tuple[str, Ints]],
) -> str:
    """What to say of a surface that lies inside the mesh, whose facets make no group.

    Args:
        name: Name of the surface.
        facets: Corners of its facets, an array for each number of corners.
        named: Element and face by which the file calls each of them, face 0 where it means all
            that are free; none if it calls them by their nodes alone.
        cells: Kinds of cells that are taken, with their nodes.

    Returns:
        A line; empty if no facet that is named lies inside.

    Raises:
        InputError: A part of the surface lies inside.

    Example:
        >>> two = np.array([[0, 1, 2, 3], [1, 2, 3, 4]])
        >>> told_inside("cut", [np.array([[2, 1, 3]])], None, [("tetrahedron", two)])
        "surface 'cut' lies inside the mesh: no facet group"
    """
    cells, inner, total, such = list(cells), 0, 0, ""
    for k, corners in enumerate(facets):
        labels = None if named is None else named[k]
        chosen = np.full(len(corners), True) if labels is None else labels[:, 1] > 0
        counts = _cells_at(corners[chosen], cells)
        within = counts > 1
        inner, total = inner + int(within.sum()), total + int((counts > 0).sum())
        total += int((~chosen).sum())
        if labels is not None and within.any() and not such:
            element, face = labels[chosen][within][0].tolist()
            such = f", such as S{face} of element {element}"
    if 0 < inner < total:
        raise InputError(
            f"facet group {name!r}: {inner} of {total} facets lie inside the mesh{such}; "
            f"{ON_THE_BOUNDARY}"
        )
    return f"surface {name!r} lies inside the mesh{such}: no facet group" if inner else ""


def _cells_at(facets: Ints, cells: Iterable[tuple[str, Ints]]) -> Ints:
    """How many cells have each facet, by its corners in any order."""
    if not len(facets):
        return np.zeros(0, dtype=np.int64)
    size, sides = facets.shape[1], [np.sort(facets, axis=1)]
    for cell, nodes in cells:
        near = np.isin(nodes, facets)
        for side in (list(s) for s in SIDES[cell] if len(s) == size):
            sides.append(np.sort(nodes[near[:, side].all(axis=1)][:, side], axis=1))
    found = np.concatenate(sides)
    _, place = np.unique(found, axis=0, return_inverse=True)
    place = place.reshape(-1)
    counts = np.bincount(place[len(facets) :], minlength=int(place.max()) + 1)
    return counts[place[: len(facets)]]
