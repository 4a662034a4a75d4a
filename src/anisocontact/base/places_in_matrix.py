"""Where the entries of a sparse matrix of PETSc stand in one that has room for more."""

from __future__ import annotations

import ctypes
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np

from anisocontact.base.array_types import Floats, Ints
from anisocontact.base.fenicsx import Mat, PETSc
from anisocontact.base.petsc_calls import call_petsc, has_petsc, numbers_of, pattern_of

#: Name of what is left at a matrix to know it again; it goes when the matrix does.
_MARK = "anisocontact.places"
_NEEDED = ("MatSeqAIJGetArray", "MatSeqAIJRestoreArray", "MatGetNonzeroState")


class PlacesInMatrix:
    """Copies the entries of a sparse matrix to where they stand in one that has room for more.

    Places are looked for once for a matrix and its pattern, on one process.

    Args:
        source: The matrix with the entries; its columns increase in every row, its pattern stays.

    Attributes:
        found: How often places have been looked for.

    Example:
        >>> from anisocontact.base.fenicsx import PETSc
        >>> out = PETSc.Mat().createAIJ((2, 2), csr=([0, 2, 4], [0, 1, 0, 1], [1.0, 2.0, 3.0, 4.0]))
        >>> source = PETSc.Mat().createAIJ((2, 2), csr=([0, 1, 2], [0, 1], [5.0, 6.0]))
        >>> PlacesInMatrix(source).copy(out)
        True
        >>> out.getValuesCSR()[2]
        array([5., 2., 3., 6.])
    """

    def __init__(self, source: Mat) -> None:
        self._source = source
        self._mark = object()
        self._pattern: tuple[float, int] | None = None
        self._places: _Places | None = None
        self.found = 0

    def copy(self, out: Mat) -> bool:
        """Write the entries of now over those that a matrix has there.

        Args:
            out: The matrix; further rows and columns stay as they are.

        Returns:
            Whether it has all of the places; nothing is written if not.
        """
        if out.getType() != PETSc.Mat.Type.SEQAIJ or not out.assembled or not has_petsc(*_NEEDED):
            return False
        pattern = pattern_of(out)
        if out.getAttr(_MARK) is not self._mark or pattern != self._pattern:
            self._mark, self._pattern = object(), pattern
            self.found += 1
            self._places = _places(self._source, out)
            out.setAttr(_MARK, self._mark)
        if self._places is None:
            return False
        with _entries(self._source) as source, _entries(out) as there:
            self._places.copy(source, there)
        return True


@dataclass(frozen=True)
class _Places:
    """Places of entries: most rows of bodies are with contact as they are without.

    Args:
        pieces: Entries of rows that are the same in both: first there, first and end in the source.
        there: Places of the entries of other rows.
        source: Where these are in the source.
    """

    pieces: list[tuple[int, int, int]]
    there: Ints
    source: Ints

    def copy(self, source: Floats, there: Floats) -> None:
        """Write entries to their places."""
        for start, first, end in self.pieces:
            there[start : start + end - first] = source[first:end]
        there[self.there] = source[self.source]


def _places(source: Mat, out: Mat) -> _Places | None:
    """Places of all entries; None where one is missing."""
    own, columns = source.getRowIJ()
    starts, room = out.getRowIJ()
    rows = len(own) - 1
    if len(starts) <= rows:
        return None
    starts = starts[: rows + 1]
    same = np.diff(own) == np.diff(starts)
    edges = np.flatnonzero(np.diff(same, prepend=False, append=False))
    pieces = []
    for first, end in edges.reshape(-1, 2):
        if not np.array_equal(columns[own[first] : own[end]], room[starts[first] : starts[end]]):
            return None
        pieces.append((int(starts[first]), int(own[first]), int(own[end])))
    others, width = np.flatnonzero(~same), out.getSize()[1]
    entries, keys = _keyed(others, own, columns, width)
    places, known = _keyed(others, starts, room, width)
    at = np.searchsorted(known, keys)
    increasing = bool(np.all(np.diff(keys) > 0) and np.all(np.diff(known) > 0))
    if not increasing or not np.array_equal(np.append(known, -1)[at], keys):
        return None
    return _Places(pieces, places[at], entries)


def _keyed(rows: Ints, starts: Ints, columns: Ints, width: int) -> tuple[Ints, Ints]:
    """Entries of some rows, and a number for each that increases by rows and columns."""
    counts = np.diff(starts)[rows].astype(np.int64)
    ends = np.cumsum(counts)
    entries = np.arange(counts.sum()) + np.repeat(starts[rows] - ends + counts, counts)
    return entries, np.repeat(rows, counts) * width + columns[entries]


@contextmanager
def _entries(matrix: Mat) -> Iterator[Floats]:
    """The entries of a matrix of this process, by rows, to read or overwrite."""
    count = int(matrix.getInfo()["nz_used"])
    address, entries = numbers_of("MatSeqAIJGetArray", matrix, count)
    try:
        yield entries
    finally:
        call_petsc("MatSeqAIJRestoreArray", matrix, ctypes.byref(address))
