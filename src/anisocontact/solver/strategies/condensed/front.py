"""The dense matrix of the contact unknowns with masters eliminated: what contact changes is left.

With u_s = v_s + P u_m, P the shares of master nodes in what is opposite to slave nodes, the gap of
a slave node is v_s: `T^T (S + C) T` with u = T v has what contacts do, and undo, in the rows of
slave nodes alone [Wohlmuth 2011, 5]. All others are eliminated once for many tangents.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
import scipy

Ints = npt.NDArray[np.int64]
Floats = npt.NDArray[np.float64]
Flags = npt.NDArray[np.bool_]
Singles = npt.NDArray[np.float32]
Block = tuple[slice, Floats]
type Sparse = Any  # scipy.sparse.csr_array

#: Operations of a dense factorisation in the time in which a solution reads an entry of a factor:
#: 70 Gflop/s and 4.4 G entries/s, OpenBLAS on one core in single precision, and a quarter more
#: for GMRES.
_OPERATIONS_PER_ENTRY = 20.0


class Front:
    """S where slave nodes move against what is opposite, condensed on a part of its unknowns.

    Args:
        blocks: Blocks of S on the diagonal.
        scale: What S is divided by.
        shares: P, in single precision, (c, c); no column of it has a row.
        stays: Unknowns that are not eliminated, (c,).

    Attributes:
        shares: As given.
        unknowns: Those that are not eliminated, (f,).
        cost: What it has cost, in solutions with the whole.
        factor_cost: The same of a factorisation.

    Raises:
        ZeroDivisionError: What is to be eliminated is singular.
    """

    def __init__(self, blocks: Sequence[Block], scale: float, shares: Sparse, stays: Flags) -> None:
        self._blocks, self._scale = blocks, scale
        self.shares, self.stays = shares, stays
        self.unknowns, self._rest = np.flatnonzero(stays), np.flatnonzero(~stays)
        n, f, r = (float(len(one)) for one in (stays, self.unknowns, self._rest))
        entries = _OPERATIONS_PER_ENTRY * max(n, 1.0) ** 2
        self.factor_cost = 2.0 / 3.0 * f**3 / entries
        self.cost = r * (r**2 / 3.0 + 2.0 * r * f + 2.0 * f**2) / entries
        self._matrix: Singles | None = None
        if r:
            self._eliminate()

    def _eliminate(self) -> None:
        whole, rest, own = self._summed(), self._rest, self.unknowns
        lifted = self.shares.T @ whole  # S is symmetric
        whole += lifted
        whole += lifted.T
        whole += self.shares.T @ lifted.T
        self._factor, info = scipy.linalg.lapack.spotrf(whole[np.ix_(rest, rest)], lower=1)
        if info != 0:
            raise ZeroDivisionError("what is to be eliminated is singular")
        across = np.asfortranarray(whole[np.ix_(rest, own)])
        self._follows = scipy.linalg.lapack.spotrs(self._factor, across, lower=1)[0]
        front = np.asfortranarray(whole[np.ix_(own, own)])
        self._matrix = scipy.linalg.blas.sgemm(
            -1.0, across, self._follows, beta=1.0, c=front, trans_a=1, overwrite_c=1
        )

    def _summed(self) -> Singles:
        """S over its scale, (c, c)."""
        n = len(self.stays)
        matrix = np.zeros((n, n), dtype=np.float32, order="F")
        for place, block in self._blocks:
            np.divide(block, self._scale, out=matrix[place, place], casting="same_kind")
        return matrix

    def shares_with(self, now: Sparse) -> Sparse:
        """P of now, and that of this front where nothing is opposite any more."""
        gone = scipy.sparse.diags_array((np.diff(now.indptr) == 0).astype(np.float32))
        return (now + gone @ self.shares).tocsr()

    def factor(self, contact: Sparse) -> Callable[[Singles], Singles]:
        """LU with a matrix of what contacts do, as a function that solves with it.

        Args:
            contact: Of v, over the scale, in unknowns that are not eliminated alone, (c, c).

        Raises:
            ZeroDivisionError: The matrix is singular.
        """
        own = self.unknowns
        matrix = self._summed() if self._matrix is None else self._matrix.copy(order="F")
        entries = (contact if self._matrix is None else contact[own][:, own]).tocoo()
        matrix[entries.row, entries.col] += entries.data
        lu, pivots, info = scipy.linalg.lapack.sgetrf(matrix, overwrite_a=1)
        if info != 0:
            raise ZeroDivisionError("the tangent is singular")

        def solve(b: Singles) -> Singles:
            return np.asarray(scipy.linalg.lapack.sgetrs(lu, pivots, b)[0])

        return solve if self._matrix is None else lambda b: self._expanded(solve, b)

    def _expanded(self, solve: Callable[[Singles], Singles], b: Singles) -> Singles:
        own, rest, product = self.unknowns, self._rest, scipy.linalg.blas.sgemv
        x = np.empty_like(b)
        x[own] = solve(product(-1.0, self._follows, b[rest], beta=1.0, y=b[own], trans=1))
        x[rest] = scipy.linalg.lapack.spotrs(self._factor, b[rest], lower=1)[0]
        x[rest] = product(-1.0, self._follows, x[own], beta=1.0, y=x[rest])
        return x
