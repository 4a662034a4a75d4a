"""Objects with a part in the core, which is no data: copies are made anew of their arguments."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Self

import numpy as np

from anisocontact.base.sealed import Sealed


class CopiedByArguments(Sealed):
    """What is copied and pickled by the arguments it was made of, and has no other state.

    Example:
        >>> import copy
        >>> class Half(CopiedByArguments):
        ...     def __init__(self, of: float) -> None:
        ...         self.value = of / 2
        >>> copy.deepcopy(Half(of=3.0)).value
        1.5
    """

    _made: tuple[tuple[Any, ...], dict[str, Any]]

    def __new__(cls, *args: Any, **kwargs: Any) -> Self:
        """Keep the arguments."""
        new = super().__new__(cls)
        new._made = tuple(map(_kept, args)), {name: _kept(one) for name, one in kwargs.items()}
        return new

    def __reduce__(self) -> tuple[Any, ...]:
        return _made_anew, (type(self), *self._made)

    def with_parts(self, instead: Mapping[int, Any]) -> Self:
        """Made anew with other parts; as it is where it has none of them.

        Args:
            instead: New parts by the `id` of those in whose place they stand.
        """
        args, kwargs = self._made
        parts = [_replaced(one, instead) for one in args]
        named = {name: _replaced(one, instead) for name, one in kwargs.items()}
        pairs = zip([*parts, *named.values()], [*args, *kwargs.values()], strict=True)
        same = all(new is old for new, old in pairs)
        return self if same else type(self)(*parts, **named)


def _kept(argument: Any) -> Any:
    """An argument, with copies of lists, dictionaries and arrays, into which a script may write."""
    if isinstance(argument, np.ndarray):
        return argument.copy()
    if type(argument) is list:
        return [_kept(one) for one in argument]
    if type(argument) is dict:
        return {name: _kept(one) for name, one in argument.items()}
    return argument


def _replaced(part: Any, instead: Mapping[int, Any]) -> Any:
    found = instead.get(id(part), part)
    return (
        found.with_parts(instead)
        if isinstance(found, CopiedByArguments) and found is part
        else found
    )


def _made_anew(kind: type[Any], args: tuple[Any, ...], kwargs: dict[str, Any]) -> Any:
    return kind(*args, **kwargs)
