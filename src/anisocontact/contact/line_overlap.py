"""Overlaps of straight parts of edges in the plane, with derivatives by the ends of the parts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from anisocontact.base.array_types import Flags, Floats, Ints


@dataclass(frozen=True)
class Number:
    """Numbers, (q,), and their derivatives by both coordinates of four points, (q, 8).

    The points are the ends of the part of the slave, then of the master.
    """

    of: Floats
    by: Floats

    def __add__(self, other: Number) -> Number:
        return Number(self.of + other.of, self.by + other.by)

    def __mul__(self, other: Number) -> Number:
        by = self.of[:, None] * other.by + other.of[:, None] * self.by
        return Number(self.of * other.of, by)

    def __truediv__(self, other: Number) -> Number:
        share = self.of / other.of
        return Number(share, (self.by - share[:, None] * other.by) / other.of[:, None])

    def times(self, factor: Floats | float) -> Number:
        """Multiplied by what stays."""
        column = np.asarray(factor)[..., None] if np.ndim(factor) else factor
        return Number(factor * self.of, column * self.by)

    def less(self, other: Number) -> Number:
        """The difference."""
        return self + other.times(-1.0)

    def where(self, own: Flags, other: Number) -> Number:
        """These numbers, or others."""
        by = np.where(own[:, None], self.by, other.by)
        return Number(np.where(own, self.of, other.of), by)

    def take(self, which: Ints) -> Number:
        """Some of them."""
        return Number(self.of[which], self.by[which])


@dataclass(frozen=True)
class LineOverlap:
    """Parts of edges that face each other, as numbers along the part of the slave.

    Attributes:
        length: Length of the part of the slave.
        ends: Where the part of the master begins and ends on it.
        low, high: Where the overlap begins and ends.
    """

    length: Number
    ends: tuple[Number, Number]
    low: Number
    high: Number

    @classmethod
    def of(cls, x: Floats) -> LineOverlap:
        """Overlap of parts with their ends at x, (q, 4, 2), length."""
        t = x[:, 1] - x[:, 0]
        size = np.linalg.norm(t, axis=1)
        e = t / size[:, None]
        by = np.zeros((len(x), 4, 2))
        by[:, 0], by[:, 1] = -e, e
        length = Number(size, by.reshape(-1, 8))
        ends = []
        for i in (2, 3):
            r = x[:, i] - x[:, 0]
            along = np.einsum("qi,qi->q", e, r)
            turn = (r - along[:, None] * e) / size[:, None]  # by the second end of the slave
            by = np.zeros((len(x), 4, 2))
            by[:, 0], by[:, 1], by[:, i] = -e - turn, turn, e
            ends.append(Number(along, by.reshape(-1, 8)))
        first, last = ends
        back = first.of > last.of
        low, high = last.where(back, first), first.where(back, last)
        zero = length.times(0.0)
        low = low.where(low.of > 0.0, zero)
        high = high.where(high.of < length.of, length)
        return cls(length, (first, last), low, high)

    def take(self, which: Ints) -> LineOverlap:
        """Some of them."""
        first, last = (one.take(which) for one in self.ends)
        return LineOverlap(
            self.length.take(which), (first, last), self.low.take(which), self.high.take(which)
        )
