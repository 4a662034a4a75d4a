"""Bodies that turn, extrapolated: a rigid motion goes on about its axis, not along its chord.

A chord leads away from the axis: a body that turns by an angle a in a sub-increment is predicted
too large by a^2, which strains it as no load does. What is no rigid motion turns with the body and
goes on as it did.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from anisocontact.base.array_types import Flags, Floats

#: Angle, radian, below which a chord serves: it strains a body by 4e-4.
TURNS = 0.02
#: Extent of a body across its length, over that, from which on it tells how it has turned.
_WIDE = 1e-3
#: Largest component of an axis across those about which bodies may turn.
_ALONG = 1e-6


@dataclass(frozen=True)
class RigidWay:
    """The rigid motion next to that of some points: a turn about an axis, and a way along it.

    Attributes:
        axis: Direction of the axis, (3,).
        angle: Of the turn, radian, positive.
        point: On the axis, (3,), length.
        along: Way along the axis, (3,), length.
    """

    axis: Floats
    angle: float
    point: Floats
    along: Floats

    def turned(self, vectors: Floats, share: float) -> Floats:
        """Vectors turned by a share of the angle, (n, 3) [Rodrigues]."""
        a, angle = self.axis, share * self.angle
        along = np.outer(vectors @ a, a)
        across = vectors - along
        turned = along + np.cos(angle) * across + np.sin(angle) * np.cross(a, vectors)
        return np.asarray(turned)

    def moved(self, points: Floats, share: float) -> Floats:
        """Points after a share of the motion, (n, 3)."""
        return self.point + share * self.along + self.turned(points - self.point, share)


def rigid_way(before: Floats, after: Floats, total: Callable[[Any], Any]) -> RigidWay | None:
    """The rigid motion that is closest to the motion of points, in the mean of squares; collective.

    Its turn is the rotation in the polar decomposition of the sum of `(after) (before)^T`, both
    from their means [Kabsch 1976].

    Args:
        before: Where this rank's points were, (n, 3), length.
        after: Where they are, (n, 3), length.
        total: Sum over all ranks.

    Returns:
        The motion; None where it turns by less than `TURNS`, or the points lie on a line.

    Example:
        >>> points = np.array([[1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 0.0]])
        >>> way = rigid_way(points, points[:, [1, 0, 2]] * [-1.0, 1.0, 1.0], lambda x: x)
        >>> float(round(np.degrees(way.angle), 9)), way.axis.round(9).tolist()
        (90.0, [0.0, 0.0, 1.0])
    """
    sums = total(np.array([*before.sum(axis=0), *after.sum(axis=0), len(before)]))
    start, end = sums[:3] / max(sums[6], 1.0), sums[3:6] / max(sums[6], 1.0)
    left, sizes, right = np.linalg.svd(total((after - end).T @ (before - start)))
    if not sizes[1] > _WIDE**2 * sizes[0]:
        return None
    mirror = np.array([1.0, 1.0, np.linalg.det(left @ right)])
    rotation = (left * mirror) @ right
    axial = 0.5 * (rotation[[2, 0, 1], [1, 2, 0]] - rotation[[1, 2, 0], [2, 0, 1]])
    sine = float(np.linalg.norm(axial))
    angle = float(np.arctan2(sine, 0.5 * (np.trace(rotation) - 1.0)))
    if not (angle > TURNS and sine > _WIDE):  # half a turn has no axis to be told
        return None
    axis = axial / sine
    along = ((end - start) @ axis) * axis
    across = end - start - along
    point = 0.5 * (start + end) + np.cross(axis, across) / (2.0 * np.tan(0.5 * angle))
    return RigidWay(axis, angle, point, along)


def turned_on(
    before: Floats, after: Floats, ratio: float, total: Callable[[Any], Any], about: Flags
) -> Floats | None:
    """Where points come to if they move on as they did; collective.

    Args:
        before: Where this rank's points were, (n, 3), length.
        after: Where they are, (n, 3), length.
        ratio: Size of the next sub-increment over that of the last one.
        total: Sum over all ranks.
        about: Whether a turn about each axis is a rigid motion: that of a section of a body of
            revolution is none, (3,).

    Returns:
        (n, 3), length; None where they hardly turn, see `rigid_way`, or not as a rigid body.
    """
    way = rigid_way(before, after, total)
    if way is None or np.abs(way.axis[~about]).max(initial=0.0) > _ALONG:
        return None
    strained = after - way.moved(before, 1.0)
    return way.moved(after, ratio) + ratio * way.turned(strained, ratio)
