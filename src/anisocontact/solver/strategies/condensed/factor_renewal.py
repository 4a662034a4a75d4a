"""When a factor that preconditions a matrix which moves away from it is to be made anew."""

from __future__ import annotations

import numpy as np

from anisocontact.base.array_types import Floats

#: Cost of a decimal over that with the factor before up to which the new one has helped.
_HELPED = 0.5


class FactorRenewal:
    """What corrections have cost since a factor was made, in solutions with it.

    A new factor is due where a decimal of the residual costs more now than on average since the
    last one was made, with that factor counted in: no other moment to make the next one costs less
    in the long run, as long as the cost grows with the age of the factor. It does not where all has
    changed at once after the factor was made: a new one is also due where corrections have cost
    more than with a new one, by what one costs to make. Where the next one has then not helped, it
    may lose twice as much.

    Args:
        last: Corrections whose cost is the cost of now.
        margin: How far above the average it has to be, as it scatters.
        fresh: Cost of a decimal with a factor that is new; it is not asked for if not given.

    Attributes:
        spent: Cost of the factor and decimals that it gained, none, then those of each correction.

    Example:
        >>> renewal = FactorRenewal(1, 1.0)
        >>> renewal.begin(10.0)
        >>> for used in (2, 4, 8, 16):
        ...     renewal.add(used, 1e-4)
        ...     print(renewal.due)
        False
        False
        False
        True
    """

    def __init__(self, last: int, margin: float, fresh: float | None = None) -> None:
        self._last, self._margin, self._fresh = last, margin, fresh
        # own costs of a factor that corrections may lose with it, and cost of a decimal before it
        self._allowed, self._before = 1.0, np.inf
        self.spent: list[tuple[float, float]] = []
        self._ahead = 0.0

    def begin(self, cost: float) -> None:
        """Take it that a factor has been made.

        Args:
            cost: What it has cost, in solutions.
        """
        if self._wasted:
            used, gained = np.sum(self.spent[1:], axis=0)
            now = float(used / max(gained, 1.0))
            self._allowed = 2.0 * self._allowed if now > _HELPED * self._before else 1.0
            self._before = now
        self.spent, self._ahead = [(cost, 0.0)], 0.0

    def spend(self, cost: float) -> None:
        """Count what the next correction costs beside its iterations, in solutions."""
        self._ahead += cost

    def add(self, cost: float, left: float) -> None:
        """Count a correction.

        Args:
            cost: What it has cost, in solutions.
            left: Residual over the right-hand side.
        """
        self.spent.append((cost + self._ahead, -np.log10(max(left, 1e-16))))
        self._ahead = 0.0

    @property
    def due(self) -> bool:
        """Whether a new factor pays."""
        total, last = np.sum(self.spent, axis=0), np.sum(self.spent[-self._last :], axis=0)
        dearer = last[0] * total[1] > self._margin * last[1] * total[0]
        return len(self.spent) > self._last and bool(dearer or self._wasted)

    @property
    def _wasted(self) -> bool:
        """Whether corrections have cost more than with new factors, by what one of those costs."""
        if self._fresh is None or not self.spent:
            return False
        (own, _), *since = self.spent
        lost = sum(max(cost - self._fresh * gained, 0.0) for cost, gained in since)
        return lost > self._allowed * own

    def persistent(self) -> Floats:
        """What `restore` goes on from, (k, 2)."""
        return np.array([(self._allowed, self._before), *self.spent])

    def restore(self, kept: Floats) -> None:
        """Go on from what `persistent` gave."""
        (self._allowed, self._before), *self.spent = map(tuple, kept.tolist())
