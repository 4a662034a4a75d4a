"""LU of a matrix whose border changes while its interior stays: one pass for a solution."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping
from functools import cache
from typing import Any

import numpy as np
import scipy

from anisocontact.base.array_types import Flags, Floats, Ints, Sparse
from anisocontact.base.fenicsx import PETSc
from anisocontact.base.petsc_calls import call_petsc, has_petsc, numbers_of
from anisocontact.solver.strategies.condensed.border import Border
from anisocontact.solver.strategies.condensed.diagonal_rows import DiagonalRows
from anisocontact.solver.strategies.condensed.factor import aij
from anisocontact.solver.strategies.condensed.front import Reals, whole
from anisocontact.solver.strategies.condensed.interior import Interior
from anisocontact.solver.strategies.condensed.mumps import schur_matrix
from anisocontact.solver.strategies.costs import factorisation_cost

#: PETSc: the Schur complement has a factor of its own; the place of "solve for a dense matrix".
_FACTORED, _MAT_SOLVE = 1, 100
#: Prefix and options of PETSc under which MUMPS works in single precision.
_SINGLE = ("anisocontact_single_", {"pc_precision": "single"})


@cache
def reachable() -> bool:
    """Whether this PETSc has what `PartialLU` needs."""
    if not has_petsc("MatFactorRestoreSchurComplement", "MatSetOperation", "MatDenseGetArray"):
        return False
    small = scipy.sparse.csr_array([[2.0, -1.0], [-1.0, 2.0]])
    try:
        factor = BorderedLU(small, np.array([0]))
    except PETSc.Error:
        return False
    factor.renew(scipy.sparse.csr_array([[1.0]]), *whole(1))
    x = factor.solution(np.array([2.0, 1.0]))
    factor.close()
    return bool(np.allclose(x, 1.0))


class PartialLU:
    """LU of the interior of a matrix A; a solution leaves the border to somebody else.

    With the unknowns cut into interior i and border c MUMPS factorises `A_ii` and makes
    `S = A_cc - A_ci A_ii^-1 A_ic` once. A solution condenses the right-hand side, has the border
    solved for and expands: every entry of the factor is read once. Unknowns of the interior whose
    row is a diagonal, as where they are prescribed, are no part of the factor.

    Args:
        matrix: A, columns in order; any matrix whose interior has an inverse.
        border: Numbers of the border unknowns, increasing, (c,); neither none nor all.
        single: Whether MUMPS works in single precision, where this PETSc can.
        answer: Solution for the border with its condensed right-hand side, (c,).

    Raises:
        SingularError: There is no factor.

    Attributes:
        schur: S, in single precision, (c, c).
        cost: Time of the factorisation, see `factorisation_cost`.
        entries: Entries of the factor.
    """

    def __init__(
        self, matrix: Sparse, border: Ints, single: bool, answer: Callable[[Floats], Floats]
    ) -> None:
        self._border, self._single, self._answer = border, single, answer
        self._known = DiagonalRows(matrix, border)
        own = np.searchsorted(self._known.others, border)
        rest = aij(self._known.rest)
        self._right, self._left = rest.createVecs()
        self._interior = Interior(rest, own, *(_SINGLE if single else ("", {})))
        self._callback = _MatSolve(self._hand_over)
        self._begin()

    def take(self, matrix: Sparse, border: Ints, single: bool) -> bool:
        """Factorise another matrix in the place of A, if its entries have the same places.

        Args:
            matrix: The matrix.
            border: As of the class; it has to be that of A.
            single: As of the class.

        Returns:
            Whether it has; nothing is done if not.

        Raises:
            SingularError: There is no factor, of A neither from now on.
        """
        if single != self._single or not np.array_equal(border, self._border):
            return False
        known = DiagonalRows(matrix, border)
        if not np.array_equal(known.others, self._known.others):
            return False
        if not self._interior.take(known.rest):
            return False
        self._known = known
        self._begin()
        return True

    def solution(self, b: Floats) -> Floats:
        """Solution of A with what is added to its border."""
        return self._known.solution(b, self._of_others)

    def close(self) -> None:
        """Give back the memory."""
        self._interior.close()

    def _begin(self) -> None:
        """Take what is left on the border of a factor that is new."""
        handle, schur = schur_matrix(self._interior.factor, len(self._border))
        self.schur: Reals = schur.astype(np.float32)
        self.entries = self._interior.entries
        self.cost = factorisation_cost(self.entries, self._interior.operations)
        call_petsc("MatFactorRestoreSchurComplement", self._interior.factor, None, _FACTORED)
        call_petsc("MatSetOperation", handle, _MAT_SOLVE, self._callback)

    def _of_others(self, b: Floats) -> Floats:
        self._right.array[:] = b
        self._interior.factor.solve(self._right, self._left)
        return np.asarray(self._left.array_r)

    def _hand_over(self, _: Any, __: Any, values: int) -> int:
        """What MUMPS asks for between its two halves: the border, in place."""
        handle = ctypes.c_void_p(values)
        address, border = numbers_of("MatDenseGetArray", handle, len(self._border))
        border[:] = self._answer(border)
        call_petsc("MatDenseRestoreArray", handle, ctypes.byref(address))
        return 0


class BorderedLU:
    """LU of `A + C`, where C, what contacts do, is in the border alone.

    The interior is that of a `PartialLU`; `S + C` is factorised here, see `Border`, dense and in
    single precision, whenever C is another one.

    Args:
        matrix: A, as of `PartialLU`.
        border: Numbers of the border unknowns, as of `PartialLU`.
        single: Whether MUMPS works in single precision, where this PETSc can.

    Raises:
        SingularError: There is no factor.

    Attributes:
        border: As given.
        solutions_per_factor: Solutions that cost as much as the factorisation.
    """

    def __init__(self, matrix: Sparse, border: Ints, single: bool = False) -> None:
        self.border = border
        self._interior = PartialLU(matrix, border, single, self._of_border)
        self._begin()

    def take(self, matrix: Sparse, border: Ints, single: bool) -> bool:
        """Factorise another matrix in the place of A, see `PartialLU.take`."""
        if not self._interior.take(matrix, border, single):
            return False
        self._begin()
        return True

    def renew(self, contact: Sparse, shares: Sparse, slaves: Flags) -> float:
        """Take what contacts do now, see `Border.renew`."""
        return self._dense.renew(contact, shares, slaves)

    def persistent(self) -> dict[str, Any]:
        """What the factor of the border was made of."""
        return self._dense.persistent()

    def restore(self, kept: Mapping[str, Any]) -> None:
        """Make it again."""
        self._dense.restore(kept)

    def solution(self, b: Floats) -> Floats:
        """Solution of `(A + C) x = b`; `renew` comes first."""
        return self._interior.solution(b)

    def close(self) -> None:
        """Give back the memory."""
        self._interior.close()
        del self._dense

    def _begin(self) -> None:
        interior = self._interior
        self._dense = Border(interior.schur, interior.entries)
        self.solutions_per_factor = interior.cost / interior.entries

    def _of_border(self, b: Floats) -> Floats:
        return self._dense.solution(b)


_MatSolve = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p)
