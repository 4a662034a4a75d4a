"""Tables of what a load step prescribes."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Annotated, Any, Self

from pydantic import Field, model_validator
from pydantic_core import ErrorDetails

from anisocontact.case.amplitudes import PATH, Scheduled, prescribed, times
from anisocontact.case.bodies import Point, Rotate
from anisocontact.case.quantity import FREE, line, number
from anisocontact.case.section import Section


class Components(Section):
    """Components of a vector; what is left out is not prescribed."""

    @model_validator(mode="after")
    def _some(self) -> Self:
        keys = [key for key in ("x", "y", "z", "path") if key in type(self).model_fields]
        if all(getattr(self, key) is None for key in keys):
            raise line(f"nothing given, at least one of {', '.join(keys)} needed")
        return self

    @classmethod
    def _text(cls, e: ErrorDetails) -> str:
        text = super()._text(e)
        in_pieces = e["type"] == "extra_forbidden" and isinstance(e["input"], dict)
        return f'{text}; a group is written in quotes: "body.group"' if in_pieces else text

    def given(self) -> dict[str, Any]:
        """The components that are prescribed."""
        values = {axis: getattr(self, axis) for axis in ("x", "y", "z")}
        return {axis: value for axis, value in values.items() if value is not None}


class Displacement(Components):
    """Displacement of a facet group at the end of the step; "free" releases the support."""

    x: Annotated[float | Scheduled | str | None, prescribed("length", "along x", word=FREE)] = None
    y: Annotated[float | Scheduled | str | None, prescribed("length", "along y", word=FREE)] = None
    z: Annotated[float | Scheduled | str | None, prescribed("length", "along z", word=FREE)] = None
    path: str | None = PATH


class CylindricalMotion(Section):
    """Displacement of a group along directions of cylinder coordinates; "free" releases them.

    Directions are those at the places of the nodes in the mesh, about an axis through a point.
    """

    radial: Annotated[
        float | Scheduled | str | None, prescribed("length", "away from the axis", word=FREE)
    ] = None
    tangential: Annotated[
        float | Scheduled | str | None,
        prescribed("length", "about the axis, right-handed", word=FREE),
    ] = None
    axial: Annotated[
        float | Scheduled | str | None, prescribed("length", "along the axis", word=FREE)
    ] = None
    axis: Annotated[Point, number("vector", "1", "direction of the axis")] = (0.0, 0.0, 1.0)
    point: Annotated[Point, number("vector", "length", "a point of the axis")] = (0.0, 0.0, 0.0)

    def given(self) -> dict[str, Any]:
        """The components that are prescribed."""
        values = {name: getattr(self, name) for name in ("radial", "tangential", "axial")}
        return {name: value for name, value in values.items() if value is not None}


class Traction(Components):
    """Force per reference area on a facet group at the end of the step."""

    x: Annotated[float | Scheduled | None, prescribed("stress", "along x")] = None
    y: Annotated[float | Scheduled | None, prescribed("stress", "along y")] = None
    z: Annotated[float | Scheduled | None, prescribed("stress", "along z")] = None


class Force(Components):
    """Force on a whole facet group, as a uniform traction, or on nodes, in equal shares."""

    x: Annotated[float | Scheduled | None, prescribed("force", "along x")] = None
    y: Annotated[float | Scheduled | None, prescribed("force", "along y")] = None
    z: Annotated[float | Scheduled | None, prescribed("force", "along z")] = None


class BodyForce(Components):
    """Force on a body per reference volume, or its acceleration where a density is given."""

    x: Annotated[float | Scheduled | None, prescribed("stress/length", "along x")] = None
    y: Annotated[float | Scheduled | None, prescribed("stress/length", "along y")] = None
    z: Annotated[float | Scheduled | None, prescribed("stress/length", "along z")] = None
    density: Annotated[
        float,
        number(
            "scalar",
            "mass/length^3",
            "factor of the components, which are then accelerations",
            "positive",
        ),
    ] = 1.0

    def given(self) -> dict[str, Any]:
        """Components of the force per volume."""
        return {axis: times(value, self.density) for axis, value in super().given().items()}


class Gravity(Components):
    """Acceleration of all bodies, times `density` of the material a force per volume."""

    x: Annotated[float | Scheduled | None, prescribed("length/time^2", "along x")] = None
    y: Annotated[float | Scheduled | None, prescribed("length/time^2", "along y")] = None
    z: Annotated[float | Scheduled | None, prescribed("length/time^2", "along z")] = None


def accelerations(tables: Iterable[Gravity | BodyForce]) -> list[float]:
    """How large some accelerations are, without those that are zero.

    Args:
        tables: Gravity, or forces on bodies of a density; of values that follow an amplitude the
            factor of it counts.

    Returns:
        Their sizes, length over time squared, each of them once.

    Example:
        >>> accelerations([Gravity(x=3.0, z=-4.0), Gravity(z=0.0)])
        [5.0]
    """
    rows = ([table.x, table.y, table.z] for table in tables)
    found = (
        math.hypot(*(one.value if isinstance(one, Scheduled) else one or 0.0 for one in row))
        for row in rows
    )
    return list(dict.fromkeys(size for size in found if size > 0.0))


class Anchor(Components):
    """Displacement of a spring's end on ground at the end of the step."""

    x: Annotated[float | Scheduled | None, prescribed("length", "along x")] = None
    y: Annotated[float | Scheduled | None, prescribed("length", "along y")] = None
    z: Annotated[float | Scheduled | None, prescribed("length", "along z")] = None
    path: str | None = PATH


