"""The dense matrix of the contact unknowns with masters eliminated: what contact changes is left.

With u_s = v_s + P u_m, P the shares of master nodes in what is opposite to slave nodes, the gap of
a slave node is v_s: `T^T (S + C) T` with u = T v has what contacts do, and undo, in the rows of
slave nodes alone [Wohlmuth 2011, 5]. All others are eliminated once for many tangents.
All of it is in single precision.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import numpy.typing as npt
import scipy

Flags = npt.NDArray[np.bool_]
Ints = npt.NDArray[np.int64]
Singles = npt.NDArray[np.float32]
type Sparse = Any  # scipy.sparse.csr_array

#: Rows or columns of a dense matrix in one product.
_AT_ONCE = 512


class Front:
    """A dense matrix where slave nodes move against what is opposite, condensed on some unknowns.

    Args:
        summed: The matrix S, made anew by every call, (c, c).
        shares: P, in single precision, (c, c); no column of it has a row.
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

    def __init__(self, summed: Callable[[], Singles], shares: Sparse, stays: Flags) -> None:
        self._summed, self.shares, self.stays = summed, shares, stays
        self.unknowns, self._rest = np.flatnonzero(stays), np.flatnonzero(~stays)
        f, r = float(len(self.unknowns)), float(len(self._rest))
        self.factor_operations = 2.0 / 3.0 * f**3
        self.operations = 2.0 * r * (r**2 / 3.0 + r * f + f**2)
        self._matrix: Singles | None = None
        self._identity = scipy.sparse.diags_array(stays.astype(np.float32)).tocsr()
        if r:
            self._eliminate()
        elif shares.nnz:
            self._matrix = self._moved()

    def _moved(self) -> Singles:
        """T^T S T."""
        whole, back = self._summed(), self.shares.T.tocsr()
        for part in _parts(len(whole)):  # all at once needs twice the memory
            whole[part] += (back @ whole[part].T).T
        for part in _parts(len(whole)):
            whole[:, part] += back @ whole[:, part]
        return whole

    def _eliminate(self) -> None:
        whole, rest, own = self._moved(), self._rest, self.unknowns
        self._across, front = _taken(whole, own, rest), _taken(whole, own, own)
        follows, left = _taken(whole, rest, own), _taken(whole, rest, rest)
        del whole
        self._factor = _factor(left)
        self._follows = self._factor(follows)
        self._matrix = scipy.linalg.blas.sgemm(
            -1.0, self._across, self._follows, beta=1.0, c=front, overwrite_c=1
        )

    def shares_with(self, now: Sparse) -> Sparse:
        """P of now, and that of this front where nothing is opposite any more."""
        gone = (np.diff(now.indptr) == 0) & (np.diff(self.shares.indptr) > 0)
        if not gone.any():
            return now
        return (now + scipy.sparse.diags_array(gone.astype(np.float32)) @ self.shares).tocsr()

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
        moves = (moves + self._identity).tocsr()
        return moves.T.tocsr() @ contact @ moves

    def factor(self, held: Sparse) -> Callable[[Singles], Singles]:
        """LU with a matrix of `held`, as a function that solves for v with it.

        Raises:
            ZeroDivisionError: The matrix is singular.
        """
        own = self.unknowns
        whole = not len(self._rest)
        matrix = self._summed() if self._matrix is None else self._matrix.copy(order="F")
        entries = (held if whole else held[own][:, own]).tocoo()
        matrix[entries.row, entries.col] += entries.data.astype(np.float32)
        solve = _factor(matrix)
        return solve if whole else lambda b: self._expanded(solve, b)

    def _expanded(self, solve: Callable[[Singles], Singles], b: Singles) -> Singles:
        own, rest, product = self.unknowns, self._rest, scipy.linalg.blas.sgemv
        x = np.empty_like(b)
        alone = self._factor(b[rest])
        x[own] = solve(product(-1.0, self._across, alone, beta=1.0, y=b[own]))
        x[rest] = product(-1.0, self._follows, x[own], beta=1.0, y=alone)
        return x


def _taken(whole: Singles, rows: Ints, columns: Ints) -> Singles:
    """Some rows and columns of a matrix, by columns."""
    return whole.T[np.ix_(columns, rows)].T


def _parts(count: int) -> Iterator[slice]:
    """Rows or columns of a matrix, some at a time."""
    return (slice(first, first + _AT_ONCE) for first in range(0, count, _AT_ONCE))


def _factor(matrix: Singles) -> Callable[[Singles], Singles]:
    """LU of a matrix, which is overwritten, as a function that solves with it."""
    lu, pivots, info = scipy.linalg.lapack.sgetrf(matrix, overwrite_a=1)
    if info != 0:
        raise ZeroDivisionError("the matrix is singular")

    def solve(b: Singles) -> Singles:
        return np.asarray(scipy.linalg.lapack.sgetrs(lu, pivots, b)[0])

    return solve
