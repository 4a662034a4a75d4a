"""Quantities over time: a constant, straight lines between knots, or a function."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from anisocontact.base.array_types import Floats
from anisocontact.base.errors import InputError
from anisocontact.base.sizes import MOST, check_size

#: A number or vector, knots of it, or a function of time.
OverTime = npt.ArrayLike | Callable[[float], npt.ArrayLike]


class Schedule:
    """A number or vector over time.

    Args:
        given: A constant; one value for each knot of `times`, linear between them; or a function
            of time.
        times: Times of the knots, (k,) [time].
        sizes: Allowed numbers of components; 0 stands for a plain number.
        field: Name for messages.
        least: Smallest number allowed.

    Raises:
        InputError: The form fits neither a constant nor the knots, or a number is not finite, too
            small, or beyond what can be computed with.

    Example:
        >>> float(Schedule([0.0, 4.0], np.array([0.0, 2.0]), (0,), "pressure")(0.5))
        1.0
    """

    def __init__(
        self,
        given: OverTime,
        times: Floats,
        sizes: Sequence[int],
        field: str,
        least: float = -np.inf,
    ) -> None:
        self.times, self.field, self.sizes, self._least = times, field, sizes, least
        self._function = given if callable(given) else None
        self._knots = None if callable(given) else self._checked(given)

    def __call__(self, t: float) -> Floats:
        """Value at time t, shape () or (size,)."""
        if self._function is not None:
            return self._value(self._function(t), t)
        assert self._knots is not None
        if len(self._knots) == 1:
            return np.asarray(self._knots[0])
        i = int(np.clip(np.searchsorted(self.times, t, side="right") - 1, 0, len(self.times) - 2))
        s = (t - self.times[i]) / (self.times[i + 1] - self.times[i])
        # The end of a segment is its knot to the last digit.
        a, b = self._knots[i], self._knots[i + 1]
        return np.asarray(b if s == 1.0 else a + s * (b - a))

    def _checked(self, given: npt.ArrayLike) -> Floats:
        """Knots, or one value in a list of its own."""
        try:
            a = np.asarray(given, dtype=np.float64)
        except (TypeError, ValueError):
            raise InputError(f"numbers needed, {self._needed()}", field=self.field) from None
        if a.ndim == 0 or (a.ndim == 1 and 0 not in self.sizes):
            a = a[None]
        k = len(self.times)
        size = 0 if a.ndim == 1 else a.shape[-1]
        if a.ndim > 2 or size not in self.sizes or len(a) not in (1, k):
            raise InputError(
                f"an array of shape {np.shape(given)} given, {self._needed()}", field=self.field
            )
        if not np.isfinite(a).all():
            raise InputError("a number that is not finite given", field=self.field)
        if (a < self._least).any():
            raise InputError(f"{a.min():g} given, must be >= {self._least:g}", field=self.field)
        check_size(self.field, a)
        return a

    def _needed(self) -> str:
        what = " or ".join("a number" if s == 0 else f"{s} numbers" for s in self.sizes)
        return f"{what} or {len(self.times)} knots of it needed"

    def _value(self, v: npt.ArrayLike, t: float) -> Floats:
        a = np.asarray(v, dtype=np.float64)
        if (0 if a.ndim == 0 else a.size) not in self.sizes or a.ndim > 1:
            raise InputError(
                f"the function gives an array of shape {a.shape} at time {t:g}", field=self.field
            )
        if not np.isfinite(a).all():
            raise InputError(f"the function gives {a.tolist()} at time {t:g}", field=self.field)
        if (a < self._least).any():
            text = f"the function gives {a.min():g} at time {t:g}, must be >= {self._least:g}"
            raise InputError(text, field=self.field)
        # What a function gives may come near 0 without being it.
        if np.abs(a).max() > MOST:
            text = f"the function gives {a.tolist()} at time {t:g}, at most {MOST:g} needed"
            raise InputError(text, field=self.field)
        return a


def knot_times(given: npt.ArrayLike | None, value: Any) -> Floats:
    """Times of the knots: as given, or 0, 1, 2, ... for the knots of `value`.

    Args:
        given: Times, increasing, (k,) [time].
        value: The knots the times belong to, a constant or a function.

    Returns:
        Times, (k,), at least two.

    Raises:
        InputError: Not increasing, missing where they cannot be counted, or beyond what can be
            computed with.
    """
    if given is None:
        n = 0 if callable(value) or not np.ndim(value) else len(value)
        if n < 2:
            raise InputError("missing; times of start and end are needed", field="times")
        return np.arange(float(n))
    times = np.asarray(given, dtype=np.float64)
    if times.ndim != 1 or len(times) < 2 or not np.isfinite(times).all():
        shown = times.tolist()
        raise InputError(f"{shown} given, two or more finite times needed", field="times")
    if not (np.diff(times) > 0.0).all():
        raise InputError(f"{times.tolist()} given, increasing times needed", field="times")
    check_size("times", times)
    for duration in np.diff(times):
        check_size("times", duration, zero=False)
    return times


def instants(times: Floats, increments: int | Sequence[int]) -> Floats:
    """Ends of the time steps: every segment between knots in equal steps.

    Args:
        times: Times of the knots, (k,).
        increments: Steps of each segment, one number for all or a list of k - 1.

    Returns:
        Instants, the first is the start, (m + 1,).

    Raises:
        InputError: Numbers that are not positive, or not one for each segment.
    """
    n = len(times) - 1
    given = np.asarray(increments)
    if given.dtype.kind not in "iu" or (given < 1).any():
        raise InputError(f"{increments!r} given, whole numbers > 0 needed", field="increments")
    if given.shape not in ((), (n,)):
        raise InputError(
            f"{given.size} given, one or {n} needed, one a segment", field="increments"
        )
    counts = np.broadcast_to(given, n).tolist()
    parts = [
        np.linspace(a, b, c + 1)[1:] for a, b, c in zip(times[:-1], times[1:], counts, strict=True)
    ]
    return np.concatenate([times[:1], *parts])
