"""How a prescribed value goes along a step: held, linearly to a number, or along an amplitude."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np

from anisocontact.base.amplitudes import Amplitude
from anisocontact.base.array_types import Floats
from anisocontact.base.errors import InputError
from anisocontact.base.paths import Path
from anisocontact.base.python_file import where_failed
from anisocontact.base.renamed import renamed
from anisocontact.base.sizes import RANGE, out_of_range
from anisocontact.base.typed import is_number, typed

#: Difference between where something is and where its amplitude begins that is round-off, over
#: the largest of the numbers.
_SAME = 1e-9
#: Places in an increment at which an amplitude is compared with what the increments see of it.
_PLACES = 8
#: Places in a step at most.
_MOST = 20000
#: Places in a step at which its largest value is looked for.
_WAY = 64
#: Departure from the straight line of an increment, over the range of the step, that is said.
_COARSE = 0.25
#: Size from which on the square of a number is none.
_LARGEST = 1e150


class TimeHistory(Protocol):
    """How a prescribed value goes along a step from where it is when the step begins."""

    @property
    def linear(self) -> bool:
        """Whether it goes linearly to a value, where later steps leave it."""

    def at(self, share: float, duration: float, start: Any) -> Any:
        """The value at a share of a step.

        Args:
            share: Share of the step, 0 to 1.
            duration: Time the step takes.
            start: Where it was when the step began, a number or array.

        Returns:
            The value, of the shape of `start`.
        """

    def end(self, before: float | None, duration: float) -> float | None:
        """Value at the end of a step that begins at `before`; None where that is not known."""

    def largest(self, duration: float, start: float) -> float:
        """Largest size of the value along a step that begins at `start`."""

    def coarse(self, duration: float, increments: int) -> bool:
        """Whether increments are too few to follow it."""


@dataclass(frozen=True)
class Held:
    """The value stays where it is when the step begins."""

    linear = True

    def at(self, share: float, duration: float, start: Any) -> Any:
        """See `TimeHistory.at`."""
        return start

    def end(self, before: float | None, duration: float) -> float | None:
        """See `TimeHistory.end`."""
        return before

    def largest(self, duration: float, start: float) -> float:
        """See `TimeHistory.largest`."""
        return abs(start)

    def coarse(self, duration: float, increments: int) -> bool:
        """See `TimeHistory.coarse`."""
        return False


@dataclass(frozen=True)
class LinearHistory:
    """The value goes linearly to a number.

    Attributes:
        value: The number, of the unit of the prescribed value.

    Example:
        >>> LinearHistory(3.0).at(0.5, 4.0, 1.0)
        2.0
    """

    value: float
    linear = True

    def at(self, share: float, duration: float, start: Any) -> Any:
        """See `TimeHistory.at`."""
        return (1.0 - share) * start + share * self.value

    def end(self, before: float | None, duration: float) -> float | None:
        """See `TimeHistory.end`."""
        return self.value

    def largest(self, duration: float, start: float) -> float:
        """See `TimeHistory.largest`."""
        return max(abs(start), abs(self.value))

    def coarse(self, duration: float, increments: int) -> bool:
        """See `TimeHistory.coarse`."""
        return False

    def scaled(self, factor: float) -> float:
        """What prescribes a multiple."""
        return factor * self.value

    def __str__(self) -> str:
        return f"{self.value:g}"


@typed
@dataclass(frozen=True)
class LoadCurve:
    """A value times an amplitude of the time since the beginning of the step.

    The prescribed value is `value A(t)`, or with `relative` at `value (A(t) - A(0))` from where it
    is when the step begins. A support, or load, that takes over what was free begins where that
    is, and the difference goes to zero along the step.

    Attributes:
        amplitude: A, a number at a time.
        value: Its factor, of the unit of the prescribed value.
        relative: Whether it counts from where it is.

    Example:
        >>> LoadCurve(lambda t: t**2, 3.0).at(0.5, 4.0, 0.0)
        12.0
        >>> LoadCurve(lambda t: 1.0 + t, 3.0, relative=True).at(1.0, 1.0, 10.0)
        13.0
    """

    amplitude: Amplitude
    value: float = 1.0
    relative: bool = False

    linear = False

    def at(self, share: float, duration: float, start: Any) -> Any:
        """See `TimeHistory.at`.

        Raises:
            InputError: The amplitude has no finite number there.
        """
        first, now = self._number(0.0), self._number(share * duration)
        return now + (1.0 if self.relative else 1.0 - share) * (start - first)

    def jump(self, start: float) -> float:
        """How far the amplitude begins from a value.

        Args:
            start: The value, of the unit of what is prescribed.

        Returns:
            Its first value less this one; 0 where that is round-off, or where it counts from there.
        """
        first = self._number(0.0)
        same = _SAME * max(abs(start), abs(self.value), abs(first))
        return 0.0 if self.relative or abs(first - start) <= same else first - start

    def end(self, before: float | None, duration: float) -> float | None:
        """See `TimeHistory.end`.

        Raises:
            InputError: The amplitude begins elsewhere, or has no finite number.
        """
        if before is not None and (jump := self.jump(before)):
            raise InputError(
                f"the amplitude begins at {before + jump:g} where {before:g} is: prescribe "
                "that value in a step before, or take relative = true"
            )
        if before is None and self.relative:
            return None
        return float(self.at(1.0, duration, before or 0.0))

    def largest(self, duration: float, start: float) -> float:
        """Largest size of the value along a step that begins at `start`."""
        places = np.arange(_WAY + 1) / _WAY
        return max(abs(float(self.at(share, duration, start))) for share in places)

    def scaled(self, factor: float) -> LoadCurve:
        """The load curve of a multiple.

        Args:
            factor: What the value is multiplied with.

        Returns:
            Another load curve with the same amplitude.
        """
        return replace(self, value=factor * self.value)

    def coarse(self, duration: float, increments: int) -> bool:
        """Whether increments are too few to follow the amplitude."""
        values, seen = self._seen(duration, increments)
        return bool(np.abs(values - seen).max() > _COARSE * np.ptp(values))

    def check_answers(self, duration: float) -> None:
        """Refuse an amplitude whose values depend on more than the time.

        It is asked for the same times in two orders: attempts, cuts and runs that go on ask for any
        time, in any order and any number of times.

        Args:
            duration: Time the step takes.

        Raises:
            InputError: It has two values at one time.
        """
        times = [duration * k / _PLACES for k in range(_PLACES + 1)]
        there = [self._number(t) for t in times]
        for time, value in zip(reversed(times), reversed(there), strict=True):
            again = self._number(time)
            if abs(again - value) > _SAME * max(abs(value), abs(again)):
                text = f"the amplitude at the time {time:g} makes it {value:g}, and asked again"
                raise InputError(f"{text} {again:g}: it must depend on the time alone")

    def __str__(self) -> str:
        return "a load curve"

    def _seen(self, duration: float, increments: int) -> tuple[Floats, Floats]:
        """Values at many places of a step, and what straight increments make of them."""
        places = min(_PLACES * increments, _MOST)
        times = duration * np.arange(places + 1) / places
        values = np.array([self._number(t) for t in times])
        ends = duration * np.arange(increments + 1) / increments
        return values, np.interp(times, ends, np.interp(ends, times, values))

    def _number(self, time: float) -> float:
        try:
            answer: object = self.amplitude(time)
            if isinstance(answer, str | bytes):  # Python would read the number in it
                raise TypeError(f"{answer!r} returned, a number needed")
            found = float(answer)  # type: ignore[arg-type]
        except (Exception, SystemExit) as error:
            raise InputError(f"amplitude at the time {time:g}: {where_failed(error)}") from None
        if not math.isfinite(found):
            raise InputError(f"amplitude at the time {time:g} is {found}, a finite number needed")
        prescribed = self.value * found
        if not abs(prescribed) < _LARGEST:
            text = f"amplitude at the time {time:g} is {found:g}, which prescribes {prescribed:g}"
            raise InputError(f"{text}, less than {_LARGEST:g} needed")
        return prescribed


#: What a step takes for a prescribed value: a number at its end, or all the way.
PrescribedValue = float | LoadCurve


def history_of(given: PrescribedValue) -> LinearHistory | LoadCurve:
    """How a value goes along the step that prescribes it.

    Args:
        given: What the step is given.

    Returns:
        A ramp to a number, or the load curve itself.

    Example:
        >>> history_of(2.0).end(0.0, 1.0), history_of(LoadCurve(lambda t: t)).end(0.0, 4.0)
        (2.0, 4.0)
    """
    if isinstance(given, LoadCurve):
        return given
    # a number of NumPy would carry its own precision into all that is computed with it
    return LinearHistory(float(given) if is_number(given) else given)


def check_prescribed(given: Any) -> None:
    """Refuse what no step can prescribe.

    Args:
        given: What the step is given, a `PrescribedValue` if it is right.

    Raises:
        InputError: Neither a load curve nor a finite number in range.

    Example:
        >>> check_prescribed("much")
        Traceback (most recent call last):
        anisocontact.base.errors.InputError: 'much' given, needs a finite number
    """
    value: Any = history_of(given).value
    if not is_number(value) or not math.isfinite(value):
        raise InputError(f"{given!r} given, needs a finite number")
    if not isinstance(given, LoadCurve) and out_of_range(value):
        raise InputError(f"{given!r} given, must be 0, or {RANGE}")


@typed
def load_curves(path: Path) -> dict[str, LoadCurve]:
    """A path as what a step takes for the components of a displacement, motion or anchor.

    Args:
        path: The path.

    Returns:
        A load curve for each axis of the path, from where it is.

    Example:
        >>> from anisocontact.base.paths import make_path
        >>> circle = load_curves(make_path("circle", radius=2.0))
        >>> round(circle["x"].at(0.5, 1.0, 7.0), 12)
        3.0
    """
    return {axis: LoadCurve(way, relative=True) for axis, way in path.components().items()}


def path_cut_off(curves: Sequence[LoadCurve], duration: float, increments: int) -> float:
    """Share of the way along several axes that straight increments cut off, 0 to 1.

    Args:
        curves: What is prescribed along each axis.
        duration: Time the step takes.
        increments: How many it has.

    Example:
        >>> from anisocontact.base.paths import make_path
        >>> circle = load_curves(make_path("circle", radius=2.0)).values()
        >>> round(path_cut_off(list(circle), 1.0, 4), 2)  # 1 - 4 sqrt(2) / (2 pi)
        0.1
    """
    both = zip(*(curve._seen(duration, increments) for curve in curves), strict=True)
    way, seen = (np.linalg.norm(np.diff(axes, axis=1), axis=0).sum() for axes in both)
    return float(1.0 - seen / way) if way > 0.0 else 0.0


def __getattr__(name: str) -> Any:
    return renamed(__name__, name)
