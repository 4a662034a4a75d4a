"""Files of a results folder: whole or not there, and only our own are ever removed."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from anisocontact.errors import InputError

__all__ = ["check_folder", "clear", "replacing", "write_text"]

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
    "pictures",
    "report.html",
    "case.toml",
    "run.log",
)
#: Files that show that a folder is that of a run.
MARKS = ("summary.json", "run.log")


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A path to write to; it takes the place of `path` when the block ends well.

    Readers see the old file or the new one, never a part of either.
    """
    draft = path.with_name(f".{path.stem}-{os.getpid()}{path.suffix}")
    try:
        yield draft
        draft.replace(path)
    finally:
        draft.unlink(missing_ok=True)


def write_text(path: Path, text: str) -> None:
    """Write a text file at once."""
    with replacing(path) as draft:
        draft.write_text(text, encoding="utf-8", newline="\n")


def check_folder(folder: Path, overwrite: bool = False) -> None:
    """Refuse a folder that holds something we may not replace.

    Args:
        folder: Where results are to go; it may not exist yet.
        overwrite: Whether results of an earlier run may be replaced.

    Raises:
        InputError: It is a file, or not empty and either not asked for or not that of a run.
    """
    try:
        found = sorted(entry.name for entry in folder.iterdir())
    except FileNotFoundError:
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
            f"results folder '{folder}' holds an earlier run: give --overwrite to replace it, "
            "or another folder with -o"
        )


def clear(folder: Path) -> None:
    """Remove the files of an earlier run; others stay."""
    for name in OWN:
        path = folder / name
        if path.is_dir() and not path.is_symlink():
            shutil.rmtree(path)
        else:
            path.unlink(missing_ok=True)
