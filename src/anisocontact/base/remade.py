"""Objects with a part in the core, which is no data: copies are made anew of their arguments."""

from __future__ import annotations

from typing import Any, Self


class Remade:
    """What is copied and pickled by the arguments it was made of, and has no other state.

    Example:
        >>> import copy
        >>> class Half(Remade):
        ...     def __init__(self, of: float) -> None:
        ...         self.value = of / 2
        >>> copy.deepcopy(Half(of=3.0)).value
        1.5
    """

    _made: tuple[tuple[Any, ...], dict[str, Any]]

    def __new__(cls, *args: Any, **kwargs: Any) -> Self:
        """Keep the arguments."""
        new = super().__new__(cls)
        new._made = args, kwargs
        return new

    def __reduce__(self) -> tuple[Any, ...]:
        return _remake, (type(self), *self._made)


def _remake(kind: type[Any], args: tuple[Any, ...], kwargs: dict[str, Any]) -> Any:
    return kind(*args, **kwargs)
