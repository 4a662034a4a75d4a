"""Paths in space for prescribed motions, as amplitudes of its components."""

from __future__ import annotations

import math
from typing import Any, Protocol

import numpy as np

from anisocontact.base import registry
from anisocontact.base.amplitudes import Amplitude, Table, check_times
from anisocontact.base.errors import InputError
from anisocontact.base.kinds import Kinds
from anisocontact.base.registry import Entry, Parameter
from anisocontact.base.typed import typed

_KIND = "path"
_AXES = ("x", "y", "z")
#: Share of a unit vector that is round-off.
_NOTHING = 1e-12


class Path(Protocol):
    """A curve over time; a motion along it begins where the body or group is.

    One that comes to an end has an attribute `end`, the time of its last position.

    Example:
        >>> class Helix:
        ...     def components(self):
        ...         return {"x": math.cos, "y": math.sin, "z": lambda t: 0.1 * t}
        >>> [round(at(math.pi), 3) for at in Helix().components().values()]
        [-1.0, 0.0, 0.314]
    """

    def components(self) -> dict[str, Amplitude]:
        """Position over time by axis; axes that are left out are not prescribed."""
        ...


def _columns(doc: str) -> tuple[Parameter, ...]:
    return tuple(
        Parameter(
            axis,
            "array",
            "length",
            f"{axis} {doc}; not prescribed along {axis} if left out",
            "any",
            False,
        )
        for axis in _AXES
    )


def _given(values: dict[str, list[float]], field: str) -> dict[str, list[float]]:
    found = {axis: values[axis] for axis in _AXES if values[axis]}
    if not found:
        raise InputError("nothing given, at least one of x, y, z needed", field)
    return found


class TimedPath:
    """Positions at times, straight between them.

    Example:
        >>> way = TimedPath(time=(0, 1, 3), x=(0, 2, 2), y=(0, 0, 4)).components()
        >>> way["x"](2.0), way["y"](2.0), sorted(way)
        (2.0, 2.0, ['x', 'y'])
    """

    entry = Entry(
        "table",
        _KIND,
        "positions at times, straight between them, held before and after",
        (
            Parameter("time", "array", "time", "times, each later than the one before"),
            *_columns("at these times"),
        ),
    )

    def __init__(self, *, field: str = "", **parameters: Any) -> None:
        values = registry.values(self.entry, parameters, field)
        self._time, self._columns = values["time"], _given(values, field)
        check_times(self._time, dict(self._columns), field)
        self.end: float = self._time[-1]

    def components(self) -> dict[str, Amplitude]:
        """Position over time by axis."""
        columns = self._columns.items()
        return {axis: Table(time=self._time, value=values) for axis, values in columns}


class Polyline:
    """Points one after the other along straight lines, at one speed.

    Example:
        >>> way = Polyline(x=(0, 3, 3), y=(0, 0, 1), duration=8.0).components()
        >>> way["x"](3.0), way["y"](7.0)
        (1.5, 0.5)
    """

    entry = Entry(
        "polyline",
        _KIND,
        "points one after the other along straight lines, at one speed",
        (
            *_columns("of the points"),
            Parameter(
                "duration",
                "scalar",
                "time",
                "time from the first point to the last",
                "positive",
                default=(1,),
            ),
        ),
    )

    def __init__(self, *, field: str = "", **parameters: Any) -> None:
        values = registry.values(self.entry, parameters, field)
        (duration,) = values["duration"]
        columns = _given(values, field)
        first = len(next(iter(columns.values())))
        for axis, column in columns.items():
            if len(column) != first or first < 2:
                text = f"{len(column)} numbers given, two or more needed, as many for each axis"
                raise InputError(text, f"{field}.{axis}".removeprefix("."))
        lengths = np.linalg.norm(np.diff(np.array(list(columns.values()))), axis=0)
        if not lengths.all():
            text = f"points {int(np.argmin(lengths)) + 1} and {int(np.argmin(lengths)) + 2} are one"
            raise InputError(text, field or _KIND)
        gone = np.concatenate([[0.0], np.cumsum(lengths)])
        self._timed = TimedPath(**{"time": duration * gone / gone[-1], **columns})
        self.end: float = duration

    def components(self) -> dict[str, Amplitude]:
        """Position over time by axis."""
        return self._timed.components()


