"""A trial of the points of a contact and what it started from, as multipliers see it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from anisocontact.base.array_types import Flags, Floats
from anisocontact.base.statuses import OPEN
from anisocontact.contact.frames import Frames
from anisocontact.interface import Response, State


@dataclass(frozen=True)
class ContactTrial:
    """A trial of the points and what it started from.

    Attributes:
        start: State that the trial started from, with the multipliers.
        answer: The trial.
        areas: Area of each point, (n,), length^2.
        now: Frames of the trial.
        before: Frames at the committed coordinates, in the configuration of the trial.
        axes: Axes of adhesion as the frames have them, (n, 2, 3); zero at open points.
        softness: Least stiffness of adhesion over that along each axis, (2,).
        immovable: Points that supports hold along the normal, which no multiplier can bring to no
            gap, or of which next to nothing is covered: they keep a penalty, (n,).
        slight: The latter of them, which keep one along the surface as well, (n,).
        covered: Share of the weight of each point that the master covers, above 0, (n,).
        rigidity: How many times as stiff as the penalties points are, see `Multipliers.rigidity`,
            (n, 2).
        far: Distances of the points from the origin, (n,), length.
        held: Projection on directions along which supports hold points and what they meet,
            (n, 3, 3), or none: tractions have nothing along them, multipliers have.
        closeness: Of points whose gap closes, see `Multipliers.closeness`, else infinite, (n,).
        settled: Whether all points, on all ranks, have the status of the trial that the last
            correction was linear about.
    """

    start: State
    answer: Response
    areas: Floats
    now: Frames
    before: Frames
    axes: Floats
    softness: Floats
    immovable: Flags
    slight: Flags
    covered: Floats
    rigidity: Floats
    far: Floats
    held: Floats | None
    closeness: Floats
    settled: bool = False

    @property
    def supported(self) -> Floats:
        """What of the tangential multipliers answered supports carry, (n, 3), stress."""
        if self.held is None:
            return np.zeros((len(self.start), 3))
        tangential = self.now.vector(self.answer.state["stored"])
        return np.asarray((self.held @ tangential[..., None])[..., 0])

    @property
    def kept(self) -> Floats:
        """What compliance leaves of the tractions for multipliers, normal and tangential, (n, 2).

        Several contacts would say more of one node than it can do: compliance, `SHARED_RATIO` times
        as stiff as the penalties, makes their multipliers unique. Where it is hardly felt, which of
        the contacts sticks is a matter of rounding, and corrections find no end. Where a gap closes
        friction has that of the way there.
        """
        left = self.left
        left[:, 1] *= left_by(self.closeness)
        return left

    @property
    def left(self) -> Floats:
        """The same where no gap closes, (n, 2)."""
        return np.asarray(1.0 - self.covered[:, None] / self.rigidity)

    def flexed(self, force: Floats) -> Floats:
        """Elastic slip of a force times the least stiffness of adhesion, (n, 3), stress.

        Springs of a gap that closes have one stiffness.

        Args:
            force: Along the surface where the trial is, (n, 3), stress.
        """
        along = np.einsum("nad,nd->na", self.axes, force) * (1.0 - self.softness)
        along[np.isfinite(self.closeness)] = 0.0
        return np.asarray(force - np.einsum("na,nad->nd", along, self.axes))

    @property
    def remembers(self) -> Flags:
        """Points that were in contact and have a tangential history, (n, 1)."""
        return np.asarray(self.start["status"] != OPEN)[:, None]


def left_by(closeness: Floats) -> Floats:
    """What tangential multipliers are of the friction of points so near, (n,)."""
    return np.asarray(1.0 - 1.0 / np.maximum(closeness, 1.0))
