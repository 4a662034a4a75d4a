"""What is opposite to slave nodes, with numbers that do not depend on how a mesh is distributed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from anisocontact.contact.contact_planes import Opposite
from anisocontact.contact.master_surface import MasterSurface


def names_of(then: Opposite, gathered: MasterSurface) -> Opposite:
    """What was opposite before, with names of its nodes and numbers of facets in the whole group.

    Args:
        then: What was opposite.
        gathered: The master as this process has it.
    """
    kept = {name: getattr(then, name).copy() for name in ("shape", "gradient", "second", "edge")}
    around = np.where(then.facet[:, None] >= 0, gathered.names(then.around), np.int32(-1))
    named = replace(then, **kept).around_in_order(around)
    for values in kept.values():
        values[then.facet < 0] = 0.0
    return replace(named, facet=gathered.globally(then.facet)).in_order(
        gathered.names(then.masters)
    )


def numbers_of(named: Opposite, gathered: MasterSurface) -> Opposite:
    """What `names_of` gave, with the numbers of this process, which has to have these facets."""
    facet, nodes = gathered.renumbered(named.facet), named.nodes
    if len(gathered.facets.nodes):
        nodes = gathered.facets.nodes[np.maximum(facet, 0)]
    masters, around = (gathered.of_names(one) for one in (named.masters, named.around))
    return replace(named, masters=masters, around=around, facet=facet, nodes=nodes).in_order()
