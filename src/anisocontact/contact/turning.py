"""A turn about a line along x, y or z, from one cut face of a sector to the other."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

#: Cosine, and distance over that from the origin, by which lines that are one may differ.
SAME_LINE = 1e-9

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Turning:
    """A turn about a line along an axis of space.

    Attributes:
        axis: Number of the axis, 0 to 2.
        point: A point of the line, length.
        angle: Angle, right-handed about the axis, radian.
    """

    axis: int
    point: tuple[float, float, float]
    angle: float

    @property
    def matrix(self) -> Floats:
        """What turns vectors, Q, (3, 3)."""
        found = np.eye(3)
        a, b = self.across
        c, s = math.cos(self.angle), math.sin(self.angle)
        found[[a, b], [a, b]] = c
        found[a, b], found[b, a] = -s, s
        return found

    @property
    def across(self) -> tuple[int, int]:
        """The two axes of space that the turn mixes, right-handed."""
        return (self.axis + 1) % 3, (self.axis + 2) % 3

    @property
    def text(self) -> str:
        """The turn in words."""
        at = ", ".join(f"{v:g}" for v in self.point)
        return f"turned by {math.degrees(self.angle):.6g} degrees about {'xyz'[self.axis]} ({at})"

    def about(self, axis: Sequence[float], point: Sequence[float]) -> bool:
        """Whether a line through a point, along a direction of any length, is the axis."""
        along = np.abs(np.asarray(axis, dtype=float) / np.linalg.norm(axis))
        apart = float(self.distance(np.asarray(point, dtype=float)[None])[0])
        size = max(1.0, float(np.abs(self.point).max()))
        return bool(along[self.axis] > 1.0 - SAME_LINE and apart <= SAME_LINE * size)

    def of(self, x: Floats) -> Floats:
        """Where points go, (n, 3), length."""
        return np.asarray((x - self.point) @ self.matrix.T + self.point)

    def distance(self, x: Floats) -> Floats:
        """Of points from the line, (n,), length."""
        return np.asarray(np.linalg.norm((x - self.point)[:, list(self.across)], axis=1))
