"""Sizes of numbers that can be computed with in double precision."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from anisocontact.base.errors import InputError

#: Least and largest size of numbers that are not 0: products of six of them, as squares of volumes,
#: are numbers of double precision.
LEAST, MOST = 1e-50, 1e50
#: What is said of others.
RANGE = f"from {LEAST:g} to {MOST:g} in size"


def out_of_range(*numbers: float) -> bool:
    """Whether numbers are too large to compute with, or all of them too small and not 0.

    Example:
        >>> out_of_range(1e60), out_of_range(1e-60), out_of_range(1e-60, 1.0), out_of_range(0.0)
        (True, True, False, False)
    """
    size = max(map(abs, numbers), default=0.0)
    return size != 0.0 and not LEAST <= size <= MOST


def check_size(field: str, numbers: npt.ArrayLike, *, zero: bool = True) -> None:
    """Refuse an array of numbers that cannot be computed with.

    Args:
        field: Name for the message.
        numbers: Finite numbers that count by the largest of them, of any shape.
        zero: Whether all of them may be 0.

    Raises:
        InputError: `out_of_range`.

    Example:
        >>> check_size("path", [[0.0, 1e60], [1.0, 0.0]])
        Traceback (most recent call last):
        anisocontact.base.errors.InputError: path: up to 1e+60 given, must be 0, or from 1e-50 \
to 1e+50 in size
    """
    size = float(np.abs(numbers).max(initial=0.0))
    if out_of_range(size):
        raise InputError(f"up to {size:g} given, must be {'0, or ' if zero else ''}{RANGE}", field)
