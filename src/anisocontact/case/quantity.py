"""Values of the case file: numbers, pairs, vectors and words, each described by a `Parameter`."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from pydantic import GetJsonSchemaHandler
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from anisocontact.base import registry
from anisocontact.base.errors import InputError
from anisocontact.base.registry import Parameter

#: Written instead of a stiffness that the run is to choose.
AUTO = "auto"
#: Written instead of a displacement where a support is released.
FREE = "free"

_ITEMS = {"pair": 2, "vector": 3}


def key_of(parameter: Parameter) -> str:
    """Key of a parameter in the case file: people write angles in degrees."""
    return f"{parameter.name}_deg" if parameter.unit == "angle" else parameter.name


def line(text: str) -> PydanticCustomError:
    """A finished message; the place is put in front of it by whoever knows the path."""
    return PydanticCustomError("line", "{text}", {"text": text})


def shown(value: object, width: int = 60) -> str:
    """What was given, on one short line."""
    try:
        text = repr(value)
    except ValueError:  # Python refuses to print whole numbers of more than 4300 digits
        text = f"a {type(value).__name__}"
    return text if len(text) <= width else f"{text[: width - 3]}..."


@dataclass(frozen=True)
class Quantity:
    """Annotation of a field whose value is checked as a parameter of the registry is.

    Args:
        parameter: Form, unit and bound.
        word: A word that may be written instead, such as "auto".
        most: Largest number allowed, if there is one.
        count: How many numbers a list must have, if its kind does not say so.

    Example:
        >>> Quantity(Parameter("mu", "pair", "1", "friction", "positive")).check(0.3)
        (0.3, 0.3)
    """

    parameter: Parameter
    word: str | None = None
    most: float = math.inf
    count: int | None = None

    def check(self, given: object) -> Any:
        """The value in the form of its kind: float, int, bool, str or a tuple of numbers.

        Raises:
            PydanticCustomError: It has another form or is out of bounds.
        """
        if self.word is not None and given == self.word:
            return given
        p = self.parameter
        if isinstance(given, str | Mapping) and p.kind != "choice":
            raise line(f"{shown(given)} given, {self.allowed()} needed")
        try:
            numbers = registry.check(p, given)
        except (OverflowError, TypeError):
            raise line(f"{shown(given)} given, {self.allowed()} needed") from None
        except InputError as error:
            said = error.said
            raise line(said if len(said) < 200 else f"{said[:197]}...") from None
        if self.count is not None and len(numbers) != self.count:
            raise line(f"{shown(given)} given, {self.count} numbers needed")
        if max(numbers, default=0.0) > self.most:
            raise line(f"{shown(given)} given, must be at most {self.most:g}")
        return p.shaped(numbers)

    def default(self) -> Any:
        """The parameter's default as it would stand in a case file."""
        numbers = self.parameter.default
        if not numbers and self.parameter.kind not in ("array", "integers"):
            return None  # may be left out, and nothing stands for it
        if self.parameter.unit == "angle":
            numbers = tuple(math.degrees(v) for v in numbers)
        return self.parameter.shaped(numbers)

    def allowed(self) -> str:
        """What may be written, in a few words."""
        words = {
            "scalar": "a number",
            "pair": "one or two numbers",
            "vector": "one or three numbers" if self.parameter.alike else "three numbers",
            "axis": "a point and a direction, [[x, y, z], [x, y, z]]",
            "array": "one number or a list" if self.parameter.alike else "a list of numbers",
            "integer": "a whole number",
            "integers": "a list of whole numbers",
            "flag": "true or false",
            "choice": " or ".join(f'"{c}"' for c in self.parameter.choices),
        }[self.parameter.kind]
        return f'{words} or "{self.word}"' if self.word else words

    def __get_pydantic_core_schema__(self, source: object, handler: object) -> CoreSchema:
        """Pydantic asks: every check is ours."""
        return core_schema.no_info_plain_validator_function(self.check)

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """Pydantic asks: form, bounds and unit for editors and for the reference."""
        p = self.parameter
        description = p.doc if p.unit == "1" else f"{p.doc} [{self.unit}]"
        form = self._form()
        if self.word:
            form = {"anyOf": [{"const": self.word}, form]}
        return {"description": description, "unit": self.unit, **form}

    @property
    def unit(self) -> str:
        """Unit in the case file."""
        return "degree" if self.parameter.unit == "angle" else self.parameter.unit

    def _form(self) -> dict[str, Any]:
        p = self.parameter
        if p.kind == "choice":
            return {"enum": list(p.choices)}
        if p.kind == "flag":
            return {"type": "boolean"}
        number: dict[str, Any] = {"type": "integer" if "integer" in p.kind else "number"}
        number |= {"positive": {"exclusiveMinimum": 0}, "non-negative": {"minimum": 0}}.get(
            p.bound, {}
        )
        if self.most < math.inf:
            number["maximum"] = self.most
        if p.kind in ("scalar", "integer"):
            return number
        if p.kind == "axis":
            three = {"type": "array", "items": number, "minItems": 3, "maxItems": 3}
            return {"type": "array", "items": three, "minItems": 2, "maxItems": 2}
        if p.kind == "array":  # of numbers, or of lists of them, as points are
            row = {"type": "array", "items": number}
            rows = {"type": "array", "items": {"anyOf": [number, row]}}
            return {"anyOf": [number, rows]} if p.alike else rows
        array: dict[str, Any] = {"type": "array", "items": number}
        count = _ITEMS.get(p.kind, self.count or p.count)
        if count:
            array |= {"minItems": count, "maxItems": count}
        return {"anyOf": [number, array]} if p.alike else array


def number(kind: str, unit: str, doc: str, bound: str = "any", **more: Any) -> Quantity:
    """Annotation of a key that is not a parameter of the registry; see `Parameter`."""
    return Quantity(Parameter("", kind, unit, doc, bound), **more)


def word(doc: str, *choices: str) -> Quantity:
    """Annotation of a key that is one of several words."""
    return Quantity(Parameter("", "choice", "1", doc, choices=choices))