class Circle:
    """A circle about an axis, right-handed, at one speed: `r (cos a e_1 + sin a e_2)`.

    `e_1` is the x axis made normal to the axis, y where that is along x, and `e_2 = n x e_1`.

    Example:
        >>> way = Circle(radius=2.0, period=4.0).components()
        >>> [round(way[axis](1.0), 12) for axis in "xy"], sorted(way)
        ([0.0, 2.0], ['x', 'y'])
    """

    entry = Entry(
        "circle",
        _KIND,
        "a circle at one speed, begun anywhere on it",
        (
            Parameter("radius", "scalar", "length", "radius", "positive"),
            Parameter("period", "scalar", "time", "time of a turn", "positive", default=(1,)),
            Parameter(
                "start",
                "scalar",
                "angle",
                "where on the circle it begins, counted from x (from y where the axis is x)",
                default=(0,),
            ),
            Parameter(
                "axis",
                "vector",
                "1",
                "direction it goes about, right-handed",
                "nonzero",
                default=(0, 0, 1),
            ),
        ),
    )

    def __init__(self, *, field: str = "", **parameters: Any) -> None:
        values = registry.values(self.entry, parameters, field)
        (self._radius,), (self._period,), (self._start,) = (
            values[name] for name in ("radius", "period", "start")
        )
        n = np.array(values["axis"]) / np.linalg.norm(values["axis"])
        near = np.eye(3)[1 if abs(n[0]) > 1.0 - _NOTHING else 0]
        first = near - (near @ n) * n
        first /= np.linalg.norm(first)
        axes = np.stack([first, np.cross(n, first)])
        self._axes = np.where(np.abs(axes) > _NOTHING, axes, 0.0)

    def components(self) -> dict[str, Amplitude]:
        """Position over time along the axes of space in which it moves."""

        def along(shares: Any) -> Amplitude:
            return lambda time: float(shares @ self._at(time))

        moved = [i for i in range(3) if self._axes[:, i].any()]
        return {_AXES[i]: along(self._axes[:, i].copy()) for i in moved}

    def _at(self, time: float) -> Any:
        angle = self._start + 2.0 * math.pi * time / self._period
        return self._radius * np.array([math.cos(angle), math.sin(angle)])


_PATHS = Kinds(_KIND, "kind", (Polyline, Circle, TimedPath))


def register_path[T: type[Any]](kind: T) -> T:
    """Register a path by its name, for Python and case files read afterwards.

    Args:
        kind: Class with an `entry`, whose parameters its constructor takes by name, and with
            `components`, see `Path`.

    Returns:
        The class, so that this serves as a decorator.

    Raises:
        InputError: There is a path of that name, or it is no class with an `entry`.

    Example:
        >>> register_path(Circle)
        Traceback (most recent call last):
        anisocontact.base.errors.InputError: path: 'circle' is registered already
    """
    _PATHS.add(kind)
    return kind


def paths() -> tuple[Entry, ...]:
    """The registered paths with their parameters.

    Returns:
        An entry for each.

    Example:
        >>> [entry.name for entry in paths()]
        ['polyline', 'circle', 'table']
    """
    return _PATHS.entries()


@typed
def make_path(kind: str, *, field: str = "", **parameters: Any) -> Path:
    """Path by name.

    Args:
        kind: Name of a registered path.
        field: Where it was written, for messages.
        **parameters: Its parameters; angles in radian, or in degrees by `<name>_deg`.

    Returns:
        The path.

    Raises:
        InputError: Unknown name or parameter, a parameter missing or out of range.

    Example:
        >>> sorted(make_path("circle", radius=1.0, axis=(0, 1, 0)).components())
        ['x', 'z']
    """
    found: Path = _PATHS.make(kind, field, parameters)
    return found
