"""The laws of a contact in a case file, as types made from the registries."""

from __future__ import annotations

from functools import cache
from typing import Annotated, Any

from pydantic import Field, create_model

from anisocontact.base.registry import Entry
from anisocontact.case.python_section import PythonSection
from anisocontact.case.quantity import word
from anisocontact.case.registered import Key, OneOf, Registered, default_of
from anisocontact.case.registries import Registries
from anisocontact.case.section import Section
from anisocontact.interface import Interface
from anisocontact.laws import SIDES, Adhesion, Friction, NormalLaw

_DIRECTIONS = "direction field of the axes; needed where the two values of a pair differ"
_CARRIER = "body that carries these directions; angles count about the master's normal on either"
_DIRECTIONS_SECOND = "directions of the second surface, for a friction model of two surfaces"


class Directed(Registered):
    """A law whose axes follow a direction field."""

    directions: Any = None
    directions_on: str = SIDES[0]


def laws_or_python(known: Registries) -> dict[str, Any]:
    """`laws`, with a law in Python that may stand in place of those of the core."""
    fields = laws(known)
    friction, about = fields["friction"]
    python = _directed("Python", PythonSection, known, "direction field of the law's first axis")
    text = f"{about.description}; needed unless there is a law in Python"
    return fields | {
        "friction": (friction, Field(None, description=text)),
        "python": (python | None, Field(None, description=str(PythonSection.__doc__))),
    }


@cache
def _field(known: Registries) -> Any:
    """A table of a direction field."""
    return Annotated[Any, OneOf("Directions", Key("kind", known.direction_fields))]


def _directed(name: str, base: type[Section], known: Registries, about: str) -> Any:
    """A table with a direction field and the body that carries it."""
    return create_model(
        name,
        __base__=base,
        directions=(_field(known), Field(None, description=about)),
        directions_on=_on("master"),
    )


def _on(default: str) -> tuple[Any, str]:
    """A key for the body that carries a direction field."""
    return Annotated[str, word(_CARRIER, *SIDES)], default


def laws(known: Registries) -> dict[str, Any]:
    """Fields of a contact that come from the registries."""
    directed = _directed("Directed", Directed, known, _DIRECTIONS)
    twice_directed = create_model(
        "TwiceDirected",
        __base__=directed,
        directions_second=(_field(known), Field(None, description=_DIRECTIONS_SECOND)),
        directions_second_on=_on("slave"),
    )
    normal = OneOf("Normal", Key("model", known.normal_laws, default_of(NormalLaw, "model")))
    adhesion = OneOf(
        "Adhesion",
        Key("model", known.adhesion_models, default_of(Adhesion, "model")),
        base=directed,
    )
    friction = OneOf(
        "Friction",
        Key("model", known.friction_models, default_of(Friction, "model")),
        Key("sliding_rule", known.sliding_rules, default_of(Friction, "sliding_rule")),
        base=twice_directed,
    )
    return {
        "normal": (Annotated[Any, normal], Field(normal.validate({}), description="pressure law")),
        "adhesion": (
            Annotated[Any, adhesion],
            Field(adhesion.validate({}), description="tangential law inside the yield ellipse"),
        ),
        "friction": (Annotated[Any, friction], Field(description="yield ellipse and sliding rule")),
        "evolution": (
            Annotated[str, word("how the history enters a step", *_names(known.evolution_forms))],
            default_of(Interface, "evolution"),
        ),
    }


def _names(entries: tuple[Entry, ...]) -> list[str]:
    return [entry.name for entry in entries]
