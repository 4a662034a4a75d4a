"""Laws and surfaces as text that a file can keep, and made again from it."""

from __future__ import annotations

import importlib
import inspect
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import is_dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from anisocontact.anisotropy import DirectionField, make_directions
from anisocontact.base import registry
from anisocontact.base.errors import InputError
from anisocontact.base.python_file import module_of
from anisocontact.interface.contact_law import AdhesionAndFriction, ContactLaw
from anisocontact.interface.interface import Interface
from anisocontact.interface.python_law import PythonLaw, state_type
from anisocontact.interface.states import STATE, State
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.surfaces import Surface, make_surface


def described(part: Any) -> Any:
    """A law, a surface or what a law in Python holds, as JSON has it.

    Args:
        part: It. An object of a class that is not named here is its class, where that is, and its
            attributes.

    Returns:
        Numbers, texts, lists and tables; what a table is stands under `is`.

    Raises:
        InputError: Something of it cannot be written to a file.

    Example:
        >>> described(NormalLaw(penalty=10.0))
        {'is': 'normal', 'model': 'penalty', 'penalty': 10.0}
        >>> made(described(Adhesion(stiffness=2.0))).named[1]["stiffness"]
        (2.0, 2.0)
    """
    if part is None or isinstance(part, str | int | float):
        return part
    if isinstance(part, list):
        return [described(one) for one in part]
    if isinstance(part, dict):
        return {str(name): described(one) for name, one in part.items()}
    kind = next((kind for kind in _KINDS if kind.fits(part)), _OBJECT)
    return {"is": kind.word} | described(kind.parts(part))


def made(text: Any) -> Any:
    """What a description describes.

    Args:
        text: As `described` has given it.

    Raises:
        InputError: It describes nothing that there is here.
    """
    if isinstance(text, list):
        return [made(one) for one in text]
    if not isinstance(text, dict):
        return text
    parts = {name: made(one) for name, one in text.items() if name != "is"}
    if "is" not in text:
        return parts
    makers = {kind.word: kind.make for kind in (*_KINDS, _OBJECT)}
    if text["is"] not in makers:
        raise InputError(f"{text['is']!r} given, allowed: {', '.join(makers)}", "is")
    return makers[text["is"]](**parts)


def compared(part: Any) -> Any:
    """A law, a surface, or what else a problem is made of, as what it is compared by.

    Args:
        part: It. Of an object of a class that is not named here its class and those of its
            attributes that are data; where a class stands does not matter.

    Returns:
        As of `described`, of what cannot be written the name of its type.

    Example:
        >>> compared(Friction(coefficients=0.3)) == compared(Friction(coefficients=[0.3, 0.3]))
        True
        >>> compared({"a law": lambda x: x})
        {'a law': {'is': 'function', 'name': '<lambda>'}}
    """
    if part is None or isinstance(part, str | int | float):
        return part
    if isinstance(part, Mapping):
        return {str(name): compared(one) for name, one in part.items()}
    if isinstance(part, Sequence | np.ndarray):
        return [compared(one) for one in part]
    if isinstance(part, np.generic):
        return part.item()
    kind = next((kind for kind in _KINDS if kind.fits(part)), _PLAIN)
    return {"is": kind.word or type(part).__qualname__} | compared(kind.parts(part))


def _data(part: Any) -> dict[str, Any]:
    """Attributes that say what an object is; of a function its name."""
    name = getattr(part, "__qualname__", None)
    own = {n: one for n, one in getattr(part, "__dict__", {}).items() if _is_data(one)}
    return {"name": name} if isinstance(name, str) else own


def _is_data(value: Any) -> bool:
    """Whether an attribute says what an object is: no other object that may name it in turn."""
    if isinstance(value, Mapping):
        return all(_is_data(one) for one in value.values())
    if isinstance(value, list | tuple):
        return all(_is_data(one) for one in value)
    plain = value is None or isinstance(value, str | int | float | np.ndarray | np.generic)
    return plain or is_dataclass(value) or any(kind.fits(value) for kind in _KINDS)


class _Kind(NamedTuple):
    """What can be described.

    Attributes:
        word: Its name in a description.
        fits: Whether an object is of the kind.
        parts: What it is made of, by the arguments of `make`.
        make: Makes it.
    """

    word: str
    fits: Callable[[Any], bool]
    parts: Callable[[Any], dict[str, Any]]
    make: Callable[..., Any]


