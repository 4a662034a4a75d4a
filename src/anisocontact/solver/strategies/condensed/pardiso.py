"""Partial factorisation by Pardiso of Intel's MKL, for those who have installed it."""

from __future__ import annotations

import ctypes
import os
import sys
from collections.abc import Iterator
from contextlib import suppress
from functools import cache
from importlib.metadata import PackageNotFoundError, files
from pathlib import Path
from typing import Any, override

import numpy as np
import numpy.typing as npt
import scipy

from anisocontact.base.array_types import Floats, Ints
from anisocontact.solver.strategies.condensed.factor import Eliminated, mirror, singular, solves

#: The library of MKL that finds the others.
_RUNTIME = "libmkl_rt.so"
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
    """`pardiso` of the MKL beside this Python; None where there is none."""
    # else its threads and those of OpenBLAS wait for each other, spinning
    os.environ.setdefault("KMP_BLOCKTIME", "0")
    for library in _libraries():
        with suppress(OSError, AttributeError):
            found = ctypes.CDLL(str(library)).pardiso
            found.restype = None
            return found
    return None


def _libraries() -> Iterator[Path]:
    """Where MKL's library may be: that of the package of PyPI, then that of a conda environment."""
    with suppress(PackageNotFoundError):
        yield from (Path(file.locate()) for file in files("mkl") or () if _RUNTIME in file.name)
    yield from sorted(Path(sys.prefix, "lib").glob(f"{_RUNTIME}*"))


class PardisoFactor(Eliminated):
    """An interior eliminated by Pardiso; arguments as of `Eliminator`.

    The Schur complement comes out of the factorisation, of which only a triangle is made. Pardiso
    goes on and factorises it as well, which has to have positive pivots: those of a body that
    contact alone holds are zero. The diagonal of the border is doubled, and taken off again.
    """

    def __init__(self, matrix: scipy.sparse.csr_array, border: Ints) -> None:
        n = matrix.shape[0]
        doubled: Floats = np.zeros(n)
        doubled[border] = matrix.diagonal()[border]
        upper = scipy.sparse.triu(matrix + scipy.sparse.diags_array(doubled), format="csr")
        upper.sort_indices()
        self._border = border
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
        self.schur = np.zeros((count, count), order="F")
        if self._call(_FACTORISE, np.zeros((n, 1)), self.schur) != 0:
            self.close()
            raise singular()
        self.schur[np.diag_indices(count)] -= doubled[border]
        mirror(self.schur)
        if not solves(self, matrix, border):
            self.close()
            raise singular()

    @override
    def interior(self, b: Floats) -> Floats:
        right = np.array(b, dtype=np.float64, order="F")
        right[self._border] = 0.0
        half, x = np.zeros_like(right), np.zeros_like(right)
        self._call(_FORWARD, right, half)
        half[self._border] = 0.0
        self._call(_BACKWARD, half, x)
        return x

    @override
    def close(self) -> None:
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
