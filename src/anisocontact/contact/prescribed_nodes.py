"""Which displacements are prescribed at the nodes that a process has gathered."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from anisocontact.base.array_types import Flags, Floats, Locals
from anisocontact.contact.integration_points import FREE, free_along
from anisocontact.contact.master import Resting
from anisocontact.contact.master_surface import MasterSurface


class PrescribedNodes:
    """Prescribed displacements of the nodes of both sides, those of other processes too.

    Args:
        gathered: The master as this rank has it.

    Attributes:
        resting: Gathered nodes that are held where they are along directions.
    """

    def __init__(self, gathered: MasterSurface) -> None:
        self._gathered = gathered
        self.resting: Sequence[Resting] = ()
        self._resting: Sequence[Resting] = ()
        self._prescribed: Floats | None = None
        self._fixed: Floats | None = None

    def take_resting(self, resting: Sequence[Resting]) -> None:
        """Learn which local nodes are held where they are; collective."""
        self._resting = resting
        self.spread()

    def take_fixed(self, fixed: Floats) -> None:
        """Learn the projections on prescribed directions, (nodes, 3, 3); collective."""
        self._prescribed = fixed
        self.spread()

    def spread(self) -> None:
        """Have the same of the nodes that are gathered now; collective."""
        spread, moved = self._gathered.everywhere, self._gathered.moved
        self.resting = [(spread(there), direction) for there, direction in self._resting]
        self._fixed = None if self._prescribed is None else spread(moved(self._prescribed))

    def immovable(self, masters: Locals, shares: Floats, normal: Floats) -> Flags:
        """Whether what is opposite each point cannot move along its normal, (n,).

        Args:
            masters: Nodes opposite, gathered, (n, k).
            shares: Their weights, (n, k).
            normal: At the points, (n, 3).
        """
        if self._fixed is None:
            return np.zeros(len(normal), dtype=bool)
        size = np.abs(shares)
        free = size * free_along(self._fixed, masters, size > 0.0, normal)
        return np.asarray(free.sum(axis=1) < FREE)
