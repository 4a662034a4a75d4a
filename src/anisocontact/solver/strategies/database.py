"""PETSc's options, and which of them nothing reads."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Set
from contextlib import contextmanager
from typing import Any

from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import PETSc
from anisocontact.base.machine import lack
from anisocontact.base.processes import Together

OptionValue = str | int | float | bool | None

#: What PETSc takes for the precision of a factor; it crashes where it reads another word.
PRECISIONS = ("single", "double")


class Database:
    """PETSc options while something reads them; those of the user come first and stay.

    Args:
        prefix: Prefix of the options.
        options: Values by name, without prefix.
        field: Where the user has given them.

    Raises:
        InputError: An option has a value that would end the process.
    """

    def __init__(
        self, prefix: str, options: Mapping[str, OptionValue], field: str = "options"
    ) -> None:
        self._prefix, self._options = prefix, PETSc.Options(prefix)
        self._given, self._field = dict(options), field
        for name, value in options.items():
            if name.endswith("pc_precision") and value not in PRECISIONS:
                text = f"{value!r} given, allowed: {', '.join(PRECISIONS)}"
                raise InputError(text, field=f"{field}.{name}")
        self._set: list[str] = []
        self._unread, self._said = set(self._given), False

    def __enter__(self) -> None:
        # to ask for one by its name would count as reading it
        there = self._options.getAll()
        self._set = [name for name in self._given if name not in there]
        for name in self._set:
            value = self._given[name]
            # a monitor takes the name of what it writes to, or nothing; nothing is true as well
            self._options.setValue(name, None if value is True else value)

    def __exit__(self, *_: object) -> None:
        database = PETSc.Options()
        self._unread -= {name for name in self._given if database.used(self._prefix + name)}
        for name in self._set:
            self._options.delValue(name)

    @property
    def left(self) -> Set[str]:
        """Names of the options that nothing on this process has read."""
        return self._unread

    @contextmanager
    def blamed(self, together: Together | None = None) -> Iterator[None]:
        """Around all that reads options: what PETSc raises there is a mistake in them.

        Many are read, and fit together or not, only when something is solved.

        Args:
            together: The processes, where others may be stuck; then the error stays what it is.

        Raises:
            InputError: PETSc has failed, with options given, and not for lack of memory.
        """
        try:
            yield
        except PETSc.Error as error:
            names = sorted({*self._given, *self._options.getAll()})
            stuck = together is not None and together.apart
            if stuck or not names or lack(error) is not None:
                raise
            reason = str(error).splitlines()[-1].split("] ", 1)[-1]
            text = f"PETSc fails with {', '.join(names)}: {reason}"
            raise InputError(text, field=self._field) from error

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
