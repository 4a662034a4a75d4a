"""Slave nodes of the front of a crack, which both faces have: nothing opens or slides there."""

from __future__ import annotations

import numpy as np

from anisocontact.base.array_types import Ints
from anisocontact.contact.mortar_weights import MortarWeights
from anisocontact.contact.sides import Sides
from anisocontact.contact.slave_nodes import SlaveNodes


class CrackFront:
    """Those of one contact.

    Args:
        sides: Slave nodes and facets.
        points: The slave nodes.
    """

    def __init__(self, sides: Sides, points: SlaveNodes) -> None:
        gathered = sides.gathered
        self._gathered, self._points = gathered, points
        shared = gathered.owned(gathered.local_names(np.unique(gathered.own.nodes)))
        self._nodes = np.flatnonzero(np.isin(gathered.local_names(points.nodes[:, 0]), shared))

    def opposite_themselves(self, weights: MortarWeights) -> Ints:
        """Slave nodes that are opposite themselves.

        Once the faces slide, what is left of their own weight would let a pressure grow that
        displacements of their neighbours hardly change.

        Args:
            weights: Mortar weights where the nodes are.

        Returns:
            Their numbers among the slave nodes.
        """
        front, named = self._nodes, self._gathered.in_mesh
        same = named(weights.masters[front]) == named(self._points.nodes[front, :1])
        return np.asarray(front[(same & (weights.weight[front] != 0.0)).any(axis=1)])
