"""Copies of dictionaries, lists and arrays that nobody writes into."""

from __future__ import annotations

from types import MappingProxyType
from typing import Any, NoReturn

import numpy as np

from anisocontact.base.errors import InputError


class ReadOnlyDict(dict[Any, Any]):
    """A dictionary that stays what it was made of: in all else one of Python.

    Example:
        >>> led = ReadOnlyDict(z=-0.1)
        >>> led | {"x": 0.0}
        {'z': -0.1, 'x': 0.0}
        >>> led["z"] = -0.2
        Traceback (most recent call last):
        anisocontact.base.errors.InputError: read only, as what has it was checked when ...
    """

    def _refuse(self, *args: Any, **kwargs: Any) -> NoReturn:
        text = "read only, as what has it was checked when it was made: make another one"
        raise InputError(f"{text}; of a step, with dataclasses.replace")

    __setitem__ = __delitem__ = __ior__ = _refuse
    clear = pop = popitem = setdefault = update = _refuse

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (dict(self),)


def read_only(value: Any) -> Any:
    """A copy that nobody writes into of a dictionary, list or array, nested or not.

    Args:
        value: Anything; what is none of them is given back as it is.

    Returns:
        A `ReadOnlyDict`, a tuple, or an array that is not writeable.

    Example:
        >>> read_only({"axis": [0, 0, 1]})
        {'axis': (0, 0, 1)}
    """
    if isinstance(value, np.ndarray):
        value = value.copy()
        value.flags.writeable = False
        return value
    if type(value) is list:
        return tuple(map(read_only, value))
    if isinstance(value, dict | MappingProxyType):
        return ReadOnlyDict({name: read_only(one) for name, one in value.items()})
    return value
