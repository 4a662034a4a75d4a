"""Arguments of what scripts call, checked against the types that are written there.

An annotation says what an argument may be; `typed` makes it hold, so that what is something else is
one line with the name of the argument, before anything is made of it. Of types only is judged:
what a number may be is checked where it is used.
"""

from __future__ import annotations

import dataclasses
import inspect
import math
import types
import typing
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from functools import cache, partial, wraps
from itertools import chain
from numbers import Integral, Real
from pathlib import Path
from typing import Any, TypeGuard, cast

import numpy as np
import numpy.typing as npt

from anisocontact.base.errors import InputError
from anisocontact.base.read_only import read_only
from anisocontact.base.words import hint as hint_at

#: What is said of types that are known by another name, or hold several things.
_CALLED: Mapping[Any, str] = {
    str: "a text",
    bool: "True or False",
    int: "a whole number",
    float: "a number",
    Path: "a path",
}


def typed[F: Callable[..., Any]](made: F) -> F:
    """Let a function, or the constructor of a class, refuse arguments of other types.

    A dataclass that is frozen has what lists, dictionaries and arrays held, whatever a script goes
    on to write into those that it gave, and nobody writes into its own.

    Args:
        made: The function or class; with annotations that are not `Any` or `object`.

    Returns:
        The same class, or a function that does so.

    Example:
        >>> @typed
        ... def area(radius: float) -> float:
        ...     return math.pi * radius**2
        >>> area("two")
        Traceback (most recent call last):
        anisocontact.base.errors.InputError: radius: 'two' given, a number needed
    """
    if isinstance(made, type):
        own: Any = made
        frozen = dataclasses.is_dataclass(made) and own.__dataclass_params__.frozen
        own.__init__ = _checked(_keeping(own.__init__) if frozen else own.__init__)
        return made
    return cast(F, _checked(made))


def is_number(value: object) -> TypeGuard[float]:
    """Whether a value is a number, of Python or of NumPy, and no truth value and no NaN.

    Example:
        >>> is_number(np.float32(0.5)), is_number(np.int64(2)), is_number(True), is_number("2")
        (True, True, False, False)
    """
    return _is_number(Real, value)


def unexpected(called: str, name: str, known: Collection[str]) -> TypeError:
    """What is said of an argument that there is not: Python's words, and what there is instead.

    Args:
        called: Name of what was called.
        name: The argument.
        known: Those that it has.

    Example:
        >>> str(unexpected("Step", "durations", ["name", "duration"]))
        "Step() got an unexpected keyword argument 'durations': did you mean 'duration'?"
    """
    said = f"{called}() got an unexpected keyword argument {name!r}"
    return TypeError(f"{said}: {hint_at(name, known, 'allowed')}")


#: Says whether a value is of a type.
type _Judge = Callable[[Any], bool]


def _checked(function: Any) -> Any:
    @wraps(function)
    def checked(*args: Any, **kwargs: Any) -> Any:
        names, judges = _arguments(function)
        known = _keywords(function)
        strange = next((name for name in kwargs if known and name not in known), None)
        if known and strange:
            called = function.__qualname__.removesuffix(".__init__").split(".")[-1]
            raise unexpected(called, strange, known)
        for name, value in chain(zip(names, args, strict=False), kwargs.items()):
            if name in judges and not judges[name](value) and _binds(function, args, kwargs):
                place, part, hint = _wrong_part(name, value, _hints(function)[name])
                text = f"{_shown(part)} given, {_needed(hint)} needed"
                raise InputError(" ".join(text.split()), field=place)
        return function(*args, **kwargs)

    return checked


def _keeping(init: Any) -> Any:
    @wraps(init)
    def kept(self: Any, *args: Any, **kwargs: Any) -> None:
        init(self, *args, **kwargs)
        for field in dataclasses.fields(self):
            object.__setattr__(self, field.name, read_only(getattr(self, field.name)))

    return kept


def _binds(function: Any, args: Any, kwargs: Any) -> bool:
    """Whether a function can be called so at all, of which Python speaks itself."""
    try:
        _signature(function).bind_partial(*args, **kwargs)
    except TypeError:
        return False
    return True


@cache
def _signature(function: Any) -> inspect.Signature:
    return inspect.signature(function)


