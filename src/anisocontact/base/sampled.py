"""Functions of place that a user gives: what they return is looked at before it is used."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.arrays import real
from anisocontact.base.errors import InputError
from anisocontact.base.python_file import called
from anisocontact.base.shown import shown


def sampled(
    function: Callable[[Floats], Any],
    x: Floats,
    *shapes: tuple[int, ...],
    field: str,
    axis: int = 0,
) -> Floats:
    """What a function of a user's gives at positions.

    Args:
        function: The function; it is given a copy, which it may change.
        x: Positions, as it takes them.
        *shapes: Shapes that its answer may have.
        field: Where it was given, for messages.
        axis: Axis of `x` along which the positions are.

    Returns:
        The answer, as finite doubles.

    Raises:
        InputError: The function failed, or gave something else.

    Example:
        >>> sampled(lambda x: x[:, 0] / 2, np.ones((1, 3)), (1,), field="f").tolist()
        [0.5]
        >>> sampled(lambda x: x[:, :2], np.ones((1, 3)), (1,), field="f")
        Traceback (most recent call last):
        anisocontact.base.errors.InputError: f: an array of shape (1, 2) for 1 positions given, ...
    """
    given = called(function, x.copy(), who="the function", field=field)
    found = real(given)
    if found is None:
        text = " ".join(f"{given!r:.60} given by the function".split())
        raise InputError(f"{text}, an array of real numbers needed", field)
    if found.shape not in shapes:
        needed = " or ".join(map(str, shapes))
        count = f"for {x.shape[axis]} positions given"
        raise InputError(f"an array of shape {found.shape} {count}, {needed} needed", field)
    wrong = np.flatnonzero(~np.isfinite(found).all(axis=tuple(range(1, found.ndim))))
    if wrong.size:
        where = shown(np.moveaxis(x, axis, 0)[wrong[0]])
        text = f"{found[wrong[0]].tolist()} at {where} given, finite numbers needed"
        raise InputError(text, field)
    return found
