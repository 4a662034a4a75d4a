"""A rigid body: where its surfaces are and what holds it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from anisocontact.base import registry
from anisocontact.base.array_types import Floats
from anisocontact.base.errors import InputError, within
from anisocontact.base.load_curve import LoadCurve, PrescribedValue, check_prescribed, history_of
from anisocontact.base.one_history import OneHistory
from anisocontact.base.parameters import OfDegrees
from anisocontact.base.read_only import read_only
from anisocontact.base.typed import is_number, typed
from anisocontact.rigid.rotation import orthonormal, rotation, spin_of

#: Translation of the reference point along, and turn about the axes of space.
COMPONENTS = ("x", "y", "z", "rx", "ry", "rz")


@dataclass(frozen=True, eq=False)
class Pose:
    """Where a rigid body is.

    Attributes:
        translation: Of the reference point, (3,), length.
        turn: Sum of all small rotations about the axes of space, (3,), radian. For a body that has
            turned about one axis only it is the rotation vector.
        rotation: Orientation, (3, 3).
        spin: Small rotation in space per change of the turn, (3, 3).

    Example:
        >>> at_rest().values.tolist()
        [0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
    """

    translation: Floats
    turn: Floats
    rotation: Floats
    spin: Floats

    @property
    def values(self) -> Floats:
        """Translation and turn, (6,)."""
        return np.concatenate([self.translation, self.turn])


def at_rest() -> Pose:
    """A body where it was drawn."""
    return Pose(np.zeros(3), np.zeros(3), np.eye(3), np.eye(3))


@typed
class RigidBody(OneHistory, changing="accepted trial turns_freely"):
    """A rigid body that carries the surfaces of one or several contacts.

    A point `X` of it goes to `x = c + d + R (X - c)`, `c` the reference point. From one accepted
    state to the next it turns by a rotation vector in space, `R = exp([v]) R_accepted`; the sum of
    these vectors is the turn. So a step that turns it by `(0, 0, a)` turns it about the z axis
    through the reference point, wherever and however it is.

    Args:
        name: Name in steps and output.
        reference: Reference point `c` in the configuration the surfaces are given in, (3,), length.
        free: Whether a step may free some of its components: it then has six unknowns.
        springs: Component of `COMPONENTS` -> stiffness of a spring to ground, force/length for
            translations and force length/radian for turns, >= 0.

    Attributes:
        accepted: Pose of the accepted state.
        trial: Pose of the state that is tried.
        turns_freely: Whether the step leaves it free to turn, so that points may come to it as to a
            wheel.

    Raises:
        InputError: No name or one with a dot, a reference point that is no point, an unknown
            component or a negative stiffness, or springs of a body that is not free.

    Example:
        >>> die = RigidBody("die", (0, 0, 1))
        >>> die.move(rz=np.pi / 2)
        >>> die.to_space(np.array([[1.0, 0.0, 0.0]])).round(12).tolist()
        [[0.0, 1.0, 0.0]]
    """

    def __init__(
        self,
        name: str,
        reference: npt.ArrayLike,
        *,
        free: bool = False,
        springs: Mapping[str, float] | None = None,
    ) -> None:
        point = np.array(reference, dtype=np.float64)
        if not name or "." in name:
            raise InputError(f"{name!r} given, a name without a dot needed", "name")
        if point.shape != (3,) or not np.isfinite(point).all():
            raise InputError(f"{reference!r} given, needs three finite numbers", "reference")
        self.name = name
        self.reference = read_only(point)
        self.free, self.turns_freely = free, False
        stiffness: Floats = np.zeros(6)
        for component, value in (springs or {}).items():
            where = f"springs.{component}"
            stiffness[component_number(component, where)] = _stiffness(value, where)
        self.springs: Floats = read_only(stiffness)
        if self.springs.any() and not free:
            raise InputError("given for a body that is not free", "springs")
        self.accepted = self.trial = at_rest()

    @property
    def position(self) -> Floats:
        """Reference point of the trial, (3,), length."""
        return np.asarray(self.reference + self.trial.translation)

    def place(self, values: Floats) -> None:
        """Bring the trial to a translation and a turn, (6,), from the accepted state.

        Args:
            values: Translation, length, and turn, radian, (6,).
        """
        step = values[3:] - self.accepted.turn
        self.trial = Pose(
            values[:3].copy(),
            values[3:].copy(),
            rotation(step) @ self.accepted.rotation,
            spin_of(step),
        )

    def move(self, **components: float) -> None:
        """Bring the trial to the given components; the others stay as they are.

        Args:
            **components: Translation `x`, `y`, `z`, length, and turn `rx`, `ry`, `rz`, radian, or
                `rx_deg`, `ry_deg`, `rz_deg`.

        Raises:
            InputError: No such component, no number for it, or a turn in radian beyond a full one.
        """
        values = self.trial.values
        for name, value in turns_in_radian(components, "").items():
            if not is_number(value):
                raise InputError(f"{value!r} given, needs a finite number", name)
            values[component_number(name, name)] = value
        self.place(values)

    def rests_along(self, direction: Floats) -> bool:
        """Whether the trial has neither turned nor moved along a direction since it was accepted.

        Args:
            direction: In space, (3,).
        """
        now, last = self.trial, self.accepted
        moved = (now.translation - last.translation) @ direction
        return moved == 0.0 and np.array_equal(now.turn, last.turn)

    def commit(self) -> None:
        """Accept the trial."""
        now = self.trial
        self.accepted = Pose(now.translation, now.turn, orthonormal(now.rotation), np.eye(3))
        self.trial = self.accepted

    def go_on(self, values: Floats, rotation: Floats) -> None:
        """Be where an accepted state has the body.

        Args:
            values: Translation, length, and turn, radian, (6,).
            rotation: Orientation, (3, 3).
        """
        self.accepted = Pose(values[:3].copy(), values[3:].copy(), rotation.copy(), np.eye(3))
        self.trial = self.accepted

    def farthest(self, points: Floats) -> float:
        """Farthest that the last motion can have carried one of the points.

        Args:
            points: Points of the body in its last accepted position, (n, 3), length.

        Returns:
            An upper bound of the distance, length.
        """
        shift = self.trial.translation - self.accepted.translation
        turn = np.linalg.norm(self.trial.rotation - self.accepted.rotation, ord=2)
        lever = np.linalg.norm(points - self.position, axis=1).max(initial=0.0)
        return float(np.linalg.norm(shift) + turn * lever)

    def to_body(self, points: Floats, accepted: bool = False) -> Floats:
        """Points of space where the body has them in its first configuration, (n, 3).

        Args:
            points: Points in space, (n, 3), length.
            accepted: Whether with the body in its accepted pose, not at its trial.

        Returns:
            The points in the body, (n, 3), length.
        """
        pose = self.accepted if accepted else self.trial
        place = self.reference + pose.translation
        return np.asarray((points - place) @ pose.rotation + self.reference)

    def out_of_body(self, points: Floats) -> Floats:
        """Points of the first configuration where they are in space, (n, 3).

        Args:
            points: Points in the body, (n, 3), length.

        Returns:
            The points in space, (n, 3), length.
        """
        return np.asarray(self.to_space(points - self.reference) + self.position)

    def to_space(self, vectors: Floats) -> Floats:
        """Vectors of the first configuration as they are in space, (..., 3).

        Args:
            vectors: Vectors in the body, (..., 3).

        Returns:
            The vectors in space, (..., 3).
        """
        return np.asarray(vectors @ self.trial.rotation.T)


def turns_in_radian(
    components: Mapping[str, PrescribedValue | None], field: str
) -> dict[str, PrescribedValue | None]:
    """Components of a motion with turns in radian, of which `rx_deg` and the like are in degrees.

    Args:
        components: Values by component; None where it is free.
        field: Dotted path of the motion, for messages.

    Returns:
        Values by names of `COMPONENTS`, in the order given; unknown names are passed on.

    Raises:
        InputError: A component is given twice, has no finite number, or is a turn in radian of more
            than a full one.

    Example:
        >>> turns_in_radian({"x": 1.0, "rz_deg": 180.0}, "motion.die")
        {'x': 1.0, 'rz': 3.141592653589793}
    """
    found: dict[str, PrescribedValue | None] = {}
    for name, given in components.items():
        plain = name.removesuffix("_deg")
        in_degrees = plain != name and plain in COMPONENTS[3:]
        component = plain if in_degrees else name
        where = f"{field}.{name}".removeprefix(".")
        if component in found:
            raise InputError(f"given twice, as {plain} and {plain}_deg", where)
        if given is None:
            found[component] = None
            continue
        with within(where):
            check_prescribed(given)
        if name in COMPONENTS[3:]:
            registry.check_radian(given.value if isinstance(given, LoadCurve) else given, where)
        found[component] = _of_degrees(given) if in_degrees else given
    return found


def _of_degrees(given: PrescribedValue) -> PrescribedValue:
    """A turn in radian, marked as one that was given in degrees."""
    turned = history_of(given).scaled(math.radians(1.0))
    if isinstance(turned, LoadCurve):
        return replace(turned, value=OfDegrees(turned.value))
    return OfDegrees(turned)


def component_number(name: str, field: str) -> int:
    """Place of a component in `COMPONENTS`.

    Raises:
        InputError: There is none of that name.
    """
    if name not in COMPONENTS:
        raise InputError(f"no component {name!r}, allowed: {', '.join(COMPONENTS)}", field)
    return COMPONENTS.index(name)


def _stiffness(value: object, field: str) -> float:
    if not (is_number(value) and np.isfinite(value) and value >= 0.0):
        raise InputError(f"{value!r} given, must be >= 0", field)
    return float(value)
