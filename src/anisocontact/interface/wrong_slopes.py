"""What is wrong with the derivatives that a law in Python returns, found by differences."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from anisocontact.base.array_types import Flags, Floats
from anisocontact.base.errors import InputError
from anisocontact.interface.tangential_law import (
    LawKinematics,
    LawResult,
    LawState,
    TangentialLaw,
    evaluate,
)

#: Changes of an input over its size, one ahead and one behind: differences that agree have neither
#: a kink between them nor the rounding of a law that computes in single precision.
_AHEAD, _BEHIND = 1e-6, -1e-4
#: Difference of two differences, over the larger of them, from which on they do not agree.
_KINK = 0.01
#: Difference of a block and the differences, over the larger of them, that is said.
_WRONG = 0.05
#: Rounding of a traction over its size, with all that a law sums up.
_ROUNDING = 1e3 * float(np.finfo(float).eps)

type _Input = tuple[LawState, LawKinematics]


def wrong_slopes(law: TangentialLaw, state: LawState, kinematics: LawKinematics) -> str:
    """Which derivative a law returns is not that of its traction.

    Args:
        law: The law.
        state: What points remember.
        kinematics: What happens to them.

    Returns:
        A line; empty where all derivatives are right, as far as differences can tell. Points at
        which the law has a kink, as between stick and slip, are left out.

    Example:
        A spring whose derivative has the wrong sign:

        >>> class Spring:
        ...     internal = 0
        ...     def update(self, state, kinematics):
        ...         n, moved = len(kinematics.pressure), kinematics.increment
        ...         none = np.zeros((n, 2, 2))
        ...         return LawResult(
        ...             traction=-3.0 * moved, slip=0.0 * moved, d_increment=none + 3.0 * np.eye(2),
        ...             d_pressure=0.0 * moved, d_traction=none, d_elastic=none,
        ...             internal=state.internal, dissipation=np.zeros(n), energy=np.zeros(n))
        >>> rest, moved = np.zeros((1, 2)), np.array([[0.1, 0.0]])
        >>> start = LawState(rest, rest, np.zeros((1, 0)))
        >>> wrong_slopes(Spring(), start, LawKinematics(moved, np.ones(1), np.zeros(1), rest, 1.0))
        'the law Spring returns 3 in d_increment where differences of its traction give -3, at 1 of
        1 points'
    """
    try:
        here, again = evaluate(law, state, kinematics), evaluate(law, state, kinematics)
        who = f"the law {type(law).__name__}"
        if not np.array_equal(here.traction, again.traction):
            return f"{who} gives another traction for the same input: it must not keep a state"
        for name, given, found, smooth in _blocks(law, (state, kinematics), here):
            larger = np.maximum(_size(given), _size(found))
            wrong = smooth & (_size(given - found) > _WRONG * larger)
            if wrong.any():
                point = int(np.flatnonzero(wrong)[0])
                entry = np.abs(given[point] - found[point]).argmax()
                a, b = given[point].flat[entry], found[point].flat[entry]
                return (
                    f"{who} returns {a:.3g} in {name} where differences of its traction give "
                    f"{b:.3g}, at {np.count_nonzero(wrong)} of {len(wrong)} points"
                )
    except InputError:  # it has no answer beside where it has one
        return ""
    return ""


def _blocks(
    law: TangentialLaw, at: _Input, here: LawResult
) -> Iterator[tuple[str, Floats, Floats, Flags]]:
    """Name of each block, what is given, differences, (n, 2, k), and where they count, (n,)."""
    state, kinematics = at
    moved = (kinematics.increment, state.elastic, kinematics.gap)
    length = max(float(np.abs(a).max(initial=0.0)) for a in moved)
    force = max(float(np.abs(a).max(initial=0.0)) for a in (state.traction, kinematics.pressure))
    scales = {"increment": length, "pressure": force, "traction": force, "elastic": length}
    for name, scale in scales.items():
        if scale <= 0.0:
            continue
        columns = range(1 if name == "pressure" else 2)

        def differences(by: float, name: str = name, columns: range = columns) -> Floats:
            ends = [evaluate(law, *_moved(at, name, c, by)).traction for c in columns]
            return np.stack([(end - here.traction) / by for end in ends], axis=2)

        ahead, behind = differences(_AHEAD * scale), differences(_BEHIND * scale)
        given = np.asarray(getattr(here, f"d_{name}")).reshape(ahead.shape)
        noise = _ROUNDING * np.abs(here.traction).max(initial=0.0) / (_AHEAD * scale)
        larger = np.maximum(_size(ahead), _size(behind))
        smooth = _size(ahead - behind) <= _KINK * larger + noise
        yield f"d_{name}", given, ahead, smooth & (_size(given - ahead) > noise / _WRONG)


def _moved(at: _Input, name: str, column: int, by: float) -> _Input:
    """The input with one of its numbers changed at all points."""
    state, kinematics = at
    remembered = hasattr(state, name)
    values = np.array(getattr(state if remembered else kinematics, name), dtype=float)
    values.reshape(len(values), -1)[:, column] += by
    changed: dict[str, Any] = {name: values}
    if remembered:
        return replace(state, **changed), kinematics
    return state, replace(kinematics, **changed)


def _size(blocks: Floats) -> Floats:
    """Largest entry of each block, (n,)."""
    return np.abs(blocks).max(axis=(1, 2))
