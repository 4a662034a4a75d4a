"""Partial factorisation by any factorisation of the interior and many right-hand sides."""

from __future__ import annotations

from typing import override

import numpy as np
import scipy

from anisocontact.base.array_types import Floats, Ints
from anisocontact.base.fenicsx import PETSc
from anisocontact.base.petsc_calls import check_memory
from anisocontact.solver.strategies.condensed.factor import Eliminated, aij, singular, solves

#: Right-hand sides at a time: enough for products of matrices, few beside the factor.
_COLUMNS = 64


class BlockedFactor(Eliminated):
    """An interior eliminated by any factorisation of it; arguments as of `Eliminator`.

    PETSc factorises `A_ii`, with MUMPS if it has it, and S is made of solutions with the columns of
    `A_ic`: several times slower than a partial factorisation, but nothing is needed that PETSc does
    not always have.
    """

    def __init__(self, matrix: scipy.sparse.csr_array, border: Ints) -> None:
        self._inside: Ints = np.setdiff1d(np.arange(matrix.shape[0]), border)
        self._matrix = aij(matrix[self._inside][:, self._inside].tocsr())
        self._pc = _solver(self._matrix)
        if not (self._factorised() and solves(self, matrix, border)):
            self.close()
            raise singular()
        self.schur = self._eliminated(matrix, border)

    @override
    def interior(self, b: Floats) -> Floats:
        out = np.zeros(b.shape)
        out[self._inside] = self._solved(b[self._inside])
        return out

    @override
    def close(self) -> None:
        self._pc.destroy()
        self._matrix.destroy()

    def _solved(self, b: Floats) -> Floats:
        right = PETSc.Mat().createDense(b.shape, array=b.ravel(order="F"), comm=PETSc.COMM_SELF)
        left = right.duplicate()
        self._pc.getFactorMatrix().matSolve(right, left)
        x = np.array(left.getDenseArray())
        right.destroy()
        left.destroy()
        return x

    def _factorised(self) -> bool:
        """Whether there is a factor."""
        try:
            self._pc.setUp()
        except PETSc.Error:  # PETSc's own factorisation raises at a pivot that is zero
            return False
        if self._pc.getFailedReason() == 0:
            return True
        check_memory(self._pc)
        return False

    def _eliminated(self, matrix: scipy.sparse.csr_array, border: Ints) -> Floats:
        of_border = matrix[border].tocsr()
        coupling = of_border[:, self._inside].tocsr()
        schur: Floats = of_border[:, border].toarray(order="F")
        for first in range(0, len(border), _COLUMNS):
            some = slice(first, first + _COLUMNS)
            schur[:, some] -= coupling @ self._solved(coupling[some].toarray().T)
        return 0.5 * (schur + schur.T)


def _solver(matrix: PETSc.Mat) -> PETSc.PC:
    """A factorisation by MUMPS if PETSc has it, else by PETSc itself."""
    kinds = PETSc.Mat.SolverType
    for kind in (kinds.MUMPS, kinds.PETSC):
        pc = PETSc.PC().create(comm=PETSc.COMM_SELF)
        pc.setOperators(matrix)
        pc.setType(PETSc.PC.Type.LU)
        pc.setFactorSolverType(kind)
        try:
            pc.setFactorSetUpSolverType()
        except PETSc.Error:
            continue
        break
    return pc
