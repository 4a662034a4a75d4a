"""What a step prescribes for nodes of a group along one axis: a value, a course or a turn."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.course import Course
from anisocontact.solver.terms.step import Goal
from anisocontact.solver.terms.turn import Turn

#: Places along a step at which what follows a course is compared with what else is prescribed.
_PLACES = 16


@dataclass(frozen=True)
class StepBeginning:
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


class Aim(Protocol):
    """What nodes of a group are to do along one axis."""

    @property
    def places(self) -> int:
        """Shares of the step at which it is to be looked at, the last one its end."""

    @property
    def straight(self) -> bool:
        """Whether values go linearly to those at the end, where later steps leave them."""

    def at(self, share: float, start: StepBeginning) -> Floats:
        """Displacement at a share of the step, (n,), length."""


@dataclass(frozen=True)
class Stay:
    """Nodes stay where they are."""

    places = 1
    straight = True

    def at(self, share: float, start: StepBeginning) -> Floats:
        """See `Aim.at`."""
        return start.displacement


@dataclass(frozen=True)
class LinearAim:
    """Nodes go linearly to a displacement.

    Attributes:
        value: The displacement, length.
    """

    value: float

    places = 1
    straight = True

    def at(self, share: float, start: StepBeginning) -> Floats:
        """See `Aim.at`."""
        return np.asarray((1.0 - share) * start.displacement + share * self.value)


@dataclass(frozen=True)
class Along:
    """Nodes follow an amplitude.

    Attributes:
        course: The value over time.
    """

    course: Course

    places = _PLACES
    straight = False

    def at(self, share: float, start: StepBeginning) -> Floats:
        """See `Aim.at`."""
        return np.asarray(self.course.at(share, start.duration, start.displacement))


@dataclass(frozen=True)
class Turned:
    """Nodes turn about an axis.

    Attributes:
        turn: The motion of the group.
    """

    turn: Turn

    places = 1
    straight = False

    def at(self, share: float, start: StepBeginning) -> Floats:
        """See `Aim.at`."""
        moved = self.turn.path(start.positions, share) - start.positions
        return np.asarray(start.displacement + moved[:, start.axis])


def aim_of(goal: Goal) -> Aim:
    """What a step gives for a component of a displacement."""
    return Along(goal) if isinstance(goal, Course) else LinearAim(goal)
