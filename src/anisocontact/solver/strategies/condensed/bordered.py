"""LU of a matrix whose border changes while its interior stays: one pass for a solution."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import numpy.typing as npt
import scipy

from anisocontact.base.fenicsx import Mat, PETSc, Vec
from anisocontact.base.petsc_calls import call_petsc, check_memory, has_petsc
from anisocontact.solver.strategies.condensed.factor import aij, singular
from anisocontact.solver.strategies.condensed.mumps import (
    TOO_SMALL,
    WORKSPACE,
    partial_factor,
    schur_matrix,
)
from anisocontact.solver.strategies.newton import Database

Ints = npt.NDArray[np.int64]
Floats = npt.NDArray[np.float64]
Singles = npt.NDArray[np.float32]

#: PETSc: the Schur complement has a factor of its own; the place of "solve for a dense matrix".
_FACTORED, _MAT_SOLVE = 1, 100
#: Floating-point operations of a dense or sparse factorisation in the time in which a solution
#: reads one entry of a factor: 27 Gflop/s and 1 G entries/s, MUMPS and OpenBLAS on one core.
OPERATIONS_PER_ENTRY = 27.0
#: Share of the diagonal that the largest entry of a row has to change by to count.
_CLEARLY = 0.1
#: Prefix and options of PETSc under which MUMPS works in single precision.
_SINGLE = ("anisocontact_single_", {"pc_precision": "single"})


@cache
def reachable() -> bool:
    """Whether this PETSc has what `BorderedLU` needs."""
    if not has_petsc("MatFactorRestoreSchurComplement", "MatSetOperation", "MatDenseGetArray"):
        return False
    small = aij(scipy.sparse.csr_array([[2.0, -1.0], [-1.0, 2.0]]))
    try:
        factor = BorderedLU(small, np.array([0]))
    except PETSc.Error:
        return False
    factor.renew(scipy.sparse.csr_array([[1.0]]))
    b, x = small.createVecs()
    b.array[:] = [2.0, 1.0]
    factor.solve(b, x)
    factor.close()
    return bool(np.allclose(x.array_r, 1.0))


class BorderedLU:
    """LU of `A + change`, where the change is in the border alone.

    With the unknowns cut into interior i and border c MUMPS factorises `A_ii` and makes
    `S = A_cc - A_ci A_ii^-1 A_ic` once; `S + change` is factorised here, dense and in single
    precision, whenever the change is another one. A solution condenses the right-hand side,
    solves with the border and expands: every entry of the factor is read once.

    Args:
        matrix: A, on one process; any matrix whose interior has an inverse.
        border: Numbers of the border unknowns, increasing, (c,); neither none nor all.
        single: Whether MUMPS works in single precision, where this PETSc can.

    Raises:
        SingularError: There is no factor.

    Attributes:
        border: As given.
        solutions_per_factor: Solutions that cost as much as the factorisation.
        solutions_per_border: Solutions that cost as much as a factorisation of the border.
        change: Change of the border that is factorised, None before the first.
    """

    def __init__(self, matrix: Mat, border: Ints, single: bool = False) -> None:
        self.border = border
        prefix, options = _SINGLE if single else ("", {})
        for extra in WORKSPACE:
            with Database(prefix, options):
                self._pc, self._factor = partial_factor(matrix, border, extra, prefix)
            if self._factor.getMumpsInfog(1) not in TOO_SMALL:
                break
            self._pc.destroy()
        if self._pc.getFailedReason() != 0:
            check_memory(self._pc)
            self._pc.destroy()
            raise singular()
        handle, schur = schur_matrix(self._factor, len(border))
        self._schur = schur.astype(np.float32)
        entries = float(self._factor.getMumpsInfog(29))
        entries = entries if entries >= 0.0 else -1e6 * entries
        operations = float(self._factor.getMumpsRinfog(3))
        self.solutions_per_factor = operations / OPERATIONS_PER_ENTRY / entries
        dense = len(border) ** 3 / 3.0  # single precision is twice as fast
        self.solutions_per_border = dense / OPERATIONS_PER_ENTRY / entries
        self._diagonal = np.abs(np.diagonal(self._schur))
        self.change: scipy.sparse.csr_array | None = None
        self._solve_border: Callable[[Singles], Singles] | None = None
        self._callback = _MatSolve(self._answer)
        call_petsc("MatFactorRestoreSchurComplement", self._factor, None, _FACTORED)
        call_petsc("MatSetOperation", handle, _MAT_SOLVE, self._callback)

    def renew(self, change: scipy.sparse.csr_array) -> float:
        """Take a change of the border, (c, c).

        What a factor lacks costs a Krylov method at most an iteration for every row: where fewer
        rows differ clearly from those of the last one than the factorisation would cost, it stays.

        Returns:
            What it has cost, in solutions.

        Raises:
            SingularError: The border has no inverse.
        """
        if self.change is not None:
            rows = abs(change - self.change).max(axis=1).toarray().ravel()
            if np.count_nonzero(rows > _CLEARLY * self._diagonal) < self.solutions_per_border:
                return 0.0
        matrix = np.array(self._schur, order="F")
        entries = change.tocoo()
        matrix[entries.row, entries.col] += entries.data.astype(np.float32)

        lu, pivots, info = scipy.linalg.lapack.sgetrf(matrix, overwrite_a=1)
        if info != 0:
            raise singular()
        self._solve_border = lambda b: np.asarray(scipy.linalg.lapack.sgetrs(lu, pivots, b)[0])
        self.change = change
        return self.solutions_per_border

    def solve(self, b: Vec, x: Vec) -> None:
        """Solve `(A + change) x = b`; `renew` comes first."""
        self._factor.solve(b, x)

    def close(self) -> None:
        """Give back the memory."""
        self._pc.destroy()
        self._solve_border = None

    def _answer(self, _: Any, __: Any, values: int) -> int:
        """What MUMPS asks for between its two halves: the border, in place."""
        handle, entries = ctypes.c_void_p(values), ctypes.POINTER(ctypes.c_double)()
        call_petsc("MatDenseGetArray", handle, ctypes.byref(entries))
        border = np.ctypeslib.as_array(entries, (len(self.border),))
        size = float(np.abs(border).max(initial=0.0)) or 1.0  # what is small is no zero
        assert self._solve_border is not None, "`renew` comes first"
        border[:] = size * self._solve_border((border / size).astype(np.float32))
        call_petsc("MatDenseRestoreArray", handle, ctypes.byref(entries))
        return 0


_MatSolve = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p)
