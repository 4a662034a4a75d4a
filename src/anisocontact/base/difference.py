"""The first difference between two descriptions: nested tables and lists of numbers and texts."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import chain
from typing import Any, NamedTuple

_MISSING = object()


class Difference(NamedTuple):
    """Where two descriptions differ, and what stands there in either, as text."""

    place: str
    old: str
    new: str


def first_difference(old: Any, new: Any, near: float = 0.0, place: str = "") -> Difference | None:
    """Find the first entry that is not the same.

    Args:
        old: A description.
        new: Another one.
        near: Difference of two numbers that are the same, over the larger of them.
        place: Where both stand.

    Returns:
        The place of the entry with both values; None if there is none.

    Example:
        >>> first_difference({"a": [1, 2]}, {"a": [1, 3]})
        Difference(place='a[1]', old='2', new='3')
    """
    if isinstance(old, Mapping) and isinstance(new, Mapping):
        pairs = [
            (f"{place}.{key}" if place else key, old.get(key, _MISSING), new.get(key, _MISSING))
            for key in dict.fromkeys(chain(old, new))
        ]
    elif _is_list(old) and _is_list(new) and len(old) == len(new):
        pairs = [(f"{place}[{i}]", a, b) for i, (a, b) in enumerate(zip(old, new, strict=True))]
    elif _is_list(old) and _is_list(new) and (_has_tables(old) or _has_tables(new)):
        return Difference(place, f"{len(old)} of them", f"{len(new)} of them")
    else:
        return None if _same(old, new, near) else Difference(place, _shown(old), _shown(new))
    found = (first_difference(a, b, near, where) for where, a, b in pairs)
    return next((one for one in found if one is not None), None)


def _is_list(value: Any) -> bool:
    return isinstance(value, Sequence) and not isinstance(value, str)


def _has_tables(values: Sequence[Any]) -> bool:
    """Whether there are tables in a list, whose texts are long and begin alike."""
    return any(isinstance(value, Mapping) for value in values)


def _same(old: Any, new: Any, near: float) -> bool:
    if near and all(isinstance(one, int | float) for one in (old, new)):
        return math.isclose(old, new, rel_tol=near) or (math.isnan(old) and math.isnan(new))
    return bool(old == new)


def _shown(value: Any) -> str:
    if value is _MISSING:
        return "nothing"
    text = repr(value)
    return text if len(text) < 60 else f"{text[:57]}..."
