"""Laws of an interface: pressure, adhesion, friction."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy.typing as npt

from anisocontact import _core
from anisocontact.anisotropy import (
    BY_COORDINATES,
    DirectionField,
    components,
    require_regular,
)
from anisocontact.base import registry
from anisocontact.base.array_types import Floats
from anisocontact.base.copied_by_arguments import CopiedByArguments
from anisocontact.base.errors import InputError
from anisocontact.base.read_only import read_only
from anisocontact.base.registry import Entry
from anisocontact.base.sealed import Sealed
from anisocontact.base.typed import typed
from anisocontact.surfaces import Surface, points

Named = tuple[str, Mapping[str, Sequence[float]]]
#: Arguments of laws beside their parameters.
_SIDED = ("directions", "directions_on")
_OF_FRICTION = (*_SIDED, "directions_second", "directions_second_on", "sliding_rule")


def _named(
    registry_of: Callable[[], tuple[Entry, ...]],
    name: str,
    parameters: dict[str, object],
    field: str,
    others: tuple[str, ...] = (),
) -> Named:
    e = registry.entry(registry_of(), name, field)
    return name, read_only(registry.values(e, parameters, others=others))


@typed
class NormalLaw(Sealed):
    """Law of the pressure N of the gap.

    Args:
        model: Name in `registry.normal_laws()`.
        **parameters: Its parameters.

    Raises:
        InputError: Unknown name or parameter, or a value out of range.

    Example:
        >>> NormalLaw(penalty=1e5).named[1]["penalty"]
        (100000.0,)
    """

    def __init__(self, model: str = "penalty", **parameters: object) -> None:
        self.named = _named(registry.normal_laws, model, parameters, "normal.model")

    def stiffened(self, factor: float) -> NormalLaw:
        """The law "penalty" with another penalty.

        Args:
            factor: How many times as large it is.

        Returns:
            The stiffer law.
        """
        return NormalLaw(penalty=factor * self.named[1]["penalty"][0])


#: Bodies that may carry a direction field.
SIDES = ("master", "slave")


def _side(given: str, field: str) -> str:
    if given not in SIDES:
        raise InputError(f"{given!r} given, allowed: {', '.join(SIDES)}", field)
    return given


@typed
class Adhesion(CopiedByArguments):
    """Tangential law inside the yield ellipse.

    Args:
        model: Name in `registry.adhesion_models()`.
        directions: Axes of the tensors; may be left out where both values of every pair are
            equal, or one number is given for both.
        directions_on: "master" or "slave": the body that carries the directions. Angles count about
            the normal of the master on either: with the sides swapped they change their sign.
        **parameters: The model's parameters, such as `stiffness`, the eigenvalues of -B
            [stress/length].

    Raises:
        InputError: Unknown name or parameter, a value out of range, or no directions where the
            values differ.

    Example:
        >>> Adhesion(stiffness=1e5).named[1]["stiffness"]
        (100000.0, 100000.0)
    """

    def __init__(
        self,
        model: str = "elastic",
        *,
        directions: DirectionField | None = None,
        directions_on: str = "master",
        **parameters: object,
    ) -> None:
        self.named = _named(registry.adhesion_models, model, parameters, "adhesion.model", _SIDED)
        entry = registry.entry(registry.adhesion_models(), model)
        _need_directions("adhesion", directions, entry, self.named)
        self.directions = directions
        self.directions_on = _side(directions_on, "adhesion.directions_on")

    def stiffened(self, factor: float) -> Adhesion:
        """The model "elastic" with other stiffnesses.

        Args:
            factor: How many times as large they are.

        Returns:
            The stiffer model, with the same directions.
        """
        first, second = self.named[1]["stiffness"]
        return Adhesion(
            stiffness=(factor * first, factor * second),
            directions=self.directions,
            directions_on=self.directions_on,
        )


@typed
class Friction(CopiedByArguments):
    """Yield ellipse and sliding rule.

    Args:
        model: Name in `registry.friction_models()`.
        directions: Axes of the friction tensor; may be left out where both values of every pair
            are equal, or one number is given for both.
        directions_second: Axes of the second surface, for a model of two surfaces that is not the
            same all around.
        directions_on: "master" or "slave": the body that carries the directions. Angles count about
            the normal of the master on either: with the sides swapped they change their sign.
        directions_second_on: The body that carries those of the second surface. Slave points alone,
            without a surface, have none: all of them then count on the master.
        sliding_rule: Name in `registry.sliding_rules()`.
        **parameters: Parameters of the model, such as `coefficients`, and of the sliding rule,
            such as `history`. Coefficients of 0 are contact without friction: there is no
            tangential force, whatever the adhesion, and every point that touches slips.

    Attributes:
        frictionless: Whether there is no friction at all.

    Raises:
        InputError: Unknown name or parameter, a value out of range, or directions that are missing
            or too many.

    Example:
        >>> Friction(coefficients=0.3).rule[0], Friction(coefficients=0).frictionless
        ('maximum-dissipation', True)
    """

    def __init__(
        self,
        model: str = "orthotropic",
        *,
        directions: DirectionField | None = None,
        directions_second: DirectionField | None = None,
        directions_on: str = "master",
        directions_second_on: str = "slave",
        sliding_rule: str = "maximum-dissipation",
        **parameters: object,
    ) -> None:
        rule = registry.entry(registry.sliding_rules(), sliding_rule, "friction.sliding_rule")
        of_rule = {key for p in rule.parameters for key in (p.name, f"{p.name}_deg")}
        own = {k: v for k, v in parameters.items() if k not in of_rule}
        self.named = _named(registry.friction_models, model, own, "friction.model", _OF_FRICTION)
        self.rule: Named = (
            sliding_rule,
            read_only(registry.values(rule, {k: v for k, v in parameters.items() if k in of_rule})),
        )
        entry = registry.entry(registry.friction_models(), model)
        if entry.directions == 2:
            _need_both(entry, self.named, directions, directions_second)
        else:
            _need_directions("friction", directions, entry, self.named)
            _refuse_second(model, directions_second)
        _need_directions("friction", directions, rule, self.rule)
        self.directions, self.directions_second = directions, directions_second
        self.directions_on = _side(directions_on, "friction.directions_on")
        self.directions_second_on = _side(directions_second_on, "friction.directions_second_on")
        try:
            self.core = _core.FrictionModel(*self.named)
        except ValueError as error:
            name, _, line = str(error).partition(": ")
            raise InputError(line, field=f"friction.{name}") from None
        self.frictionless: bool = self.core.frictionless

    def tensor(self, surface: Surface, xi: npt.ArrayLike, placement: str = "contra") -> Floats:
        """Friction tensor F of the yield ellipse T.FT = N^2.

        Args:
            surface: The surface.
            xi: Coordinates, (n, 2).
            placement: "co", "contra", "mixed" or "spatial".

        Returns:
            Components, (n, 2, 2), or the spatial tensor, (n, 3, 3)
            [Konyukhov Schweizerhof 2006, eq. (36), (43), (57)].

        Raises:
            InputError: A point where a direction field has no direction, or no friction at all.

        Example:
            >>> from anisocontact.surfaces import make_surface
            >>> plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
            >>> Friction(coefficients=(0.5, 0.5)).tensor(plane, [[0, 0]])[0].tolist()
            [[4.0, 0.0], [0.0, 4.0]]
        """
        if self.frictionless:
            raise InputError("0 given, F is infinite without friction", field="friction.tensor")
        xi = points(xi, 2, "xi")
        first, second = (d.core if d else None for d in (self.directions, self.directions_second))
        r = self.core.tensor(surface.core, xi, first, second)
        require_regular(surface, xi, r["valid"])
        a = surface.geometry(xi).a_co
        return components(surface, xi, a @ r["contra"] @ a, placement)


def _need_both(
    entry: Entry, named: Named, directions: DirectionField | None, second: DirectionField | None
) -> None:
    """Checks that a model of two surfaces has the directions of both, unless it needs none."""
    if _same_all_around(entry, named):
        return
    for name, given in (("directions", directions), ("directions_second", second)):
        if given is None:
            raise InputError(
                f"missing; friction model {entry.name!r} needs the directions of both surfaces",
                field=f"friction.{name}",
            )


def _refuse_second(model: str, second: DirectionField | None) -> None:
    if second is not None:
        raise InputError(
            f"given, but friction model {model!r} has one surface with directions",
            field="friction.directions_second",
        )


def _same_all_around(entry: Entry, named: Named) -> bool:
    return all(p.same_all_around(named[1][p.name]) for p in entry.parameters)


def _need_directions(
    what: str, directions: DirectionField | None, entry: Entry, named: Named
) -> None:
    if directions is not None:
        return
    for p in entry.parameters:
        numbers = named[1][p.name]
        if not p.same_all_around(numbers):
            shown = ", ".join(f"{v:g}" for v in numbers)
            values = "two different values" if len(numbers) == 2 else "different values"
            raise InputError(
                f"{what} has {values} of {p.name} ({shown}) and no directions; give directions, or "
                "one number",
                field=f"{what}.directions",
            )


@dataclass(frozen=True)
class CarriedDirections:
    """A direction field of the laws of a contact and the body that carries it.

    Args:
        place: Where it is given, "adhesion.directions" and the like.
        field: The field, if there is one.
        on: "master" or "slave".

    Example:
        >>> CarriedDirections("friction.directions", None, "slave").on_slave  # there is no field
        False
    """

    place: str
    field: DirectionField | None
    on: str

    @property
    def on_slave(self) -> bool:
        """Whether there is a field and the slave carries it."""
        return self.field is not None and self.on == "slave"

    def check_meshed(self, body: str) -> None:
        """Check that a meshed body can carry the field.

        Args:
            body: "master" or "slave".

        Raises:
            InputError: The field is given by coordinates of a surface.
        """
        if self.field is not None and self.on == body and self.field.name in BY_COORDINATES:
            raise InputError(
                f"{self.field.name!r} goes by the coordinates of a surface, and the {body} that "
                "carries it is a mesh; give the directions in space, or in Python "
                "facet_directions with that surface",
                self.place,
            )


def carried_directions(
    adhesion: Adhesion, friction: Friction
) -> tuple[CarriedDirections, CarriedDirections, CarriedDirections]:
    """The direction fields of two laws, and which body carries them.

    Args:
        adhesion: Law inside the yield ellipse.
        friction: The yield ellipse.

    Returns:
        Those of adhesion, of friction, and of the second surface of friction.

    Example:
        >>> both = carried_directions(Adhesion(stiffness=(5, 5)), Friction(coefficients=(0.3, 0.3)))
        >>> [one.field is None for one in both]
        [True, True, True]
    """
    return (
        CarriedDirections("adhesion.directions", adhesion.directions, adhesion.directions_on),
        CarriedDirections("friction.directions", friction.directions, friction.directions_on),
        CarriedDirections(
            "friction.directions_second",
            friction.directions_second,
            friction.directions_second_on,
        ),
    )
