"""The gap that gives a pressure."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.shown import shown
from anisocontact.point.balance import PointBalance, StepError, Trial
from anisocontact.point.foot import foot


def pressed(balance: PointBalance, guess: Floats) -> Trial:
    """The guess, moved along its normal until the resultant pressure is the one that is given.

    The pressure grows with the penetration, so a bracketed Newton iteration in the gap always
    finds it; for the penalty law one step does. Without a given pressure the guess is returned.

    Args:
        balance: The equations.
        guess: Unknowns, whose foot is kept.

    Raises:
        StepError: No penetration gives the pressure.
    """
    if balance.control.pressure is None:
        return balance.at(guess)
    target = balance.normal_force
    here = foot(balance.interface.surface, guess[:3])
    if not here.reached:
        raise StepError(f"no point of the surface is under {shown(guess[:3], 6)}")

    def miss(gap: float) -> tuple[float, float, Trial]:
        q = guess.copy()
        q[:3] = here.position + gap * here.normal
        trial = balance.at(q)
        slope = float(here.normal @ trial.d_force[:, :3] @ here.normal)
        return float(here.normal @ trial.force) - target, slope, trial

    return _root(miss, here.gap, target, balance)


def _root(
    miss: Callable[[float], tuple[float, float, Trial]],
    gap: float,
    target: float,
    balance: PointBalance,
) -> Trial:
    """Gap at which `miss` vanishes: positive for more penetration, negative for less."""
    low, high = -np.inf, np.inf  # the gap is in between
    far = float(np.abs(balance.pose.position).max()) + balance.interface.surface.extent
    rounding = 4.0 * np.finfo(np.float64).eps * far
    # The penetration before the step; without one there is no scale, and the guess only grows.
    size = max(-balance.pose.foot.gap, 1e-12 * far, 1e-30)
    for _ in range(200):
        value, slope, trial = miss(gap)
        if abs(value) <= 1e-13 * target or abs(value) <= -slope * rounding:
            return trial
        if gap < -rounding and trial.pose.foot.gap > rounding:
            break  # beyond the centre of curvature
        if value < 0.0:
            high = gap
        else:
            low = gap
        following = gap - value / slope if slope < 0.0 else np.nan
        if not low < following < high:
            following = 0.5 * (low + high) if np.isfinite(low + high) else min(gap, 0.0) - size
            size *= 10.0
        gap = float(following)
    raise StepError(f"no penetration gives the pressure {balance.control.pressure:g}")
