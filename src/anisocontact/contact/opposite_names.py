"""What is opposite to slave nodes, with numbers that do not depend on how a mesh is distributed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from anisocontact.base.array_types import Flags, Ints, Locals
from anisocontact.contact.contact_planes import Opposite
from anisocontact.contact.master_surface import MasterSurface
from anisocontact.contact.slave_nodes import Patches, SlaveNodes


class OppositeNames:
    """Names of nodes opposite to slave nodes, and of nodes beside these that count with them.

    Those of the master go by its facets, those of the slave, behind them, by their place on the
    facets around the slave node.

    Args:
        gathered: The master as this process has it.
        points: The slave nodes.
    """

    def __init__(self, gathered: MasterSurface, points: SlaveNodes) -> None:
        self._gathered, self._beside = gathered, _listed(points.around, points.keys)

    def named(self, then: Opposite) -> Opposite:
        """What was opposite with names of its nodes and numbers of facets in the whole group."""
        gathered = self._gathered
        places = ("shape", "gradient", "second", "edge")
        kept = {name: getattr(then, name).copy() for name in places}
        around = np.where(then.facet[:, None] >= 0, gathered.names(then.around), np.int32(-1))
        named = replace(then, **kept).around_in_order(around)
        for values in kept.values():
            values[then.facet < 0] = 0.0
        return replace(named, facet=gathered.globally(then.facet)).in_order(
            self._names(then.masters)
        )

    def numbered(self, named: Opposite) -> Opposite:
        """What `named` gave with the numbers of this process, which has to have these facets."""
        gathered = self._gathered
        facet, nodes = gathered.renumbered(named.facet), named.nodes
        if len(gathered.facets.nodes):
            nodes = gathered.facets.nodes[np.maximum(facet, 0)]
        masters, around = self._nodes(named.masters), gathered.of_names(named.around)
        return replace(named, masters=masters, around=around, facet=facet, nodes=nodes).in_order()

    def facets(self, named: Sequence[Opposite]) -> list[Locals]:
        """Facets of the master that `named` goes by, numbers in the whole group, -1 for none."""
        masters = [np.where(self._of_slave(one.masters), -1, one.masters) for one in named]
        names = [*masters, *(one.around for one in named)]
        return [one.facet for one in named] + [self._gathered.facets_of_names(n) for n in names]

    def _of_slave(self, names: Locals) -> Flags:
        return np.asarray(names >= self._gathered.name_count)

    def _names(self, nodes: Locals) -> Locals:
        beside = (nodes >= 0) & ~self._gathered.has(nodes)
        names = self._gathered.names(np.where(beside, np.int32(-1), nodes))
        row, column = np.nonzero(beside)
        if not len(row):  # a process without slave nodes has nothing to look in
            return names
        place = (self._beside[row] == nodes[row, column][:, None]).argmax(axis=1)
        names[row, column] = self._gathered.name_count + place
        return names

    def _nodes(self, names: Locals) -> Locals:
        beside = self._of_slave(names)
        nodes = self._gathered.of_names(np.where(beside, np.int32(-1), names))
        row, column = np.nonzero(beside)
        place = names[row, column] - self._gathered.name_count
        nodes[row, column] = self._beside[row, place]
        return nodes


def _listed(around: Patches, keys: Ints) -> Locals:
    """Nodes of the facets around each slave node, facet by facet in the order of keys, (n, k)."""
    count = np.diff(around.offsets)
    owner = np.repeat(np.arange(len(count)), count)
    facets = around.facets[np.lexsort((keys[around.facets], owner))]
    most, width = int(count.max(initial=0)), around.mesh.nodes.shape[1]
    table = np.full((len(count), most, width), -1, dtype=np.int32)
    table[owner, np.arange(len(owner)) - around.offsets[owner]] = around.mesh.nodes[facets]
    return table.reshape(len(count), most * width)
