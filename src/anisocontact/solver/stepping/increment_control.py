"""How large the next sub-increment is: cut back after a failure, grown after success."""

from __future__ import annotations

import math
from dataclasses import dataclass

from anisocontact.base.limits import Limits
from anisocontact.contact.multiplier_schemes import USUAL

#: What is left of a sub-increment that failed.
CUT = 0.25
#: What a sub-increment grows by.
GROWTH = 2.0
#: Sub-increments in a row that have to converge before the next one grows; at most, where what they
#: grow to has failed again and again: each time twice as many.
STREAK, LONGEST_STREAK = 2, 16
#: Times what a size may be short of another one to count as large: sub-increments fill an increment
#: evenly.
SAME = 1.1
#: Share of an increment at which smaller sub-increments are not likely to help.
SMALL = 0.01
#: Newton iterations beyond which a sub-increment was hard enough not to grow.
HARD = 15


@dataclass
class IncrementControl:
    """Goes through the increments of a step in sub-increments, whose sizes are shares of one.

    Args:
        limits: Bounds of the sub-increments.
        size: Size that the next sub-increment should have.

    Attributes:
        increment: Number of the increment that is worked at, from 1.
        done: Share of it that is done.
        last: Size of the last sub-increment that converged, 0 at the start of a step.
        streak: Sub-increments in a row that converged.
        failed: Size of the last sub-increment that failed, 0 where one as large has converged
            since.
        wait: Sub-increments in a row that have to converge before one is as large as that again.
        cuts: Number of cuts within this increment.
        relaxed: Whether penalties held in the last sub-increment, as no multipliers were found.
        way: Scheme that led to the multipliers of the last sub-increment, see `multiplier_schemes`.
        goal: Share of the increment at which the next sub-increment ends, if it is that large; 0
            for none.

    Example:
        >>> limits = Limits()
        >>> control = IncrementControl(limits, limits.largest)
        >>> control.cut(), control.end
        (True, 0.25)
        >>> control.advance(iterations=3)
        >>> control.done, control.end
        (0.25, 0.5)
    """

    limits: Limits
    size: float
    increment: int = 1
    done: float = 0.0
    last: float = 0.0
    streak: int = 0
    failed: float = 0.0
    wait: int = STREAK
    cuts: int = 0
    relaxed: bool = False
    way: str = USUAL
    goal: float = 0.0

    @property
    def end(self) -> float:
        """Where the next one ends: those up to the end of the increment, 1, are equal."""
        left = 1.0 - self.done
        # Round-off in a size is no reason for one more sub-increment.
        count = math.ceil(left / self.size * (1.0 - 1e-9))
        end = 1.0 if count <= 1 else self.done + left / count
        return min(end, self.goal) if self.goal > 0.0 else end

    @property
    def part(self) -> float:
        """Size of the next sub-increment."""
        return self.end - self.done

    @property
    def tiny(self) -> bool:
        """Whether a sub-increment smaller than the next one is not likely to help."""
        return self.part <= max(SMALL, self.limits.smallest)

    @property
    def small(self) -> bool:
        """Whether the next sub-increment is tiny, or the last one that may be tried."""
        return self.tiny or self.cuts >= self.limits.cuts

    @property
    def cuttable(self) -> bool:
        """Whether the limits allow to make the next sub-increment smaller."""
        return self.cuts < self.limits.cuts and self.part > self.limits.smallest

    @property
    def may_relax(self) -> bool:
        """Whether penalties may hold in the next one: a cut has not led to multipliers."""
        return self.small or self.relaxed or self.cuts > 0

    def bound(self, size: float) -> None:
        """Make the next sub-increments no larger than a size, as far as the limits allow."""
        self.size = min(self.size, max(size, self.limits.smallest))

    def advance(self, iterations: int, relaxed: bool = False, way: str = USUAL) -> None:
        """Go on behind a sub-increment that has converged.

        Args:
            iterations: Newton iterations that it took.
            relaxed: Whether penalties held in it.
            way: Scheme that led to its multipliers.
        """
        end, self.last = self.end, self.part
        self.relaxed, self.way = relaxed, way
        self.done, self.goal = end, 0.0
        self.streak += 1
        if self._as_large_as_failed(self.last):
            self.failed, self.wait = 0.0, STREAK
        larger = min(GROWTH * self.size, self.limits.largest)
        enough = self.wait if self._as_large_as_failed(larger) else STREAK
        if self.streak >= enough and iterations <= HARD:
            self.size = larger
        if end == 1.0:
            self.increment += 1
            self.done = 0.0
            self.cuts = 0

    def cut(self) -> bool:
        """Cut the next sub-increment; False, and nothing changed, where a limit forbids it."""
        if not self.cuttable:
            return False
        again = self._as_large_as_failed(self.part)
        self.wait = min(2 * self.wait, LONGEST_STREAK) if again else STREAK
        self.failed = self.part
        self.size = max(CUT * self.part, self.limits.smallest)
        self.cuts += 1
        self.streak = 0
        return True

    def _as_large_as_failed(self, size: float) -> bool:
        """Whether a size is that which failed last, or more; equal ones fill an increment."""
        return 0.0 < self.failed <= SAME * size
