"""Files that are whole or not there."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A path to write to; it takes the place of `path` when the block ends well.

    Readers see the old file or the new one, never a part of either.

    Yields:
        The path to write to, in the same folder.

    Example:
        >>> from tempfile import TemporaryDirectory
        >>> with TemporaryDirectory() as folder, replacing(Path(folder) / "a.txt") as draft:
        ...     length = draft.write_text("whole")
    """
    draft = draft_of(path)
    try:
        yield draft
        draft.replace(path)
    finally:
        draft.unlink(missing_ok=True)


def draft_of(path: Path) -> Path:
    """Where a file is while this process writes it.

    Returns:
        A name that no other process has, in the same folder.
    """
    return path.with_name(f".{path.stem}-{os.getpid()}{path.suffix}")
