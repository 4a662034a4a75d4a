"""PETSc's options, and which of them nothing reads."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from anisocontact.base.fenicsx import PETSc

OptionValue = str | int | float | bool | None


class Database:
    """PETSc options while something reads them; those of the user come first and stay.

    Args:
        prefix: Prefix of the options.
        options: Values by name, without prefix.
    """

    def __init__(self, prefix: str, options: Mapping[str, OptionValue]) -> None:
        self._prefix, self._options = prefix, PETSc.Options(prefix)
        self._given = dict(options)
        self._set: list[str] = []
        self._unread, self._said = set(self._given), False

    def __enter__(self) -> None:
        # to ask for one by its name would count as reading it
        there = self._options.getAll()
        self._set = [name for name in self._given if name not in there]
        for name in self._set:
            self._options.setValue(name, self._given[name])

    def __exit__(self, *_: object) -> None:
        database = PETSc.Options()
        self._unread -= {name for name in self._given if database.used(self._prefix + name)}
        for name in self._set:
            self._options.delValue(name)

    def unread(self, comm: Any) -> Iterator[str]:
        """A line with the options that nothing on any process has read, the first time; collective.

        Args:
            comm: The processes.
        """
        if self._said:
            return
        self._said = True
        if names := sorted(set.intersection(*comm.allgather(self._unread))):
            named = ", ".join(names)
            yield f"options of PETSc that nothing has read: {named}; misspelt, or of another solver"
