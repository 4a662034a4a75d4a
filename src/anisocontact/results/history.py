"""`history.csv`: a row for each accepted increment, the same bytes for the same run."""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

#: Columns that hold text.
TEXT = ("step",)


class HistoryTable:
    """The table, a row appended at a time; a row is on disk before the next increment starts.

    Args:
        path: The file, begun with the first row.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._columns: list[str] = []
        self._size = 0

    def state(self) -> dict[str, Any]:
        """What `resume` needs, as JSON can have it."""
        return {"columns": self._columns, "size": self._size}

    def resume(self, state: Mapping[str, Any]) -> None:
        """Go on behind the rows of a state; later ones are cut off."""
        self._columns, self._size = list(state["columns"]), state["size"]
        if self._size:
            os.truncate(self._path, self._size)
        else:
            self._path.unlink(missing_ok=True)

    def append(self, row: Mapping[str, Any]) -> None:
        """Add a row of nested numbers; the first one fixes the columns."""
        values = dict(flat(row))
        text = ""
        if not self._columns:
            self._columns = list(values)
            text = _line(self._columns)
        text += _line([_shown(values[column]) for column in self._columns])
        self._path.parent.mkdir(exist_ok=True)
        with self._path.open("ab") as file:
            self._size += file.write(text.encode())


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
    text = path.read_text(encoding="utf-8")
    rows = list(csv.reader(io.StringIO(text[: text.rfind("\n") + 1])))
    if not rows:
        return {}
    columns: Sequence[Sequence[str]] = list(zip(*rows[1:], strict=True)) or [()] * len(rows[0])
    return {
        name: np.array(column, dtype=str if name in TEXT else float)
        for name, column in zip(rows[0], columns, strict=True)
    }


def _shown(value: Any) -> str:
    # The shortest text that reads back as the same number.
    return repr(float(value)) if isinstance(value, float | np.floating) else str(value)


def _line(cells: Sequence[str]) -> str:
    out = io.StringIO()
    csv.writer(out, lineterminator="\n").writerow(cells)
    return out.getvalue()
