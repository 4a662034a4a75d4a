"""Bodies of order 1 in a space of order 2: their middle nodes follow from the corners."""

from __future__ import annotations

import numpy as np

from anisocontact.base.array_types import Floats, Ints
from anisocontact.base.fenicsx import Vec, corner_weights
from anisocontact.mesh import Model
from anisocontact.solver.terms.constraint import Constraint


def middle_nodes(model: Model) -> Ints:
    """Nodes this rank owns that follow from corners, local numbers."""
    return np.unique(shares_of_corners(model)[0])


def constrain_middles(model: Model, like: Vec) -> Constraint | None:
    """Constraint of the bodies whose displacement is of order 1.

    At a middle node `u = mean of u at the corners of its edge, face or cell`, so that the
    displacement is that of order 1 exactly.

    Args:
        model: The mesh.
        like: A vector of the unknowns.

    Returns:
        The constraint; None where all bodies have the order of the space.
    """
    if not model.linear:
        return None
    slaves, masters, weights = shares_of_corners(model)
    index_map = model.space.dofmap.index_map
    # Unknowns of rigid bodies come last, so that those of the mesh keep their numbers.
    globally = index_map.local_to_global
    rows = 3 * globally(slaves.astype(np.int32)).astype(np.int64)
    columns = 3 * globally(masters.astype(np.int32)).astype(np.int64)
    components = np.arange(3)
    return Constraint(
        like,
        (rows[:, None] + components).reshape(-1),
        (columns[:, None] + components).reshape(-1),
        np.repeat(weights, 3),
    )


def shares_of_corners(model: Model) -> tuple[Ints, Ints, Floats]:
    """Middle nodes this rank owns, corners and weights, each middle node once for each corner."""
    middle, weights = corner_weights(model.space)
    cells = np.concatenate([np.zeros(0, dtype=np.int32), *map(model.cells, model.linear)])
    nodes = model.space.dofmap.list[cells].astype(np.int64)
    slaves, first = np.unique(nodes[:, middle], return_index=True)
    cell, which = np.divmod(first, max(len(middle), 1))
    owned = slaves < model.space.dofmap.index_map.size_local
    slaves, cell, which = slaves[owned], cell[owned], which[owned]
    pair, corner = np.nonzero(weights[which])
    return slaves[pair], nodes[cell[pair], corner], weights[which[pair], corner]
