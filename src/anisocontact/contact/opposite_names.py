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
    named = replace(then, **kept).in_order(gathered.names(then.masters))
    around = np.where(then.facet[:, None] >= 0, gathered.names(then.around), -1)
    count = max(int((around >= 0).sum(axis=1).max(initial=0)), 1)
    order = np.argsort(np.where(around < 0, np.iinfo(np.int32).max, around), axis=1)[:, :count]
    around = np.take_along_axis(around, order, axis=1)
    along = np.take_along_axis(then.along, order[:, None], axis=2)
    bending = np.take_along_axis(then.bending, order[:, None, None], axis=3)
    there, none = around[:, None] >= 0, then.facet < 0
    for values in kept.values():
        values[none] = 0.0
    return replace(
        named,
        facet=gathered.globally(then.facet),
        around=around,
        along=np.where(there, along, 0.0),
        bending=np.where(there[:, None], bending, 0.0),
    )


def numbers_of(named: Opposite, gathered: MasterSurface) -> Opposite:
    """What `names_of` gave, with the numbers of this process, which has to have these facets."""
    facet, nodes = gathered.renumbered(named.facet), named.nodes
    if len(gathered.facets.nodes):
        nodes = gathered.facets.nodes[np.maximum(facet, 0)]
    masters, around = (gathered.of_names(one) for one in (named.masters, named.around))
    return replace(named, masters=masters, around=around, facet=facet, nodes=nodes).in_order()
