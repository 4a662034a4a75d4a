"""The tables of loads and points in the case file of the point driver."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, GetJsonSchemaHandler
from pydantic_core import CoreSchema, core_schema

from anisocontact.base.registry import Entry
from anisocontact.case.quantity import line, shown, word
from anisocontact.case.registered import Registered
from anisocontact.case.section import Section
from anisocontact.point import DeadLoad, DraggingSpring, Group, Load, PrescribedPath, Push
from anisocontact.point.device import FRAMES
from anisocontact.point.group import ORIENTATIONS

# More steps than anyone waits for: a slip of the keyboard.
_MOST_STEPS = 10_000_000

_FORMS = {0: "a number", 1: "a list of numbers", 2: "a list of lists of numbers"}


@dataclass(frozen=True)
class Numbers:
    """Annotation of numbers in lists; what only the load can judge is left to it.

    Args:
        unit: Unit.
        depths: How deep the lists may be: 0 a number, 1 a list, 2 a list of lists.
        whole: Whether they are whole and positive.
    """

    unit: str
    depths: tuple[int, ...]
    whole: bool = False

    def check(self, given: object) -> Any:
        """The value as it stands.

        Args:
            given: What is written.

        Raises:
            PydanticCustomError: It is of another form, or a number is not finite or not whole.
        """
        if _depth(given) not in self.depths or not self._good(given):
            forms = " or ".join(_FORMS[d] for d in self.depths)
            kind = "whole numbers > 0" if self.whole else "finite numbers"
            raise line(f"{shown(given)} given, {forms} needed, {kind}")
        return given

    def _good(self, given: object) -> bool:
        if isinstance(given, list):
            return bool(given) and all(self._good(v) for v in given)
        if isinstance(given, bool) or not isinstance(given, int | float):
            return False
        if not math.isfinite(given):
            return False
        return not self.whole or (given == int(given) and 0 < given <= _MOST_STEPS)

    def __get_pydantic_core_schema__(self, source: object, handler: object) -> CoreSchema:
        """Pydantic asks: every check is ours."""
        return core_schema.no_info_plain_validator_function(self.check)

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """Pydantic asks: nested arrays of numbers."""
        bound: dict[str, Any] = {"minimum": 1} if self.whole else {}
        form: dict[str, Any] = {"type": "integer" if self.whole else "number", **bound}
        forms = [form]
        for _ in range(max(self.depths)):
            forms.append({"type": "array", "items": forms[-1]})
        allowed = [forms[d] for d in self.depths]
        return {"unit": self.unit, **(allowed[0] if len(allowed) == 1 else {"anyOf": allowed})}


def _depth(given: object) -> int:
    """How deep lists are nested; -1 where they are uneven."""
    if not isinstance(given, list):
        return 0
    inner = {_depth(v) for v in given} or {0}
    return inner.pop() + 1 if len(inner) == 1 and -1 not in inner else -1


class LoadSection(Registered):
    """Keys that every load has."""

    python: ClassVar[Callable[..., Load]]

    times: Annotated[Any, Numbers("time", (1,))] = Field(
        default=None, description="times of the knots; 0, 1, 2, ... if left out"
    )
    increments: Annotated[Any, Numbers("1", (0, 1), whole=True)] = Field(
        default=20, description="steps of each segment between knots, one number or a list"
    )
    pressure: Annotated[Any, Numbers("stress", (0, 1))] = Field(
        default=None, description="N, one number or one for each knot; either this or the gap"
    )
    gap: Annotated[Any, Numbers("length", (0, 1))] = Field(
        default=None,
        description="gap of the reference, negative in contact, in place of a pressure",
    )

    @classmethod
    def entry(cls) -> Entry:
        """Name and description, as of a registry."""
        name = cls.model_fields["kind"].default
        return Entry(name, "load", (cls.__doc__ or "").split("\n")[0], ())

    def build(self) -> Load:
        """The load in Python."""
        given = {k: v for k, v in self if k != "kind" and v is not None}
        return type(self).python(**given)


_START = "the reference at the start: three numbers in space, or two surface coordinates"
_PATH = "knots, joined by straight lines: positions in space, or pairs of surface coordinates"
_FRAME = "what the components belong to; all but space turn with the surface"


class PathSection(LoadSection):
    """A prescribed path of the reference."""

    python = PrescribedPath
    kind: Literal["path"] = "path"
    path: Annotated[Any, Numbers("length", (2,))] = Field(description=_PATH)


class SpringSection(LoadSection):
    """A spring whose free end moves along a path; without pressure and gap it also presses."""

    python = DraggingSpring
    kind: Literal["spring"] = "spring"
    path: Annotated[Any, Numbers("length", (2,))] = Field(description=_PATH)
    stiffness: Annotated[Any, Numbers("force/length", (0, 1, 2))] = Field(
        description="one number, three along x, y, z, or a matrix"
    )
    start: Annotated[Any, Numbers("length", (1,))] = Field(
        default=None, description=f"{_START}; under the free end if left out"
    )


class DeadLoadSection(LoadSection):
    """A tangential force of given size and direction, with a dashpot past the friction limit."""

    python = DeadLoad
    kind: Literal["dead-load"] = "dead-load"
    force: Annotated[Any, Numbers("force", (2,))] = Field(
        description="knots of the force: its components in the frame"
    )
    start: Annotated[Any, Numbers("length", (1,))] = Field(description=_START)
    frame: Annotated[str, word(_FRAME, *FRAMES)] = "space"
    viscosity: Annotated[Any, Numbers("force*time/length", (0,))] = Field(
        default=None,
        description="of the dashpot; if left out, 1e-4 times the largest tangential stiffness "
        "times the duration",
    )


class PushSection(LoadSection):
    """A force of given direction that grows to move the point a given length along it."""

    python = Push
    kind: Literal["push"] = "push"
    direction: Annotated[Any, Numbers("1", (1, 2))] = Field(
        description="direction of the force in the frame, or knots of it"
    )
    travel: Annotated[Any, Numbers("length", (1,))] = Field(
        description="knots of the length moved along the direction"
    )
    start: Annotated[Any, Numbers("length", (1,))] = Field(description=_START)
    frame: Annotated[str, word(_FRAME, *FRAMES)] = "space"


#: Tables of all loads.
LOADS: tuple[type[LoadSection], ...] = (PathSection, SpringSection, DeadLoadSection, PushSection)


class GroupSection(Section):
    """Points that are rigidly linked; a single point at the reference if left out."""

    offsets: Annotated[Any, Numbers("length", (2,))] = Field(
        default=None,
        description="places of the points relative to the reference: three numbers in space each, "
        "or two in the tangent plane at the start",
    )
    areas: Annotated[Any, Numbers("area", (0, 1))] = Field(
        default=1.0, description="area each point stands for, one number or a list"
    )
    orientation: Annotated[
        str, word('"surface" turns with the normal, "free" also about it', *ORIENTATIONS)
    ] = "held"

    def build(self) -> Group:
        """The points in Python."""
        return Group(**{name: value for name, value in self if value is not None})
