"""Slave nodes at the front of a crack or the tip of a slot, where both faces meet.

Nothing opens or slides there. At the front of a closed crack a node is opposite itself. At the tip
of an open slot, of one group that meets itself, it is opposite facets that go on from those around
it: that these, drawn on as far as the tip, come to lie behind it is no overlap, as both faces end
in this node.
"""

from __future__ import annotations

import numpy as np

from anisocontact.base.array_types import Flags, Floats, Ints
from anisocontact.contact.mortar_weights import MortarWeights
from anisocontact.contact.sharp_edges import SMOOTH, Around
from anisocontact.contact.sides import Sides
from anisocontact.contact.slave_nodes import SlaveNodes


class CrackFront:
    """Those of one contact.

    Args:
        sides: Slave nodes and facets.
        points: The slave nodes.
        normals: Of a group that meets itself the outward unit normals of the facets around the
            nodes in the reference configuration, (m, 3): a slot has its tips on edges.
    """

    def __init__(self, sides: Sides, points: SlaveNodes, normals: Floats | None = None) -> None:
        gathered = sides.gathered
        self._gathered, self._points = gathered, points
        shared = gathered.owned(gathered.local_names(np.unique(gathered.own.nodes)))
        self._nodes = np.flatnonzero(np.isin(gathered.local_names(points.nodes[:, 0]), shared))
        none = np.zeros(0, dtype=np.int64)
        self._edges = none if normals is None else np.flatnonzero(_on_edges(points.around, normals))

    def opposite_themselves(self, weights: MortarWeights) -> Ints:
        """Slave nodes that are opposite themselves, or at a tip.

        Once faces slide, what is left of the own weight of a node at the front would let a pressure
        grow that displacements of its neighbours hardly change.

        Args:
            weights: Mortar weights where the nodes are.

        Returns:
            Their numbers among the slave nodes.
        """
        front = self._opposite(self._nodes, 1, weights)
        return np.union1d(front, self._opposite(self._edges, None, weights))

    def _opposite(self, which: Ints, count: int | None, weights: MortarWeights) -> Ints:
        """Those of some slave nodes with weights on the first nodes of their facets, or all."""
        named = self._gathered.in_mesh
        own, masters = named(self._points.nodes[which, :count]), named(weights.masters[which])
        same = (masters[:, :, None] == own[:, None]).any(axis=2)
        return np.asarray(which[(same & (weights.weight[which] != 0.0)).any(axis=1)])


def _on_edges(around: Around, normals: Floats) -> Flags:
    """Nodes around which two facets do not go on smoothly, (n,)."""
    lists = np.split(normals[around.facets], around.offsets[1:-1])
    return np.array([bool((own @ own.T < SMOOTH).any()) for own in lists], dtype=bool)
