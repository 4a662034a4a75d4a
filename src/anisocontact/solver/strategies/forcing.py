"""How precise corrections of Newton's method have to be where a Krylov method finds them."""

from __future__ import annotations

import numpy as np

from anisocontact.solver.strategies.system import System

#: Residual of a correction over its right-hand side that is asked for at most.
_FINEST = 1e-13
#: Forces that a correction may leave, over the smallest ones at work since the increment began,
#: or since the last one did.
_LEFT = 3e-4
_TINY = float(np.finfo(np.float64).tiny)


class Forcing:
    """Forcing terms of inexact Newton methods [Eisenstat Walker 1996].

    Newton squares the residual: no correction has to be better than that or than asked for; one
    that is rough takes points of a stiff contact from one status to another and back. Neither does
    the share of a residual say enough where an iterate is far off: pressures of bodies that keep
    their volume are then 1e5 times the loads, and what is left of them would be as large as these.

    Args:
        tolerance: Residual over the forces at work at which Newton stops.
        rough: Residual of a correction over its right-hand side, far from the solution.
        careful: The same where the last one has not brought the forces nearer to balance.
        fine: The same where multipliers follow, over the forces out of balance.
    """

    def __init__(
        self, tolerance: float, rough: float = 1e-2, careful: float = 1e-5, fine: float = 1e-5
    ) -> None:
        self.tolerance, self._rough, self._careful, self._fine = tolerance, rough, careful, fine
        self._before = self._least = self._earlier = np.inf

    def begin(self, pressed: bool = False) -> None:
        """Take it that an increment begins.

        Args:
            pressed: Whether it may begin with pressures that mean nothing, as where bodies that
                keep their volume are extrapolated: forces at work are those of the last one then.
        """
        self._earlier = self._least if pressed else np.inf
        self._before = self._least = np.inf

    def rtol(self, system: System, size: float) -> float:
        """Residual of the next correction over its right-hand side, at most.

        Args:
            system: The system at its last evaluation.
            size: Norm of the right-hand side, force.
        """
        self._least = min(self._least, system.balance.force_scale or np.inf)
        share, least = self._share(system, size), min(self._least, self._earlier)
        if size <= least:
            return share
        return min(share, max(_LEFT * least / size, _FINEST))

    def _share(self, system: System, size: float) -> float:
        """What the residual of now allows for."""
        relative = size / max(system.balance.force_scale, _TINY)
        rough = self._rough if relative < self._before else self._careful
        self._before = 0.5 * relative
        if system.contact_term.simultaneous:
            # forces that take violations away are large beside those that are out of balance
            return max(self._fine * min(system.balance.norm / max(size, _TINY), 1.0), _FINEST)
        # forces in balance may wait for what is prescribed: a correction is found then, too
        enough = min(0.1 * self.tolerance / max(relative, _TINY), self._rough)
        return max(min(rough, relative), enough)
