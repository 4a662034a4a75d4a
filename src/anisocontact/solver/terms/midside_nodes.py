"""Bodies of order 1 in a space of order 2: their middle nodes follow from the corners."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from anisocontact.base.array_types import Floats, Ints
from anisocontact.base.fenicsx import Vec, corner_weights
from anisocontact.mesh import Model
from anisocontact.solver.terms.constraint import Constraint


def midside_nodes(model: Model) -> Ints:
    """Nodes this rank owns that follow from corners, local numbers."""
    return np.unique(shares_of_corners(model)[0])


def constrain_middles(model: Model, like: Vec, without: Collection[str] = ()) -> Constraint | None:
    """Constraint of the bodies whose displacement is of order 1.

    At a middle node `u = mean of u at the corners of its edge, face or cell`, so that the
    displacement is that of order 1 exactly.

    Args:
        model: The mesh.
        like: A vector of the unknowns.
        without: Bodies all of whose nodes follow a rigid body: a motion that is affine leaves
            middle nodes where they are between the corners.

    Returns:
        The constraint; None where all other bodies have the order of the space.
    """
    if set(model.linear) <= set(without):
        return None
    slaves, masters, weights = shares_of_corners(model, without)
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


def shares_of_corners(model: Model, without: Collection[str] = ()) -> tuple[Ints, Ints, Floats]:
    """Middle nodes this rank owns, corners and weights, each middle node once for each corner.

    Args:
        model: The mesh.
        without: Bodies that are left out.
    """
    middle, weights = corner_weights(model.space)
    bodies = [name for name in model.linear if name not in without]
    cells = np.concatenate([np.zeros(0, dtype=np.int32), *map(model.cells, bodies)])
    nodes = model.space.dofmap.list[cells].astype(np.int64)
    slaves, first = np.unique(nodes[:, middle], return_index=True)
    cell, which = np.divmod(first, max(len(middle), 1))
    owned = slaves < model.space.dofmap.index_map.size_local
    slaves, cell, which = slaves[owned], cell[owned], which[owned]
    pair, corner = np.nonzero(weights[which])
    return slaves[pair], nodes[cell[pair], corner], weights[which[pair], corner]
