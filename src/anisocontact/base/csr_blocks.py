"""Compressed sparse rows of PETSc's matrices, as arrays of this process."""

from __future__ import annotations

import ctypes
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from anisocontact.base.array_types import Floats, Ints
from anisocontact.base.fenicsx import Mat, PETSc
from anisocontact.base.petsc_calls import array_at, call_petsc, has_petsc, numbers_of

__all__ = ["CsrBlock", "blocks_of", "keyed_entries"]

_NEEDED = (
    "MatSeqAIJGetArray",
    "MatSeqAIJRestoreArray",
    "MatSeqAIJGetCSRAndMemType",
    "MatMPIAIJGetSeqAIJ",
)


class CsrBlock:
    """Entries of the rows of this process, in the columns that it owns or in those of others.

    Args:
        handle: PETSc's sequential matrix; whose block it is has to live as long.
        rows: Number of its rows.
        names: Global numbers of its columns, which increase; None where they are counted as they
            are owned.

    Attributes:
        starts: Where rows start, (rows + 1,).
    """

    def __init__(self, handle: ctypes.c_void_p, rows: int, names: Ints | None = None) -> None:
        self._handle = handle
        starts, columns = ctypes.c_void_p(), ctypes.c_void_p()
        wanted = (ctypes.byref(starts), ctypes.byref(columns), None, None)
        call_petsc("MatSeqAIJGetCSRAndMemType", handle, *wanted)
        self.starts: Ints = array_at(starts, rows + 1, PETSc.IntType)
        self._size = int(self.starts[-1])
        self._columns: Ints = array_at(columns, self._size, PETSc.IntType)
        self._names = names

    def columns(self) -> Ints:
        """Columns of the entries, global numbers or as they are owned."""
        return self._columns if self._names is None else self._names[self._columns]

    @contextmanager
    def entries(self) -> Iterator[Floats]:
        """The entries, by rows, to read or overwrite."""
        address, entries = numbers_of("MatSeqAIJGetArray", self._handle, self._size)
        try:
            yield entries
        finally:
            call_petsc("MatSeqAIJRestoreArray", self._handle, ctypes.byref(address))


def blocks_of(matrix: Mat) -> list[CsrBlock] | None:
    """Blocks that the rows of a matrix consist of on this process.

    Args:
        matrix: An assembled matrix.

    Returns:
        Its rows on one process; on several those in the columns that this one owns, and those in
        the columns of others. None where PETSc keeps it in another way.
    """
    if not has_petsc(*_NEEDED) or not matrix.assembled:
        return None
    rows = matrix.getLocalSize()[0]
    if matrix.getType() == PETSc.Mat.Type.SEQAIJ:
        return [CsrBlock(ctypes.c_void_p(matrix.handle), rows)]
    if matrix.getType() != PETSc.Mat.Type.MPIAIJ:
        return None
    own, others, names = (ctypes.c_void_p() for _ in range(3))
    wanted = [ctypes.byref(part) for part in (own, others, names)]
    call_petsc("MatMPIAIJGetSeqAIJ", matrix, *wanted)
    ghosts = array_at(names, _columns(others), PETSc.IntType)
    return [CsrBlock(own, rows), CsrBlock(others, rows, ghosts)]


def _columns(handle: ctypes.c_void_p) -> int:
    sides = np.zeros(2, dtype=PETSc.IntType)
    rows, columns = (ctypes.c_void_p(sides[i:].ctypes.data) for i in range(2))
    call_petsc("MatGetSize", handle, rows, columns)
    return int(sides[1])


def keyed_entries(rows: Ints, starts: Any, columns: Any, width: int) -> tuple[Ints, Ints]:
    """Entries of some rows, and a number for each that increases by rows and columns.

    Args:
        rows: Which rows.
        starts: Where all rows start.
        columns: Columns of all entries.
        width: A number that no column reaches.

    Returns:
        Places of the entries, and `row * width + column`.
    """
    counts = np.diff(starts)[rows].astype(np.int64)
    ends = np.cumsum(counts)
    entries = np.arange(counts.sum()) + np.repeat(starts[rows] - ends + counts, counts)
    return entries, np.repeat(rows, counts).astype(np.int64) * width + columns[entries]
