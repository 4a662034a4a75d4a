"""Arrays of points as the core takes them."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from anisocontact.base.errors import InputError

Floats = npt.NDArray[np.float64]


def points(x: npt.ArrayLike, columns: int, name: str = "x", rows: int | None = None) -> Floats:
    """`x` as a contiguous (n, columns) array of doubles.

    Args:
        x: What was given; one point may be given without its brackets.
        columns: Number of columns.
        name: Name of the argument, for the message.
        rows: Number of rows, where it is known.

    Returns:
        The array, (n, columns).

    Raises:
        InputError: Another shape was given, or something else than numbers.

    Example:
        >>> points((1, 2, 3), 3).shape
        (1, 3)
    """
    try:
        a = np.ascontiguousarray(np.atleast_2d(np.asarray(x, dtype=np.float64)))
    except (TypeError, ValueError):
        raise InputError(f"{x!r} given, an array of numbers needed", field=name) from None
    if a.ndim != 2 or a.shape[1] != columns or (rows is not None and a.shape[0] != rows):
        needed = "n" if rows is None else rows
        raise InputError(
            f"an array of shape {a.shape} given, ({needed}, {columns}) needed", field=name
        )
    return a


def blocks(x: npt.ArrayLike, shape: tuple[int, ...], name: str) -> Floats:
    """`x` as a contiguous array of doubles of one shape.

    Args:
        x: What was given; it is broadcast along its first axis.
        shape: The shape.
        name: Name of the argument, for the message.

    Returns:
        The array.

    Raises:
        InputError: The shapes do not agree.

    Example:
        >>> blocks([1.0, 2.0], (3, 2), "x").tolist()
        [[1.0, 2.0], [1.0, 2.0], [1.0, 2.0]]
    """
    a = np.asarray(x, dtype=np.float64)
    try:
        return np.ascontiguousarray(np.broadcast_to(a, shape))
    except ValueError:
        raise InputError(f"an array of shape {a.shape} given, {shape} needed", field=name) from None
