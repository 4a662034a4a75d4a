"""A turn about a line, from one cut face of a sector to the other."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from anisocontact.base.array_types import Floats

#: Cosine, and distance over that from the origin, by which lines that are one may differ.
SAME_LINE = 1e-9


@dataclass(frozen=True)
class Turning:
    """A turn about a line.

    Attributes:
        axis: Direction of the line, a unit vector.
        point: A point of the line, length.
        angle: Angle, right-handed about the axis, radian.
    """

    axis: tuple[float, float, float]
    point: tuple[float, float, float]
    angle: float

    @property
    def matrix(self) -> Floats:
        """What turns vectors, Q, (3, 3): exactly along axes of space about one of them."""
        x, y, z = self.axis
        cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
        c, s = math.cos(self.angle), math.sin(self.angle)
        return np.asarray(np.eye(3) + s * cross + (1.0 - c) * cross @ cross)

    @property
    def mixed(self) -> tuple[int, ...]:
        """The axes of space that the turn mixes."""
        along = [i for i, share in enumerate(self.axis) if share]
        return tuple(i for i in range(3) if len(along) > 1 or i != along[0])

    @property
    def frame(self) -> Floats:
        """Three unit vectors, the last one along the axis, (3, 3): axes of space where it is."""
        along = np.array(self.axis)
        first = np.eye(3)[(int(np.argmax(np.abs(along))) + 1) % 3]
        first = first - (first @ along) * along
        first /= np.linalg.norm(first)
        return np.array([first, np.cross(along, first), along])

    @property
    def name(self) -> str:
        """The direction of the axis in words."""
        if len(self.mixed) == 2:
            return "xyz"[int(np.flatnonzero(self.axis)[0])]
        return "(" + ", ".join(f"{v:.4g}" for v in self.axis) + ")"

    @property
    def text(self) -> str:
        """The turn in words."""
        at = ", ".join(f"{v:g}" for v in self.point)
        degrees = f"{math.degrees(self.angle):.6g} degrees"
        if len(self.mixed) == 2:
            return f"turned by {degrees} about {self.name} ({at})"
        return f"turned by {degrees} about the direction {self.name} at ({at})"

    def along(self, direction: Sequence[float] | Floats) -> bool:
        """Whether a direction of any length is that of the axis."""
        cosine = abs(float(np.dot(self.axis, direction))) / float(np.linalg.norm(direction))
        return cosine > 1.0 - SAME_LINE

    def about(self, axis: Sequence[float], point: Sequence[float]) -> bool:
        """Whether a line through a point, along a direction of any length, is the axis."""
        apart = float(self.distance(np.asarray(point, dtype=float)[None])[0])
        size = max(1.0, float(np.abs(self.point).max()))
        return self.along(axis) and apart <= SAME_LINE * size

    @property
    def repeats(self) -> int:
        """How many of these turns make a whole one."""
        return round(2.0 * math.pi / abs(self.angle))

    def times(self, count: int) -> Turning:
        """So many of these turns, back if negative."""
        return replace(self, angle=count * self.angle)

    def same_as(self, other: Turning) -> bool:
        """Whether another turn brings all points to the same places."""
        size = max(1.0, float(np.abs(self.point).max()))
        origin = np.zeros((1, 3))
        apart = np.abs(self.of(origin) - other.of(origin)).max()
        turned = np.abs(self.matrix - other.matrix).max()
        return bool(turned <= SAME_LINE and apart <= SAME_LINE * size)

    def of(self, x: Floats) -> Floats:
        """Where points go, (n, 3), length."""
        return np.asarray((x - self.point) @ self.matrix.T + self.point)

    def distance(self, x: Floats) -> Floats:
        """Of points from the line, (n,), length."""
        return np.asarray(np.linalg.norm((x - self.point) @ self.frame[:2].T, axis=1))
