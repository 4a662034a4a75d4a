"""Points of which next to nothing is covered: a penalty or a compliance, while that holds them."""

from __future__ import annotations

from typing import Any

import numpy as np

from anisocontact.base.array_types import Flags, Floats
from anisocontact.contact.contact_trial import ContactTrial
from anisocontact.contact.integration_points import IntegrationPoints
from anisocontact.contact.multipliers import FADES, Multipliers
from anisocontact.interface import State

#: Share of its weight up to which a point may be left to its penalty: times a gap of a hundredth of
#: a facet that is the tolerance.
SLIGHT = 1e-4


class Slivers:
    """Those of the points of one contact in an increment.

    Args:
        points: The points.
        comm: Communicator of the mesh.

    Attributes:
        left: Points that are left to their penalty, (n,).
        firm: Points that hold exactly, however little of them is covered, (n,).
    """

    def __init__(self, points: IntegrationPoints, comm: Any) -> None:
        self._points, self._comm = points, comm
        self.left: Flags = np.zeros(len(points.facet), dtype=bool)
        self.firm: Flags = self.left.copy()

    def begin(self, areas: Floats) -> None:
        """Take those of an increment that begins with these areas, (n,), length^2."""
        self.left = self._slight(areas)
        self.firm = np.zeros_like(self.left)

    def look(self, areas: Floats) -> None:
        """Leave out what is no sliver in a trial with these areas, (n,), length^2."""
        self.left = self.left & self._slight(areas)

    def held_as_well(self, own: Multipliers, step: ContactTrial, start: State) -> State | None:
        """Let those that are left too deep have multipliers that hold, for good; collective.

        Args:
            own: The multipliers.
            step: A trial in equilibrium.
            start: State that it started from.

        Returns:
            A start with these multipliers; None where no point is too deep.
        """
        deep = own.exact & own.beyond(step) & (self.left | (step.covered < FADES) & ~self.firm)
        if not self._comm.allreduce(int(deep.any())):
            return None
        self.left, self.firm = self.left & ~deep, self.firm | deep
        held = start.copy()
        held["multiplier"][deep] = step.answer.pressure[deep]
        return held

    def _slight(self, areas: Floats) -> Flags:
        return np.asarray(self._points.covered(areas) < SLIGHT)
