"""The reference page of the case file, from its JSON Schema.

A section for every table of the file, headed by where it stands (`[mesh.box.NAME]`), in the order
in which a reader of the file meets them.
"""

from collections.abc import Iterator, Mapping
from typing import Any

from markdown_parts import code, table

Schema = Mapping[str, Any]
BOUNDS = {"exclusiveMinimum": ">", "minimum": ">=", "exclusiveMaximum": "<", "maximum": "<="}
INTRODUCTION = """# Case file

A case is a [TOML](https://toml.io) file: bodies and their materials, rigid surfaces, the pairs in
contact, the load steps. `anisocontact check CASE.toml` reads one and says what it contains; a key
that does not belong, or a value out of range, is answered by one line. `anisocontact schema` prints
the JSON Schema this page is made from; editors use it to complete and check a case while it is
typed."""


TRACE_INTRODUCTION = """# Case file of the point driver

`anisocontact trace CASE.toml` moves a point, or several that are rigidly linked, over a rigid
surface. The file has the surface, the laws of the contact, which are those of the main case file,
and one load. `anisocontact schema --trace` prints the JSON Schema this page is made from. The
cases in `examples/point/` use every kind of load."""


class CaseReference:
    """The page of one schema; `prefix` keeps its labels apart from those of other pages."""

    def __init__(self, schema: Schema, introduction: str = INTRODUCTION, prefix: str = "") -> None:
        self.root = schema
        self.introduction = introduction
        self.prefix = prefix
        self.definitions: Mapping[str, Schema] = schema.get("$defs", {})
        self.places: dict[str, list[str]] = {}
        for key, value in schema.get("properties", {}).items():
            self._visit(value, key)

    def page(self) -> str:
        """Return the page."""
        parts = [self.introduction, self._properties(self.root)]
        return "\n\n".join(parts + [self._section(name) for name in self.places])

    def _visit(self, schema: Schema, path: str) -> None:
        """Note where each table stands, outside first."""
        for name, place in references(schema, path):
            known = self.places.setdefault(name, [])
            if place in known:
                continue
            known.append(place)
            for key, value in self.definitions[name].get("properties", {}).items():
                self._visit(value, f"{place}.{key}")

    def _section(self, name: str) -> str:
        schema, (place, *others) = self.definitions[name], self.places[name]
        kind = self._kind(name)
        heading = f"`{place}`" + (f": {kind}" if kind else "")
        also = f"Also as {', '.join(f'`{other}`' for other in others)}.\n\n" if others else ""
        about = schema.get("description", "")
        return (
            f"({self._label(name)})=\n## {heading}\n\n{about}\n\n{also}{self._properties(schema)}"
        )

    def _label(self, name: str) -> str:
        return f"{self.prefix}{name.lower()}"

    def _kind(self, name: str) -> str:
        """Return the words that choose this table among others, such as the name of its model."""
        values = self.definitions[name].get("properties", {}).values()
        return ", ".join(code(value["const"]) for value in values if "const" in value)

    def _properties(self, schema: Schema) -> str:
        required = set(schema.get("required", ()))

        def fallback(key: str, value: Schema) -> str:
            if key in required:
                return "required"
            return code(value["default"]) if value.get("default") is not None else ""

        rows = (
            (f"`{key}`", self._words(value), fallback(key, value), self._meaning(value))
            for key, value in schema.get("properties", {}).items()
        )
        return table(("key", "value", "default", "meaning"), rows)

    def _meaning(self, schema: Schema) -> str:
        """Return what a key means; a bare reference means what its table does."""
        table_of = self.definitions.get(schema.get("$ref", "").rsplit("/", 1)[-1], {})
        text: str = schema.get("description", table_of.get("description", ""))
        return text

    def _words(self, schema: Schema) -> str:
        """Return what a value may be, in words."""
        if "$ref" in schema:
            name = schema["$ref"].rsplit("/", 1)[-1]
            return f"[{self._kind(name) or 'table'}](#{self._label(name)})"
        if "const" in schema or "enum" in schema:
            return ", ".join(map(code, schema.get("enum", [schema.get("const")])))
        options = [option for key in ("anyOf", "oneOf") for option in schema.get(key, ())]
        if options:
            return " or ".join(dict.fromkeys(map(self._words, options)))
        if schema.get("type") == "array":
            return self._array(schema)
        if isinstance(inner := schema.get("additionalProperties"), Mapping):
            return f"by name: {self._words(inner)}"
        limits = ", ".join(f"{s} {schema[key]:g}" for key, s in BOUNDS.items() if key in schema)
        return f"{schema.get('type', 'anything')} {limits}".strip()

    def _array(self, schema: Schema) -> str:
        if "prefixItems" in schema:
            items = dict.fromkeys(map(self._words, schema["prefixItems"]))
            return f"list of {len(schema['prefixItems'])}: {', '.join(items)}"
        least, most = schema.get("minItems"), schema.get("maxItems")
        size = f" of {least}:" if least is not None and least == most else " of"
        items = self._words(schema.get("items", {}))
        return f"list{size} ({items})" if " or " in items else f"list{size} {items}"


def references(schema: Schema, path: str) -> Iterator[tuple[str, str]]:
    """Yield the tables a value may be or hold, and where they stand."""
    if "$ref" in schema:
        yield schema["$ref"].rsplit("/", 1)[-1], path
    for key in ("anyOf", "oneOf", "prefixItems"):
        for option in schema.get(key, ()):
            yield from references(option, path)
    if isinstance(items := schema.get("items"), Mapping):
        yield from references(items, f"{path}[]")
    if isinstance(inner := schema.get("additionalProperties"), Mapping):
        yield from references(inner, f"{path}.NAME")
