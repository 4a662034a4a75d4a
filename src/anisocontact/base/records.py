"""Data classes that cost little to import.

`dataclasses.dataclass` compiles up to six methods of each class where its module is imported, which
takes a fifth of the start of a small run, and half of the classes are not used in it. Here fields
are found by `dataclasses`, the constructor is compiled when it is first asked for, and what else a
data class has is not compiled at all.
"""

from __future__ import annotations

import dataclasses
import reprlib
import sys
from typing import TYPE_CHECKING, Any, NoReturn

__all__ = ["dataclass"]

if TYPE_CHECKING:
    from dataclasses import dataclass
else:

    def dataclass(cls: type | None = None, /, *, frozen: bool = False, eq: bool = True) -> Any:
        """`dataclasses.dataclass` with the two options that are used here.

        Args:
            cls: The class, where there are no options.
            frozen: Whether fields can be set by the constructor alone.
            eq: Whether objects with equal fields are equal.
        """
        if cls is None:
            return lambda cls: dataclass(cls, frozen=frozen, eq=eq)
        cls.__doc__ = cls.__doc__ or cls.__name__  # `dataclasses` would make a long one
        dataclasses.dataclass(init=False, repr=False, eq=False)(cls)
        methods = {"__init__": _Constructor(cls, frozen), "__repr__": _text}
        if eq:
            methods |= {"__eq__": _equal, "__hash__": _hash if frozen else None}
        if frozen:
            methods |= _frozen(cls)
        for name, method in methods.items():
            if name not in cls.__dict__:
                setattr(cls, name, method)
        return cls


class _Constructor:
    """Stands for `__init__` until Python asks for it."""

    def __init__(self, cls: type, frozen: bool) -> None:
        self._cls = cls
        self._frozen = frozen

    def __get__(self, instance: object, owner: type) -> Any:
        made: Any = _constructor(self._cls, self._frozen)
        setattr(self._cls, "__init__", made)  # noqa: B010  (as no class is written)
        return made.__get__(instance, owner)


def _constructor(cls: Any, frozen: bool) -> Any:
    """`__init__` of a data class."""
    known: dict[str, Any] = {"__made": _MADE, "__put": object.__setattr__}
    put = "__put(self, {0!r}, {1})" if frozen else "self.{0} = {1}"
    places: list[str] = []
    named: list[str] = []
    lines: list[str] = []
    for one in dataclasses.fields(cls):
        name = one.name
        value = name
        known[f"__default_{name}"] = one.default
        known[f"__factory_{name}"] = one.default_factory
        if one.default_factory is not dataclasses.MISSING:
            default = "=__made"
            value = f"__factory_{name}() if {name} is __made else {name}"
        else:
            default = "" if one.default is dataclasses.MISSING else f"=__default_{name}"
        if one.init:
            (named if one.kw_only else places).append(name + default)
        elif one.default_factory is not dataclasses.MISSING:
            value = f"__factory_{name}()"
        else:  # the class has the default, or `__post_init__` sets it
            continue
        lines.append(put.format(name, value))
    if hasattr(cls, "__post_init__"):
        lines.append("self.__post_init__()")
    arguments = ", ".join(["self", *places, *(["*", *named] if named else [])])
    inside = "\n  ".join([f"def __init__({arguments}):", *(lines or ["pass"])])
    source = f"def make({', '.join(known)}):\n {inside}\n return __init__"
    found: dict[str, Any] = {}
    exec(source, vars(sys.modules[cls.__module__]), found)  # where the names of types are known
    made: Any = found["make"](**known)
    made.__module__, made.__qualname__ = cls.__module__, f"{cls.__qualname__}.__init__"
    made.__annotations__ = {one.name: one.type for one in dataclasses.fields(cls) if one.init}
    made.__annotations__["return"] = None
    return made


class _Made:
    """Default of a field that is made for each object."""

    def __repr__(self) -> str:
        return "<factory>"


_MADE = _Made()


@reprlib.recursive_repr()
def _text(self: Any) -> str:
    shown = [f"{one.name}={getattr(self, one.name)!r}" for one in _fields(self) if one.repr]
    return f"{type(self).__qualname__}({', '.join(shown)})"


def _equal(self: Any, other: object) -> Any:
    if type(self) is not type(other):
        return NotImplemented
    return _compared(self) == _compared(other)


def _hash(self: Any) -> int:
    return hash(_compared(self))


def _compared(self: Any) -> tuple[Any, ...]:
    return tuple(getattr(self, one.name) for one in _fields(self) if one.compare)


def _fields(self: Any) -> tuple[dataclasses.Field[Any], ...]:
    return dataclasses.fields(self)


def _frozen(cls: Any) -> dict[str, Any]:
    """Methods that let no field be changed; a subclass that is no data class has its own."""
    names = {one.name for one in dataclasses.fields(cls)}

    def put(self: Any, name: str, value: object) -> None:
        if type(self) is cls or name in names:
            _refuse("assign to", name)
        super(cls, self).__setattr__(name, value)

    def drop(self: Any, name: str) -> None:
        if type(self) is cls or name in names:
            _refuse("delete", name)
        super(cls, self).__delattr__(name)

    return {"__setattr__": put, "__delattr__": drop}


def _refuse(what: str, name: str) -> NoReturn:
    raise dataclasses.FrozenInstanceError(f"cannot {what} field {name!r}")
