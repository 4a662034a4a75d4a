"""A rotation prescribed for a facet group or a rigid body along a step."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from anisocontact.base.amplitudes import Amplitude
from anisocontact.base.array_types import Floats
from anisocontact.base.errors import InputError
from anisocontact.base.load_curve import LoadCurve
from anisocontact.base.typed import typed
from anisocontact.mesh.placement import Rotation, check_vector

#: Places along a step at which the pace of a rotation is looked at.
_PLACES = 64


@typed
@dataclass(frozen=True)
class Turn(Rotation):
    """A rigid rotation about an axis that moves along the step, a screw motion.

    At the share s of it a point that began it at x is at
    `p + R(s angle) (x - p) + s move`, R the rotation about the axis through p.

    Attributes:
        axis: Direction of the axis, of any length but zero.
        angle: Angle turned along the step, right-handed, radian, at most a full turn.
        point: Where the axis is at the beginning of the step, length.
        angle_deg: The angle in degrees instead; may be many turns. None once taken over.
        move: How far the axis goes along the step, length.
        amplitude: s over the time since the beginning of the step, 0 at the time 0; the share of
            the step if None.
        duration: Time the step takes; a `Step` sets its own.

    Raises:
        InputError: As of `Rotation`, or the amplitude does not begin at 0.

    Example:
        >>> roll = Turn((0, 1, 0), np.pi / 2, point=(0, 0, 1), move=(np.pi / 2, 0, 0))
        >>> (roll.path(np.array([[0.0, 0.0, 0.0]]), 1.0) + 0.0).round(3).tolist()
        [[0.571, 0.0, 1.0]]
    """

    move: Sequence[float] = (0.0, 0.0, 0.0)
    amplitude: Amplitude | None = None
    duration: float = 1.0

    def __post_init__(self) -> None:
        super().__post_init__()
        check_vector("move", self.move)
        if self.amplitude is not None and (first := LoadCurve(self.amplitude).jump(0.0)):
            raise InputError(f"it begins at {first:g}, must be 0", "amplitude")

    def share(self, fraction: float) -> float:
        """The share of it that is done at a fraction of the step.

        Args:
            fraction: Fraction of the step, 0 to 1.

        Returns:
            Share of angle and way; where an amplitude leads back it may fall.
        """
        if self.amplitude is None:
            return fraction
        return float(LoadCurve(self.amplitude).at(fraction, self.duration, 0.0))

    @property
    def fastest(self) -> float:
        """Angle along the step at its fastest pace, radian."""
        if self.amplitude is None:
            return abs(self.angle)
        shares = np.array([self.share(k / _PLACES) for k in range(_PLACES + 1)])
        return float(_PLACES * np.abs(np.diff(shares)).max() * abs(self.angle))

    @property
    def vector(self) -> Floats:
        """Angle times the unit vector of the axis, (3,), radian."""
        n = np.asarray(self.axis, dtype=float)
        return np.asarray(self.angle * n / np.linalg.norm(n))

    def path(self, start: Floats, fraction: float) -> Floats:
        """Positions at a fraction of the step, (n, 3), of points that began it at `start`, (n, 3).

        Args:
            start: Positions at the beginning of the step, (n, 3), length.
            fraction: Fraction of the step.

        Returns:
            Positions, (n, 3), length.
        """
        share = self.share(fraction)
        return self.apply(start, share) + share * np.asarray(self.move, dtype=float)
