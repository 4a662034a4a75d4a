"""Partial factorisation by Pardiso of Intel's MKL, for those who have installed `pypardiso`."""

from __future__ import annotations

import ctypes
import os
from functools import cache
from typing import Any

import numpy as np
import numpy.typing as npt
import scipy.sparse

from anisocontact.solver.newton import SingularError

Ints = npt.NDArray[np.int64]
Floats = npt.NDArray[np.float64]

#: Real, symmetric, positive definite.
_KIND = 2
#: Places of `iparm`, counted from one, and what is put there: values are given; nested dissection;
#: the Schur complement with a factor for solutions with the interior.
_OPTIONS = {1: 1, 2: 2, 36: 2}
#: Phases: analysis and factorisation, the two halves of a solution with the interior, release.
_FACTORISE, _FORWARD, _BACKWARD, _RELEASE = 12, 331, 333, -1
#: A pivot of an interior that is not positive.
_PIVOT = -4


@cache
def routine() -> Any:
    """`pardiso` of the MKL that `pypardiso` finds; None where there is none."""
    # else its threads and those of OpenBLAS wait for each other, spinning
    os.environ.setdefault("KMP_BLOCKTIME", "0")
    try:
        from pypardiso import PyPardisoSolver

        found = PyPardisoSolver().libmkl["pardiso"]
    except ImportError:
        return None
    found.restype = None
    return found


class PardisoFactor:
    """The interior of `A` eliminated, its border left; see `MumpsFactor`.

    The Schur complement comes out of the factorisation, of which only a triangle is made.

    Args:
        starts: Row pointers of A in compressed rows, (n + 1,).
        columns: Column of each entry.
        values: The entries, both triangles.
        border: Numbers of the border unknowns, increasing, (c,); neither none nor all.

    Attributes:
        schur: S, (c, c), dense and symmetric.

    Raises:
        SingularError: The interior cannot be solved.
    """

    def __init__(
        self, starts: npt.ArrayLike, columns: npt.ArrayLike, values: npt.ArrayLike, border: Ints
    ) -> None:
        n = len(np.asarray(starts)) - 1
        upper = scipy.sparse.triu(
            scipy.sparse.csr_array((values, columns, starts), (n, n)), format="csr"
        )
        upper.sort_indices()
        self.border = border
        self._entries = np.ascontiguousarray(upper.data, dtype=np.float64)
        self._starts = (upper.indptr + 1).astype(np.int32)
        self._columns = (upper.indices + 1).astype(np.int32)
        self._marks = np.zeros(n, dtype=np.int32)
        self._marks[border] = 1
        self._handle = np.zeros(64, dtype=np.int64)
        self._options = np.zeros(64, dtype=np.int32)
        for place, value in _OPTIONS.items():
            self._options[place - 1] = value
        count = len(border)
        self.schur: Floats = np.zeros((count, count), order="F")
        if self._call(_FACTORISE, np.zeros((n, 1)), self.schur) != 0:
            self.close()
            raise SingularError("the stiffness of the bodies is singular")
        for j in range(1, count):  # symmetric to the last bit
            self.schur[:j, j] = self.schur[j, :j]

    def interior(self, b: Floats) -> Floats:
        """Solve `A_ii x_i = b_i` for several right-hand sides, with `x_c = 0`.

        Args:
            b: Right-hand sides, (n, k); entries of the border do not count.

        Returns:
            x, (n, k).
        """
        right = np.array(b, dtype=np.float64, order="F")
        right[self.border] = 0.0
        half, x = np.zeros_like(right), np.zeros_like(right)
        self._call(_FORWARD, right, half)
        half[self.border] = 0.0
        self._call(_BACKWARD, half, x)
        return x

    def close(self) -> None:
        """Give back the memory of the factor."""
        if self._handle.any():
            self._call(_RELEASE, np.zeros((1, 1)), np.zeros((1, 1)))
            self._handle[:] = 0

    def _call(self, phase: int, b: Floats, x: Floats) -> int:
        """One phase; right-hand sides and solutions by columns.

        Returns:
            0, or -4 where a pivot is not positive.

        Raises:
            MemoryError: Pardiso failed for another reason, which is nearly always that one.
        """
        error = ctypes.c_int32(0)
        count = 1 if phase == _FACTORISE else b.shape[1]
        numbers = [ctypes.c_int32(v) for v in (1, 1, _KIND, phase, len(self._marks))]
        tail = [ctypes.c_int32(count), ctypes.c_int32(0)]
        arrays = (self._entries, self._starts, self._columns, self._marks)
        routine()(
            _pointer(self._handle),
            *map(ctypes.byref, numbers),
            *map(_pointer, arrays),
            ctypes.byref(tail[0]),
            _pointer(self._options),
            ctypes.byref(tail[1]),
            _pointer(b),
            _pointer(x),
            ctypes.byref(error),
        )
        if error.value not in {0, _PIVOT}:
            raise MemoryError(f"Pardiso stopped with error {error.value} in phase {phase}")
        return error.value


def _pointer(array: npt.NDArray[Any]) -> ctypes.c_void_p:
    return ctypes.c_void_p(array.ctypes.data)