class ElasticBed(Section):
    """A bed of springs between a facet group and ground, along the reference normal and across."""

    normal: Annotated[
        float, number("scalar", "stress/length", "stiffness along the normal", "non-negative")
    ] = 0.0
    tangential: Annotated[
        float, number("scalar", "stress/length", "stiffness along the surface", "non-negative")
    ] = 0.0


class GroupSpring(Section):
    """A spring between a facet group, by its mean displacement, and ground or another group."""

    group: str = Field(description='facet group, "body.group"')
    to: str | None = Field(None, description="the other facet group; ground if left out")
    stiffness: Annotated[
        Point, number("vector", "force/length", "stiffness along x, y and z", "non-negative")
    ]


class Turning(Rotate):
    """Rotation of a facet group or rigid body along the step, from where it is.

    The axis may move.
    """

    move: Annotated[Point, number("vector", "length", "translation of the axis along the step")] = (
        0.0,
        0.0,
        0.0,
    )
    amplitude: str | None = Field(
        None,
        description="name of an amplitude that begins at 0: angle and translation times it; linear "
        "along the step if left out",
    )


class Loading(Section):
    """What a step prescribes of facet groups and bodies."""

    displacement: dict[str, Displacement] = Field(
        default_factory=dict, description='prescribed displacements by "body.group"'
    )
    cylindrical: dict[str, CylindricalMotion] = Field(
        default_factory=dict,
        description='prescribed displacements along cylindrical directions by "body.group"',
    )
    rotation: dict[str, Turning] = Field(
        default_factory=dict, description='prescribed rotations by "body.group" or rigid body'
    )
    traction: dict[str, Traction] = Field(
        default_factory=dict, description='forces per reference area by "body.group"'
    )
    force: dict[str, Force] = Field(
        default_factory=dict,
        description='forces on whole facet groups, points or edges by "body.group"',
    )
    pressure: dict[str, Annotated[float | Scheduled, prescribed("stress", "pressure")]] = Field(
        default_factory=dict,
        description='pressures by "body.group", positive into the body; they follow a body at '
        "finite strain",
    )
    body_force: dict[str, BodyForce] = Field(
        default_factory=dict, description="forces per volume by body"
    )

    gravity: Gravity | None = Field(None, description=str(Gravity.__doc__))
    temperature: dict[
        str, Annotated[float | Scheduled, prescribed("temperature", "temperature")]
    ] = Field(
        default_factory=dict,
        description="temperature by body whose material has an expansion, over that without stress",
    )
    anchor: dict[str, Anchor] = Field(
        default_factory=dict, description="displacements of the ends of springs on ground, by name"
    )

    def groups(self) -> list[tuple[str, str]]:
        """Every facet group that is named, with the key it is named under."""
        kinds = ("displacement", "cylindrical", "rotation", "traction", "force", "pressure")
        named = [(kind, group) for kind in kinds for group in getattr(self, kind)]
        return [(kind, name) for kind, name in named if kind != "rotation" or "." in name]
