"""What a run is asked to do and what it reports."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from anisocontact.base.errors import InputError
from anisocontact.rigid import turns_in_radian
from anisocontact.solver.stepping.imbalance import Imbalance
from anisocontact.solver.stepping.rotations import Turned
from anisocontact.solver.terms.turn import Turn

AXES = ("x", "y", "z")
# Fields of a step that are forces with a direction.
_FORCES = ("traction", "force", "body_force")
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
        motion: Rigid body -> component "x", "y", "z" (translation of its reference point, length)
            or "rx", "ry", "rz" (turn about the axes of space, radian; "rx_deg", ... in degrees)
            -> value at the end. None frees the component of a free body.
        load: Rigid body -> freed component -> force, or moment about the reference point, at the
            end. Moments do not turn with the body.
        force: Facet group -> axis -> force on the whole group at the end, as a uniform traction.
        pressure: Facet group -> pressure at the end, stress, positive into the body; at finite
            strain on the area and against the normal of now, else of the reference.
        body_force: Body -> axis -> force per reference volume at the end, stress/length.
        rotation: Facet group "body.group", or rigid body, -> rotation it is led through along the
            step.
        anchor: Spring -> axis -> displacement of its end on ground at the end, length.

    Raises:
        InputError: A value is out of range or no number.

    Example:
        >>> press = Step("press", 2, {"block.top": {"x": 0.0, "y": 0.0, "z": -0.01}})
        >>> pull = Step("pull", 10, {"block.top": {"z": None}}, traction={"block.top": {"z": -1.0}})
        >>> press.led(), pull.driven()
        (['block.top'], ['block.top'])
    """

    name: str
    increments: int
    displacement: Mapping[str, Mapping[str, float | None]] = field(default_factory=dict)
    traction: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    duration: float = 1.0
    motion: Mapping[str, Mapping[str, float | None]] = field(default_factory=dict)
    load: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    force: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    pressure: Mapping[str, float] = field(default_factory=dict)
    body_force: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    rotation: Mapping[str, Turn] = field(default_factory=dict)
    anchor: Mapping[str, Mapping[str, float]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if isinstance(self.increments, bool) or not isinstance(self.increments, int):
            raise self._error("increments", f"{self.increments!r} given, needs a whole number >= 1")
        if self.increments < 1:
            raise self._error("increments", f"{self.increments} given, must be >= 1")
        if not (math.isfinite(self.duration) and self.duration > 0.0):
            raise self._error("duration", f"{self.duration!r} given, must be > 0")
        for kind in ("displacement", "anchor", *_FORCES):
            self._check_vectors(kind)
        for body, components in self.load.items():
            for component, value in components.items():
                self._check_value("load", f"load.{body}.{component}", value)
        motion = {
            body: turns_in_radian(components, f"step {self.name!r}.motion.{body}")
            for body, components in self.motion.items()
        }
        object.__setattr__(self, "motion", motion)
        for group, pressure in self.pressure.items():
            self._check_value("pressure", f"pressure.{group}", pressure)
        for group in self.rotation:
            if group in self.displacement:
                text = "given with a displacement of the same group, one of the two is allowed"
                raise self._error(f"rotation.{group}", text)
            if group in self.motion:
                text = "given with a motion of the same rigid body, one of the two is allowed"
                raise self._error(f"rotation.{group}", text)

    def led(self) -> list[str]:
        """Names of the facet groups with prescribed displacements, each once."""
        return list(dict.fromkeys([*self.displacement, *self.turned_groups()]))

    def turned_groups(self) -> dict[str, Turn]:
        """Rotations of facet groups; names of rigid bodies have no dot."""
        return {name: turn for name, turn in self.rotation.items() if "." in name}

    def turned_bodies(self) -> dict[str, Turn]:
        """Rotations of rigid bodies."""
        return {name: turn for name, turn in self.rotation.items() if "." not in name}

    def driven(self) -> list[str]:
        """Names of all groups and bodies that are led or loaded, each once."""
        loaded = [name for kind in (*_FORCES, "pressure", "anchor") for name in getattr(self, kind)]
        return list(dict.fromkeys([*self.led(), *loaded, *self.rotation, *self.motion, *self.load]))

    def _check_vectors(self, kind: str) -> None:
        groups: Mapping[str, object] = getattr(self, kind)
        for group, values in groups.items():
            if not isinstance(values, Mapping):
                text = f'{values!r} given, values by axis needed, as in {{"x": 0.1}}'
                raise self._error(f"{kind}.{group}", text)
            for axis, value in values.items():
                self._check(kind, group, axis, value)

    def _check(self, kind: str, group: str, axis: str, value: float | None) -> None:
        where = f"{kind}.{group}.{axis}"
        if axis not in AXES:
            raise self._error(where, f"no axis {axis!r}, allowed: {', '.join(AXES)}")
        self._check_value(kind, where, value)

    def _check_value(self, kind: str, where: str, value: float | None) -> None:
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
        residual: Residual over the forces at work, or over those whose rounding is a hundred
            millionth of them where next to none are.
        contacts: Number of "open", "stick" and "slip" points of each contact, by name.
    """

    step: str
    increment: int
    iteration: int
    residual: float
    contacts: dict[str, dict[str, int]]


@dataclass(frozen=True)
class Accepted:
    """An increment, or a part of one, that converged.

    Attributes:
        step: Name of the step.
        step_index: Number of the step, from 0.
        increment: Number of the increment in the step, from 1.
        done: Share of that increment that is done: below 1 where it was cut into parts.
        time: Time that is reached.
        iterations: Newton iterations, with those of attempts that failed.
        residuals: Residual (out-of-balance force) over the forces at work, of the start and after
            each iteration of the attempt that converged.
        contacts: Number of "open", "stick" and "slip" points of each contact, by name.
        resultants: Force and moment about the origin on each slave, by name of the contact.
        reactions: Force of each support on the body, by facet group.
        energies: See `Problem.energies`.
        ran_off: Slave points that left the end of their master in it, by name of the contact, each
            (k, 3), length; contacts without any are left out.
        turned: How far each body at small strain has turned, by name.
        imbalance: What is left open in the balance of energy.
    """

    step: str
    step_index: int
    increment: int
    done: float
    time: float
    iterations: int
    residuals: list[float]
    contacts: dict[str, dict[str, int]]
    resultants: dict[str, tuple[Floats, Floats]]
    reactions: dict[str, Floats]
    energies: dict[str, float]
    ran_off: dict[str, Floats]
    turned: dict[str, Turned]
    imbalance: Imbalance


@dataclass(frozen=True)
class Culprit:
    """A place that kept an increment from converging.

    Attributes:
        kind: "law" (a slave point without answer), "flipping" (a slave point whose status
            alternates), "hopping" (one that hops between facets), "inverted" (a cell turned inside
            out), "behind" (a body behind its master) or "residual" (the node that is farthest from
            equilibrium).
        position: Where it is, (x, y, z), length.
        why: What is wrong with it.
        contact: Name of the contact of a slave point.
        point: Number of the slave point in its contact, from 0; -1 for cells and nodes.
        facet: Number of its facet in the facet group, from 0; -1 for cells and nodes.
        statuses: Status of a slave point in the last Newton iterations, the latest at the end.
    """

    kind: str
    position: tuple[float, float, float]
    why: str
    contact: str = ""
    point: int = -1
    facet: int = -1
    statuses: tuple[str, ...] = ()

    def __str__(self) -> str:
        """One line."""
        at = ", ".join(f"{v:.6g}" for v in self.position)
        slave = f"{self.contact}, facet {self.facet}, " if self.contact else ""
        history = f"; status {' '.join(self.statuses)}" if self.statuses else ""
        return f"{slave}({at}): {self.why}{history}"


@dataclass(frozen=True)
class Cut:
    """A cutback: an increment, or a part of one, that failed and is tried again in smaller parts.

    Attributes:
        step: Name of the step.
        increment: Number of the increment in the step, from 1.
        time: Last accepted time.
        size: Share of the increment that was tried.
        next_size: Share that is tried next.
        reason: Why it failed.
        iterations: Newton iterations that were spent on it.
        count: How many places caused it, over all ranks.
        culprits: The first of them.
    """

    step: str
    increment: int
    time: float
    size: float
    next_size: float
    reason: str
    iterations: int
    count: int
    culprits: tuple[Culprit, ...]

    def __str__(self) -> str:
        """One line."""
        return (
            f"{self.step} {self.increment}  cut from {self.size:.3g} to {self.next_size:.3g} of "
            f"the increment after {self.iterations} iterations: {self.reason}"
        )


class LostError(RuntimeError):
    """Equilibrium is lost, and what comes of it is a state that cannot be.

    Args:
        culprit: A body that is where it cannot be.
    """

    def __init__(self, culprit: Culprit) -> None:
        super().__init__(
            f"contact {culprit.contact!r}: equilibrium is lost, and the bodies flow until "
            f"{culprit.why}"
        )
        self.culprit = culprit


class StoppedError(RuntimeError):
    """The run stopped before its end; what converged is kept.

    Args:
        step: Name of the step.
        increment: Number of the increment that failed.
        reason: Why, in a few words.
        culprits: The first places that caused it.
        points: Positions of all slave points at which the law had no answer, (n, 3), length.
        tried: What was tried, in a few words.
    """

    def __init__(
        self,
        step: str,
        increment: int,
        reason: str,
        culprits: Sequence[Culprit] = (),
        points: Floats | None = None,
        tried: str = "",
    ) -> None:
        self.points: Floats = np.zeros((0, 3)) if points is None else points
        where = ""
        if len(self.points):
            first = ", ".join(f"{v:.6g}" for v in self.points[0])
            where = f"; {len(self.points)} slave points failed, the first at ({first})"
        elif culprits and culprits[0].why not in reason:
            where = f"; {culprits[0]}"
        tried = f"; {tried}" if tried else ""
        super().__init__(f"step {step!r}, increment {increment}: {reason}{where}{tried}")
        self.step = step
        self.increment = increment
        self.reason = reason
        self.culprits = tuple(culprits)
