"""A tangential law in Python with a compliant layer behind it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from anisocontact.base.typed import typed
from anisocontact.interface.tangential_law import (
    LawKinematics,
    LawResult,
    LawState,
    TangentialLaw,
    evaluate,
)

#: Change of the force of a law in series over the force at which it is found, and the most
#: corrections that are made to find it.
_SAME, _MOST = 1e-12, 20


@typed
class LawInSeries:
    """A law in Python with a compliant layer behind it: the force T with `T = law(dxi + c T)`.

    Args:
        law: The law.
        compliance: c, length/stress.

    Example:
        A viscous law, `T = - 3 dxi / dt`, in front of a layer of the compliance 1: a quarter of the
        way is left to the law.

        >>> class Viscous:
        ...     internal = 0
        ...     def update(self, state, kinematics):
        ...         n, slip = len(kinematics.pressure), kinematics.increment
        ...         none, rate = np.zeros((n, 2, 2)), 3.0 / kinematics.dt
        ...         return LawResult(
        ...             traction=-rate * slip, slip=slip, d_increment=none - rate * np.eye(2),
        ...             d_pressure=0.0 * slip, d_traction=none, d_elastic=none,
        ...             internal=state.internal, dissipation=rate * (slip**2).sum(axis=1),
        ...             energy=np.zeros(n))
        >>> rest, moved = np.zeros((1, 2)), np.array([[0.4, 0.0]])
        >>> start = LawState(rest, rest, np.zeros((1, 0)))
        >>> found = LawInSeries(Viscous(), 1.0).update(
        ...     start, LawKinematics(moved, np.ones(1), np.zeros(1), rest, dt=1.0))
        >>> found.traction.round(12).tolist(), found.slip.round(12).tolist()
        ([[-0.3, -0.0]], [[0.1, 0.0]])
    """

    def __init__(self, law: TangentialLaw, compliance: float) -> None:
        self._law, self._compliance = law, compliance
        self.internal = law.internal

    def update(self, state: LawState, kinematics: LawKinematics) -> LawResult:
        """Force, tangent and new state, found by Newton's method at every point.

        Args:
            state: History of n points, as the law has it.
            kinematics: What happens to them: the slip of law and layer together.

        Returns:
            Force, tangent and new state of law and layer; `slip` is that of the law.

        Raises:
            InputError: The law failed, or returned what is no result.
        """
        c, force = self._compliance, state.traction
        for _ in range(_MOST):
            moved = replace(kinematics, increment=kinematics.increment + c * force)
            result = evaluate(self._law, state, moved)
            left = np.eye(2) - c * np.asarray(result.d_increment)
            step = np.linalg.solve(left, (result.traction - force)[..., None])[..., 0]
            force = force + step
            if np.abs(step).max(initial=0.0) <= _SAME * np.abs(force).max(initial=0.0):
                break
        return replace(
            result,
            d_increment=np.linalg.solve(left, result.d_increment),
            d_pressure=np.linalg.solve(left, np.asarray(result.d_pressure)[..., None])[..., 0],
            d_traction=np.linalg.solve(left, result.d_traction),
            d_elastic=np.linalg.solve(left, result.d_elastic),
        )
