"""Cells with curved edges that are folded over at a corner: a middle node is too near to it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from anisocontact.base.array_types import Floats, Locals
from anisocontact.base.fenicsx import vertex_gradients
from anisocontact.base.shown import shown
from anisocontact.mesh.model import Model

#: Volume at a corner over the mean of the corners, negative beyond which a cell is folded there:
#: rounding, as it is zero where a middle node is at a quarter of an edge.
ROUNDED = 1e-9
_AT_ONCE = 5000


def folded_cells(model: Model) -> list[str]:
    """Bodies with cells that are folded over at a corner, a line each; collective.

    The points at which a body is integrated may not see it, its facets do: weights of slave nodes
    are negative there. Meshes are refused where those points see it.

    Args:
        model: The bodies.
    """
    if model.mesh.geometry.cmaps[0].degree != 2:
        return []
    comm, said = model.mesh.comm, []
    owned = model.mesh.topology.index_map(model.idealisation.dim).size_local
    for name in model.body_names():
        cells = model.cells(name)
        own = cells[cells < owned]
        here = np.array([*_folded(model, own)]).reshape(-1, 3)
        places = np.concatenate(comm.allgather(here))
        count = comm.allreduce(len(own))
        if len(places):
            at = shown(places[0])
            said.append(
                f"body {name!r}: {len(places)} of {count} curved cells are folded over at a "
                f"corner, the first at {at}, as a node inside one of its edges is within a "
                "quarter of the edge from its end, or far beside it: stresses and contact "
                "pressures there are wrong; put these nodes near the middles, or mesh finer where "
                "faces are round"
            )
    return said


def _folded(model: Model, cells: Locals) -> Iterator[Floats]:
    """Corners at which cells are folded over, one for each such cell."""
    geometry, dim = model.mesh.geometry, model.idealisation.dim
    gradients = vertex_gradients(model.mesh)
    for begin in range(0, len(cells), _AT_ONCE):
        x = geometry.x[geometry.dofmaps[0][cells[begin : begin + _AT_ONCE]]]
        volumes = np.linalg.det(np.einsum("cnd,pnk->cpdk", x[..., :dim], gradients))
        mean = volumes.mean(axis=1)
        least = (volumes * np.sign(mean)[:, None]) / np.abs(mean)[:, None]
        worst = least.argmin(axis=1)
        for i in np.flatnonzero(least.min(axis=1) < -ROUNDED):
            yield x[i, worst[i]]
