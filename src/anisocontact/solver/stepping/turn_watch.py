"""How far points in contact turn along one sub-increment, and what that allows.

A step follows the path of a point to second order in the angle by which normal, axes of adhesion or
the slave turn along it, see `FOLLOWED`. It is the tangential force of a contact that has to be
right: points that turn further pass where they have a small share of it, see `Contact.turn`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from anisocontact.base.limits import FOLLOWED
from anisocontact.solver.stepping.acceptance import Refusal
from anisocontact.solver.system.problem import Problem
from anisocontact.solver.terms.persistent import Arrays

#: Share of `FOLLOWED` that is let pass: sub-increments are sized for the limit itself.
MARGIN = 1.05
#: Prescribed rotation along a sub-increment at most: more could pass for another one, radian.
PRESCRIBED = math.radians(45.0)
#: Share of its angle that a sub-increment of at most a share of the size of one that was refused
#: keeps at least where it does not depend on the size: where a point passes from one facet to
#: another one at an angle, in this one or in a later one. On surfaces, which have
#: none, more.
_KINK, _ON_SURFACES, _SMALLER = 0.6, 0.75, 0.5
#: Turn over size of a sub-increment, over that of one that was refused, from which on the next one
#: is no larger than its refusal lets it be: points turn by more in the second half of a
#: sub-increment.
_AS_FAST = 0.5
#: Names in a checkpoint of the kink, and of angle and size of what was refused.
_KEPT = ("place.kink", "place.refused_angle", "place.refused_size")


@dataclass(frozen=True)
class PathTurn:
    """The largest angle by which a contact turns.

    Attributes:
        angle: Of normal, axes or slave, see `Contact.turn`, radian.
        contact: Name of the contact.
        meshed: Whether its master is facets.
    """

    angle: float
    contact: str
    meshed: bool = False

    @property
    def reason(self) -> str:
        """Why a sub-increment is cut, in a line."""
        return (
            f"contact {self.contact!r} turns by {math.degrees(self.angle):.0f} degrees in it, "
            f"{math.degrees(FOLLOWED):.0f} are followed well"
        )


def half_turns(prescribed: float, smallest: float) -> str:
    """Why an increment cannot be followed that may not be cut enough; empty if it can.

    From half a turn on friction would be that of a turn the other way.

    Args:
        prescribed: Rotation of a body or facet group that an increment prescribes, radian.
        smallest: Smallest sub-increment, share of an increment.
    """
    part = prescribed * smallest
    if part < math.pi * (1.0 - 1e-9):
        return ""
    return (
        f"{math.degrees(part):.0f} degrees of rotation are prescribed in the smallest "
        f"sub-increment that is allowed, {smallest:g} of the increment: from 180 on nobody can "
        "tell which way it turns; "
        "take more increments, or let sub-increments be smaller (smallest_increment)"
    )


def largest_turn(problem: Problem) -> PathTurn:
    """The largest turn of the trial, over all ranks; collective."""
    found = PathTurn(0.0, "")
    for contact in problem.contacts:
        angle = contact.turn()
        if angle > found.angle:
            found = PathTurn(angle, contact.name, contact.meshed)
    return found


class TurnWatch:
    """Says whether a sub-increment turns too far, and how large the next one may be.

    Attributes:
        permitted: Whether sub-increments may be cut: not at the limits of the cuts.
        objects: Whether the last sub-increment was objected to.
        kink: Angle up to which turns did not depend on the size of the sub-increments of this step,
            radian.
        refused: Angle, radian, and time increment of the last sub-increment of this step that was
            refused.
    """

    def __init__(self) -> None:
        self.permitted, self.objects = True, False
        self.begin()

    def begin(self) -> None:
        """Forget what another step has shown."""
        self.kink, self._angle, self._size = 0.0, 0.0, 0.0
        self.refused = (0.0, 0.0)

    def objection(self, problem: Problem) -> Refusal | None:
        """Why a trial is to be cut; None where it may be accepted. Collective."""
        turned = largest_turn(problem)
        self._angle, self._size = turned.angle, problem.dt
        angle, size = self.refused
        kept = _KINK if turned.meshed else _ON_SURFACES
        if turned.angle > kept * angle and problem.dt <= _SMALLER * size:
            self.kink = max(self.kink, 1.1 * turned.angle)  # cutting does not make it smaller
        if not self.permitted or turned.angle <= max(MARGIN * FOLLOWED, self.kink):
            return None
        self.refused, self.objects = (turned.angle, problem.dt), True
        return Refusal(turned.reason)

    def allowed(self, part: float) -> float:
        """Size of the next sub-increment after one that was accepted, share of an increment."""
        if self._angle <= self.kink:
            return 1.0
        angle, size = self.refused
        if angle > self.kink and self._angle * size > _AS_FAST * angle * self._size:
            return part * size / self._size * FOLLOWED / angle
        return 1.0 if self._angle <= 0.5 * FOLLOWED else part * FOLLOWED / self._angle

    def persistent(self) -> Arrays:
        """What this step has shown, as arrays by name."""
        numbers = (self.kink, *self.refused)
        return {name: np.array(number) for name, number in zip(_KEPT, numbers, strict=True)}

    def restore(self, kept: Arrays) -> None:
        """Go on from what `persistent` gave."""
        self.kink, *refused = (kept[name].item() for name in _KEPT)
        self.refused = (refused[0], refused[1])
