"""What a run is asked to do."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from anisocontact.base.errors import InputError, within
from anisocontact.base.limits import MOST_INCREMENTS
from anisocontact.base.load_curve import (
    LoadCurve,
    PrescribedValue,
    check_prescribed,
    history_of,
    path_cut_off,
)
from anisocontact.base.sizes import RANGE, out_of_range
from anisocontact.base.typed import typed
from anisocontact.base.until import Until
from anisocontact.rigid import turns_in_radian
from anisocontact.solver.terms.cylindrical import Cylindrical
from anisocontact.solver.terms.turn import Turn

AXES = ("x", "y", "z")
# Fields of a step that are forces with a direction.
_FORCES = ("traction", "force", "body_force")
# Fields that have one number for each name.
_PLAIN = ("pressure", "temperature")

#: Share of the way along a path above which it is said that increments cut it off.
_CUT_OFF = 0.05
#: Field of a step, name of what is prescribed, component.
Place = tuple[str, str, str]


@typed
@dataclass(frozen=True)
class Step:
    """A load step; every value goes linearly from where it is to the one given.

    What is not named keeps its value. A displacement of None releases the support: the force it
    carried goes to zero along the step. A `LoadCurve` in the place of a number is followed instead.

    Attributes:
        name: Name in progress and output.
        increments: Number of equal increments, 1 to 10,000,000.
        displacement: Facet group -> axis "x", "y" or "z" -> displacement at the end, length.
        traction: Facet group -> axis -> force per reference area at the end, stress.
        duration: Time the step takes, > 0, time.
        motion: Rigid body -> component "x", "y", "z" (translation of its reference point, length)
            or "rx", "ry", "rz" (turn about the axes of space, radian; "rx_deg", ... in degrees)
            -> value at the end. None frees the component of a free body.
        load: Rigid body -> freed component -> force, or moment about the reference point, at the
            end. Moments do not turn with the body.
        force: Group -> axis -> force on all of it at the end: a uniform traction on facets, equal
            shares on the nodes of points and edges.
        pressure: Facet group -> pressure at the end, stress, positive into the body; at finite
            strain on the area and against the normal of now, else of the reference.
        body_force: Body -> axis -> force per reference volume at the end, stress/length.
        rotation: Facet group "body.group", or rigid body, -> prescribed rotation along the
            step.
        temperature: Body whose material has an expansion -> temperature at the end, over that at
            which it has no stress.
        cylindrical: Facet group -> displacement along radial, tangential and axial directions.
        anchor: Spring -> axis -> displacement of its end on ground at the end, length.
        until: Event at which the step ends, before its end; prescribed values stay as they are.

    Raises:
        InputError: A value is out of range or no number.

    Example:
        >>> press = Step("press", 2, {"block.top": {"x": 0.0, "y": 0.0, "z": -0.01}})
        >>> pull = Step("pull", 10, {"block.top": {"z": None}}, traction={"block.top": {"z": -1.0}})
        >>> press.prescribed_groups(), pull.driven()
        (['block.top'], ['block.top'])
    """

    name: str
    increments: int
    displacement: Mapping[str, Mapping[str, PrescribedValue | None]] = field(default_factory=dict)
    traction: Mapping[str, Mapping[str, PrescribedValue]] = field(default_factory=dict)
    duration: float = 1.0
    motion: Mapping[str, Mapping[str, PrescribedValue | None]] = field(default_factory=dict)
    load: Mapping[str, Mapping[str, PrescribedValue]] = field(default_factory=dict)
    force: Mapping[str, Mapping[str, PrescribedValue]] = field(default_factory=dict)
    pressure: Mapping[str, PrescribedValue] = field(default_factory=dict)
    body_force: Mapping[str, Mapping[str, PrescribedValue]] = field(default_factory=dict)
    rotation: Mapping[str, Turn] = field(default_factory=dict)
    anchor: Mapping[str, Mapping[str, PrescribedValue]] = field(default_factory=dict)
    cylindrical: Mapping[str, Cylindrical] = field(default_factory=dict)
    temperature: Mapping[str, PrescribedValue] = field(default_factory=dict)
    until: Until | None = None

    def __post_init__(self) -> None:
        if not self.name.strip():
            raise InputError(f"{self.name!r} given, a name of one letter or more needed", "name")
        if not 1 <= self.increments <= MOST_INCREMENTS:
            allowed = f"allowed: 1 to {MOST_INCREMENTS}"
            raise self._error("increments", f"{self.increments} given, {allowed}")
        if not (math.isfinite(self.duration) and self.duration > 0.0):
            raise self._error("duration", f"{self.duration!r} given, must be > 0")
        if out_of_range(self.duration):
            raise self._error("duration", f"{self.duration!r} given, must be {RANGE}")
        for kind in ("displacement", "anchor", *_FORCES):
            self._check_vectors(kind)
        for body, components in self._by_component("load"):
            for component, value in components.items():
                self._check_value("load", f"load.{body}.{component}", value)
        motion = {
            body: turns_in_radian(components, f"step {self.name!r}.motion.{body}")
            for body, components in self._by_component("motion")
        }
        object.__setattr__(self, "motion", motion)
        for kind in _PLAIN:
            for name, value in getattr(self, kind).items():
                self._check_value(kind, f"{kind}.{name}", value)
        self._check_once()
        rotation = {
            name: replace(turn, duration=self.duration) for name, turn in self.rotation.items()
        }
        object.__setattr__(self, "rotation", rotation)

    def prescribed(self) -> Iterator[tuple[Place, PrescribedValue | None]]:
        """All values that are given, but for rotations, with where they stand."""
        for kind in ("displacement", "motion", "load", "anchor", *_FORCES):
            named: Mapping[str, Mapping[str, PrescribedValue | None]] = getattr(self, kind)
            for name, values in named.items():
                yield from (((kind, name, component), value) for component, value in values.items())
        for name, given in self.cylindrical.items():
            yield from (
                (("cylindrical", name, part), value) for part, value in given.values.items()
            )
        for kind in _PLAIN:
            plain: Mapping[str, PrescribedValue] = getattr(self, kind)
            yield from (((kind, name, ""), value) for name, value in plain.items())

    def load_curves(self) -> dict[Place, LoadCurve]:
        """Those of the values that follow an amplitude."""
        return {place: value for place, value in self.prescribed() if isinstance(value, LoadCurve)}

    def prescribed_groups(self) -> list[str]:
        """Names of the facet groups with prescribed displacements, each once."""
        return list(dict.fromkeys([*self.displacement, *self.cylindrical, *self.turned_groups()]))

    def turned_groups(self) -> dict[str, Turn]:
        """Rotations of facet groups; names of rigid bodies have no dot."""
        return {name: turn for name, turn in self.rotation.items() if "." in name}

    def turned_bodies(self) -> dict[str, Turn]:
        """Rotations of rigid bodies."""
        return {name: turn for name, turn in self.rotation.items() if "." not in name}

    def driven(self) -> list[str]:
        """Names of all groups and bodies with prescribed motion or loads, each once."""
        loaded = [name for kind in (*_FORCES, "pressure", "anchor") for name in getattr(self, kind)]
        return list(
            dict.fromkeys(
                [*self.prescribed_groups(), *loaded, *self.rotation, *self.motion, *self.load]
            )
        )

    def _check_once(self) -> None:
        """Refuse what is prescribed twice."""
        pairs = (
            ("rotation", "displacement", "a displacement of the same group"),
            ("rotation", "cylindrical", "cylindrical of the same group"),
            ("rotation", "motion", "a motion of the same rigid body"),
            ("cylindrical", "displacement", "a displacement of the same group"),
        )
        for kind, other, said in pairs:
            for name in getattr(self, kind):
                if name in getattr(self, other):
                    text = f"given with {said}, one of the two is allowed"
                    raise self._error(f"{kind}.{name}", text)

    def _check_vectors(self, kind: str) -> None:
        for group, values in self._by_component(kind):
            for axis, value in values.items():
                self._check(kind, group, axis, value)

    def _by_component(self, kind: str) -> Iterator[tuple[str, Mapping[str, Any]]]:
        """Groups or bodies of one sort, with what is given for each."""
        for name, values in getattr(self, kind).items():
            if not isinstance(values, Mapping):
                text = f'{values!r} given, values by axis needed, as in {{"x": 0.1}}'
                raise self._error(f"{kind}.{name}", text)
            yield name, values

    def _check(self, kind: str, group: str, axis: str, value: PrescribedValue | None) -> None:
        where = f"{kind}.{group}.{axis}"
        if axis not in AXES:
            raise self._error(where, f"no axis {axis!r}, allowed: {', '.join(AXES)}")
        self._check_value(kind, where, value)

    def _check_value(self, kind: str, where: str, value: PrescribedValue | None) -> None:
        if value is None and kind == "displacement":
            return
        with within(f"step {self.name!r}.{where}"):
            check_prescribed(value)

    def _error(self, where: str, message: str) -> InputError:
        return InputError(message, f"step {self.name!r}.{where}")


def check_load_curves(steps: Sequence[Step]) -> list[str]:
    """Refuse load curves that do not begin where the step before ends.

    Args:
        steps: All steps of a run.

    Returns:
        Warnings: increments that are too few to follow an amplitude.

    Raises:
        InputError: A jump, or an amplitude without a number or with two at one time.
    """
    known: dict[Place, float | None] = {}
    said = []
    for step in steps:
        turned = set(step.rotation)
        for name, turn in step.rotation.items():
            if turn.amplitude is not None:
                with within(f"step {step.name!r}.rotation.{name}.amplitude"):
                    LoadCurve(turn.amplitude).check_answers(step.duration)
        known |= {place: None for place in known if place[1] in turned}
        for place, value in step.prescribed():
            name = ".".join(part for part in place if part)
            field = f"step {step.name!r}.{name}"
            with within(field):
                known[place], coarse = _followed(step, place, value, known.get(place, 0.0))
            if coarse:
                said.append(
                    f"{field}: {step.increments} increments are too few to follow its amplitude"
                )
            if step.until is not None:  # where it ends is not known beforehand
                known[place] = None
            if place[0] == "motion":  # a load on what is freed begins with what held it
                known["load", *place[1:]] = None if value is None else 0.0
        said += _shortened(step)
    return said


def _followed(
    step: Step, place: Place, value: PrescribedValue | None, before: float | None
) -> tuple[float | None, bool]:
    """Value at the end of a step, None if it is not known before; whether increments are coarse."""
    if value is None:
        return None, False
    history = history_of(value)
    if isinstance(history, LoadCurve):
        history.check_answers(step.duration)
    after = history.end(before, step.duration)
    if after is None and place[0] == "load":
        raise InputError("relative to a reaction force, which is not known beforehand")
    return after, history.coarse(step.duration, step.increments)


def _shortened(step: Step) -> list[str]:
    """Warnings of paths whose corners and arcs the increments of a step cut off."""
    along: dict[tuple[str, str], list[LoadCurve]] = {}
    for (kind, name, axis), curve in step.load_curves().items():
        if axis in AXES and kind not in _FORCES:
            along.setdefault((kind, name), []).append(curve)
    said = []
    for (kind, name), curves in along.items():
        lost = path_cut_off(curves, step.duration, step.increments) if len(curves) > 1 else 0.0
        if lost > _CUT_OFF:
            said.append(
                f"step {step.name!r}.{kind}.{name}: {step.increments} increments cut off "
                f"{100.0 * lost:.0f} % of the way along its path, at corners or as chords of arcs"
            )
    return said
