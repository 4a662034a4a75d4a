"""Partial factorisation in dense fronts, by the library of dense matrices that SciPy has."""

from __future__ import annotations

from functools import cache
from typing import override

import numpy as np
import scipy

from anisocontact import _core
from anisocontact.base.array_types import Floats, Ints
from anisocontact.base.blas_threads import one_thread, shared
from anisocontact.base.fenicsx import PETSc
from anisocontact.solver.strategies.condensed.factor import Eliminated, mirror, singular, solves
from anisocontact.solver.strategies.condensed.supernodes import Supernode, elimination_of

_POTRF = scipy.linalg.lapack.dpotrf
_TRSM, _SYRK, _GEMM = (getattr(scipy.linalg.blas, name) for name in ("dtrsm", "dsyrk", "dgemm"))


@cache
def reachable() -> bool:
    """Whether this PETSc has METIS, which finds the order of elimination."""
    small = scipy.sparse.csr_array([[2.0, -1.0], [-1.0, 2.0]])
    try:
        elimination_of(small, np.array([0]))
    except PETSc.Error:
        return False
    return True


class MultifrontalFactor(Eliminated):
    """An interior eliminated front by front; arguments as of `Way`.

    The multifrontal method [Duff Reid 1983; Liu 1992]: each front is a dense matrix, of the entries
    of its own unknowns and of what its children leave. `F_11 = L L^T`, `K = F_21 L^-T`, and
    `F_22 - K K^T` is left for its parent, in the end for the border.

    Example:
        >>> springs = scipy.sparse.csr_array([[2.0, -1.0], [-1.0, 2.0]])
        >>> factor = MultifrontalFactor(springs, np.array([0]))
        >>> factor.schur.tolist(), factor.interior(np.array([[7.0], [4.0]])).round(9).tolist()
        ([[1.5]], [[0.0], [2.0]])
    """

    def __init__(self, matrix: scipy.sparse.csr_array, border: Ints) -> None:
        self._elimination = elimination_of(matrix, border)
        self._border = border
        self._factors: list[tuple[Floats, Floats]] = []
        with one_thread():
            self.schur = self._eliminated(matrix)
        if not solves(self, matrix, border):
            self.close()
            raise singular()

    @override
    def interior(self, b: Floats) -> Floats:
        order, inside = self._elimination.order, len(self._elimination.order) - len(self._border)
        x = np.asfortranarray(b[order])
        steps = list(zip(self._elimination.supernodes, self._factors, strict=False))
        with one_thread():
            for node, (square, below) in steps:
                own = slice(node.first, node.first + node.count)
                x[own] = _TRSM(1.0, square, x[own], lower=1)
                x[node.left] -= _GEMM(1.0, below, x[own])
            x[inside:] = 0.0
            for node, (square, below) in reversed(steps):
                own = slice(node.first, node.first + node.count)
                x[own] -= _GEMM(1.0, below, x[node.left], trans_a=1)
                x[own] = _TRSM(1.0, square, x[own], lower=1, trans_a=1)
        out = np.empty_like(x)
        out[order] = x
        return out

    @override
    def close(self) -> None:
        self._factors = []

    def _eliminated(self, matrix: scipy.sparse.csr_array) -> Floats:
        """Eliminate all fronts but the last one, the border; its Schur complement."""
        upper = _upper(matrix, self._elimination.order)
        left: dict[int, Floats] = {}
        for number, node in enumerate(self._elimination.supernodes[:-1]):
            square, below, rest = self._assembled(node, upper, left)
            with shared(node.as_large_as):
                square, failed = _POTRF(square, lower=1, clean=0, overwrite_a=1)
                if failed:
                    raise singular()
                if len(below):
                    below = _TRSM(1.0, square, below, side=1, lower=1, trans_a=1, overwrite_b=1)
                    rest = _SYRK(-1.0, below, beta=1.0, c=rest, lower=1, overwrite_c=1)
            self._factors.append((square, below))
            left[number] = rest
        schur, _, _ = self._assembled(self._elimination.supernodes[-1], upper, left)
        mirror(schur)
        return schur

    def _assembled(
        self, node: Supernode, upper: scipy.sparse.csr_array, left: dict[int, Floats]
    ) -> tuple[Floats, Floats, Floats]:
        """Lower triangle of a front: own unknowns, the others with them, and the others."""
        first, count, others = node.first, node.count, len(node.left)
        square, below, rest = (
            np.zeros(shape, order="F")
            for shape in ((count, count), (others, count), (others, others))
        )
        starts = upper.indptr[first : first + count + 1]
        entries = slice(starts[0], starts[-1])
        row, columns = np.repeat(np.arange(count), np.diff(starts)), upper.indices[entries]
        place, values = node.places(columns), upper.data[entries]
        own = place < count
        square[place[own], row[own]] = values[own]
        below[place[~own] - count, row[~own]] = values[~own]
        for child in node.children:
            places = node.places(self._elimination.supernodes[child].left)
            _core.add_lower(left.pop(child), places, square, below, rest)
        return square, below, rest


def _upper(matrix: scipy.sparse.csr_array, order: Ints) -> scipy.sparse.csr_array:
    """Upper triangle of a symmetric matrix with rows and columns in an order."""
    place = np.empty(len(order), dtype=np.int32)
    place[order] = np.arange(len(order))
    row, column = np.repeat(place, np.diff(matrix.indptr)), place[matrix.indices]
    kept = row <= column
    parts = (matrix.data[kept], (row[kept], column[kept]))
    return scipy.sparse.csr_array(parts, shape=matrix.shape)
