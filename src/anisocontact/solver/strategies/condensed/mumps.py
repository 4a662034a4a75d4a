"""Partial factorisation by MUMPS: Schur complement and solutions with the interior."""

from __future__ import annotations

import ctypes
from functools import cache
from typing import Any, override

import numpy as np
import scipy

from anisocontact.base.array_types import Floats, Ints
from anisocontact.base.fenicsx import Mat, PETSc
from anisocontact.base.petsc_calls import call_petsc, check_memory, has_petsc, numbers_of
from anisocontact.solver.strategies.binary_scale import binary_scale
from anisocontact.solver.strategies.condensed.factor import (
    Eliminated,
    aij,
    mirror,
    singular,
    solves,
)

#: MUMPS: what a solution does with the Schur complement, and "the interior alone".
_ICNTL_SCHUR_SOLUTION, _INTERIOR_ALONE = 26, 0
#: MUMPS: workspace beyond what it expects to need, percent: tried one after the other.
_ICNTL_WORKSPACE, WORKSPACE = 14, (30, 200, 1000)
#: MUMPS: whether workspace that a factorisation leaves is given back, and "by a copy".
_ICNTL_COMPACT, _BY_COPY = 49, 1
#: MUMPS: whether fronts are cut into blocks that may be of low rank, and "where it is told so".
_ICNTL_BLOCKED, _BLOCKED = 35, 2
#: MUMPS: error that blocks of low rank may have: they are whole, but their products are fast ones.
_CNTL_DROPPED, _NOTHING = 7, 0.0
#: The same where no pivots are looked for, as a rule: what is expected is what is needed.
WORKSPACE_SYMMETRIC = (5, *WORKSPACE)
#: MUMPS: what it says where its workspace was too small.
TOO_SMALL = (-8, -9, -14, -15, -17, -20)


@cache
def reachable() -> bool:
    """Whether this PETSc has MUMPS with its Schur complement.

    petsc4py has no name for it, but the library that petsc4py is linked to has.
    """
    if not has_petsc("MatFactorSetSchurIS", "MatFactorGetSchurComplement", "MatDenseGetArrayRead"):
        return False
    small = scipy.sparse.csr_array([[2.0, -1.0], [-1.0, 2.0]])
    try:
        MumpsFactor(small, np.array([0])).close()
    except PETSc.Error:
        return False
    return True


class MumpsFactor(Eliminated):
    """An interior eliminated by MUMPS; arguments as of `Eliminator`.

    MUMPS makes S as the last front of one factorisation, which then solves with `A_ii`. LDL^T takes
    0.63 of the memory of LU and, cut into blocks, 0.8 of its time; with whole fronts as much, for
    OpenBLAS has a fast product of matrices and a slow one of which a triangle is wanted.

    Example:
        >>> springs = scipy.sparse.csr_array([[2.0, -1.0], [-1.0, 2.0]])
        >>> factor = MumpsFactor(springs, np.array([0]))
        >>> factor.schur.tolist(), factor.interior(np.array([[7.0], [4.0]])).round(9).tolist()
        ([[1.5]], [[0.0], [2.0]])
    """

    def __init__(self, matrix: scipy.sparse.csr_array, border: Ints) -> None:
        self._border = border
        given = aij(matrix)
        # without a search for pivots MUMPS takes those below some 1e-16 for zero, in any units
        stiff = matrix.diagonal()
        self._binary = binary_scale(float(stiff[stiff > 0.0].min(initial=np.inf)))
        given.scale(self._binary)
        given.setOption(PETSc.Mat.Option.SYMMETRIC, True)
        given.setOption(PETSc.Mat.Option.SPD, True)  # no pivots are looked for
        kind = PETSc.PC.Type.CHOLESKY
        for extra in WORKSPACE_SYMMETRIC:
            pc, self._factor = partial_factor(given, border, extra, kind=kind)
            if self._factor.getMumpsInfog(1) not in TOO_SMALL:
                break
        failed = pc.getFailedReason() != 0
        if failed:
            check_memory(pc)
        pc.destroy()  # the factor goes without the matrix
        given.destroy()
        if failed:
            self.close()
            raise singular()
        # of the solutions that MUMPS offers: the interior, border at zero
        self._factor.setMumpsIcntl(_ICNTL_SCHUR_SOLUTION, _INTERIOR_ALONE)
        self.schur = self._schur_view(len(border))
        if not solves(self, matrix, border):
            self.close()
            raise singular()

    @override
    def interior(self, b: Floats) -> Floats:
        right = PETSc.Mat().createDense(b.shape, comm=PETSc.COMM_SELF)
        right.setUp()
        left = right.duplicate()
        given = right.getDenseArray()
        given[:] = self._binary * b
        given[self._border] = 0.0
        right.assemble()
        self._factor.matSolve(right, left)
        out = np.array(left.getDenseArray(), order="F")
        out[self._border] = 0.0
        right.destroy()
        left.destroy()
        return out

    @override
    def close(self) -> None:
        self._factor.destroy()

    def _schur_view(self, count: int) -> Floats:
        """S without a copy, made symmetric to the last bit."""
        _, view = schur_matrix(self._factor, count)
        view /= self._binary
        mirror(view)
        return view


def partial_factor(
    matrix: Mat, border: Ints, extra: int, prefix: str = "", kind: str = PETSc.PC.Type.LU
) -> tuple[Any, Mat]:
    """Factorise with a border left.

    Args:
        matrix: The matrix.
        border: Numbers of the border unknowns.
        extra: Percent of workspace beyond what MUMPS expects.
        prefix: Prefix of PETSc's options.
        kind: PETSc's name of the factorisation.

    Returns:
        PETSc's preconditioner, which owns it, and the factor.
    """
    pc, factor = unfactorised(matrix, border, prefix, kind)
    factor.setMumpsIcntl(_ICNTL_WORKSPACE, extra)
    factor.setMumpsIcntl(_ICNTL_COMPACT, _BY_COPY)
    if kind == PETSc.PC.Type.CHOLESKY:
        factor.setMumpsIcntl(_ICNTL_BLOCKED, _BLOCKED)
        factor.setMumpsCntl(_CNTL_DROPPED, _NOTHING)
    pc.setUp()
    return pc, factor


def unfactorised(
    matrix: Mat, border: Ints, prefix: str = "", kind: str = PETSc.PC.Type.CHOLESKY
) -> tuple[Any, Mat]:
    """What `partial_factor` returns before anything is factorised."""
    pc = PETSc.PC().create(comm=PETSc.COMM_SELF)
    pc.setOperators(matrix)
    pc.setType(kind)
    pc.setFactorSolverType(PETSc.Mat.SolverType.MUMPS)
    pc.setFactorSetUpSolverType()
    factor = pc.getFactorMatrix()
    factor.setOptionsPrefix(prefix)
    numbers = PETSc.IS().createGeneral(border.astype(PETSc.IntType), comm=PETSc.COMM_SELF)
    call_petsc("MatFactorSetSchurIS", factor, numbers)
    numbers.destroy()
    return pc, factor


def schur_matrix(factor: Mat, count: int) -> tuple[ctypes.c_void_p, Floats]:
    """PETSc's dense matrix of a factor with a border of `count` unknowns, and its entries."""
    handle, status = ctypes.c_void_p(), ctypes.c_int()
    call_petsc("MatFactorGetSchurComplement", factor, ctypes.byref(handle), ctypes.byref(status))
    _, entries = numbers_of("MatDenseGetArrayRead", handle, count * count)
    return handle, entries.reshape(count, count).T
