"""Classes by name that more can be added to."""

from __future__ import annotations

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
            InputError: There is one of that name.
        """
        if kind.entry.name in self._kinds:
            raise InputError(f"{kind.entry.name!r} is registered already", field=self._what)
        self._kinds[kind.entry.name] = kind

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
