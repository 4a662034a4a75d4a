"""The interior of a matrix eliminated, and what all ways to do it share."""

from __future__ import annotations

from typing import Protocol

import numpy as np
import scipy

from anisocontact.base.array_types import Floats, Ints
from anisocontact.base.fenicsx import Mat, PETSc
from anisocontact.solver.terms.term import SingularError

#: Error of a solution beyond which a matrix counts as singular.
_TRUSTED = 0.1


class Eliminated(Protocol):
    """The interior of a symmetric positive definite matrix A eliminated, its border left.

    With the unknowns split into interior i and border c: `S = A_cc - A_ci A_ii^-1 A_ic`.

    Attributes:
        schur: S, (c, c), dense and symmetric to the last bit; memory of the factor.
    """

    schur: Floats

    def interior(self, b: Floats) -> Floats:
        """Solve `A_ii x_i = b_i` for several right-hand sides, with `x_c = 0`.

        Args:
            b: Right-hand sides, (n, k); entries of the border do not count.

        Returns:
            x, (n, k).
        """
        ...

    def close(self) -> None:
        """Give back the memory; `schur` must not be used any more."""
        ...


class Eliminator(Protocol):
    """Who eliminates an interior."""

    def __call__(self, matrix: scipy.sparse.csr_array, border: Ints, /) -> Eliminated:
        """Eliminate it.

        Args:
            matrix: A, both triangles, columns in order, (n, n).
            border: Numbers of the border unknowns, increasing, (c,); neither none nor all.

        Raises:
            SingularError: The interior cannot be solved.
        """
        ...


def aij(matrix: scipy.sparse.csr_array) -> Mat:
    """The same matrix for PETSc, on this process alone."""
    parts = (
        (matrix.indptr, PETSc.IntType),
        (matrix.indices, PETSc.IntType),
        (matrix.data, PETSc.ScalarType),
    )
    csr = tuple(np.ascontiguousarray(values, dtype=kind) for values, kind in parts)
    return PETSc.Mat().createAIJ(matrix.shape, csr=csr, comm=PETSc.COMM_SELF)


def mirror(lower: Floats) -> None:
    """Write the lower triangle of a matrix over the upper one."""
    for j in range(1, len(lower)):
        lower[:j, j] = lower[j, :j]


def solves(factor: Eliminated, matrix: scipy.sparse.csr_array, border: Ints) -> bool:
    """Whether a factor finds a known solution: of a pivot of rounding size nothing else tells."""
    known = np.ones((matrix.shape[0], 1))
    known[border] = 0.0
    return bool(np.abs(factor.interior(matrix @ known) - known).max() < _TRUSTED)


def singular() -> SingularError:
    """The error that every way ends with."""
    return SingularError("the stiffness of the bodies is singular")
