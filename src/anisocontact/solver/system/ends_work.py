"""Work from outside on a way of which only the ends are known."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from anisocontact.base.array_types import Floats


@dataclass(frozen=True)
class EndsWork:
    """Work from outside on a way, told by both ends.

    Attributes:
        mean: That of the mean of the forces of both ends.
        missed: What this misses at most where forces on the way lie between those of both ends.
    """

    mean: float
    missed: float

    @classmethod
    def of(cls, before: float, after: float) -> EndsWork:
        """That of an energy which is one number at each end, as what a temperature gives."""
        return cls(0.5 * (before + after), 0.5 * abs(after - before))

    @classmethod
    def between(cls, before: Floats, after: Floats, way: Floats) -> EndsWork:
        """That of forces before and after on their ways, all of them (n,)."""
        mean = 0.5 * (before + after) @ way
        return cls(float(mean), float(0.5 * np.abs(after - before) @ np.abs(way)))

    def __add__(self, other: EndsWork) -> EndsWork:
        return EndsWork(self.mean + other.mean, self.missed + other.missed)
