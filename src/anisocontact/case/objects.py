"""Objects of the tables made from the registries."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Protocol

from anisocontact.anisotropy import DirectionField, make_directions
from anisocontact.base.errors import within
from anisocontact.case.quantity import AUTO
from anisocontact.case.registered import Registered
from anisocontact.interface import ContactLaw, Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw, numerical_adhesion
from anisocontact.surfaces import Surface, make_surface

if TYPE_CHECKING:
    from anisocontact.bulk import Material
    from anisocontact.case.bodies import Placed, Shaped
    from anisocontact.mesh import Body, Idealisation, Placement
    from anisocontact.mesh.selectors import Selector


class Laws(Protocol):
    """What an interface is made of: the tables of a contact."""

    normal: Any
    adhesion: Any
    friction: Any
    evolution: str


def surface(section: Registered, place: str) -> Surface:
    """The surface of a `surface.*` table."""
    with within(place):
        return make_surface(section.chosen["shape"], **section.parameters())


def material(section: Registered, place: str) -> Material:
    """The material of a `material.*` table."""
    from anisocontact.bulk import make_material

    with within(place):
        # what is left out has its default there; a default of here would count as given
        given = {k: v for k, v in section.parameters().items() if k in section.model_fields_set}
        return make_material(section.chosen["model"], **given)


def idealisation(case: Any) -> Idealisation:
    """What the `idealisation` table takes the mesh for; a body in space without one."""
    from anisocontact.mesh.idealisation import SOLID, make_idealisation

    section: Registered | None = case.idealisation
    if section is None:
        return SOLID
    with within("idealisation"):
        return make_idealisation(section.chosen["kind"], **section.parameters())


def body(section: Shaped, name: str, place: str) -> Body:
    """The body of a `mesh.<shape>.<name>` table.

    Args:
        section: The table.
        name: Name of the body.
        place: Its path, for messages.

    Returns:
        The body, not meshed yet.

    Raises:
        InputError: A value only the shape can judge is wrong.
    """
    from anisocontact.mesh import Body, make_shape

    with within(place):
        shape = make_shape(
            section.entries[0].name, cell=section.cell, order=section.order, **section.parameters()
        )
        return Body(name, shape, placement(section))


def selector(section: Registered, place: str) -> Selector:
    """The selector of a `group.*` table."""
    from anisocontact.mesh import make_selector

    with within(place):
        return make_selector(section.chosen["by"], **section.parameters())


def placement(section: Placed) -> Placement:
    """Where the bodies of a table stand."""
    from anisocontact.mesh import Placement, Rotation

    turn = None if section.rotate is None else Rotation(**dict(section.rotate))
    return Placement(section.scale, turn, section.move)


def contact_law(
    section: Laws, place: str, auto: float = 1.0, *, meshed: bool = False
) -> ContactLaw:
    """The law of a `[[contact]]` table.

    Args:
        section: The table.
        place: Its path, for messages.
        auto: Stiffness where the table says "auto" [stress/length].
        meshed: Whether the master is meshed.

    Raises:
        InputError: A direction is missing, a value only the laws can judge is wrong, or a meshed
            master does not have the evolution.
    """
    with within(place):
        law = ContactLaw(*_laws(section, auto), evolution=section.evolution)
        if meshed:
            law.check_meshed()
        return law


def interface(law: ContactLaw, master: Surface, place: str) -> Interface:
    """The interface of the law of a table with a surface.

    Raises:
        InputError: Directions on the slave with an evolution that has none there.
    """
    with within(place):
        return Interface(master, law)


def _laws(section: Laws, auto: float) -> tuple[NormalLaw, Adhesion, Friction]:
    friction = Friction(
        **section.friction.chosen,
        **_numbers(section.friction, auto),
        directions=directions(section.friction.directions, "friction.directions"),
        directions_second=directions(
            section.friction.directions_second, "friction.directions_second"
        ),
        directions_on=section.friction.directions_on,
        directions_second_on=section.friction.directions_second_on,
    )
    return normal_law(section, auto), _adhesion(section.adhesion, auto, friction), friction


def _adhesion(section: Any, auto: float, friction: Friction) -> Adhesion:
    along = directions(section.directions, "adhesion.directions")
    if along is None and section.parameters() == {"stiffness": AUTO}:
        return numerical_adhesion(friction, auto)
    return Adhesion(
        **section.chosen,
        **_numbers(section, auto),
        directions=along,
        directions_on=section.directions_on,
    )


def normal_law(section: Laws, auto: float) -> NormalLaw:
    """The law of the pressure; `auto` where the table says "auto" [stress/length]."""
    return NormalLaw(**section.normal.chosen, **_numbers(section.normal, auto))


def directions(section: Registered | None, place: str) -> DirectionField | None:
    """The direction field of a table, if there is one."""
    if section is None:
        return None
    with within(place):
        return make_directions(section.chosen["kind"], **section.parameters())


def _numbers(section: Registered, auto: float) -> dict[str, Any]:
    values = section.parameters().items()
    return {name: auto if value == AUTO else value for name, value in values}
