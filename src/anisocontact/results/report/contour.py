"""The outline of a slave in the plane: its points one after the other."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from anisocontact.base.array_types import Flags, Floats, Ints
from anisocontact.results.dataset import DataSet

#: Share of the size of an outline by which a coordinate may turn back as rounding does.
_ROUNDING = 1e-9


@dataclass(frozen=True)
class Contour:
    """Points of a slave along it.

    Args:
        order: Their numbers from one end to the other, or once around, (n,).
        closed: Whether the last one is beside the first.
    """

    order: Ints
    closed: bool

    def folds(self, along: Floats) -> bool:
        """Whether a coordinate of the points, (n,), goes forth and back on the way."""
        steps = np.diff(along[self.order])
        least = _ROUNDING * float(np.ptp(along))
        return self.closed or bool((steps > least).any() and (steps < -least).any())

    def way(self, position: Floats) -> Floats:
        """Distance along the outline from its first point to each, (n,), length."""
        steps = np.linalg.norm(np.diff(position[self.order], axis=0), axis=1)
        found = np.empty(len(position))
        found[self.order] = np.concatenate([[0.0], np.cumsum(steps)])
        return found

    def opened(self, touching: Flags) -> Contour:
        """The same beginning far from contact, where it goes once around."""
        if not self.closed or touching.all() or not touching.any():
            return self
        closed = np.flatnonzero(touching[self.order])
        gaps = np.diff(np.append(closed, closed[0] + len(self.order)))
        widest = int(np.argmax(gaps))
        start = closed[widest] + gaps[widest] // 2
        return Contour(np.roll(self.order, -start), closed=True)


def contour_of(points: DataSet, chosen: Flags) -> Contour | None:
    """The outline that lines between the chosen points make.

    Args:
        points: All slave points.
        chosen: Which of them, (points,).

    Returns:
        The outline; None where there are no lines, or they are not one chain of all these points.
    """
    lines = points.cells.get("Lines")
    if lines is None or not len(lines["connectivity"]):
        return None
    beside: list[list[int]] = [[] for _ in range(int(chosen.sum()))]
    number = np.cumsum(chosen) - 1
    for first, last in pairwise(lines["offsets"].tolist()):
        for a, b in pairwise(lines["connectivity"][first:last].tolist()):
            if chosen[a] and chosen[b]:
                beside[number[a]].append(int(number[b]))
                beside[number[b]].append(int(number[a]))
    ends = [i for i, near in enumerate(beside) if len(near) == 1]
    if len(ends) not in (0, 2) or any(len(near) not in (1, 2) for near in beside):
        return None
    chain = _chain(beside, ends[0] if ends else 0)
    return Contour(np.array(chain), closed=not ends) if len(chain) == len(beside) else None


def _chain(beside: list[list[int]], start: int) -> list[int]:
    """Points from one on, each beside the last one."""
    chain, before, here = [start], -1, start
    while True:
        after = next((i for i in beside[here] if i != before), start)
        if after == start:
            return chain
        chain.append(after)
        before, here = here, after
