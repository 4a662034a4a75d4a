"""How much of the force of a point is rounding of positions."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from anisocontact.base.array_types import Floats

#: Share of its force for each of the 16 roundings that a solver takes, which a point has at most
#: beside what laws and bodies are stiff.
SHARE = 1e-6 / 16.0
#: How many times as stiff as laws and bodies a point is at most by its laws: friction above 1, and
#: dashpots in short increments.
STIFFER = 1e3
_EPSILON = float(np.finfo(np.float64).eps)


def levers(
    slopes: Floats, distance: Floats, force: Floats, stiffness: Callable[[], Floats]
) -> Floats:
    """Forces whose roundings are those of the forces of points.

    The derivative of a force tells what rounding of positions makes of it. Where it is not that of
    the laws but the force over a length that is itself rounding, as the distance from the tip of a
    cone along which its normals turn, the whole force would be rounding, and any state in balance.
    There a small share of the force counts.

    Args:
        slopes: Size of the derivative of the force of each point, (n,), force/length.
        distance: Length of which positions are rounded, (n,).
        force: Size of the force of each point, (n,).
        stiffness: How stiff points are by laws and bodies, (n,), force/length; asked where that
            matters.

    Returns:
        The forces, (n,).

    Example:
        >>> along, one = np.array([1e3, 1e16]), np.ones(2)  # the second one is at a tip
        >>> (levers(along, one, one, lambda: 1e3 * one) / 1e3).round().tolist()
        [1.0, 282475.0]
    """
    found = slopes * distance
    small = force * (SHARE / _EPSILON)
    if (found <= small).all():
        return found
    return np.minimum(found, small + STIFFER * stiffness() * distance)
