"""Line search where pressures of cells are unknowns of their own."""

from __future__ import annotations

import numpy as np

from anisocontact.base.fenicsx import Vec
from anisocontact.solver.strategies.system import System

#: Share of the linear decrease that the residual has to fall by [Armijo 1966].
ENOUGH = 1e-4
#: Least share of a correction that is tried, where a dozen halvings have gained nothing.
LEAST = 2.0**-12


class MixedSearch:
    """Halves corrections until the residual of displacement and pressure falls.

    The residual of the displacement alone has the pressure `K de(du, du)` that every correction
    leaves, and a search by it would hold back those of the mixed form, see `FollowedPressures`.

    Args:
        system: What is solved.

    Attributes:
        stuck: Whether no share of the last correction would do.
    """

    def __init__(self, system: System) -> None:
        self._system = system
        self._last: float | None = None
        self.stuck = False

    def begin(self) -> None:
        """Take it that another iteration begins."""
        self._last, self.stuck = None, False

    def share(self, x: Vec, correction: Vec, largest: float) -> float:
        """Share of a correction to take; the pressures have taken it then.

        Args:
            x: Where the system was evaluated last.
            correction: What is to be subtracted from it.
            largest: Largest share that may be taken.
        """
        followed, share = self._system.followed, largest
        assert followed is not None
        before = self._norm(x, correction, 0.0) if self._last is None else self._last
        self._last = self._norm(x, correction, share)
        # a number that is none compares as false
        while not self._last <= (1.0 - ENOUGH * share) * before and share > LEAST * largest:
            share *= 0.5
            self._last = self._norm(x, correction, share)
        self.stuck = not self._last <= before
        followed.take(share)
        return share

    def _norm(self, x: Vec, correction: Vec, share: float) -> float:
        """Residual of the mixed form where a share of a correction leads to, over all ranks."""
        followed, there = self._system.followed, x.duplicate()
        assert followed is not None
        there.waxpy(-share, correction, x)
        with followed.trial(share):
            residual = self._system.evaluate(there)
        return float(np.sqrt(x.comm.tompi4py().allreduce(float(residual @ residual))))
