"""Tables made from the registries: an entry and its parameters become a table and its keys."""

from __future__ import annotations

import difflib
import inspect
import itertools
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

from pydantic import (
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    ValidationError,
    WithJsonSchema,
    create_model,
)
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, InitErrorDetails, core_schema

from anisocontact.base.registry import Entry, Parameter
from anisocontact.case.quantity import AUTO, Quantity, key_of, line, shown
from anisocontact.case.section import Section, near


class Registered(Section):
    """A table whose keys are the parameters of one or several registry entries.

    Attributes:
        chosen: Choosing key -> name of the entry it has chosen.
        entries: The chosen entries.
    """

    chosen: ClassVar[dict[str, str]] = {}
    entries: ClassVar[tuple[Entry, ...]] = ()

    def parameters(self) -> dict[str, Any]:
        """Values by their keys, angles in degrees; "auto" as it stands."""
        keys = [key_of(p) for entry in self.entries for p in entry.parameters]
        return {key: getattr(self, key) for key in keys}


@dataclass(frozen=True)
class Key:
    """A key that chooses an entry.

    Args:
        name: The key, such as "shape".
        entries: What it chooses from.
        default: Name of the entry where the key is left out; None if it has to be given.
    """

    name: str
    entries: tuple[Entry, ...]
    default: str | None = None


def default_of(function: Callable[..., object], argument: str) -> str:
    """Default of an argument in Python, so that the case file has the same."""
    return str(inspect.signature(function).parameters[argument].default)


def table(name: str, keys: Mapping[Key, Entry], base: type[Registered]) -> type[Registered]:
    """Table of one choice: the choosing keys, the parameters of the entries, the keys of `base`.

    Args:
        name: Name of the class; titles of the schema.
        keys: Each choosing key with the entry it has chosen.
        base: Class with the keys that do not come from a registry.
    """
    fields: dict[str, Any] = {}
    for key, entry in keys.items():
        default = entry.name if entry.name == key.default else ...
        schema = WithJsonSchema({"const": entry.name, "description": entry.doc})
        fields[key.name] = (Annotated[str, schema], default)
    model = table_of(name, tuple(keys.values()), base, fields)
    model.chosen = {key.name: entry.name for key, entry in keys.items()}
    return model


def table_of(
    name: str,
    entries: tuple[Entry, ...],
    base: type[Registered],
    fields: Mapping[str, Any] | None = None,
) -> type[Registered]:
    """Table of the parameters of entries and of the keys of `base`, without a choosing key.

    Args:
        name: Name of the class; titles of the schema.
        entries: The entries.
        base: Class with the keys that do not come from a registry.
        fields: Further keys that come first.
    """
    keys = {key_of(p): _field(p) for entry in entries for p in entry.parameters}
    doc = " ".join(entry.doc for entry in entries)
    more: dict[str, Any] = {**(fields or {}), **keys}
    model: type[Registered] = create_model(name, __base__=base, __doc__=doc, **more)
    model.entries = entries
    return model


def _field(p: Parameter) -> tuple[Any, Any]:
    # Stiffnesses are what a user without measurements cannot know: the run can choose them.
    may_be_auto = p.unit == "stress/length" and p.kind in ("scalar", "pair")
    quantity = Quantity(p, word=AUTO if may_be_auto else None)
    if quantity.word and p.required:
        return Annotated[Any, quantity], AUTO
    return Annotated[Any, quantity], ... if p.required else quantity.default()


class OneOf:
    """Annotation of a table that is one of several, chosen by the value of its keys.

    Args:
        what: Name of the classes, such as "Surface".
        *keys: The keys that choose.
        base: Class with further keys.
        bases: Other ones, of the names that are chosen.
    """

    def __init__(
        self,
        what: str,
        *keys: Key,
        base: type[Registered] = Registered,
        bases: Mapping[str, type[Registered]] | None = None,
    ) -> None:
        self.keys = keys
        self._what, self._base, self._bases = what, base, bases or {}
        self._models: dict[tuple[Entry, ...], type[Registered]] = {}

    def _model(self, entries: tuple[Entry, ...]) -> type[Registered]:
        """The class of the chosen entries; a case chooses few of many, which take time to make."""
        if entries not in self._models:
            names = [entry.name for entry in entries]
            title = self._what + "".join(name.title().replace("-", "") for name in names)
            base = self._bases.get(names[0], self._base)
            self._models[entries] = table(title, dict(zip(self.keys, entries, strict=True)), base)
        return self._models[entries]

    def validate(self, data: object) -> Registered:
        """The table as an object of the class its keys choose."""
        if isinstance(data, Registered):
            return data
        if not isinstance(data, Mapping):
            raise line(f"{shown(data)} given, a table needed")
        return self._model(tuple(self._chosen(key, data) for key in self.keys)).model_validate(data)

    def _chosen(self, key: Key, data: Mapping[str, object]) -> Entry:
        known = [entry.name for entry in key.entries]
        name = data.get(key.name, key.default)
        if name in known:
            return key.entries[known.index(str(name))]
        if key.name not in data:
            meant = difflib.get_close_matches(key.name, map(str, data), 1)
            instead = f', "{meant[0]}" given' if meant else ""
            raise _at(key.name, f"missing{instead}; {near('', known)}")
        raise _at(key.name, f"{shown(name)} given; {near(str(name), known)}")

    def __get_pydantic_core_schema__(
        self, source: object, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        """Pydantic asks: check by hand."""
        return core_schema.no_info_plain_validator_function(self.validate)

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        """Pydantic asks: describe as a union of all tables."""
        chosen = itertools.product(*(key.entries for key in self.keys))
        tables: list[Any] = [self._model(entries).__pydantic_core_schema__ for entries in chosen]
        return handler(core_schema.union_schema(tables) if tables else core_schema.any_schema())


def _at(key: str, text: str) -> ValidationError:
    """The error of a key inside the table that is being checked."""
    return ValidationError.from_exception_data(
        "table", [InitErrorDetails(type=line(text), loc=(key,), input=None)]
    )
