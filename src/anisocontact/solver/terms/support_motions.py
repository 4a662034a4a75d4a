"""How a support moves the nodes of a group along one axis during a step."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.load_curve import TimeHistory
from anisocontact.solver.terms.turn import Turn

#: Places along a step at which what follows an amplitude is compared with what else is prescribed.
_PLACES = 16


@dataclass(frozen=True)
class StepStart:
    """Nodes where a step begins.

    Attributes:
        axis: Axis along which they are held.
        displacement: Along that axis, (n,), length.
        positions: Where they are, (n, 3), length.
        duration: Time the step takes.
    """

    axis: int
    displacement: Floats
    positions: Floats
    duration: float


class SupportMotion(Protocol):
    """How nodes of a group move along one axis."""

    @property
    def places(self) -> int:
        """Shares of the step at which it is to be looked at, the last one its end."""

    @property
    def linear(self) -> bool:
        """Whether values go linearly to those at the end, where later steps leave them."""

    def at(self, share: float, start: StepStart) -> Floats:
        """Displacement at a share of the step, (n,), length."""


@dataclass(frozen=True)
class TranslatedSupport:
    """The displacement of all nodes goes along one history, each from where it is.

    Attributes:
        history: The displacement over the step, length.
    """

    history: TimeHistory

    @property
    def places(self) -> int:
        """See `SupportMotion.places`."""
        return 1 if self.history.linear else _PLACES

    @property
    def linear(self) -> bool:
        """See `SupportMotion.linear`."""
        return self.history.linear

    def at(self, share: float, start: StepStart) -> Floats:
        """See `SupportMotion.at`."""
        return np.asarray(self.history.at(share, start.duration, start.displacement))


@dataclass(frozen=True)
class RotatedSupport:
    """Nodes turn about an axis.

    Attributes:
        turn: The motion of the group.
    """

    turn: Turn

    places = 1
    linear = False

    def at(self, share: float, start: StepStart) -> Floats:
        """See `SupportMotion.at`."""
        moved = self.turn.path(start.positions, share) - start.positions
        return np.asarray(start.displacement + moved[:, start.axis])
