"""Loads of a point: what moves it tangentially, and what presses it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from anisocontact.base.array_types import Floats
from anisocontact.base.errors import InputError
from anisocontact.base.sizes import check_size
from anisocontact.base.typed import typed
from anisocontact.point.device import (
    FRAMES,
    Advance,
    Committed,
    Dashpot,
    Device,
    DraggedSpring,
    FixedPlace,
    in_space,
)
from anisocontact.point.foot import foot, foot_at
from anisocontact.point.schedule import OverTime, Schedule, instants, knot_times
from anisocontact.surfaces import Surface


class Load(ABC):
    """What all loads share: time, and the control of pressure or penetration.

    Args:
        main: The load's own knots, which count the times where these are not given.
        times: Times of the knots [time]; 0, 1, 2, ... if left out.
        increments: Steps of each segment between knots, one number or a list.
        pressure: N >= 0, over time [stress]; of a group the mean over its areas. The gap follows.
        gap: xi^3 of the reference, negative in contact, over time [length].

    Raises:
        InputError: Both pressure and gap, or values that do not fit the knots.
    """

    #: Whether the size of the force is an unknown.
    sized = False
    #: Whether the load itself presses where neither pressure nor gap is given.
    presses = False

    def __init__(
        self,
        main: object,
        times: npt.ArrayLike | None,
        increments: int | Sequence[int],
        pressure: OverTime | None,
        gap: OverTime | None,
    ) -> None:
        self.times = knot_times(times, main)
        self.instants = instants(self.times, increments)
        if pressure is not None and gap is not None:
            raise InputError("given with a gap; either pressure or gap", field="pressure")
        if pressure is None and gap is None and not self.presses:
            raise InputError("missing; either pressure or gap is needed", field="pressure")
        self.pressure = self._normal(pressure, "pressure", 0.0)
        self.gap = self._normal(gap, "gap", -np.inf)

    def _normal(self, given: OverTime | None, field: str, least: float) -> Schedule | None:
        return None if given is None else Schedule(given, self.times, (0,), field, least)

    @abstractmethod
    def start(self, surface: Surface) -> Floats:
        """Reference at the start.

        Args:
            surface: The surface it is on.

        Returns:
            Its position, (3,) [length].
        """

    @abstractmethod
    def device(self, surface: Surface, before: Committed, t: float) -> Device:
        """What acts in the step from `before` to time t.

        Args:
            surface: The surface.
            before: State at the beginning of the step.
            t: Time at its end.

        Returns:
            What holds or pushes the reference.

        Raises:
            InputError: A value at that time has no meaning, such as a direction without length.
        """


@typed
class PrescribedPath(Load):
    """A path of the reference: its foot is prescribed, and the pressure or the gap.

    Args:
        path: Knots or a function of time: positions in space (k, 3), or surface coordinates
            (k, 2), along which straight lines are meant in coordinates. Where neither pressure
            nor gap is given, positions in space are taken as they are, with their penetration.
        times: See `Load`.
        increments: See `Load`.
        pressure: See `Load`.
        gap: See `Load`.

    Example:
        >>> PrescribedPath([(0, 0, 0), (1, 0, 0)], gap=-0.1, increments=2).instants
        array([0. , 0.5, 1. ])
    """

    def __init__(
        self,
        path: OverTime,
        *,
        times: npt.ArrayLike | None = None,
        increments: int | Sequence[int] = 20,
        pressure: OverTime | None = None,
        gap: OverTime | None = None,
    ) -> None:
        self.presses = True
        super().__init__(path, times, increments, pressure, gap)
        self.path = Schedule(path, self.times, (2, 3), "path")
        if pressure is None and gap is None and self.path(self.times[0]).size == 2:
            raise InputError(
                "missing; a path in surface coordinates needs pressure or gap", field="pressure"
            )

    def place(self, surface: Surface, t: float) -> Floats:
        """Position of the path.

        Args:
            surface: The surface it is on.
            t: Time.

        Returns:
            The position, (3,), length.
        """
        return _in_space(surface, self.path(t))

    def start(self, surface: Surface) -> Floats:
        """First position of the path."""
        return self.place(surface, float(self.times[0]))

    def device(self, surface: Surface, before: Committed, t: float) -> Device:
        """Holds the reference above the foot of the path."""
        p = self.path(t)
        if p.size == 2:
            return Device(surface.position(p[None])[0])
        if self.pressure is None and self.gap is None:
            return FixedPlace(p)
        under = foot(surface, p)
        if not under.reached:
            raise InputError(f"no point of the surface is under it at time {t:g}", field="path")
        return Device(under.position)


@typed
class DraggingSpring(Load):
    """A linear spring from the reference to a free end that moves along a path.

    Where pressure or gap is given, the spring acts in the tangent plane; else it also presses.

    Args:
        path: Free end: knots (k, 3) in space or (k, 2) in surface coordinates, or a function.
        stiffness: k, or three values along x, y, z, or a matrix (3, 3) [force/length].
        start: Reference at the start, (3,) in space or (2,) in coordinates; under the free end,
            the spring without force, if left out.
        times: See `Load`.
        increments: See `Load`.
        pressure: See `Load`.
        gap: See `Load`.

    Example:
        >>> DraggingSpring([(0, 0, 0), (1, 0, 0)], 10.0, pressure=1.0).stiffness[0].tolist()
        [10.0, 0.0, 0.0]
    """

    presses = True

    def __init__(
        self,
        path: OverTime,
        stiffness: npt.ArrayLike,
        *,
        start: npt.ArrayLike | None = None,
        times: npt.ArrayLike | None = None,
        increments: int | Sequence[int] = 20,
        pressure: OverTime | None = None,
        gap: OverTime | None = None,
    ) -> None:
        super().__init__(path, times, increments, pressure, gap)
        self.path = Schedule(path, self.times, (2, 3), "path")
        self.stiffness = _spring(stiffness)
        self._start = None if start is None else _place(start)

    def end(self, surface: Surface, t: float) -> Floats:
        """Free end of the spring.

        Args:
            surface: The surface it is on.
            t: Time.

        Returns:
            Its position, (3,), length.
        """
        return _in_space(surface, self.path(t))

    def start(self, surface: Surface) -> Floats:
        """Where the reference begins."""
        if self._start is None:
            return self.end(surface, float(self.times[0]))
        return _in_space(surface, self._start)

    def device(self, surface: Surface, before: Committed, t: float) -> Device:
        """The spring with its free end of time t."""
        return DraggedSpring(self.stiffness, self.end(surface, t))


@typed
class DeadLoad(Load):
    """A tangential force of given size and direction.

    Past the friction limit there is no equilibrium, and a rate-independent law has no speed. So a
    dashpot holds the point: F + T - eta dx/dt = 0. It is stated, what it dissipates is the energy
    "regularisation" of the history, and as eta goes to 0 the slip has the direction that the
    sliding rule gives at the limit. `Push` needs no dashpot.

    Args:
        force: Knots (k, 3) in space, or (k, 2) in `frame`, or a function [force]. Its part along
            the normal is left to pressure or gap. Components in a frame turn with the surface;
            the frame is that of the beginning of the step.
        start: Reference at the start, (3,) in space or (2,) in coordinates.
        frame: "space"; "friction" or "adhesion" for the axes at the first point; "coordinates"
            for unit vectors along the coordinate lines.
        viscosity: eta of the dashpot [force*time/length]; if left out, 1e-4 times the largest
            tangential stiffness times the duration. In stick T lags behind the load by
            eta/(stiffness duration) of its change.
        times: See `Load`.
        increments: See `Load`.
        pressure: See `Load`.
        gap: See `Load`.

    Example:
        >>> load = DeadLoad((3.0, 0.0, 0.0), start=(0, 0, 0), times=[0, 1], pressure=10.0)
        >>> len(load.instants) - 1
        20
    """

    def __init__(
        self,
        force: OverTime,
        start: npt.ArrayLike,
        *,
        frame: str = "space",
        viscosity: float | None = None,
        times: npt.ArrayLike | None = None,
        increments: int | Sequence[int] = 20,
        pressure: OverTime | None = None,
        gap: OverTime | None = None,
    ) -> None:
        super().__init__(force, times, increments, pressure, gap)
        self.frame = _frame(frame)
        self.force = Schedule(force, self.times, (_size(frame),), "force")
        if viscosity is not None and not (np.isfinite(viscosity) and viscosity > 0.0):
            raise InputError(f"{viscosity!r} given, must be > 0", field="viscosity")
        check_size("viscosity", viscosity or 0.0)
        self.viscosity = viscosity
        self._start = _place(start)

    def start(self, surface: Surface) -> Floats:
        """Where the reference begins."""
        return _in_space(surface, self._start)

    def device(self, surface: Surface, before: Committed, t: float) -> Device:
        """Force of time t and the dashpot."""
        eta = self.viscosity
        if eta is None:
            eta = 1e-4 * before.stiffness * float(self.times[-1] - self.times[0])
            if eta == 0.0:
                raise InputError(
                    "missing; without contact and friction at the start there is no stiffness to "
                    "scale it by",
                    field="viscosity",
                )
        force = in_space(self.force(t), self.frame, before)
        return Dashpot(force, eta, before.position, t - before.time)


@typed
class Push(Load):
    """A force of given direction that moves the point by a given length along this direction.

    Its size is an unknown: it grows in stick and stays at the friction limit in slip, where the
    point is free to drift aside. It is the rate-independent continuation of a dead load of
    growing size past the limit, and a pull by a long string.

    Args:
        direction: Direction of the force: (3,) in space or (2,) in `frame`, knots of it, or a
            function. Its tangential part counts; a frame is that of the beginning of the step.
        travel: Length moved along the direction since the start, knots (k,) or a function
            [length].
        start: Reference at the start, (3,) in space or (2,) in coordinates.
        frame: See `DeadLoad`.
        times: See `Load`.
        increments: See `Load`.
        pressure: See `Load`.
        gap: See `Load`.

    Example:
        >>> push = Push((1, 0, 0), travel=[0, 1e-3], start=(0, 0, 0), pressure=10.0, increments=5)
        >>> push.instants.round(3).tolist()
        [0.0, 0.2, 0.4, 0.6, 0.8, 1.0]
    """

    sized = True

    def __init__(
        self,
        direction: OverTime,
        travel: OverTime,
        start: npt.ArrayLike,
        *,
        frame: str = "space",
        times: npt.ArrayLike | None = None,
        increments: int | Sequence[int] = 20,
        pressure: OverTime | None = None,
        gap: OverTime | None = None,
    ) -> None:
        super().__init__(travel, times, increments, pressure, gap)
        self.frame = _frame(frame)
        self.direction = Schedule(direction, self.times, (_size(frame),), "direction")
        self.travel = Schedule(travel, self.times, (0,), "travel")
        self._start = _place(start)

    def start(self, surface: Surface) -> Floats:
        """Where the reference begins."""
        return _in_space(surface, self._start)

    def device(self, surface: Surface, before: Committed, t: float) -> Device:
        """Direction of the step and how far along it."""
        d = before.foot.tangent_plane @ in_space(self.direction(t), self.frame, before)
        length = float(np.linalg.norm(d))
        if length == 0.0:
            raise InputError(
                f"no tangential part at time {t:g}, a direction is needed", field="direction"
            )
        step = float(self.travel(t) - self.travel(before.time))
        return Advance(d / length, before.position, step)


def _frame(frame: str) -> str:
    if frame not in FRAMES:
        raise InputError(f"{frame!r} given, allowed: {', '.join(FRAMES)}", field="frame")
    return frame


def _size(frame: str) -> int:
    return 3 if frame == "space" else 2


def _place(given: npt.ArrayLike) -> Floats:
    a = np.asarray(given, dtype=np.float64)
    if a.shape not in ((2,), (3,)) or not np.isfinite(a).all():
        raise InputError(
            f"{given!r} given, three numbers in space or two coordinates needed", field="start"
        )
    check_size("start", a)
    return a


def _in_space(surface: Surface, place: Floats) -> Floats:
    return place if place.size == 3 else foot_at(surface, place, 0.0).position


def _spring(given: npt.ArrayLike) -> Floats:
    k = np.asarray(given, dtype=np.float64)
    if k.shape == ():
        k = np.full(3, k)
    if k.shape == (3,):
        k = np.diag(k)
    if k.shape != (3, 3) or not np.isfinite(k).all() or not np.allclose(k, k.T):
        raise InputError(
            "one number, three along the axes, or a symmetric 3 x 3 matrix needed",
            field="stiffness",
        )
    check_size("stiffness", k, zero=False)
    if np.linalg.eigvalsh(k)[0] < 0.0 or not k.any():
        raise InputError(f"{given!r} given, must be >= 0 and not all 0", field="stiffness")
    return k
