"""Cells of one body that occupy the same space: it would be there twice."""

from __future__ import annotations

from typing import Any

import numpy as np

from anisocontact.base.array_types import Flags, Floats
from anisocontact.base.fenicsx import basix, boxes_around, geometry
from anisocontact.base.shown import shown
from anisocontact.mesh.model import Model

#: Middles that are looked for at once: cells of more would take many times the mesh.
_AT_ONCE = 20000
#: Corrections of a place in the reference cell, and how far outside a cell a point still is in it.
_MOST, _ROUNDED = 20, 1e-9


def overlapping_cells(model: Model, body: str) -> str:
    """A line on cells of a body whose middle lies in another of its cells, if any; collective.

    Such cells carry loads beside each other, twice as stiff as the body, and meet twice what it is
    pressed on. No cell of a mesh without gaps and folds has its middle in another one.

    Args:
        model: The bodies.
        body: Name of one.
    """
    comm, dim = model.mesh.comm, model.idealisation.dim
    element, nodes, x = geometry(model.mesh)
    cells = model.mesh.topology.index_map(dim)
    mine = np.isin(np.arange(cells.size_local), model.cells(body))
    middle = element.tabulate(0, _middle(element))[0, 0, :, 0]
    middles = np.einsum("n,cnk->ck", middle, x[nodes[: cells.size_local][mine]])
    numbers = cells.local_range[0] + np.arange(cells.size_local)
    of_cells = np.concatenate(comm.allgather(numbers[mine]))
    places = np.concatenate(comm.allgather(middles))
    twice, search = np.zeros(len(places), dtype=bool), boxes_around(model.mesh)
    for begin in range(0, len(twice), _AT_ONCE):
        points, cell = search(places[begin : begin + _AT_ONCE])
        points = points + begin
        other = (numbers[cell] != of_cells[points]) & mine[cell]
        points, cell = points[other], cell[other]
        inside = _inside(element, x[nodes[cell]][..., :dim], places[points][:, :dim])
        twice[points[inside]] = True
    twice = np.logical_or.reduce(comm.allgather(twice))
    if not twice.any():
        return ""
    first = shown(places[twice][0])
    return (
        f"body {body!r}: {twice.sum()} of {len(twice)} cells have their middle in another cell of "
        f"it, the first at {first}: its material is there twice, with twice the stiffness and "
        "twice the force of a contact; take one of both out of the mesh, or make them bodies of "
        "their own"
    )


def _middle(element: Any) -> Floats:
    """The middle of the reference cell, (1, dim)."""
    return np.asarray(basix.geometry(element.cell_type).mean(axis=0)[None])


def _inside(element: Any, corners: Floats, points: Floats) -> Flags:
    """Which points are in their cells, (n,): by Newton's method from the middle of the cell.

    Args:
        element: Of the geometry.
        corners: Nodes of the cell of each point, (n, nodes, dim), length.
        points: The points, (n, dim), length.
    """
    place, left = np.repeat(_middle(element), len(points), axis=0), np.full(len(points), np.inf)
    for _ in range(_MOST if len(points) else 0):
        tables = element.tabulate(1, place)[..., 0]
        missed = points - np.einsum("pn,pnk->pk", tables[0], corners)
        slope = np.einsum("dpn,pnk->pkd", tables[1:], corners)
        flat = np.linalg.det(slope) == 0.0  # where a correction has gone too far
        slope[flat] = np.eye(slope.shape[1])
        step = np.where(flat[:, None], 1.0, np.linalg.solve(slope, missed[..., None])[..., 0])
        place, left = np.clip(place + step, -1.0, 2.0), np.abs(step).max(axis=1)
        if np.all(left < _ROUNDED):
            break
    least = place.min(axis=1, initial=1.0)
    simplex = element.cell_type.name in ("triangle", "tetrahedron")
    beyond = 1.0 - (place.sum(axis=1) if simplex else place.max(axis=1, initial=0.0))
    return np.asarray((np.minimum(least, beyond) > -_ROUNDED) & (left < _ROUNDED))