def _class(word: str, kind: type, parts: Callable[[Any], dict[str, Any]]) -> _Kind:
    return _Kind(word, lambda part: isinstance(part, kind), parts, kind)


def _chosen(key: str, entries: Iterable[registry.Entry], named: tuple[str, Any]) -> dict[str, Any]:
    """What was chosen from a registry, by the key that chooses, and its parameters."""
    values = registry.arguments(registry.entry(entries, named[0]), named[1])
    return {key: named[0]} | {n: list(v) if type(v) is tuple else v for n, v in values.items()}


def _adhesion(part: Adhesion) -> dict[str, Any]:
    own = {"directions": part.directions, "directions_on": part.directions_on}
    return _chosen("model", registry.adhesion_models(), part.named) | own


def _friction(part: Friction) -> dict[str, Any]:
    names = ("directions", "directions_second", "directions_on", "directions_second_on")
    return {
        **_chosen("model", registry.friction_models(), part.named),
        **_chosen("sliding_rule", registry.sliding_rules(), part.rule),
        **{name: getattr(part, name) for name in names},
    }


def _states(**given: Any) -> State:
    """States of points, (n,), with a law's own variables where there are any."""
    own = given.get("internal")
    found = np.zeros(len(given["status"]), STATE if own is None else state_type(own.shape[1]))
    for name, values in given.items():
        found[name] = values
    return found


def _tuple(of: list[Any]) -> Any:
    return tuple(of)


def _attributes(part: Any) -> dict[str, Any]:
    kind = type(part)
    try:
        file, attributes = inspect.getfile(kind), vars(part)
    except TypeError:  # of a class that no file has, as a function is
        raise InputError(f"{part!r:.60} cannot be written to a file") from None
    return {
        "module": kind.__module__,
        "file": str(Path(file).resolve()),
        "name": kind.__qualname__,
        "attributes": attributes,
    }


def _object(module: str, file: str, name: str, attributes: dict[str, Any]) -> Any:
    """An object of a class that stands in a file."""
    try:
        ours = module.split(".", maxsplit=1)[0] == "anisocontact"
        kind: Any = importlib.import_module(module) if ours else module_of(Path(file))
        for part in name.split("."):
            kind = getattr(kind, part)
    except (Exception, SystemExit) as error:
        text = f"the class {name} cannot be imported: {type(error).__name__}: {error}"
        raise InputError(text) from error
    found = object.__new__(kind)
    found.__dict__.update(attributes)
    return found


_KINDS = (
    _Kind(
        "surface",
        lambda part: isinstance(part, Surface),
        lambda part: _chosen("name", registry.surfaces(), part.named),
        make_surface,
    ),
    _Kind(
        "directions",
        lambda part: isinstance(part, DirectionField),
        lambda part: _chosen("name", registry.direction_fields(), part.named),
        make_directions,
    ),
    _class("normal", NormalLaw, lambda n: _chosen("model", registry.normal_laws(), n.named)),
    _class("adhesion", Adhesion, _adhesion),
    _class("friction", Friction, _friction),
    _class("interface", Interface, lambda part: {"surface": part.surface, "normal": part.law}),
    _class(
        "law",
        ContactLaw,
        lambda law: {
            "normal": law.normal,
            "adhesion": law.tangential,
            "evolution": law.evolution,
        },
    ),
    _class(
        "adhesion and friction",
        AdhesionAndFriction,
        lambda law: {"adhesion": law.adhesion, "friction": law.friction},
    ),
    _class(
        "python law",
        PythonLaw,
        lambda own: {
            "law": own.law,
            "directions": own.friction_directions,
            "directions_on": own.carried[0].on,
        },
    ),
    _Kind(
        "states",
        lambda part: isinstance(part, np.ndarray) and part.dtype.names is not None,
        lambda part: {name: part[name] for name in part.dtype.names},
        _states,
    ),
    _Kind(
        "array",
        lambda part: isinstance(part, np.ndarray | np.generic),
        lambda part: {"object": part.tolist(), "dtype": part.dtype.str},
        np.array,
    ),
    _Kind("tuple", lambda part: isinstance(part, tuple), lambda part: {"of": list(part)}, _tuple),
)
_PLAIN = _Kind("", lambda part: True, _data, object)
_OBJECT = _Kind("object", lambda part: True, _attributes, _object)
