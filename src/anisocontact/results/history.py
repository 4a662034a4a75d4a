"""`history.csv`: a row for each accepted increment, the same bytes for the same run."""

from __future__ import annotations

import csv
import io
import math
import os
import zlib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from anisocontact.base.errors import InputError
from anisocontact.base.whole_files import replacing

#: Columns that hold text.
TEXT = ("step",)


class HistoryTable:
    """The table, a row appended at a time; a row is on disk before the next increment starts.

    A run that goes on may have other columns, as of steps that were added: the table then has all
    of them, with `nan` where a row has no such value.

    Args:
        path: The file, begun with the first row.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._columns: list[str] = []
        self._size = self._rows = self._sum = 0

    def state(self) -> dict[str, Any]:
        """What `resume` needs, as JSON can have it."""
        state = {"columns": self._columns, "size": self._size, "rows": self._rows}
        return state | {"sum": self._sum}

    def resume(self, state: Mapping[str, Any]) -> None:
        """Go on behind the rows of a state; later ones are cut off.

        Raises:
            InputError: The file has fewer rows than the run has written or other ones, or is no
                table.
        """
        self._columns, self._size = list(state["columns"]), state["size"]
        self._rows, self._sum = state["rows"], state["sum"]
        if not self._size:
            self._path.unlink(missing_ok=True)
            return
        try:
            found = _cells(self._path) if self._path.is_file() else []
        except (ValueError, csv.Error) as error:
            text = f"'{self._path}' cannot be read: {error}"
            raise InputError(f"{text}: put the file back, or run without --restart") from None
        header, *rows = found or [[]]
        if len(rows) < self._rows:
            raise InputError(
                f"'{self._path}' has {len(rows)} rows, the run that is to go on has written "
                f"{self._rows}: put the file back, or run without --restart"
            )
        known = "".join(_line(row[: len(self._columns)]) for row in found[: self._rows + 1])
        if zlib.crc32(known.encode()) != self._sum:
            raise InputError(
                f"'{self._path}' is not as the run that is to go on has written it: "
                "put the file back, or run without --restart"
            )
        if self._path.read_bytes().startswith(known.encode()):
            os.truncate(self._path, self._size)
        else:  # has got columns since, or other ends of lines
            self._write(header, rows[: self._rows])

    def append(self, row: Mapping[str, Any]) -> None:
        """Add a row of nested numbers.

        Raises:
            OSError: The file cannot be written, or is gone since the last row.
        """
        values = dict(flat(row))
        known = set(self._columns)
        new = [column for column in values if column not in known]
        if new:
            self._widen(new)
        text = _line([_shown(values.get(column, math.nan)) for column in self._columns])
        line = text.encode()
        with self._path.open("r+b") as file:  # one that is gone is not begun without its header
            file.seek(0, os.SEEK_END)
            self._size += file.write(line)
        self._sum = zlib.crc32(line, self._sum)
        self._rows += 1

    def _widen(self, new: Sequence[str]) -> None:
        """Give the table further columns, the first ones too."""
        rows = _cells(self._path)[1:] if self._columns else []
        none = [_shown(math.nan)] * len(new)
        self._write([*self._columns, *new], [[*row, *none] for row in rows])

    def _write(self, columns: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
        """Write the table anew, the file replaced whole."""
        self._path.parent.mkdir(exist_ok=True)
        table = "".join(map(_line, [columns, *rows])).encode()
        with replacing(self._path) as draft:
            self._size = draft.write_bytes(table)
        self._sum = zlib.crc32(table)
        self._columns = list(columns)


def flat(nested: Any, name: str = "") -> Iterator[tuple[str, Any]]:
    """Leaves of nested dictionaries and lists with dotted names.

    Three numbers are the components `x`, `y`, `z` of a vector.

    Example:
        >>> list(flat({"a": [{"force": [1.0, 2.0, 3.0]}]}))
        [('a.0.force.x', 1.0), ('a.0.force.y', 2.0), ('a.0.force.z', 3.0)]
    """
    if isinstance(nested, Mapping):
        items = list(nested.items())
    elif isinstance(nested, list):
        vector = len(nested) == 3 and all(isinstance(v, float) for v in nested)
        items = list(zip("xyz" if vector else range(len(nested)), nested, strict=True))
    else:
        yield name, nested
        return
    for key, value in items:
        yield from flat(value, f"{name}.{key}" if name else str(key))


def read_history(path: Path) -> dict[str, npt.NDArray[Any]]:
    """Columns of the table; a row that is being written is left out.

    Args:
        path: The file.

    Returns:
        Column name -> values, text for `step`, numbers else.
    """
    rows = _cells(path)
    if not rows:
        return {}
    columns: Sequence[Sequence[str]] = list(zip(*rows[1:], strict=True)) or [()] * len(rows[0])
    return {
        name: np.array(column, dtype=str if name in TEXT else float)
        for name, column in zip(rows[0], columns, strict=True)
    }


def _cells(path: Path) -> list[list[str]]:
    """Rows of the file as texts, columns first; one that is being written is left out."""
    text = path.read_bytes().decode("utf-8")
    return list(csv.reader(io.StringIO(text[: text.rfind("\n") + 1])))


def _shown(value: Any) -> str:
    # The shortest text that reads back as the same number.
    return repr(float(value)) if isinstance(value, float | np.floating) else str(value)


def _line(cells: Sequence[str]) -> str:
    out = io.StringIO()
    csv.writer(out, lineterminator="\n").writerow(cells)
    return out.getvalue()
