"""How far increments that fail may be cut."""

from __future__ import annotations

import math
from dataclasses import dataclass

from anisocontact.base.errors import InputError
from anisocontact.base.typed import typed

#: Increments beyond which a step has no end.
MOST_INCREMENTS = 10_000_000
#: Angle by which normal, axes of adhesion or slave may turn along a step at points in contact,
#: radian: the tangential force is off by some tenths of a per cent.
FOLLOWED = math.radians(15.0)


@typed
@dataclass(frozen=True)
class Limits:
    """Bounds of the load increments, as shares of the increments that a step asks for.

    Attributes:
        smallest: A sub-increment that failed is not cut below this, > 0.
        largest: Largest sub-increment, at most 1: the end of every increment of a step is met
            exactly.
        cuts: Largest number of cuts within one increment, >= 0.

    Raises:
        InputError: A value is out of range.

    Example:
        >>> Limits(largest=0.5).smallest
        0.0001
    """

    smallest: float = 1e-4
    largest: float = 1.0
    cuts: int = 50

    def __post_init__(self) -> None:
        if not 0.0 < self.largest <= 1.0:
            raise InputError(
                f"{self.largest!r} given, must be > 0 and at most 1", "largest_increment"
            )
        if not 0.0 < self.smallest <= self.largest:
            raise InputError(
                f"{self.smallest!r} given, must be > 0 and at most the largest, {self.largest!r}",
                "smallest_increment",
            )
        if self.cuts < 0:
            raise InputError(f"{self.cuts!r} given, must be >= 0", "cuts")
