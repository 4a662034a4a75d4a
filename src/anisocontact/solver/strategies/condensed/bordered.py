"""LU of a matrix whose border changes while its interior stays: one pass for a solution."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping
from functools import cache
from typing import Any

import numpy as np
import scipy

from anisocontact.base.array_types import Flags, Floats, Ints
from anisocontact.base.fenicsx import PETSc
from anisocontact.base.petsc_calls import call_petsc, has_petsc
from anisocontact.solver.strategies.condensed.diagonal_rows import DiagonalRows
from anisocontact.solver.strategies.condensed.factor import aij, singular
from anisocontact.solver.strategies.condensed.front import Front, Reals, Sparse, whole
from anisocontact.solver.strategies.condensed.interior import Interior
from anisocontact.solver.strategies.condensed.mumps import schur_matrix
from anisocontact.solver.strategies.condensed.updated import UpdatedFactor
from anisocontact.solver.strategies.costs import factorisation_cost, operation_cost

#: PETSc: the Schur complement has a factor of its own; the place of "solve for a dense matrix".
_FACTORED, _MAT_SOLVE = 1, 100
#: Share of the diagonal that the largest entry of a row has to change by to count.
_CLEARLY = 0.1
#: Rows that are put right in a factor of the border, at most, over all; a column of many costs this
#: times what a column costs a factorisation: solutions run at half of its speed, and have no third.
_UPDATED, _COLUMN = 0.15, 6.0
#: Share of what is opposite to a slave node that may be another before masters are eliminated anew.
_DRIFT = 0.3
#: Arrays of a sparse matrix.
PARTS = ("data", "indices", "indptr")
#: Prefix and options of PETSc under which MUMPS works in single precision.
_SINGLE = ("anisocontact_single_", {"pc_precision": "single"})


@cache
def reachable() -> bool:
    """Whether this PETSc has what `BorderedLU` needs."""
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


class BorderedLU:
    """LU of `A + C`, where C, what contacts do, is in the border alone.

    With the unknowns cut into interior i and border c MUMPS factorises `A_ii` and makes
    `S = A_cc - A_ci A_ii^-1 A_ic` once; `S + C` is factorised here, see `Front`, dense and in
    single precision, whenever C is another one. A solution condenses the right-hand side,
    solves with the border and expands: every entry of the factor is read once. Unknowns of the
    interior whose row is a diagonal, as where they are prescribed, are no part of the factor.

    Args:
        matrix: A, columns in order; any matrix whose interior has an inverse.
        border: Numbers of the border unknowns, increasing, (c,); neither none nor all.
        single: Whether MUMPS works in single precision, where this PETSc can.

    Raises:
        SingularError: There is no factor.

    Attributes:
        border: As given.
        solutions_per_factor: Solutions that cost as much as the factorisation.
    """

    def __init__(self, matrix: Sparse, border: Ints, single: bool = False) -> None:
        self.border, self._single = border, single
        self._known = DiagonalRows(matrix, border)
        own = np.searchsorted(self._known.others, border)
        rest = aij(self._known.rest)
        self._right, self._left = rest.createVecs()
        self._interior = Interior(rest, own, *(_SINGLE if single else ("", {})))
        self._callback = _MatSolve(self._answer)
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
        if single != self._single or not np.array_equal(border, self.border):
            return False
        known = DiagonalRows(matrix, border)
        if not np.array_equal(known.others, self._known.others):
            return False
        if not self._interior.take(known.rest):
            return False
        self._known = known
        self._begin()
        return True

    def _begin(self) -> None:
        """Take what is left on the border of a factor that is new."""
        # gives the memory back
        self._front: Front | None = None
        self._updated: UpdatedFactor | None = None
        self._given: Sparse | None = None
        handle, schur = schur_matrix(self._interior.factor, len(self.border))
        self._schur = schur.astype(np.float32)
        entries, operations = self._interior.entries, self._interior.operations
        self.solutions_per_factor = factorisation_cost(entries, operations) / entries
        self._diagonal = np.abs(np.diagonal(self._schur))
        self._shares: Sparse = whole(len(self.border))[0]
        call_petsc("MatFactorRestoreSchurComplement", self._interior.factor, None, _FACTORED)
        call_petsc("MatSetOperation", handle, _MAT_SOLVE, self._callback)

    def renew(self, contact: Sparse, shares: Sparse, slaves: Flags) -> float:
        """Take what contacts do now.

        What a factor lacks costs a Krylov method at most an iteration for every row: where fewer
        rows differ clearly from those of the last one than the factorisation would cost, it stays.
        Where they are not many they are put right in it, see `UpdatedFactor`.

        Args:
            contact: C, (c, c).
            shares: How slave nodes follow what is opposite, see `Front`, (c, c).
            slaves: Unknowns of slave nodes, (c,).

        Returns:
            What it has cost, in solutions.

        Raises:
            SingularError: The border has no inverse.
        """
        cost, front = 0.0, self._front
        if front is None or not self._near(front, shares):
            front = self._front = self._eliminated(contact, shares, slaves)
            self._updated, cost = None, self._in_solutions(front.operations / 2.0)
        self._shares = front.shares_with(shares) if front.shares.nnz else front.shares
        held = front.own(front.held(contact, shares)).astype(np.float32)
        per_border = self._in_solutions(front.factor_operations / 2.0)  # half: single precision
        updated = self._updated
        if updated is not None:
            if self._changed(held - updated.held) < per_border:
                return cost
            found = updated.take(held, int(_UPDATED * len(front.unknowns)))
            if found is not None:
                self._given = held
                return cost + _COLUMN * found / len(front.unknowns) * per_border
        try:
            self._updated = self._made(front, held)
        except ZeroDivisionError:
            raise singular() from None
        return cost + per_border

    def _made(self, front: Front, held: Sparse) -> UpdatedFactor:
        """A factor of the border with what contacts do."""
        self._updated = self._given = None  # gives the memory back
        stiff = self._diagonal[front.unknowns]
        return UpdatedFactor(front.own_factor(held), held, stiff, (0.0,), _CLEARLY)

    def _in_solutions(self, operations: float) -> float:
        return operation_cost(operations) / self._interior.entries

    def _near(self, front: Front, shares: Sparse) -> bool:
        """Whether slave nodes are still about where they were when masters were eliminated."""
        if not front.shares.nnz:
            return not shares.nnz
        drift = abs(front.shares_with(shares) - front.shares).sum(axis=1)
        return float(drift.max()) < 2.0 * _DRIFT

    def _eliminated(self, contact: Sparse, shares: Sparse, slaves: Flags) -> Front:
        """S with all eliminated that contacts of now do not hold."""
        moves = (scipy.sparse.eye_array(len(self.border)) + shares).tocsr()
        stays = slaves | self._clearly(moves.T @ contact @ moves) | (self._diagonal == 0.0)
        try:
            if shares.nnz:
                return Front(self._copy, shares, stays)
        except ZeroDivisionError:
            pass
        none, _ = whole(len(self.border))
        return Front(self._copy, none, np.ones(len(self.border), dtype=np.bool_))

    def _copy(self) -> Reals:
        return np.array(self._schur, order="F")

    def _clearly(self, change: Sparse) -> Flags:
        rows = abs(change).max(axis=1).toarray().ravel()
        return np.asarray(rows > _CLEARLY * self._diagonal)

    def _changed(self, change: Sparse) -> int:
        """How many rows of the front change clearly."""
        assert self._front is not None
        stiff = self._diagonal[self._front.unknowns]
        return int(np.count_nonzero(abs(change).max(axis=1).toarray().ravel() > _CLEARLY * stiff))

    def persistent(self) -> dict[str, Any]:
        """What the factor of the border was made of."""
        front, updated = self._front, self._updated
        if front is None or updated is None:
            return {}
        own = {"stays": front.stays, **updated.persistent()}
        matrices = {"held": updated.first, "shares": front.shares}
        if self._given is not None:
            matrices["given"] = self._given
        for name, one in matrices.items():
            own |= {f"{name}.{part}": getattr(one, part) for part in PARTS}
        return own

    def restore(self, kept: Mapping[str, Any]) -> None:
        """Make it again."""
        if "stays" not in kept:
            return
        stays = kept["stays"]
        front = self._front = Front(self._copy, _kept(kept, "shares", len(stays)), stays)
        count = len(front.unknowns)
        updated = self._updated = self._made(front, _kept(kept, "held", count))
        updated.restore(kept)
        if "given.data" in kept:
            self._given = _kept(kept, "given", count)
            updated.take(self._given, count)

    def solution(self, b: Floats) -> Floats:
        """Solution of `(A + C) x = b`; `renew` comes first."""
        return self._known.solution(b, self._of_others)

    def _of_others(self, b: Floats) -> Floats:
        self._right.array[:] = b
        self._interior.factor.solve(self._right, self._left)
        return np.asarray(self._left.array_r)

    def close(self) -> None:
        """Give back the memory."""
        self._interior.close()
        self._updated = self._given = None

    def _answer(self, _: Any, __: Any, values: int) -> int:
        """What MUMPS asks for between its two halves: the border, in place."""
        handle, entries = ctypes.c_void_p(values), ctypes.POINTER(ctypes.c_double)()
        call_petsc("MatDenseGetArray", handle, ctypes.byref(entries))
        border = np.ctypeslib.as_array(entries, (len(self.border),))
        size = float(np.abs(border).max(initial=0.0)) or 1.0  # what is small is no zero
        front, updated = self._front, self._updated
        assert front is not None, "`renew` comes first"
        assert updated is not None, "`renew` comes first"
        given = (border / size).astype(np.float32)
        if self._shares.nnz:
            given += self._shares.T @ given
        own = front.solution(updated, given)
        border[:] = size * (own + self._shares @ own if self._shares.nnz else own)
        call_petsc("MatDenseRestoreArray", handle, ctypes.byref(entries))
        return 0


def _kept(kept: Mapping[str, Any], name: str, count: int) -> Sparse:
    """A sparse matrix that was kept, (count, count)."""
    parts = tuple(kept[f"{name}.{part}"] for part in PARTS)
    return scipy.sparse.csr_array(parts, (count, count))


_MatSolve = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p)
