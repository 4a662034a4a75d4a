"""Files of arrays in which a script keeps a state, one for each process."""

from __future__ import annotations

import zipfile
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from anisocontact.base.errors import InputError
from anisocontact.base.whole_files import named_by_user, replacing

#: What NumPy says of a file that is no state, or half of one.
_UNREADABLE = (OSError, EOFError, TypeError, ValueError, zipfile.BadZipFile, zlib.error)


def own_file(path: str | Path, comm: Any) -> Path:
    """The file of this process: its number comes before the suffix where there are several."""
    path = Path(path)
    return path.with_suffix(f".{comm.rank}{path.suffix}") if comm.size > 1 else path


def write_arrays(file: Path, arrays: Mapping[str, np.ndarray]) -> None:
    """Write arrays by name, all or nothing.

    Raises:
        InputError: The file cannot be written.
    """
    with named_by_user(file, "path"), replacing(file) as draft, draft.open("wb") as stream:
        np.savez(stream, allow_pickle=False, **arrays)


def read_arrays(file: Path) -> dict[str, np.ndarray]:
    """Arrays by name, as `write_arrays` has written them.

    Raises:
        InputError: The file cannot be read.
    """
    try:
        with file.open("rb") as stream:
            return dict(np.load(stream))
    except _UNREADABLE as problem:
        raise InputError(f"'{file}' cannot be read: {problem}", "path") from None