@cache
def _keywords(function: Any) -> tuple[str, ...]:
    """Names of the arguments that may be given by name, without the object; none where any may."""
    parameters = list(_signature(function).parameters.values())
    if any(p.kind == p.VAR_KEYWORD for p in parameters):
        return ()
    named = (inspect.Parameter.POSITIONAL_OR_KEYWORD, inspect.Parameter.KEYWORD_ONLY)
    return tuple(p.name for p in parameters if p.kind in named and p.name != "self")


@cache
def _arguments(function: Any) -> tuple[tuple[str, ...], dict[str, _Judge]]:
    """Names of the arguments that are given by place, and what judges those with a type."""
    parameters = _signature(function).parameters.values()
    by_place = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    names = tuple(p.name for p in parameters if p.kind in by_place)
    return names, {name: _judge(hint) for name, hint in _hints(function).items()}


@cache
def _hints(function: Any) -> dict[str, Any]:
    """Types of the arguments that are given one by one; none where a name is not known here."""
    own = {parameter.__name__: parameter for parameter in getattr(function, "__type_params__", ())}
    try:
        hints = typing.get_type_hints(function, localns=own)
    except NameError:
        return {}
    parameters = _signature(function).parameters.values()
    single = {p.name for p in parameters if p.kind not in (p.VAR_POSITIONAL, p.VAR_KEYWORD)}
    return {name: hint for name, hint in hints.items() if name in single and name != "return"}


@cache
def _judge(hint: Any) -> _Judge:
    """What judges values of a type, made once; it takes all for types that nothing is known of."""
    if hint is npt.ArrayLike:
        return _is_array
    if (meant := _meant(hint)) is not None:
        return _judge(meant)
    origin, of = typing.get_origin(hint), typing.get_args(hint)
    if origin in (typing.Union, types.UnionType):
        several = [_judge(one) for one in of]
        return lambda value: any(fits(value) for fits in several)
    if isinstance(origin, type):
        return partial(_fits_generic, origin, of)
    return _judge_class(hint) if isinstance(hint, type) else lambda value: True


def _fits(hint: Any, value: Any) -> bool:
    return _judge(hint)(value)


def _meant(hint: Any) -> Any:
    """What a name stands for that `type` has given, as NumPy has its arrays; None for a type."""
    alias = hint if isinstance(hint, typing.TypeAliasType) else typing.get_origin(hint)
    return alias.__value__ if isinstance(alias, typing.TypeAliasType) else None


def _is_array(value: Any) -> bool:
    try:
        return np.asarray(value).dtype.kind in "biuf" and not np.ma.is_masked(value)
    except (TypeError, ValueError):  # rows of different lengths
        return False


def _judge_class(kind: type[Any]) -> _Judge:
    if kind in (object, Any):
        return lambda value: True
    if kind in (int, float):
        return partial(_is_number, Integral if kind is int else Real)
    if getattr(kind, "_is_protocol", False):
        names = typing.cast(Any, kind).__protocol_attrs__
        return lambda value: all(hasattr(value, name) for name in names)
    accepted = {bool: (bool, np.bool_), Path: (str, Path)}.get(kind, (kind,))
    return lambda value: isinstance(value, accepted)


def _is_number(kind: type[Any], value: Any) -> bool:
    value = value[()] if isinstance(value, np.ndarray) and value.ndim == 0 else value
    is_number = isinstance(value, kind) and not isinstance(value, bool | np.bool_)
    return is_number and _counts(value)


def _counts(value: Any) -> bool:
    """Whether a number is one to compute with: not NaN, no integer beyond all floating numbers."""
    try:
        return not math.isnan(value)
    except OverflowError:
        return False


def _fits_generic(origin: type[Any], of: tuple[Any, ...], value: Any) -> bool:
    """Containers with what is in them, and what can be called."""
    if origin is np.ndarray:
        plain = isinstance(value, np.ndarray | Sequence) and not isinstance(value, str | bytes)
        return plain and not np.ma.is_masked(value)
    if issubclass(origin, Mapping):
        return isinstance(value, Mapping) and _fits_items(of, value)
    if _is_list(origin):
        return _fits_list(origin, of, value)
    return callable(value) if origin is cast(Any, Callable) else isinstance(value, origin)


