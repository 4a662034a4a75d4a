"""Partial factorisation by MUMPS: Schur complement and solutions with the interior."""

from __future__ import annotations

import ctypes
from functools import cache
from typing import Any

import numpy as np
import numpy.typing as npt

from anisocontact._fenicsx import PETSc, call_petsc, has_petsc
from anisocontact.solver.newton import SingularError

Ints = npt.NDArray[np.int64]
Floats = npt.NDArray[np.float64]

#: MUMPS: what a solution does with the Schur complement, and "the interior alone".
_ICNTL_SCHUR_SOLUTION, _INTERIOR = 26, 0
#: MUMPS: workspace beyond what it expects to need, percent: tried one after the other.
_ICNTL_WORKSPACE, _WORKSPACE = 14, (30, 200, 1000)
#: MUMPS: what it says where its workspace was too small.
_TOO_SMALL = (-8, -9, -14, -15, -17, -20)
#: Error of a solution beyond which a matrix counts as singular.
_TRUSTED = 0.1


@cache
def reachable() -> bool:
    """Whether this PETSc has MUMPS with its Schur complement.

    petsc4py has no name for it, but the library that petsc4py is linked to has.
    """
    if not has_petsc("MatFactorSetSchurIS", "MatFactorGetSchurComplement", "MatDenseGetArrayRead"):
        return False
    try:
        MumpsFactor([0, 2, 4], [0, 1, 0, 1], [2.0, -1.0, -1.0, 2.0], np.array([0])).close()
    except PETSc.Error:
        return False
    return True


class MumpsFactor:
    """The interior of `A` eliminated, its border left.

    With the unknowns split into interior i and border c:
    `S = A_cc - A_ci A_ii^-1 A_ic`. MUMPS makes S as the last front of one factorisation, which then
    solves with `A_ii`. LU takes 0.6 of the time of LDL^T, with twice the operations: OpenBLAS has a
    fast product of matrices and a slow one of which a triangle is wanted (73 and 13 Gflop/s).

    Args:
        starts: Row pointers of A in compressed rows, (n + 1,).
        columns: Column of each entry.
        values: The entries, both triangles.
        border: Numbers of the border unknowns, increasing, (c,); neither none nor all.

    Attributes:
        schur: S, (c, c), dense and symmetric; memory of the factor.

    Raises:
        SingularError: The interior cannot be solved.

    Example:
        >>> factor = MumpsFactor([0, 2, 4], [0, 1, 0, 1], [2.0, -1.0, -1.0, 2.0], np.array([0]))
        >>> factor.schur.tolist(), factor.interior(np.array([[7.0], [4.0]])).round(9).tolist()
        ([[1.5]], [[0.0], [2.0]])
    """

    def __init__(
        self, starts: npt.ArrayLike, columns: npt.ArrayLike, values: npt.ArrayLike, border: Ints
    ) -> None:
        n = len(np.asarray(starts)) - 1
        csr = tuple(
            np.ascontiguousarray(a, dtype=kind)
            for a, kind in (
                (starts, PETSc.IntType),
                (columns, PETSc.IntType),
                (values, PETSc.ScalarType),
            )
        )
        self.border = border
        self._matrix = PETSc.Mat().createAIJ((n, n), csr=csr, comm=PETSc.COMM_SELF)
        self._matrix.setOption(PETSc.Mat.Option.SYMMETRIC, True)
        for extra in _WORKSPACE:
            self._factorise(extra)
            if self._factor.getMumpsInfog(1) not in _TOO_SMALL:
                break
        if self._pc.getFailedReason() != 0:
            self.close()
            raise SingularError("the stiffness of the bodies is singular")
        # of the solutions that MUMPS offers: the interior, border at zero
        self._factor.setMumpsIcntl(_ICNTL_SCHUR_SOLUTION, _INTERIOR)
        self.schur = self._schur_view(len(border))
        if not self._regular():
            self.close()
            raise SingularError("the stiffness of the bodies is singular")

    def interior(self, b: Floats) -> Floats:
        """Solve `A_ii x_i = b_i` for several right-hand sides, with `x_c = 0`.

        Args:
            b: Right-hand sides, (n, k); entries of the border do not count.

        Returns:
            x, (n, k).
        """
        right = PETSc.Mat().createDense(b.shape, comm=PETSc.COMM_SELF)
        right.setUp()
        left = right.duplicate()
        given = right.getDenseArray()
        given[:] = b
        given[self.border] = 0.0
        right.assemble()
        self._factor.matSolve(right, left)
        out = np.array(left.getDenseArray(), order="F")
        out[self.border] = 0.0
        right.destroy()
        left.destroy()
        return out

    def close(self) -> None:
        """Give back the memory; `schur` must not be used any more."""
        self._pc.destroy()
        self._matrix.destroy()

    def _factorise(self, extra: int) -> None:
        """Factorise with so many percent of workspace beyond what MUMPS expects."""
        self._pc = PETSc.PC().create(comm=PETSc.COMM_SELF)
        self._pc.setOperators(self._matrix)
        self._pc.setType(PETSc.PC.Type.LU)
        self._pc.setFactorSolverType(PETSc.Mat.SolverType.MUMPS)
        self._pc.setFactorSetUpSolverType()
        self._factor = self._pc.getFactorMatrix()
        self._factor.setMumpsIcntl(_ICNTL_WORKSPACE, extra)
        numbers = PETSc.IS().createGeneral(self.border.astype(PETSc.IntType), comm=PETSc.COMM_SELF)
        call_petsc("MatFactorSetSchurIS", self._factor, numbers)
        numbers.destroy()
        self._pc.setUp()

    def _regular(self) -> bool:
        """Whether a known solution is found: MUMPS says nothing of a pivot of rounding size."""
        known = np.ones((self._matrix.getSize()[0], 1))
        known[self.border] = 0.0
        given, force = self._matrix.createVecs()
        given.array[:] = known[:, 0]
        self._matrix.mult(given, force)
        found = self.interior(np.array(force.array_r)[:, None])
        return bool(np.abs(found - known).max() < _TRUSTED)

    def _schur_view(self, count: int) -> Floats:
        """PETSc's dense matrix as an array without a copy, made symmetric to the last bit."""
        handle, status = ctypes.c_void_p(), ctypes.c_int()
        call_petsc(
            "MatFactorGetSchurComplement",
            self._factor,
            ctypes.byref(handle),
            ctypes.byref(status),
        )
        entries = ctypes.POINTER(ctypes.c_double)()
        call_petsc("MatDenseGetArrayRead", handle, ctypes.byref(entries))
        by_columns: Any = np.ctypeslib.as_array(entries, (count, count))
        view = np.asarray(by_columns.T)
        for j in range(1, count):
            view[:j, j] = view[j, :j]
        return view
