"""Tables of rigid bodies: surfaces that move, how they are moved and loaded."""

from __future__ import annotations

from typing import Annotated, Any, Self

from pydantic import Field, model_validator
from pydantic_core import ErrorDetails

from anisocontact.case.amplitudes import PATH, Scheduled, prescribed
from anisocontact.case.bodies import Point
from anisocontact.case.quantity import FREE, line, number
from anisocontact.case.section import Section

_TURNS = ("rx", "ry", "rz")


class Springs(Section):
    """Springs from the reference point to ground, against translation and turn."""

    x: Annotated[float, number("scalar", "force/length", "along x", "non-negative")] = 0.0
    y: Annotated[float, number("scalar", "force/length", "along y", "non-negative")] = 0.0
    z: Annotated[float, number("scalar", "force/length", "along z", "non-negative")] = 0.0
    rx: Annotated[float, number("scalar", "force length/rad", "about x", "non-negative")] = 0.0
    ry: Annotated[float, number("scalar", "force length/rad", "about y", "non-negative")] = 0.0
    rz: Annotated[float, number("scalar", "force length/rad", "about z", "non-negative")] = 0.0

    def given(self) -> dict[str, float]:
        """Stiffnesses by component, those that are not zero."""
        return {name: value for name, value in self if value > 0.0}


class Rigid(Section):
    """A rigid body: surfaces and faces that move as one. What no step moves or frees is held."""

    surfaces: list[str] | None = Field(
        None,
        description="surfaces it carries; if left out the one of its own name, none if it has "
        "faces",
    )
    faces: list[str] = Field(
        default_factory=list,
        description='facet groups that move with it, "body.group": it is their reference point',
    )
    reference: Annotated[
        Point,
        number("vector", "length", "reference point: it is turned about it, moments are about it"),
    ]
    springs: Springs = Field(Springs(), description=str(Springs.__doc__))

    def carries(self, name: str) -> list[str]:
        """Its surfaces, `name` being its own name."""
        own = [] if self.faces else [name]
        return own if self.surfaces is None else self.surfaces


def _turn(axis: str) -> Any:
    return Annotated[
        float | Scheduled | str | None, prescribed("angle", f"turn about {axis}", word=FREE)
    ]


class Motion(Section):
    """Motion of a rigid body at the end of the step; "free" lets a component go.

    Turns are about axes of space through its reference point; `rotation` has others.
    """

    x: Annotated[float | Scheduled | str | None, prescribed("length", "along x", word=FREE)] = None
    y: Annotated[float | Scheduled | str | None, prescribed("length", "along y", word=FREE)] = None
    z: Annotated[float | Scheduled | str | None, prescribed("length", "along z", word=FREE)] = None
    rx_deg: _turn("x") = None  # type: ignore[valid-type]
    ry_deg: _turn("y") = None  # type: ignore[valid-type]
    rz_deg: _turn("z") = None  # type: ignore[valid-type]
    path: str | None = PATH

    @classmethod
    def _text(cls, e: ErrorDetails) -> str:
        if e["type"] == "extra_forbidden" and e["loc"][-1] in _TURNS:
            return f"unknown key; turns are given in degrees: {e['loc'][-1]}_deg"
        return super()._text(e)

    @model_validator(mode="after")
    def _some(self) -> Self:
        if not self.components() and self.path is None:
            keys = "x, y, z, rx_deg, ry_deg, rz_deg, path"
            raise line(f"nothing given, at least one of {keys} needed")
        return self

    def components(self) -> dict[str, float | Scheduled | None]:
        """Values by component, see `given`."""
        return {key.removesuffix("_deg"): value for key, value in self.given().items()}

    def given(self) -> dict[str, float | Scheduled | None]:
        """Values by key: None where free, turns in degrees."""
        values = ((key, value) for key, value in self if value is not None and key != "path")
        return {key: None if value == FREE else value for key, value in values}


class Load(Section):
    """Forces and moments on free components of a rigid body at the end of the step.

    Moments are about the reference point and along axes of space; they do not turn with the body.
    """

    x: Annotated[float | Scheduled | None, prescribed("force", "force along x")] = None
    y: Annotated[float | Scheduled | None, prescribed("force", "force along y")] = None
    z: Annotated[float | Scheduled | None, prescribed("force", "force along z")] = None
    rx: Annotated[float | Scheduled | None, prescribed("force length", "moment about x")] = None
    ry: Annotated[float | Scheduled | None, prescribed("force length", "moment about y")] = None
    rz: Annotated[float | Scheduled | None, prescribed("force length", "moment about z")] = None

    @model_validator(mode="after")
    def _some(self) -> Self:
        if not self.given():
            raise line("nothing given, at least one of x, y, z, rx, ry, rz needed")
        return self

    def given(self) -> dict[str, float | Scheduled]:
        """Values by component."""
        return {name: value for name, value in self if value is not None}
