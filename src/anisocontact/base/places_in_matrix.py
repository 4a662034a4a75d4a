"""Where the entries of a sparse matrix stand in one of PETSc that has room for more."""

from __future__ import annotations

import ctypes
from typing import Any

import numpy as np
import scipy

from anisocontact.base.array_types import Floats, Ints
from anisocontact.base.fenicsx import Mat, PETSc
from anisocontact.base.petsc_calls import call_petsc, has_petsc

#: Name of what is left at a matrix to know it again; it goes when the matrix does.
_MARK = "anisocontact.places"
_NEEDED = ("MatSeqAIJGetArray", "MatSeqAIJRestoreArray", "MatGetNonzeroState")


class PlacesInMatrix:
    """Copies the entries of a sparse matrix to where they stand in one of PETSc.

    Places are looked for once for a matrix and its pattern, on one process.

    Args:
        starts: First entry of every row, (rows + 1,).
        columns: Column of every entry, increasing in every row, (entries,).

    Attributes:
        found: How often places have been looked for.

    Example:
        >>> from anisocontact.base.fenicsx import PETSc
        >>> out = PETSc.Mat().createAIJ((2, 2), csr=([0, 2, 4], [0, 1, 0, 1], [1.0, 2.0, 3.0, 4.0]))
        >>> PlacesInMatrix([0, 1, 2], [0, 1]).copy(np.array([5.0, 6.0]), out)
        True
        >>> out.getValuesCSR()[2]
        array([5., 2., 3., 6.])
    """

    def __init__(self, starts: Any, columns: Any) -> None:
        self._starts, self._columns = np.asarray(starts), np.asarray(columns)
        self._mark, self._state = object(), -1
        self._places: Ints | None = None
        self.found = 0

    def copy(self, values: Floats, out: Mat) -> bool:
        """Write entries over those that a matrix has there.

        Args:
            values: The entries, (entries,).
            out: The matrix; further rows and columns stay as they are.

        Returns:
            Whether it has all of the places; nothing is written if not.
        """
        if out.getType() != PETSc.Mat.Type.SEQAIJ or not out.assembled or not has_petsc(*_NEEDED):
            return False
        state = ctypes.c_int64()
        call_petsc("MatGetNonzeroState", out, ctypes.byref(state))
        if out.getAttr(_MARK) is not self._mark or state.value != self._state:
            self._mark, self._state = object(), state.value
            self._places = self._look(out)
            out.setAttr(_MARK, self._mark)
        if self._places is None:
            return False
        entries = ctypes.POINTER(ctypes.c_double)()
        call_petsc("MatSeqAIJGetArray", out, ctypes.byref(entries))
        count = int(out.getInfo()["nz_used"])
        np.ctypeslib.as_array(entries, (count,))[self._places] = values
        call_petsc("MatSeqAIJRestoreArray", out, ctypes.byref(entries))
        return True

    def _look(self, out: Mat) -> Ints | None:
        """Places of all entries; None where one is missing."""
        self.found += 1
        starts, columns = out.getRowIJ()
        rows, width = len(self._starts) - 1, out.getSize()[1]
        if len(starts) <= rows:
            return None
        starts = starts[: rows + 1]
        columns = columns[: starts[-1]]
        numbers = np.arange(1, len(columns) + 1)
        there = scipy.sparse.csr_array((numbers, columns, starts), (rows, width))
        ones = np.ones(len(self._columns), dtype=numbers.dtype)
        own = scipy.sparse.csr_array((ones, self._columns, self._starts), (rows, width))
        if not (there.has_canonical_format and own.has_canonical_format):
            return None
        places = there.multiply(own).tocsr().data - 1
        return places if len(places) == len(ones) else None
