"""Where bodies are cut open so that their largest stress is seen."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from anisocontact.base.array_types import Floats

#: Share of the nodes that the first of the ways to cut has to leave; else the one that leaves most.
ENOUGH = 0.45
#: Ways to cut: axis, and the side that is left out, from which the picture is seen.
_WAYS = ((1, -1.0), (0, -1.0), (1, 1.0), (0, 1.0))
#: Share of the size of the bodies below which a coordinate is rounding.
_NOTHING = 1e-9


@dataclass(frozen=True)
class SectionPlane:
    """A plane across an axis, in front of which bodies are left out.

    Args:
        axis: Number of the axis.
        place: Coordinate of the plane where the bodies are not deformed, length.
        side: What is left out: beyond the plane (1) or before it (-1), where it is seen from.
        opens: Whether there is anything to leave out.
    """

    axis: int
    place: float
    side: float
    opens: bool = True

    @property
    def normal(self) -> tuple[float, float, float]:
        """Unit vector to what stays."""
        x, y, z = (-self.side * (i == self.axis) for i in range(3))
        return (x, y, z)

    @property
    def towards_viewer(self) -> tuple[float, float, float]:
        """Direction to who looks at the plane, a little from the left and from above."""
        across, aside = self.side, self.side * 0.55
        return (aside, across, 0.6) if self.axis == 1 else (across, aside, 0.6)

    def __str__(self) -> str:
        """A line."""
        name, sign = "xyz"[self.axis], "+" if self.side > 0.0 else "-"
        seen = f"seen from {sign}{name}"
        if not self.opens:
            return seen
        where = f"{name} = {self.place:.3g} of the undeformed bodies"
        return f"cut open at {where}, {seen}; what is in front is left out"


def section_of(points: Floats, values: Floats) -> SectionPlane | None:
    """The cut through the largest value that leaves enough of the bodies to look at.

    Args:
        points: Nodes of the bodies, (n, 3), length.
        values: Theirs, (n,).

    Returns:
        The cut; None where nothing is in front of the largest value as bodies are always seen.
    """
    there = points[int(np.nanargmax(abs(values)))]
    rounding = _NOTHING * float(np.ptp(points, axis=0).max())
    left = [float(np.mean(side * (points[:, i] - there[i]) <= rounding)) for i, side in _WAYS]
    best = next((k for k, share in enumerate(left) if share >= ENOUGH), int(np.argmax(left)))
    axis, side = _WAYS[best]
    opens = left[best] < 1.0
    if not opens and side < 0.0:
        return None
    place = float(there[axis])
    return SectionPlane(axis, place if abs(place) > rounding else 0.0, side, opens)
