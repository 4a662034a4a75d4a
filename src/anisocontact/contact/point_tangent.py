"""How the forces of slave points follow the nodes, from a block for each point."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from anisocontact.contact.facet_mesh import SlavePoints
from anisocontact.contact.record import Snapshot

Floats = npt.NDArray[np.float64]


class PointTangent:
    """Linear change of the tractions about a trial.

    Args:
        points: The slave points.
        now: Positions of the nodes at the trial, (nodes, 3), length.
        moved: Their displacements, (nodes, 3), length.
        answer: Blocks of the points, "tangent" (n, 3 r, 3 c), and their "nodes", (n, c).
        trial: The trial.
    """

    def __init__(
        self,
        points: SlavePoints,
        now: Floats,
        moved: Floats,
        answer: dict[str, Any],
        trial: Snapshot,
    ) -> None:
        self._points, self._now, self._moved, self._trial = points, now, moved, trial
        self._nodes, self._blocks = answer["nodes"], answer["tangent"]
        n, rows, columns = self._blocks.shape
        own = points.nodes.shape[1]
        # rows of the slave's nodes are shares of the force of the point
        self._force = -self._blocks.reshape(n, rows // 3, 3, columns)[:, :own].sum(axis=1)

    def at(self, now: Floats) -> bool:
        """Whether nodes, (nodes, 3), are where they are in the trial."""
        return np.array_equal(now, self._now)

    def change(self, now: Floats, moved: Floats) -> Floats:
        """Change of the tractions where the nodes move, (n, 3), stress.

        Args:
            now: Where they move to, (nodes, 3), length.
            moved: Their displacements there: the blocks are so stiff that the rounding of
                positions would be felt in the difference, (nodes, 3), length.
        """
        moved = (moved - self._moved)[np.maximum(self._nodes, 0)]
        moved[self._nodes < 0] = 0.0
        force = np.einsum("nic,nc->ni", self._force, moved.reshape(len(moved), 3 * moved.shape[1]))
        grown = self._points.areas(now) - self._points.areas(self._now)
        force -= grown[:, None] * self._trial.response.traction
        return np.asarray(force / self._trial.areas[:, None])

    def slipped(self, slip: Floats) -> Floats:
        """Change of the tractions where slave points move by `slip`, (n, 3), stress."""
        return self._force_of(slip) / self._trial.areas[:, None]

    def forces(self, slip: Floats) -> Floats:
        """The forces on the nodes of the rows that belong to it, (n, 3 r)."""
        n, rows, _ = self._blocks.shape
        own = self._points.nodes.shape[1]
        columns = self._blocks[:, :, : 3 * own].reshape(n, rows, own, 3).sum(axis=2)
        return np.asarray(-np.einsum("nri,ni->nr", columns, slip))

    def _force_of(self, slip: Floats) -> Floats:
        n, own = len(slip), self._points.nodes.shape[1]
        columns = self._force[:, :, : 3 * own].reshape(n, 3, own, 3).sum(axis=2)
        return np.asarray(np.einsum("nij,nj->ni", columns, slip))
