"""A rotation that a facet group or a rigid body is led through along a step."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from anisocontact.mesh.placement import Rotation, check_vector

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Turn(Rotation):
    """A screw motion: a rotation about an axis that moves along the step.

    At the share s of the step a point that began it at x is at
    `p + R(s angle) (x - p) + s move`, R the rotation about the axis through p.

    Attributes:
        axis: Direction of the axis, of any length but zero.
        angle: Angle turned along the step, right-handed, radian, at most a full turn.
        point: Where the axis is at the beginning of the step, length.
        angle_deg: The angle in degrees instead; may be many turns. None once taken over.
        move: How far the axis goes along the step, length.

    Raises:
        InputError: As of `Rotation`.

    Example:
        >>> roll = Turn((0, 1, 0), np.pi / 2, point=(0, 0, 1), move=(np.pi / 2, 0, 0))
        >>> (roll.path(np.array([[0.0, 0.0, 0.0]]), 1.0) + 0.0).round(3).tolist()
        [[0.571, 0.0, 1.0]]
    """

    move: Sequence[float] = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        super().__post_init__()
        check_vector("move", self.move)

    @property
    def vector(self) -> Floats:
        """Angle times the unit vector of the axis, (3,), radian."""
        n = np.asarray(self.axis, dtype=float)
        return np.asarray(self.angle * n / np.linalg.norm(n))

    def path(self, start: Floats, share: float) -> Floats:
        """Positions at a share of the step, (n, 3), of points that began it at `start`, (n, 3).

        Args:
            start: Positions at the beginning of the step, (n, 3), length.
            share: Share of the step.

        Returns:
            Positions, (n, 3), length.
        """
        return self.apply(start, share) + share * np.asarray(self.move, dtype=float)
