"""Files of a results folder: whole or not there, and only our own are ever removed."""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

from anisocontact.base.errors import InputError
from anisocontact.base.whole_files import replacing

#: A point at which the law failed, for `anisocontact replay`.
FAILED = "failed_point.json"
#: Everything a run writes into its folder.
OWN = (
    "summary.json",
    "history.csv",
    "trace.csv",
    "compare.csv",
    "fields.pvd",
    "fields",
    "contact.pvd",
    "contact",
    "surfaces.pvd",
    "surfaces",
    "fields.vtkhdf",
    "contact.vtkhdf",
    "surfaces.vtkhdf",
    "probes",
    "pictures",
    "report.html",
    "case.toml",
    "checkpoint.npz",
    "checkpoint",
    "run.log",
    FAILED,
)
#: The file that is locked while a run goes on; a crash leaves it there, unlocked.
LOCK = ".lock"
#: Name of a file that is being written.
_DRAFT = re.compile(r"\..+-\d+\.(csv|html|json|log|npz|png|pvd|pvtp|pvtu|toml|vtkhdf|vtp|vtu)")
#: Files that show that a folder is that of a run.
MARKS = ("summary.json", "run.log")


class WriteError(RuntimeError):
    """Results cannot be written; what is there is whole."""


class Disk:
    """Writes files; a failure on one rank is raised on all of them at the next `check`.

    Args:
        comm: Communicator of the run.
    """

    def __init__(self, comm: Any) -> None:
        self.comm = comm
        self._failure = ""

    def write(self, action: Callable[[], object]) -> None:
        """Do something with files on the first rank; nothing once something has failed."""
        if self.comm.rank == 0:
            self.write_each(action)

    def write_each(self, action: Callable[[], object]) -> None:
        """Do something with files of its own on every rank; nothing once something has failed."""
        if self._failure:
            return
        try:
            action()
        except OSError as error:
            name = f" '{error.filename}'" if error.filename else ""
            self._failure = f"cannot write{name}: {error.strerror or error}"

    def check(self) -> None:
        """Raise what has failed.

        Raises:
            WriteError: A disk is full, or a folder gone or protected.
        """
        if self.failure():
            raise WriteError(self._failure)

    def failure(self) -> str:
        """What has failed first on any of the ranks; empty where nothing has; collective."""
        self._failure = next(filter(None, self.comm.allgather(self._failure)), "")
        return self._failure


def write_text(path: Path, text: str) -> None:
    """Write a text file at once."""
    with replacing(path) as draft:
        draft.write_text(text, encoding="utf-8", newline="\n")


def clear_drafts(folder: Path) -> None:
    """Remove what a run that was killed had not finished writing."""
    for place in (folder, *(folder / name for name in OWN)):
        if place.is_dir() and not place.is_symlink():
            for path in place.iterdir():
                if _DRAFT.fullmatch(path.name):
                    path.unlink()


def results_folder(given: str | None, name: str) -> Path:
    """Where results go: the folder given, or results/<name>.

    Args:
        given: What the user asks for, if anything.
        name: Name of the case.

    Raises:
        InputError: It is empty, as a variable of a shell that was never set.
    """
    if given is not None and not given.strip():
        raise InputError(f"{given!r} given, the name of a folder needed", "--output")
    return Path("results") / name if given is None else Path(given)


def check_folder(folder: Path, overwrite: bool = False) -> None:
    """Refuse a folder that holds something we may not replace.

    Args:
        folder: Where results are to go; it may not exist yet.
        overwrite: Whether results of an earlier run may be replaced.

    Raises:
        InputError: It is a file, cannot be made, or is not empty and either not asked for or not
            that of a run.
    """
    try:
        found = sorted(entry.name for entry in folder.iterdir() if entry.name != LOCK)
    except FileNotFoundError:
        there = next(parent for parent in folder.absolute().parents if parent.exists())
        if not os.access(there, os.W_OK | os.X_OK):
            text = f"results folder '{folder}' cannot be made: no permission to write in '{there}'"
            raise InputError(text) from None
        return
    except OSError as error:
        raise InputError(f"results folder '{folder}': {error.strerror}") from None
    if not found:
        return
    if not any(mark in found for mark in MARKS):
        raise InputError(
            f"results folder '{folder}' is not empty and holds no run (it has {found[0]}): "
            "name another one with -o"
        )
    if not overwrite:
        raise InputError(
            f"results folder '{folder}' holds an earlier run: give --overwrite (in a script "
            "overwrite=True) to replace it, or another folder with -o"
        )


def clear(folder: Path) -> None:
    """Remove the files of an earlier run; others stay."""
    clear_drafts(folder)
    for name in OWN:
        path = folder / name
        if path.is_dir() and not path.is_symlink():
            shutil.rmtree(path)
        else:
            path.unlink(missing_ok=True)
