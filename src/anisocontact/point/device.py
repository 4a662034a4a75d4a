"""Devices: what a load does in one step, as a function of the trial position."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.errors import InputError
from anisocontact.point.foot import Foot

#: Frames of a force or direction that is given by components.
FRAMES = ("space", "friction", "adhesion", "coordinates")


@dataclass(frozen=True)
class Committed:
    """What a load may look at: the accepted state of the group before the step.

    Args:
        time: Time of that state.
        position: The reference, (3,).
        foot: Its foot.
        friction_axes: Axes under the first point, (2, 3); zero where it is open.
        adhesion_axes: Likewise.
        stiffness: Largest tangential stiffness met so far [force/length]; 0 before any contact.
    """

    time: float
    position: Floats
    foot: Foot
    friction_axes: Floats
    adhesion_axes: Floats
    stiffness: float


@dataclass(frozen=True)
class Action:
    """What the load does at a trial position, linear in it.

    Args:
        force: Force on the reference, (3,) [force].
        d_position: Its derivative with respect to the reference, (3, 3).
        d_size: Its derivative with respect to the unknown size, (3,); None if there is none.
        aim: Foot the reference is held above; None if forces decide.
        advance: Direction and length the reference moves, for an unknown size.
    """

    force: Floats
    d_position: Floats
    d_size: Floats | None = None
    aim: Floats | None = None
    advance: tuple[Floats, float] | None = None


class Device:
    """The device of a step as a function of the trial position; the base holds a place."""

    def __init__(self, aim: Floats | None = None) -> None:
        self.aim = aim

    def at(self, x: Floats, size: float) -> Action:
        """Force and derivatives at the trial reference x, (3,)."""
        return Action(np.zeros(3), np.zeros((3, 3)), aim=self.aim)

    def energy(self, x: Floats) -> float:
        """Elastic energy of the device."""
        return 0.0

    def dissipation(self, x: Floats) -> float:
        """Energy a regularisation dissipates in the step."""
        return 0.0

    def free_end(self, x: Floats) -> Floats:
        """Point that is prescribed: the free end of a spring, else the reference, (3,)."""
        return x


class FixedPlace(Device):
    """The reference where the path says, with its penetration."""

    def __init__(self, place: Floats) -> None:
        super().__init__()
        self.place = place

    def at(self, x: Floats, size: float) -> Action:
        """No force: the place decides."""
        return Action(np.zeros(3), np.zeros((3, 3)), aim=self.place)


class DraggedSpring(Device):
    """A linear spring to a free end.

    Args:
        stiffness: Matrix k, (3, 3) [force/length].
        end: Free end, (3,).
    """

    def __init__(self, stiffness: Floats, end: Floats) -> None:
        super().__init__()
        self.stiffness, self.end = stiffness, end

    def at(self, x: Floats, size: float) -> Action:
        """F = k (end - x)."""
        return Action(self.stiffness @ (self.end - x), -self.stiffness)

    def energy(self, x: Floats) -> float:
        """Half of the elongation times the force."""
        d = self.end - x
        return float(0.5 * d @ self.stiffness @ d)

    def free_end(self, x: Floats) -> Floats:
        """The free end, (3,)."""
        return self.end


class Dashpot(Device):
    """A dead load beside a dashpot.

    Args:
        force: The dead load, (3,) [force].
        viscosity: Of the dashpot [force*time/length].
        before: Reference before the step, (3,).
        dt: Time step.
    """

    def __init__(self, force: Floats, viscosity: float, before: Floats, dt: float) -> None:
        super().__init__()
        self.force, self.before = force, before
        self.rate = viscosity / dt

    def at(self, x: Floats, size: float) -> Action:
        """The force less that of the dashpot."""
        return Action(self.force - self.rate * (x - self.before), -self.rate * np.eye(3))

    def dissipation(self, x: Floats) -> float:
        """Work of the dashpot."""
        d = x - self.before
        return float(self.rate * d @ d)


class Advance(Device):
    """A force of unknown size that moves the reference along its direction.

    Args:
        direction: Unit vector of the force, (3,).
        before: Reference before the step, (3,).
        step: Length to be moved along it.
    """

    def __init__(self, direction: Floats, before: Floats, step: float) -> None:
        super().__init__()
        self.direction, self.before, self.step = direction, before, step

    def at(self, x: Floats, size: float) -> Action:
        """The force of the size, and what is left of the length."""
        left = self.step - float(self.direction @ (x - self.before))
        return Action(
            size * self.direction,
            np.zeros((3, 3)),
            d_size=self.direction,
            advance=(self.direction, left),
        )


def in_space(components: Floats, frame: str, before: Committed) -> Floats:
    """Components in a frame as a vector in space, (3,).

    Raises:
        InputError: The frame is that of a law, and the point is open.
    """
    if frame == "space":
        return components
    if frame == "coordinates":
        basis = before.foot.basis
        return components @ (basis / np.linalg.norm(basis, axis=1)[:, None])
    axes = before.friction_axes if frame == "friction" else before.adhesion_axes
    if not axes.any():
        raise InputError(
            f"the {frame} axes are needed at time {before.time:g}, where the point is open",
            field="frame",
        )
    return components @ axes
