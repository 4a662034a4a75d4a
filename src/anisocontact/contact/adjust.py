"""Initial gaps and overlaps taken out without strain: by an offset of the gap of each point."""

from __future__ import annotations

from anisocontact.base.errors import InputError
from anisocontact.interface import State


def adjusted(state: State, reach: float | None) -> State:
    """States in which points that overlap, or nearly touch, count as just touching.

    The offset belongs to the slave point: the law sees the gap less the offset, now and later, so
    that nothing is strained and no mesh is changed.

    Args:
        state: Initial state of the points.
        reach: Gaps up to this one are closed and every overlap is taken out, >= 0, length; None
            leaves all as it is.

    Raises:
        InputError: The reach is negative.
    """
    if reach is None:
        return state
    if not reach >= 0.0:
        raise InputError(f"{reach!r} given, must be >= 0", "adjust")
    moved = state["gap"] <= reach
    new = state.copy()
    new["offset"][moved] += state["gap"][moved]
    new["gap"][moved] = 0.0
    return new
