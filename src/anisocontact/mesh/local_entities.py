"""Cells and facets of a distributed mesh: by their nodes, and by the cells beside them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from anisocontact.base.array_types import Ints, Locals
from anisocontact.base.fenicsx import locate_entities


def located(mesh: Any, dim: int, groups: Mapping[str, Ints]) -> dict[str, Locals]:
    """Local entities of each group; collective.

    Args:
        mesh: DOLFINx mesh.
        dim: Dimension of the entities.
        groups: Name -> nodes of each of its entities, (entities, nodes), as the mesh was given.

    Returns:
        Their local numbers on this rank, by name.
    """
    if not groups:
        return {}
    rows = np.concatenate(list(groups.values()))
    numbers = np.repeat(np.arange(len(groups), dtype=np.int32), [*map(len, groups.values())])
    found, of_group, once = locate_entities(mesh, dim, rows, numbers)
    if once:  # none is in two groups
        return {name: found[of_group == i] for i, name in enumerate(groups)}
    return {
        name: locate_entities(mesh, dim, nodes, np.zeros(len(nodes), dtype=np.int32))[0]
        for name, nodes in groups.items()
    }


def count_inside(mesh: Any, facets: Locals) -> int:
    """How many of the facets that this rank owns have a cell on either side.

    Args:
        mesh: DOLFINx mesh.
        facets: Local facets, (n,).
    """
    topology = mesh.topology
    dim = topology.dim
    topology.create_connectivity(dim - 1, dim)
    owned = facets[facets < topology.index_map(dim - 1).size_local]
    return int((np.diff(topology.connectivity(dim - 1, dim).offsets)[owned] > 1).sum())
