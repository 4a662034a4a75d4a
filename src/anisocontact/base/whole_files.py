"""Files that are whole or not there."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from anisocontact.base.errors import InputError


@contextmanager
def named_by_user(path: Path, field: str = "") -> Iterator[None]:
    """Say in a line why a file that the user has named cannot be written.

    Args:
        path: The file.
        field: The entry or argument that names it.

    Raises:
        InputError: Writing it in the block failed.

    Example:
        >>> with named_by_user(Path("n/a.txt")):
        ...     raise IsADirectoryError(21, "what a library says")
        Traceback (most recent call last):
        anisocontact.base.errors.InputError: 'n/a.txt' cannot be written: Is a directory
    """
    try:
        yield
    except OSError as problem:
        why = os.strerror(problem.errno) if problem.errno else problem  # libraries say much more
        raise InputError(f"'{path}' cannot be written: {why}", field) from None


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A path to write to; it takes the place of `path` when the block ends well.

    Readers see the old file or the new one, never a part of either. Errors of the operating system
    name the file: of a disk that is full it names none.

    Yields:
        The path to write to, in the same folder.

    Raises:
        OSError: It cannot be written.

    Example:
        >>> from tempfile import TemporaryDirectory
        >>> with TemporaryDirectory() as folder, replacing(Path(folder) / "a.txt") as draft:
        ...     length = draft.write_text("whole")
    """
    draft = draft_of(path)
    try:
        yield draft
        draft.replace(path)
    except OSError as error:
        if error.errno:  # a text of a library's own stays as it is
            error.filename = error.filename or str(path)
        raise
    finally:
        draft.unlink(missing_ok=True)


def draft_of(path: Path) -> Path:
    """Where a file is while this process writes it.

    Returns:
        A name that no other process has, in the same folder.
    """
    return path.with_name(f".{path.stem}-{os.getpid()}{path.suffix}")
