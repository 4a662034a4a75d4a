"""Amplitudes: numbers over time that loads, motions and displacements are multiplied with."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from anisocontact.base import registry
from anisocontact.base.errors import InputError
from anisocontact.base.kinds import Kinds
from anisocontact.base.registry import Entry, Parameter
from anisocontact.base.typed import typed

#: A number at a time, such as `lambda t: 1.0 - math.exp(-t)`, or one of `amplitudes`.
Amplitude = Callable[[float], float]
"""A number at a time: any function of one, or what `make_amplitude` gives.

Example:
    >>> from anisocontact.solver import make_amplitude
    >>> ramp = make_amplitude("ramp", duration=2.0)
    >>> ramp(1.0), (lambda t: t**2)(0.5)
    (0.5, 0.25)
"""

_KIND = "amplitude"


def check_times(times: Sequence[float], columns: dict[str, Sequence[float]], field: str) -> None:
    """Refuse a table whose times do not grow or whose columns are not as long.

    Args:
        times: The times.
        columns: Values at these times by name.
        field: Where the table was written, for messages.

    Raises:
        InputError: Names what is wrong.
    """
    path = f"{field}." if field else ""
    falls = [f"{b:.6g} after {a:.6g}" for a, b in pairwise(times) if not b > a]
    if len(times) < 2 or falls:
        given = falls[0] if falls else f"{len(times)} numbers"
        raise InputError(f"{given} given, two or more numbers that grow needed", f"{path}time")
    for name, values in columns.items():
        if len(values) != len(times):
            text = f"{len(values)} numbers given, {len(times)} needed, one for each time"
            raise InputError(text, f"{path}{name}")


class Table:
    """Values at times, linear between them; the first before and the last after them.

    Example:
        >>> Table(time=(0, 1, 3), value=(0, 2, 1))(2.0)
        1.5
    """

    entry = Entry(
        "table",
        _KIND,
        "values at times, linear between them, held before and after",
        (
            Parameter("time", "array", "time", "times, each later than the one before"),
            Parameter("value", "array", "1", "values at these times"),
        ),
    )

    def __init__(self, *, field: str = "", **parameters: Any) -> None:
        values = registry.values(self.entry, parameters, field)
        self._time, self._value = values["time"], values["value"]
        check_times(self._time, {"value": self._value}, field)

    def __call__(self, time: float) -> float:
        """The value at a time."""
        return float(np.interp(time, self._time, self._value))


class Ramp:
    """From 0 to 1 between two times, straight or without a kink at its ends.

    Smooth is `s^3 (10 - 15 s + 6 s^2)`: velocity and acceleration begin and end with zero.

    Example:
        >>> Ramp(end=2.0)(1.5), Ramp(end=2.0, smooth=True)(1.0)
        (0.75, 0.5)
    """

    entry = Entry(
        "ramp",
        _KIND,
        "from 0 to 1 between two times, held before and after",
        (
            Parameter("start", "scalar", "time", "where it leaves 0", default=(0,)),
            Parameter("end", "scalar", "time", "where it reaches 1"),
            Parameter("smooth", "flag", "1", "without kinks at both ends", default=(0,)),
        ),
    )

    def __init__(self, *, field: str = "", **parameters: Any) -> None:
        values = registry.values(self.entry, parameters, field)
        (self._start,), (self._end,), (smooth,) = (values[k] for k in ("start", "end", "smooth"))
        self._smooth = bool(smooth)
        if not self._end > self._start:
            path = f"{field}.end" if field else "end"
            raise InputError(f"{self._end:g} given, must be > start, {self._start:g}", path)

    def __call__(self, time: float) -> float:
        """The value at a time."""
        s = min(max((time - self._start) / (self._end - self._start), 0.0), 1.0)
        return s**3 * (10.0 - 15.0 * s + 6.0 * s * s) if self._smooth else s


class Sine:
    """`offset + sin(2 pi t / period + phase)`.

    Example:
        >>> round(Sine(period=4.0)(1.0), 12)
        1.0
    """

    entry = Entry(
        "sine",
        _KIND,
        "offset + sin(2 pi t / period + phase)",
        (
            Parameter("period", "scalar", "time", "time of a cycle", "positive"),
            Parameter("phase", "scalar", "angle", "angle at the time 0", default=(0,)),
            Parameter("offset", "scalar", "1", "mean, added to it", default=(0,)),
        ),
    )

    def __init__(self, *, field: str = "", **parameters: Any) -> None:
        values = registry.values(self.entry, parameters, field)
        self._period, self._phase, self._offset = (v for (v,) in values.values())

    def __call__(self, time: float) -> float:
        """The value at a time."""
        return self._offset + math.sin(2.0 * math.pi * time / self._period + self._phase)


class Cycles:
    """From 0 to 1 and back, again and again: a triangle or `(1 - cos(2 pi t / period)) / 2`.

    To both sides every second half of a cycle is below zero: 0, 1, 0, -1, 0.

    Example:
        >>> [Cycles(period=4.0, form="triangle", both_sides=True)(t) for t in (1.0, 2.0, 3.0)]
        [1.0, 0.0, -1.0]
        >>> Cycles(period=4.0)(2.0), Cycles(period=4.0, count=1)(6.0)
        (1.0, 0.0)
    """

    entry = Entry(
        "cycles",
        _KIND,
        "from 0 to 1 and back, again and again",
        (
            Parameter("period", "scalar", "time", "time of a cycle", "positive"),
            Parameter(
                "form",
                "choice",
                "1",
                "straight, or smooth as (1 - cos(2 pi t / period)) / 2",
                default=(1,),
                choices=("triangle", "haversine"),
            ),
            Parameter(
                "both_sides",
                "flag",
                "1",
                "whether a cycle goes to 1 and to -1: 0, 1, 0, -1, 0",
                default=(0,),
            ),
            Parameter(
                "count",
                "integer",
                "1",
                "how many cycles, after which it is 0; endless if left out",
                "positive",
                required=False,
            ),
        ),
    )

    def __init__(self, *, field: str = "", **parameters: Any) -> None:
        values = registry.values(self.entry, parameters, field)
        (self._period,), (form,), (both,) = (values[k] for k in ("period", "form", "both_sides"))
        self._triangle, self._halves = form == 0.0, 2 if both else 1
        (self._count,) = values["count"] or (math.inf,)

    def __call__(self, time: float) -> float:
        """The value at a time."""
        cycles = time / self._period
        if not 0.0 <= cycles < self._count:
            return 0.0
        half, share = divmod(self._halves * cycles, 1.0)
        size = 1.0 - abs(2.0 * share - 1.0)
        if not self._triangle:
            size = 0.5 * (1.0 - math.cos(2.0 * math.pi * share))
        return 0.0 - size if self._halves == 2 and half % 2.0 == 1.0 else size


_AMPLITUDES = Kinds(_KIND, "kind", (Table, Ramp, Sine, Cycles))


def register_amplitude[T: type[Any]](kind: T) -> T:
    """Register an amplitude by its name, for Python and case files read afterwards.

    Args:
        kind: Class with an `entry`, whose parameters its constructor takes by name; an object of
            it is called with a time and returns a number.

    Returns:
        The class, so that this serves as a decorator.

    Raises:
        InputError: There is an amplitude of that name, or it is no class with an `entry`.

    Example:
        >>> register_amplitude(Sine)
        Traceback (most recent call last):
        anisocontact.base.errors.InputError: amplitude: 'sine' is registered already
    """
    _AMPLITUDES.add(kind)
    return kind


def amplitudes() -> tuple[Entry, ...]:
    """The registered amplitudes with their parameters.

    Returns:
        An entry for each.

    Example:
        >>> [entry.name for entry in amplitudes()][:2]
        ['table', 'ramp']
    """
    return _AMPLITUDES.entries()


@typed
def make_amplitude(kind: str, *, field: str = "", **parameters: Any) -> Amplitude:
    """Amplitude by name.

    Args:
        kind: Name of a registered amplitude.
        field: Where it was written, for messages.
        **parameters: Its parameters; angles in radian, or in degrees by `<name>_deg`.

    Returns:
        The amplitude.

    Raises:
        InputError: Unknown name or parameter, a parameter missing or out of range.

    Example:
        >>> make_amplitude("ramp", end=2.0)(1.0)
        0.5
    """
    found: Amplitude = _AMPLITUDES.make(kind, field, parameters)
    return found
