"""Whether Krylov iterations are still worth what they save of factorisations."""

from __future__ import annotations

import numpy as np

from anisocontact.base.array_types import Ints

#: Corrections in succession that have to be dear before others are found without iterations, and
#: the most of those between two tries.
_DEAR, _MOST = 2, 16


class KrylovBackoff:
    """Tells by what corrections have cost whether iterations are tried for the next one.

    With an old factor they are lost where bodies change much between corrections, or where a
    factorisation of all unknowns costs little; with levels where they do not converge. After two
    corrections in succession that have cost more than such a factorisation two are found without,
    then four, and so on; one that costs less ends that.

    Example:
        >>> backoff = KrylovBackoff()
        >>> backoff.add(30.0, 20.0)
        >>> backoff.add(25.0, 20.0)
        >>> backoff.skips(), backoff.skips(), backoff.skips()
        (True, True, False)
    """

    def __init__(self) -> None:
        self._dear = self._left = 0

    def skips(self) -> bool:
        """Whether the next correction is to be found without iterations; it is counted."""
        skipped = self._left > 0
        self._left -= skipped
        return skipped

    def add(self, cost: float, whole: float) -> None:
        """Count a correction that iterations were tried for.

        Args:
            cost: What it has cost, with all factors made for it.
            whole: What a factorisation of all unknowns costs.
        """
        self._dear = self._dear + 1 if cost > whole else 0
        if self._dear >= _DEAR:
            self._left = min(2 ** (self._dear - 1), _MOST)

    def persistent(self) -> Ints:
        """What `restore` goes on from, (2,)."""
        return np.array([self._dear, self._left])

    def restore(self, kept: Ints) -> None:
        """Go on from what `persistent` gave."""
        self._dear, self._left = kept.tolist()
