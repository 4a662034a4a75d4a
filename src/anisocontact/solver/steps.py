"""What a run is asked to do and what it reports."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from anisocontact.errors import InputError

AXES = ("x", "y", "z")
Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Step:
    """A stretch of loading; every value goes linearly from where it is to the one given.

    What is not named keeps its value. A displacement of None releases the support: the force it
    carried goes to zero along the step.

    Attributes:
        name: Name in progress and output.
        increments: Number of equal increments, >= 1.
        displacement: Facet group -> axis "x", "y" or "z" -> displacement at the end, length.
        traction: Facet group -> axis -> force per reference area at the end, stress.
        duration: Time the step takes, > 0, time.

    Raises:
        InputError: A value is out of range or no number.
    """

    name: str
    increments: int
    displacement: Mapping[str, Mapping[str, float | None]] = field(default_factory=dict)
    traction: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    duration: float = 1.0

    def __post_init__(self) -> None:
        if isinstance(self.increments, bool) or not isinstance(self.increments, int):
            raise self._error("increments", f"{self.increments!r} given, needs a whole number >= 1")
        if self.increments < 1:
            raise self._error("increments", f"{self.increments} given, must be >= 1")
        if not (math.isfinite(self.duration) and self.duration > 0.0):
            raise self._error("duration", f"{self.duration!r} given, must be > 0")
        for kind, groups in (("displacement", self.displacement), ("traction", self.traction)):
            for group, values in groups.items():
                for axis, value in values.items():
                    self._check(kind, group, axis, value)

    def _check(self, kind: str, group: str, axis: str, value: float | None) -> None:
        where = f"{kind}.{group}.{axis}"
        if axis not in AXES:
            raise self._error(where, f"no axis {axis!r}, allowed: {', '.join(AXES)}")
        if value is None and kind == "displacement":
            return
        if not isinstance(value, int | float) or not math.isfinite(value):
            raise self._error(where, f"{value!r} given, needs a finite number")

    def _error(self, where: str, message: str) -> InputError:
        return InputError(message, f"step {self.name!r}.{where}")


@dataclass(frozen=True)
class Progress:
    """A Newton iteration.

    Attributes:
        step: Name of the step.
        increment: Number of the increment in the step, from 1.
        iteration: Number of the iteration, from 0 (the start).
        residual: Residual over the forces at work.
        contacts: Number of "open", "stick" and "slip" points of each contact, by name.
    """

    step: str
    increment: int
    iteration: int
    residual: float
    contacts: dict[str, dict[str, int]]


@dataclass(frozen=True)
class Accepted:
    """An increment that converged.

    Attributes:
        step: Name of the step.
        step_index: Number of the step, from 0.
        increment: Number of the increment in the step, from 1.
        time: Time at its end.
        iterations: Newton iterations, with those of a first attempt that failed.
        residuals: Residual over the forces at work, of the start and after each iteration of the
            attempt that converged.
        contacts: Number of "open", "stick" and "slip" points of each contact, by name.
        resultants: Force and moment about the origin on each slave, by name of the contact.
        reactions: Force of each support on the body, by facet group.
        energies: See `Problem.energies`.
    """

    step: str
    step_index: int
    increment: int
    time: float
    iterations: int
    residuals: list[float]
    contacts: dict[str, dict[str, int]]
    resultants: dict[str, tuple[Floats, Floats]]
    reactions: dict[str, Floats]
    energies: dict[str, float]


class StoppedError(RuntimeError):
    """The run stopped before its end; what converged is kept.

    Attributes:
        step: Name of the step.
        increment: Number of the increment that failed.
        reason: Why, in a few words.
        points: Positions of slave points at which the law had no answer, (n, 3), length.
    """

    def __init__(self, step: str, increment: int, reason: str, points: Floats) -> None:
        where = ""
        if len(points):
            first = ", ".join(f"{v:.6g}" for v in points[0])
            where = f"; {len(points)} slave points failed, the first at ({first})"
        super().__init__(f"step {step!r}, increment {increment}: {reason}{where}")
        self.step = step
        self.increment = increment
        self.reason = reason
        self.points = points
