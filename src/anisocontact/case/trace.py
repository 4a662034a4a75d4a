"""The case file of the point driver: a surface, its laws, a load."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, ValidationError, create_model

from anisocontact.base.errors import InputError, within
from anisocontact.case import objects
from anisocontact.case.contact_laws import laws
from anisocontact.case.quantity import AUTO, number
from anisocontact.case.read import CaseError, as_input, read_tables, without_null
from anisocontact.case.registered import Key, OneOf
from anisocontact.case.registries import Registries
from anisocontact.case.section import Section
from anisocontact.case.trace_load import LOADS, GroupSection
from anisocontact.interface import Interface
from anisocontact.point import Group, Load

_NO_AUTO = '"auto" given or nothing, a number needed: a point has no mesh that a value follows from'


class TraceOutput(Section):
    """What is written beside the table and the summary."""

    pictures: Annotated[bool, number("flag", "1", "whether pictures and report.html are made")] = (
        True
    )


class TraceContact(Section):
    """The laws of the contact."""

    normal: Any
    adhesion: Any
    friction: Any
    evolution: str


class TraceCase(Section):
    """A whole case file of the point driver; `trace_type()` adds the tables of the registries."""

    title: str = Field("", description="heading of the pictures and the report")
    surface: Any
    contact: TraceContact
    load: Any
    group: GroupSection = GroupSection()
    compare: list[dict[str, Any]] = Field(
        default_factory=list,
        description="further runs, each a table of keys of contact.friction that are replaced, "
        "such as sliding_rule, and a label",
    )
    output: TraceOutput = TraceOutput()


@dataclass(frozen=True)
class Trace:
    """Everything a drive needs.

    Args:
        case: The checked file.
        interface: The interface.
        load: The load.
        group: The points.
        compared: Label and interface of the further runs.
        text: The file as it was written.
        name: Name of the case.
    """

    case: TraceCase
    interface: Interface
    load: Load
    group: Group
    compared: list[tuple[str, Interface]] = field(default_factory=list)
    text: str = ""
    name: str = ""


def load_trace(path: str | Path) -> Trace:
    """Read and check a case file of the point driver.

    Args:
        path: The TOML file.

    Returns:
        Interface, load and points.

    Raises:
        InputError: The file is missing or is not TOML.
        CaseError: Something in it is wrong; `errors` has a line for each mistake.
    """
    path = Path(path)
    text, tables = read_tables(path)
    trace = validate_trace(tables)
    parent = path.resolve().parent.name
    name = parent if path.stem in ("case", "trace") and parent else path.stem
    return Trace(trace.case, trace.interface, trace.load, trace.group, trace.compared, text, name)


def validate_trace(data: Mapping[str, Any]) -> Trace:
    """A case of the point driver from nested tables, as `tomllib` returns them.

    Returns:
        Interface, load and points.

    Raises:
        CaseError: Something in it is wrong.
    """
    case = _checked(trace_type(Registries.of_points()), data)
    errors = list(_automatic(case.contact))
    builders: dict[str, Callable[[], Any]] = {
        "load": lambda: _within("load", case.load.build),
        "group": lambda: _within("group", case.group.build),
    }
    if not errors:
        builders["interface"] = lambda: _interface(case, case.contact)
        builders["compared"] = lambda: list(_compared(case, data))
    built: dict[str, Any] = {}
    for name, build in builders.items():
        try:
            built[name] = build()
        except InputError as error:
            errors += getattr(error, "errors", [error])
    if errors:
        raise CaseError(errors)
    return Trace(case, **built)


def trace_schema() -> dict[str, Any]:
    """JSON Schema of the case file of the point driver."""
    schema = trace_type(Registries.of_points()).model_json_schema()
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **_without_auto(without_null(schema)),
        "title": "anisocontact case file of the point driver",
    }


@cache
def trace_type(known: Registries) -> type[TraceCase]:
    """The type of a case file that can name what is in the registries."""
    contact = create_model("Contact", __base__=TraceContact, **laws(known))
    surface = OneOf("Surface", Key("shape", known.surfaces))
    return create_model(
        "TraceCase",
        __base__=TraceCase,
        surface=(Annotated[Any, surface], Field(description="the rigid surface")),
        contact=(contact, Field(description="the laws of the contact")),
        load=(Annotated[Any, _Loads()], Field(description="what moves and presses the points")),
    )


class _Loads(OneOf):
    """The table of a load, chosen by `kind`."""

    def __init__(self) -> None:
        self.keys = (Key("kind", tuple(load.entry() for load in LOADS)),)
        self._models = {(load.entry(),): load for load in LOADS}


def _checked(kind: type[TraceCase], data: Mapping[str, Any]) -> TraceCase:
    if "mesh" in data and "load" not in data:
        raise InputError("mesh given and no load: this is a case of `anisocontact run`")
    try:
        return kind.model_validate(data)
    except ValidationError as error:
        raise CaseError([as_input(e) for e in error.errors(include_url=False)]) from None


def _automatic(contact: Any) -> Iterator[InputError]:
    """Values that only a mesh could give."""
    for law in ("normal", "adhesion", "friction"):
        for name, value in getattr(contact, law):
            if value == AUTO:
                yield InputError(_NO_AUTO, field=f"contact.{law}.{name}")


def _interface(case: TraceCase, contact: Any) -> Interface:
    law = objects.contact_law(contact, "contact")
    return objects.interface(law, objects.surface(case.surface, "surface"), "contact")


def _within(place: str, build: Callable[[], Any]) -> Any:
    with within(place):
        return build()


def _compared(case: TraceCase, data: Mapping[str, Any]) -> Iterator[tuple[str, Interface]]:
    """Interfaces of the further runs: the friction table with keys replaced.

    Another rule or model takes none of the parameters of the one it replaces.
    """
    friction = dict(data["contact"]["friction"])
    own = {p.name for entry in case.contact.friction.entries for p in entry.parameters}
    labels: dict[str, str] = {}
    for i, change in enumerate(case.compare):
        table = {k: v for k, v in change.items() if k != "label"}
        if not table:
            text = "nothing of the friction given, one key or more that is another needed"
            raise InputError(text, f"compare[{i}]")
        label = change.get("label", ", ".join(str(v) for v in table.values()))
        if not isinstance(label, str):
            raise InputError(f"{label!r} given, a text in quotes needed", f"compare[{i}].label")
        if (first := labels.setdefault(label, f"compare[{i}]")) != f"compare[{i}]":
            raise InputError(f"{label!r} given, {first} has that label", f"compare[{i}].label")
        kept = friction | table
        if "sliding_rule" in table or "model" in table:
            allowed = _parameters(kept)
            kept = {k: v for k, v in kept.items() if k not in own or k in allowed or k in table}
        try:
            contact = type(case.contact).model_validate(dict(data["contact"]) | {"friction": kept})
            yield label, _interface(case, contact)
        except ValidationError as error:
            lines = [as_input(e) for e in error.errors(include_url=False)]
            raise CaseError([_moved(line, i) for line in lines]) from None
        except InputError as error:
            raise _moved(error, i) from None


def _parameters(table: Mapping[str, Any]) -> set[str]:
    """Names of the parameters of the model and rule that a friction table chooses."""
    known = Registries.of_points()
    chosen = {table.get("model"), table.get("sliding_rule")}
    entries = [e for e in (*known.friction_models, *known.sliding_rules) if e.name in chosen]
    models = [e for e in known.friction_models if "model" not in table]
    return {p.name for e in (*entries, *models) for p in e.parameters}


def _moved(error: InputError, i: int) -> InputError:
    """The same mistake at the table of the further run."""
    place = error.field.removeprefix("contact.").removeprefix("friction").removeprefix(".")
    return InputError(error.said, field=f"compare[{i}].{place}".rstrip("."))


def _without_auto(schema: Any) -> Any:
    """The schema without the word that stands for a value from a mesh."""
    if isinstance(schema, list):
        return [_without_auto(item) for item in schema]
    if not isinstance(schema, dict):
        return schema
    options = schema.get("anyOf", [])
    if {"const": AUTO} in options:
        rest = [option for option in options if option != {"const": AUTO}]
        kept = {k: v for k, v in schema.items() if k not in ("anyOf", "default")}
        return _without_auto(kept | (rest[0] if len(rest) == 1 else {"anyOf": rest}))
    found = {key: _without_auto(value) for key, value in schema.items()}
    needed = [
        name
        for name, value in schema.get("properties", {}).items()
        if isinstance(value, dict) and {"const": AUTO} in value.get("anyOf", [])
    ]
    if needed:
        found["required"] = sorted({*found.get("required", []), *needed})
    if found.get("default") is not None and _has_auto(found["default"]):
        del found["default"]
    return found


def _has_auto(value: Any) -> bool:
    if isinstance(value, dict):
        return any(_has_auto(v) for v in value.values())
    return bool(value == AUTO)
