"""How the tractions of slave points on facets follow the nodes, from a block for each point."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.contact.facet_answer import ByPoints, FacetAnswer
from anisocontact.contact.integration_points import IntegrationPoints


@dataclass(frozen=True)
class Nodes:
    """The nodes of both sides.

    Attributes:
        now: Their positions, (nodes, 3), length.
        moved: Their displacements, (nodes, 3), length.
    """

    now: Floats
    moved: Floats


class PointTangent:
    """Linear change of the tractions about an answer, see `Linear`.

    Args:
        points: The slave points.
        nodes: Gives the nodes as they are now.
        answer: The answer, given there.
    """

    def __init__(
        self, points: IntegrationPoints, nodes: Callable[[], Nodes], answer: FacetAnswer[ByPoints]
    ) -> None:
        self._points, self._nodes, self._answer = points, nodes, answer
        self._then = nodes()

    def change(self) -> Floats | None:
        """As of `Linear`."""
        now, then = self._nodes(), self._then
        if np.array_equal(now.now, then.now):
            return None
        named = self._answer.forces.nodes
        # the blocks are so stiff that the rounding of positions would be felt in the difference
        moved = (now.moved - then.moved)[np.maximum(named, 0)]
        moved[named < 0] = 0.0
        flat = moved.reshape(len(moved), 3 * moved.shape[1])  # also where a rank has no points
        force = np.einsum("nic,nc->ni", self._answer.forces.by_nodes, flat)
        points, snapshot = self._points, self._answer.snapshot
        grown = points.areas(points.at(now.now)) - points.areas(points.at(then.now))
        force -= grown[:, None] * snapshot.response.traction
        return np.asarray(force / snapshot.areas[:, None])

    def slipped(self, slip: Floats) -> Floats:
        """As of `Linear`."""
        force = self._answer.forces.on_slave(self._residual(slip))
        return force / self._answer.snapshot.areas[:, None]

    def add_force(self, slip: Floats, out: Floats) -> None:
        """As of `Linear`."""
        gathered = self._answer.gathered
        total = gathered.zeros(out)
        self._answer.forces.add_rows(-self._residual(slip), total)
        gathered.hand_back(total, out)

    def _residual(self, slip: Floats) -> Floats:
        """What slip makes of the residuals of the points, (n, 3 r), force."""
        return np.asarray(np.einsum("nkr,nk->nr", self._answer.forces.by_slip, slip))
