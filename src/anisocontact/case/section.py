"""A table of the case file: it knows its keys and says what is wrong in one line each."""

from __future__ import annotations

from typing import Any, Self

from pydantic import (
    BaseModel,
    ConfigDict,
    ModelWrapValidatorHandler,
    ValidationError,
    model_validator,
)
from pydantic_core import ErrorDetails, InitErrorDetails

from anisocontact.base.words import elsewhere, meant
from anisocontact.case.quantity import Quantity, line, shown

_NEEDED = {
    "string_type": "a text in quotes",
    "dict_type": "a table",
    "model_type": "a table",
    "list_type": "a list",
    "too_short": "at least one entry",
}


def near(name: str, known: list[str]) -> str:
    """The end of a message: the known name that was meant, then all of them."""
    close = meant(name, known)
    hint = f'did you mean "{close}"? ' if close else ""
    return f"{hint}allowed: {', '.join(known) or 'none'}"


def _key(e: ErrorDetails) -> str:
    """The key an error is about."""
    return str(e["loc"][-1]) if e["loc"] else ""


def _near_key(e: ErrorDetails, kind: type[BaseModel]) -> str | None:
    """The key that was meant by an unknown one, if one is near."""
    return meant(_key(e), kind.model_fields) if e["type"] == "extra_forbidden" else None


class Section(BaseModel):
    """Base of all tables: fixed keys, nothing converted, every message finished where it arises."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, defer_build=True)

    @model_validator(mode="wrap")
    @classmethod
    def _say(cls, data: Any, handler: ModelWrapValidatorHandler[Self]) -> Self:
        try:
            return handler(data)
        except ValidationError as error:
            found = error.errors(include_url=False)
            meant = {_near_key(e, cls) for e in found}
            raise ValidationError.from_exception_data(
                cls.__name__,
                # A key that is written wrong is not missing as well.
                [cls._finished(e) for e in found if e["type"] != "missing" or _key(e) not in meant],
            ) from None

    @classmethod
    def _finished(cls, e: ErrorDetails) -> InitErrorDetails:
        return InitErrorDetails(type=line(cls._text(e)), loc=e["loc"], input=e["input"])

    @classmethod
    def _text(cls, e: ErrorDetails) -> str:
        kind, name = e["type"], _key(e)
        if kind == "line":
            return e["msg"]
        if kind == "missing":
            return f"missing; {cls._doc(name)}"
        if kind == "extra_forbidden":
            known = list(cls.model_fields)
            there = None if meant(name, known) else elsewhere(name)
            return f"unknown key; {there or near(name, known)}"
        if kind in _NEEDED:
            # one bracket too few makes a table of what is a list of tables
            brackets = (
                f", [[{name}]]" if kind == "list_type" and isinstance(e["input"], dict) else ""
            )
            return f"{shown(e['input'])} given, {_NEEDED[kind]} needed{brackets}"
        return f"{shown(e['input'])} given: {e['msg']}"

    @classmethod
    def _doc(cls, key: str) -> str:
        field = cls.model_fields[key]
        for quantity in field.metadata:
            if isinstance(quantity, Quantity):
                unit = "" if quantity.unit == "1" else f" [{quantity.unit}]"
                return f"{quantity.parameter.doc}, {quantity.allowed()}{unit}"
        return field.description or "it must be given"
