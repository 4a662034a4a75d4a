"""Factorisations of all unknowns, one for a right-hand side, with one analysis for all of them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.fenicsx import Mat, PETSc, Vec
from anisocontact.base.petsc_calls import check_memory


class WholeLU:
    """LU by MUMPS, in double precision.

    Attributes:
        made: Factorisations so far.

    Example:
        >>> from anisocontact.solver.strategies.condensed.factor import aij
        >>> import scipy
        >>> lu = WholeLU()
        >>> lu.solve(aij(scipy.sparse.csr_array([[2.0, 0.0], [1.0, 4.0]])), np.array([4.0, 6.0]))
        array([2., 1.])
        >>> lu.close()
    """

    def __init__(self) -> None:
        self._ksp: Any = None
        self.made = 0

    def solve(self, matrix: Mat, b: Floats) -> Floats | None:
        """Factorise a matrix and solve once; None where it is singular.

        Args:
            matrix: The matrix; on one process one whose pattern is that of before is not analysed.
            b: Right-hand side of the rows of this rank, (n,).
        """
        if self._ksp is None:
            self._ksp = PETSc.KSP().create(matrix.getComm())
            self._ksp.setType(PETSc.KSP.Type.PREONLY)
            self._ksp.getPC().setType(PETSc.PC.Type.LU)
            self._ksp.getPC().setFactorSolverType(PETSc.Mat.SolverType.MUMPS)
        given, found = matrix.createVecs()
        given.array[:] = b
        self._ksp.setOperators(matrix)
        self._ksp.solve(given, found)
        self.made += 1
        failed = self._ksp.getConvergedReason() < 0
        whole = np.isfinite(found.norm())
        if failed:
            check_memory(self._ksp.getPC())
            self.close()
        return None if failed or not whole else np.array(found.array_r)

    @property
    def inverse(self) -> Callable[[Vec, Vec], None] | None:
        """Writes the solution of another right-hand side; None where there is no factor."""
        return None if self._ksp is None else self._ksp.getPC().apply

    def close(self) -> None:
        """Give back the memory; the next matrix is analysed anew."""
        if self._ksp is not None:
            self._ksp.destroy()
        self._ksp = None
