"""Objects with the history of a run, which a copy would share."""

from __future__ import annotations

from typing import Any, NoReturn

from anisocontact.base.sealed import Sealed


class Uncopied(Sealed):
    """What is neither copied nor pickled: a copy would go on with the history of the first.

    Example:
        >>> import copy
        >>> class Run(Uncopied):
        ...     pass
        >>> copy.copy(Run())
        Traceback (most recent call last):
        ...
        TypeError: Run is not copied, as the copy would share its history and mesh: make another one
    """

    def __copy__(self) -> NoReturn:
        self._refuse()

    def __deepcopy__(self, memo: dict[int, Any]) -> NoReturn:
        self._refuse()

    def __reduce_ex__(self, protocol: object) -> NoReturn:
        self._refuse()

    def _refuse(self) -> NoReturn:
        name = type(self).__name__
        text = "as the copy would share its history and mesh: make another one"
        raise TypeError(f"{name} is not copied, {text}")
