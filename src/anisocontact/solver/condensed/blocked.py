"""Partial factorisation by any factorisation of the interior and many right-hand sides."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import scipy.sparse

from anisocontact._fenicsx import PETSc
from anisocontact.solver.newton import SingularError

Ints = npt.NDArray[np.int64]
Floats = npt.NDArray[np.float64]

#: Right-hand sides at a time: enough for products of matrices, few beside the factor.
_COLUMNS = 64
#: Error of a solution beyond which a matrix counts as singular.
_TRUSTED = 0.1


class BlockedFactor:
    """The interior of `A` eliminated, its border left; see `MumpsFactor`.

    PETSc factorises `A_ii`, with MUMPS if it has it, and `S = A_cc - A_ci A_ii^-1 A_ic` is made of
    solutions with the columns of `A_ic`: several times slower than a partial factorisation, but
    nothing is needed that PETSc does not always have.

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
        matrix = scipy.sparse.csr_array((values, columns, starts), (n, n))
        self._inside: Ints = np.setdiff1d(np.arange(n), border)
        inner = matrix[self._inside][:, self._inside].tocsr()
        self._matrix = PETSc.Mat().createAIJ(
            inner.shape,
            csr=tuple(
                np.ascontiguousarray(a, dtype=kind)
                for a, kind in (
                    (inner.indptr, PETSc.IntType),
                    (inner.indices, PETSc.IntType),
                    (inner.data, PETSc.ScalarType),
                )
            ),
            comm=PETSc.COMM_SELF,
        )
        self._pc = _solver(self._matrix)
        if not self._factorised():
            self.close()
            raise SingularError("the stiffness of the bodies is singular")
        self.schur = self._eliminated(matrix, border)

    def interior(self, b: Floats) -> Floats:
        """Solve `A_ii x_i = b_i` for several right-hand sides, with `x_c = 0`.

        Args:
            b: Right-hand sides, (n, k); entries of the border do not count.

        Returns:
            x, (n, k).
        """
        out = np.zeros(b.shape)
        out[self._inside] = self._solved(b[self._inside])
        return out

    def close(self) -> None:
        """Give back the memory of the factor."""
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
        """Whether there is a factor, and a known solution is found with it."""
        try:
            self._pc.setUp()
        except PETSc.Error:  # PETSc's own factorisation raises at a pivot that is zero
            return False
        if self._pc.getFailedReason() != 0:
            return False
        given, force = self._matrix.createVecs()
        given.set(1.0)
        self._matrix.mult(given, force)
        found = self._solved(np.array(force.array_r)[:, None])
        return bool(np.abs(found - 1.0).max() < _TRUSTED)

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
