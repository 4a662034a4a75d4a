"""Classes by name that more can be added to."""

from __future__ import annotations

import reprlib
from collections.abc import Iterable
from typing import Any

from anisocontact.base import registry
from anisocontact.base.errors import InputError
from anisocontact.base.registry import Entry


class Kinds:
    """A registry of classes with an `entry`, whose constructors take its parameters by name.

    Args:
        what: What they are, in messages.
        key: Key that chooses one, in messages.
        kinds: Those of the project.
    """

    def __init__(self, what: str, key: str, kinds: Iterable[type[Any]]) -> None:
        self._what, self._key = what, key
        self._kinds: dict[str, type[Any]] = {kind.entry.name: kind for kind in kinds}

    def add(self, kind: type[Any]) -> None:
        """Add a class.

        Raises:
            InputError: There is one of that name, or it is no class with an `entry`.
        """
        name = entry_of(kind, self._what).name
        if name in self._kinds:
            raise InputError(f"{name!r} is registered already", field=self._what)
        self._kinds[name] = kind

    def entries(self) -> tuple[Entry, ...]:
        """The entry of each, in the order of registration."""
        return tuple(kind.entry for kind in self._kinds.values())

    def make(self, name: str, field: str, parameters: dict[str, Any]) -> Any:
        """An object of a class.

        Args:
            name: Name of the class.
            field: Where it was written, for messages.
            parameters: Its parameters; angles in radian, or in degrees by `<name>_deg`.

        Raises:
            InputError: Unknown name or parameter, a parameter missing or out of range.
        """
        place = f"{field}.{self._key}" if field else self._key
        entry = registry.entry(self.entries(), name, place)
        registry.values(entry, parameters, field)
        return self._kinds[name](**parameters, field=field)


def entry_of(kind: object, field: str) -> Entry:
    """The entry of a class that is to be registered.

    Args:
        kind: The class.
        field: What it is to be, for the message.

    Returns:
        The entry.

    Raises:
        InputError: It is no class, or has no `entry` that is an `Entry`.

    Example:
        >>> entry_of(int, "material")
        Traceback (most recent call last):
        anisocontact.base.errors.InputError: material: int given, a class with an 'entry' needed
    """
    entry = getattr(kind, "entry", None)
    if isinstance(kind, type) and isinstance(entry, Entry):
        return entry
    name = kind.__name__ if isinstance(kind, type) else reprlib.repr(kind)
    raise InputError(f"{name} given, a class with an 'entry' needed", field)
