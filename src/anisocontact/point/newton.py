"""Newton's method for the equations of a step, with a line search."""

from __future__ import annotations

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.point.balance import PointBalance, StepError, Trial
from anisocontact.point.press import pressed

#: Of the forces at the trial position.
TOLERANCE = 1e-12
#: Of these forces what rounding of positions may leave: farther off it is no equilibrium.
MOST_ROUNDING = 1e-6
#: Of the largest singular value: below it an equation is rounding.
SINGULAR = 1e-13
#: Iterations before the step is cut.
MOST_ITERATIONS = 40
#: Why a point without any force does not come to rest.
UNPRESSED = "no forces: nothing presses the point, a pressure, or a load towards the surface needed"


def solve(balance: PointBalance, guess: Floats) -> tuple[Trial, int]:
    """Solve the equations of a step.

    Args:
        balance: The equations.
        guess: Unknowns to start from.

    Returns:
        The solution and the number of iterations.

    Raises:
        StepError: Not converged; the message has the residual.
    """
    trial = pressed(balance, guess)
    for iteration in range(MOST_ITERATIONS):
        size = float(np.linalg.norm(trial.residual))
        if size <= TOLERANCE * trial.scale:
            return trial, iteration
        new = _searched(balance, trial, _direction(trial))
        if size <= _rounding(trial) and np.linalg.norm(new.residual) > 0.5 * size:
            return trial, iteration  # as near as rounding lets it come
        trial = new
    size = float(np.linalg.norm(trial.residual))
    why = f"residual {size:.3g}, forces {trial.scale:.3g}" if trial.scale else UNPRESSED
    raise StepError(f"no equilibrium after {MOST_ITERATIONS} iterations, {why}")


def _rounding(trial: Trial) -> float:
    """Change of the residual when the position changes by a few roundings, if that is little."""
    far = float(np.abs(trial.pose.points).max())
    stiffness = float(np.abs(trial.jacobian[:, :3]).max())
    change = 64.0 * float(np.finfo(np.float64).eps) * far * stiffness
    return min(change, MOST_ROUNDING * trial.scale)


def _direction(trial: Trial) -> Floats:
    """Newton step; of least length where the equations do not fix all unknowns.

    So a point without friction is moved along a push and not across it. What is left of an equation
    by rounding fixes nothing.
    """
    scale = np.linalg.norm(trial.jacobian, axis=0)
    scale[:3] = scale[:3].max()
    scale[scale == 0.0] = 1.0
    scaled = trial.jacobian / scale
    if np.linalg.cond(scaled) * SINGULAR < 1.0:
        step: Floats = np.linalg.solve(scaled, -trial.residual)
    else:
        step = np.linalg.lstsq(scaled, -trial.residual, rcond=SINGULAR)[0]
    return step / scale


def _searched(balance: PointBalance, trial: Trial, step: Floats) -> Trial:
    """The step, halved until the residual falls; the best of what was tried if it does not."""
    before = float(np.linalg.norm(trial.residual))
    best: Trial | None = None
    reason: StepError | None = None
    for k in range(12):
        try:
            # Under a given pressure every trial is pressed anew, so that it cannot lift off.
            new = pressed(balance, trial.q + 0.5**k * step)
        except StepError as failure:
            reason = failure
            continue
        if best is None or np.linalg.norm(new.residual) < np.linalg.norm(best.residual):
            best = new
        if np.linalg.norm(new.residual) < (1.0 - 1e-4 * 0.5**k) * before:
            return new
    if best is None:
        assert reason is not None
        raise reason
    return best
