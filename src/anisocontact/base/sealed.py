"""Objects that stay what they were made of."""

from __future__ import annotations

import inspect
from abc import ABCMeta
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any, ClassVar, cast

from anisocontact.base.errors import InputError


class _Sealing(ABCMeta):
    """Kind of classes whose objects are sealed when the outermost constructor is done."""

    def __call__(cls, *args: Any, **kwargs: Any) -> Any:
        new = super().__call__(*args, **kwargs)
        vars(new)["_sealed"] = True
        return new

    @property
    def __signature__(cls) -> inspect.Signature:
        """That of the constructor, which `__call__` would hide from who asks for it."""
        signature = inspect.signature(cast(Any, cls).__init__)
        return signature.replace(parameters=list(signature.parameters.values())[1:])


class Sealed(metaclass=_Sealing):
    """What refuses to be written into once it is made: what it was made of has been read by then.

    Private names are not refused, nor methods, nor those that a class says are `changing`, in one
    text. A class that a script derives may write what is its own.

    Example:
        >>> class Spring(Sealed, changing="length"):
        ...     def __init__(self, stiffness: float) -> None:
        ...         self.stiffness, self.length = stiffness, 0.0
        >>> spring = Spring(2.0)
        >>> spring.length = 1.0
        >>> spring.stiffness = 3.0
        Traceback (most recent call last):
        anisocontact.base.errors.InputError: Spring.stiffness: read only, as what reads it has ...
    """

    _changing: ClassVar[frozenset[str]] = frozenset()
    _sealed: bool = False

    def __init_subclass__(cls, changing: str = "", **kwargs: Any) -> None:
        super().__init_subclass__(**kwargs)
        inherited: Iterator[frozenset[str]] = (
            getattr(base, "_changing", frozenset()) for base in cls.__bases__
        )
        cls._changing = frozenset(changing.split()).union(*inherited)

    def __setattr__(self, name: str, value: Any) -> None:
        self._check_open(name)
        super().__setattr__(name, value)

    def __delattr__(self, name: str) -> None:
        self._check_open(name)
        super().__delattr__(name)

    def _check_open(self, name: str) -> None:
        kind = type(self).__name__
        if self._sealed and not name.startswith("_") and not self._may_change(name):
            text = (
                f"read only, as what reads it has done so: make another {kind} with what is meant"
            )
            raise InputError(text, field=f"{kind}.{name}")

    def _may_change(self, name: str) -> bool:
        kind = type(self)
        if name in self._changing or callable(getattr(kind, name, None)):
            return True
        return not _is_own(kind) and name not in _known(kind)


def _is_own(kind: type[Any]) -> bool:
    """Whether a class is one of this package, and not what a script has derived from one."""
    return kind.__module__.partition(".")[0] == __name__.partition(".")[0]


@cache
def _known(kind: type[Any]) -> frozenset[str]:
    """What a script's class has of the classes of this package: arguments, and what they define."""
    own = [base for base in kind.__mro__ if _is_own(base)]
    names = {
        name for base in own for name in inspect.signature(cast(Any, base).__init__).parameters
    }
    names |= {parameter.name for parameter in getattr(getattr(kind, "entry", 0), "parameters", ())}
    return frozenset(names.union(*map(vars, own)))


@contextmanager
def unsealed(made: Sealed) -> Iterator[None]:
    """Let what is sealed be made again, for the time of a block.

    Example:
        >>> class Spring(Sealed):
        ...     stiffness = 1.0
        >>> spring = Spring()
        >>> with unsealed(spring):
        ...     spring.stiffness = 2.0
    """
    made._sealed = False
    try:
        yield
    finally:
        made._sealed = True
