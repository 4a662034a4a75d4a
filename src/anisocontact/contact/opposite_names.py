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
    named = then.in_order(gathered.names(then.masters))
    around = gathered.names(then.around)
    return replace(named, facet=gathered.globally(then.facet), around=around)


def numbers_of(named: Opposite, gathered: MasterSurface) -> Opposite:
    """What `names_of` gave, with the numbers of this process, which has to have these facets."""
    facet, nodes = gathered.renumbered(named.facet), named.nodes
    if len(gathered.facets.nodes):
        nodes = gathered.facets.nodes[np.maximum(facet, 0)]
    masters, around = (gathered.of_names(one) for one in (named.masters, named.around))
    return replace(named, masters=masters, around=around, facet=facet, nodes=nodes).in_order()
