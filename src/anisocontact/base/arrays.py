"""Arrays of points as the core takes them."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from anisocontact.base.array_types import Floats, Ints
from anisocontact.base.errors import InputError

#: Kinds of NumPy's types that are real numbers, or objects that may be.
_REAL = "biufO"


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
    a = np.ascontiguousarray(np.atleast_2d(_given(x, name)))
    return _of_shape(a, "n" if rows is None else rows, (columns,), name)


def rows_of(x: npt.ArrayLike, shape: tuple[int, ...], name: str) -> Floats:
    """`x` as an array of doubles, a row of a shape for each of n things.

    Args:
        x: What was given.
        shape: Shape of a row.
        name: Name of the argument, for the message.

    Returns:
        The array, (n, *shape).

    Raises:
        InputError: Another shape was given, or something else than numbers.

    Example:
        >>> rows_of(np.zeros(6), (6,), "strain")
        Traceback (most recent call last):
        anisocontact.base.errors.InputError: strain: an array of shape (6,) given, (n, 6) needed
    """
    return _of_shape(_given(x, name), "n", shape, name)


def _given(x: object, name: str) -> Floats:
    """What was given as numbers."""
    a = real(x)
    if a is None:
        text = "an array with masked entries" if np.ma.is_masked(x) else f"{x!r:.60}"
        text = " ".join(text.split())
        raise InputError(f"{text} given, an array of real numbers needed", field=name)
    return a


def _of_shape(a: Floats, count: int | str, shape: tuple[int, ...], name: str) -> Floats:
    """The array, if it has rows of a shape, as many as are needed."""
    if a.shape[1:] != shape or count not in ("n", len(a)):
        needed = ", ".join(str(one) for one in (count, *shape))
        raise InputError(f"an array of shape {a.shape} given, ({needed}) needed", field=name)
    return a


def answered(x: object, shape: tuple[int, ...], who: str, part: str) -> Floats:
    """What code of a user's has returned, as doubles.

    Args:
        x: What it has returned.
        shape: The shape that is needed.
        who: Whose it is, for the message: "the law Creeping".
        part: Which of its answers it is, for the message.

    Returns:
        The array, of that shape.

    Raises:
        InputError: It has another shape, or is no array of real numbers.

    Example:
        >>> answered([1, 2], (2,), "the law Creeping", "energy").tolist()
        [1.0, 2.0]
    """
    found = real(x)
    if found is None:
        text = " ".join(f"{who} returned {x!r:.60}".split())
        raise InputError(f"{text}, an array of real numbers needed", field=part)
    if found.shape != shape:
        text = f"{who} returned an array of shape {found.shape}, {shape} needed"
        raise InputError(text, field=part)
    return found


def real(x: object) -> Floats | None:
    """An array of real numbers; None if it is something else.

    Example:
        >>> real([1, True]), real([None]), real("2")
        (array([1., 1.]), None, None)
    """
    if np.ma.is_masked(x):
        return None
    try:
        given = np.asarray(x)
        if given.dtype.kind not in _REAL or (given.dtype.kind == "O" and None in given.ravel()):
            return None  # NumPy takes None for a number that is none
        return np.asarray(given, dtype=np.float64)
    except (TypeError, ValueError):
        return None


def read_only_view(x: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """The same numbers, which whoever is given them cannot change.

    Returns:
        A view of it.

    Example:
        >>> read_only_view(np.ones(2))[0] = 3.0
        Traceback (most recent call last):
        ...
        ValueError: assignment destination is read-only
    """
    seen = x.view()
    seen.flags.writeable = False
    return seen


def connected(count: int, *links: npt.NDArray[np.integer]) -> Ints:
    """Number of the connected part each of some things belongs to.

    Args:
        count: How many things there are.
        links: Those that are connected, a row each: nodes of cells, for instance, (n, k) each.

    Returns:
        Parts, numbered by their first things, (count,).

    Example:
        >>> connected(4, np.array([[0, 2], [3, 1]])).tolist()
        [0, 1, 0, 1]
    """
    root = np.arange(count)
    first = np.concatenate([np.repeat(one[:, 0], one.shape[1] - 1) for one in links])
    other = np.concatenate([one[:, 1:].ravel() for one in links])
    while len(first):
        first, other = root[first], root[other]
        apart = first != other
        first, other = first[apart], other[apart]
        np.minimum.at(root, np.maximum(first, other), np.minimum(first, other))
        while np.any(root[root] != root):
            root = root[root]
    return np.asarray(np.unique(root, return_inverse=True)[1], dtype=np.int64)


def by_place(points: npt.ArrayLike) -> Ints:
    """Order of points by x, then y, then z, to rounding: on any number of processes the same.

    Args:
        points: Positions, (n, 3), length.

    Returns:
        Their numbers, (n,).

    Example:
        >>> by_place([[1.0, 0, 2], [1.0 + 1e-15, 0, 1], [0, 3, 0]]).tolist()
        [2, 1, 0]
    """
    x = np.asarray(points, dtype=np.float64)
    size = float(np.abs(x).max(initial=0.0)) or 1.0
    return np.lexsort(np.round(x / size, 9).T[::-1])


def blocks(x: npt.ArrayLike, shape: tuple[int, ...], name: str) -> Floats:
    """`x` as a contiguous array of doubles of one shape.

    Args:
        x: What was given; it is broadcast along its first axis.
        shape: The shape.
        name: Name of the argument, for the message.

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
