"""The dense matrix of the contact unknowns with masters eliminated: what contact changes is left.

With u_s = v_s + P u_m, P the shares of master nodes in what is opposite to slave nodes, the gap of
a slave node is v_s: `T^T (S + C) T` with u = T v has what contacts do, and undo, in the rows of
slave nodes alone [Wohlmuth 2011, 5]. All others are eliminated once for many tangents.
All of it is in the precision of the matrix that is given.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import numpy.typing as npt
import scipy

from anisocontact.base.array_types import Flags, Ints, Sparse
from anisocontact.base.blas_threads import shared

#: Single or double precision.
Reals = npt.NDArray[Any]

#: Rows or columns of a dense matrix in one product.
_AT_ONCE = 512


class Front:
    """A dense matrix where slave nodes move against what is opposite, condensed on some unknowns.

    Args:
        summed: The matrix S, made anew by every call, (c, c).
        shares: P, (c, c); no column of it has a row.
        stays: Unknowns that are not eliminated, (c,).

    Attributes:
        shares: As given.
        stays: As given.
        unknowns: Those that are not eliminated, (f,).
        operations: Floating-point operations that it has cost.
        factor_operations: The same of a factorisation.

    Raises:
        ZeroDivisionError: What is to be eliminated is singular.
    """

    def __init__(self, summed: Callable[[], Reals], shares: Sparse, stays: Flags) -> None:
        self._summed, self.shares, self.stays = summed, shares, stays
        self.unknowns, self._rest = np.flatnonzero(stays), np.flatnonzero(~stays)
        f, r = float(len(self.unknowns)), float(len(self._rest))
        self.factor_operations = 2.0 / 3.0 * f**3
        self.operations = 2.0 * r * (r**2 / 3.0 + r * f + f**2)
        self._matrix: Reals | None = None
        if r:
            self._eliminate()
        elif shares.nnz:
            self._matrix = self._moved()

    def _moved(self) -> Reals:
        """T^T S T."""
        whole = self._summed()
        follow(whole, self.shares)
        return whole

    def _eliminate(self) -> None:
        whole, rest, own = self._moved(), self._rest, self.unknowns
        self._across, front = _taken(whole, own, rest), _taken(whole, own, own)
        follows, left = _taken(whole, rest, own), _taken(whole, rest, rest)
        del whole
        self._factor = factorised(left)
        self._follows = self._factor(follows)
        (product,) = scipy.linalg.get_blas_funcs(("gemm",), (front,))
        with shared(len(front)):
            across, follows = self._across, self._follows
            self._matrix = product(-1.0, across, follows, beta=1.0, c=front, overwrite_c=1)

    def shares_with(self, now: Sparse) -> Sparse:
        """P of now, and that of this front where nothing is opposite any more."""
        gone = (np.diff(now.indptr) == 0) & (np.diff(self.shares.indptr) > 0)
        if not gone.any():
            return now
        return (now + scipy.sparse.diags_array(gone.astype(now.dtype)) @ self.shares).tocsr()

    def held(self, contact: Sparse, now: Sparse) -> Sparse:
        """What contacts do in v, in the unknowns that are not eliminated, (c, c).

        Args:
            contact: The same in u.
            now: P of now.
        """
        if not self.shares.nnz:
            return contact
        moves = self.shares_with(now).copy()
        moves.data *= self.stays[moves.indices]
        moves.eliminate_zeros()
        identity = scipy.sparse.diags_array(self.stays.astype(contact.dtype)).tocsr()
        moves = (moves + identity).tocsr()
        return moves.T.tocsr() @ contact @ moves

    def factor(self, held: Sparse) -> Callable[[Reals], Reals]:
        """LU with a matrix of `held`, as a function that solves for v of all unknowns with it.

        Raises:
            ZeroDivisionError: The matrix is singular.
        """
        solve = self.own_factor(self.own(held))
        return lambda b: self.solution(solve, b)

    def own(self, held: Sparse) -> Sparse:
        """The part of a matrix of `held` in the unknowns that are not eliminated, (f, f)."""
        return held[self.unknowns][:, self.unknowns].tocsr() if len(self._rest) else held

    def own_factor(self, held: Sparse) -> Callable[[Reals], Reals]:
        """LU of the unknowns that are not eliminated with a matrix of `own`.

        Raises:
            ZeroDivisionError: The matrix is singular.
        """
        matrix = self._summed() if self._matrix is None else self._matrix.copy(order="F")
        entries = held.tocoo()
        matrix[entries.row, entries.col] += entries.data.astype(matrix.dtype)
        return factorised(matrix)

    def solution(self, solve: Callable[[Reals], Reals], b: Reals) -> Reals:
        """Solution for all unknowns by one for those that are not eliminated."""
        given, alone = self.condensed(b)
        return self.expanded(solve(given), alone)

    def condensed(self, b: Reals) -> tuple[Reals, Reals]:
        """Right-hand side of those that are not eliminated, and what the others do alone."""
        if not len(self._rest):
            return b, b[:0]
        alone = self._factor(b[self._rest])
        return _less(b[self.unknowns], self._across, alone), alone

    def expanded(self, own: Reals, alone: Reals) -> Reals:
        """All unknowns from those that are not eliminated, and what the others do alone."""
        if not len(self._rest):
            return own
        x = np.empty(len(own) + len(alone), dtype=own.dtype)
        x[self.unknowns] = own
        x[self._rest] = _less(alone, self._follows, own)
        return x


def whole(count: int) -> tuple[Sparse, Flags]:
    """Shares and slave nodes of a border without any, see `Front`."""
    none = scipy.sparse.csr_array((count, count), dtype=np.float32)
    return none, np.zeros(count, dtype=np.bool_)


def difference(one: Sparse, other: Sparse) -> Sparse:
    """One matrix less another one; where both have the same places these are not put together."""
    pairs = ((one.indptr, other.indptr), (one.indices, other.indices))
    if not all(np.array_equal(*pair) for pair in pairs):
        return (one - other).tocsr()
    places = (one.indices.copy(), one.indptr.copy())
    return scipy.sparse.csr_array((one.data - other.data, *places), one.shape)


def follow(matrix: Reals, shares: Sparse) -> None:
    """Make a matrix A that of unknowns of which others follow, `(1 + P)^T A (1 + P)`."""
    back = shares.T.tocsr()
    for part in _parts(len(matrix)):  # all at once needs twice the memory
        matrix[part] += (back @ matrix[part].T).T
    for part in _parts(len(matrix)):
        matrix[:, part] += back @ matrix[:, part]


def _taken(whole: Reals, rows: Ints, columns: Ints) -> Reals:
    """Some rows and columns of a matrix, by columns."""
    return whole.T[np.ix_(columns, rows)].T


def _parts(count: int) -> Iterator[slice]:
    """Rows or columns of a matrix, some at a time."""
    return (slice(first, first + _AT_ONCE) for first in range(0, count, _AT_ONCE))


def _less(b: Reals, matrix: Reals, x: Reals) -> Reals:
    """`b - A x` for vectors."""
    (product,) = scipy.linalg.get_blas_funcs(("gemv",), (matrix,))
    return np.asarray(product(-1.0, matrix, x, beta=1.0, y=b))


def factorised(matrix: Reals) -> Callable[[Reals], Reals]:
    """LU of a matrix, which is overwritten, as a function that solves with it.

    Raises:
        ZeroDivisionError: The matrix is singular.
    """
    getrf, getrs = scipy.linalg.get_lapack_funcs(("getrf", "getrs"), (matrix,))
    with shared(len(matrix)):
        lu, pivots, info = getrf(matrix, overwrite_a=1)
    if info != 0:
        raise ZeroDivisionError("the matrix is singular")

    def solve(b: Reals) -> Reals:
        if b.ndim == 1:
            return np.asarray(getrs(lu, pivots, b)[0])
        with shared(len(lu)):
            return np.asarray(getrs(lu, pivots, b)[0])

    return solve
