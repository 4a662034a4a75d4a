"""Where trials start that meet a master which has moved before any node has."""

from __future__ import annotations

from typing import Any

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.contact.multipliers import SMALLEST, Multipliers
from anisocontact.interface import State

#: Least way of the master at a point over that at another one with which both are alike.
ALIKE = 0.5


def followed(
    start: State, own: Multipliers, gap: Floats, before: Floats, comm: Any
) -> State | None:
    """What trials start from where the master has moved along the normals, and no node yet.

    The first correction takes the points that touched along with the master, as it does where that
    is a mesh: they bear what they bore, and others are open. Without it a master that retreats has
    no point left, so that bodies go where nothing holds them, and one that comes nearer has all
    that it would go through. Where it moves along the surface, other points are pressed next.

    Args:
        start: What `Multipliers.begin` gave.
        own: The multipliers.
        gap: Of the points where the master is now, (n,), length.
        before: The same in the accepted state, (n,), length.
        comm: Communicator over whose ranks the points are spread.

    Returns:
        The start; None unless all points that touched have moved alike.
    """
    held = start["multiplier"] > 0.0
    moved = (gap - before)[held]
    extremes = comm.allgather((moved.min(initial=np.inf), moved.max(initial=-np.inf)))
    low, high = min(one for one, _ in extremes), max(one for _, one in extremes)
    least, most = (low, high) if low > 0.0 else (-high, -low)
    if not (most > own.limit and least >= ALIKE * most):
        return None
    normal = own.penalties[0]
    new = start.copy()
    new["multiplier"][held] += normal * (gap - np.minimum(before, 0.0))[held]
    beyond = ~held & (gap < 0.0)
    new["multiplier"][beyond] = (1.0 + SMALLEST) * normal * gap[beyond]
    return new