def _is_list(origin: type[Any]) -> bool:
    """Whether a type is a container as such, and not something that can be gone through as well."""
    return issubclass(origin, Iterable) and origin.__module__ in ("builtins", "collections.abc")


def _fits_items(of: tuple[Any, ...], value: Mapping[Any, Any]) -> bool:
    """Names, and values but for nested ones: of those it is said elsewhere which one is wrong."""
    inner = typing.get_origin(of[1]) or of[1]
    plain = isinstance(inner, type) and not issubclass(inner, Mapping)
    return all(_fits(of[0], k) and (not plain or _fits(of[1], v)) for k, v in value.items())


def _wrong_part(place: str, value: Any, hint: Any) -> tuple[str, Any, Any]:
    """Where a value is wrong, what is there and what is needed: one of several, or all."""
    origin, of = typing.get_origin(hint), typing.get_args(hint)
    if isinstance(origin, type) and isinstance(value, list | tuple) and _is_list(origin):
        items = [] if of[0] in _CALLED or origin is tuple else list(enumerate(value))
        wrong = next(((i, one) for i, one in items if not _fits(of[0], one)), None)
        return (place, value, hint) if wrong is None else (f"{place}[{wrong[0]}]", wrong[1], of[0])
    if not (isinstance(origin, type) and issubclass(origin, Mapping)):
        return place, value, hint
    if not isinstance(value, Mapping) or not all(_fits(of[0], key) for key in value):
        return place, value, hint
    name = next(key for key, one in value.items() if not _fits(of[1], one))
    return f"{place}.{name}", value[name], of[1]


def _fits_list(origin: type[Any], of: tuple[Any, ...], value: Any) -> bool:
    """Lists with their items, but for those that looking at them uses up."""
    if isinstance(value, str | bytes | Mapping) or not isinstance(value, Iterable):
        return False
    if isinstance(value, np.ndarray) and not (value.ndim and of[0] in _CALLED):
        return False
    if np.ma.is_masked(value):
        return False
    if not isinstance(value, Sequence | np.ndarray):
        return not issubclass(origin, Sequence)
    if origin is tuple and Ellipsis not in of:
        return len(value) == len(of) and all(map(_fits, of, value))
    return all(_fits(of[0], item) for item in value)


def _needed(hint: Any) -> str:
    """What is needed, in words."""
    if hint is npt.ArrayLike:
        return "an array of numbers"
    if (meant := _meant(hint)) is not None:
        return _needed(meant)
    origin, of = typing.get_origin(hint), typing.get_args(hint)
    if origin in (typing.Union, types.UnionType):
        words = [_needed(one) for one in _members(hint) if one is not type(None)]
        return " or ".join(filter(None, [", ".join(words[:-1]), words[-1]]))
    if isinstance(origin, type) and (_is_list(origin) or origin is np.ndarray):
        return _needed_list(origin, of)
    if getattr(hint, "_is_protocol", False):
        return f"{hint.__name__}, which has {' and '.join(sorted(hint.__protocol_attrs__))},"
    named = "a function" if origin is cast(Any, Callable) else getattr(hint, "__name__", str(hint))
    return str(_CALLED.get(hint, named))


def _members(hint: Any) -> list[Any]:
    """Types of a union, also of those that it takes in by name."""
    if hint is not npt.ArrayLike and (meant := _meant(hint)) is not None:
        return _members(meant)
    if typing.get_origin(hint) not in (typing.Union, types.UnionType):
        return [hint]
    return [member for one in typing.get_args(hint) for member in _members(one)]


def _needed_list(origin: type[Any], of: tuple[Any, ...]) -> str:
    if issubclass(origin, Mapping):
        return "values by name"
    if origin is np.ndarray:
        return "an array"
    count = str(len(of)) if origin is tuple and Ellipsis not in of else "a list of"
    return f"{count} {_plain(of[0])}"


def _plain(hint: Any) -> str:
    """Several of a type."""
    several = {str: "texts", int: "whole numbers", float: "numbers"}
    return several.get(hint, _needed(hint))


def _shown(value: Any) -> str:
    """A value, or its type where its own text is long or says nothing."""
    if np.ma.is_masked(value):
        return "an array with masked entries"
    text = repr(value)
    plain = isinstance(value, str | int | float | complex | Sequence | Mapping | None)
    return text if plain and len(text) <= 60 else type(value).__name__
