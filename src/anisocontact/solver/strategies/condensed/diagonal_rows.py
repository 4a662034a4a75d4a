"""Unknowns whose equations have no others: they are known before a factor is asked."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from anisocontact.base.array_types import Floats, Ints, Sparse


class DiagonalRows:
    """Rows of a matrix with a diagonal alone, as prescribed unknowns have, set apart.

    Their columns act on the right-hand side of the others, whose matrix is smaller: faces that are
    held couple as many unknowns in a factor as others do.

    Args:
        matrix: The matrix, columns in order, (n, n).
        stay: Unknowns that count to the others in any case.

    Attributes:
        others: Numbers of the others, increasing, (m,).
        rest: Their matrix, (m, m); zeros that have a place keep it.

    Example:
        >>> import scipy
        >>> matrix = [[2.0, 0.0, 0.0], [-1.0, 4.0, 0.0], [0.0, 1.0, 2.0]]
        >>> rows = DiagonalRows(scipy.sparse.csr_array(matrix), np.array([2]))
        >>> rows.others.tolist(), rows.rest.toarray().tolist()
        ([1, 2], [[4.0, 0.0], [1.0, 2.0]])
        >>> rows.solution(np.array([2.0, 7.0, 4.0]), lambda b: b / np.array([4.0, 2.0])).tolist()
        [1.0, 2.0, 2.0]
    """

    def __init__(self, matrix: Sparse, stay: Ints) -> None:
        count = matrix.shape[0]
        rows = np.repeat(np.arange(count), np.diff(matrix.indptr))
        beside = (rows != matrix.indices) & (matrix.data != 0.0)
        sizes = matrix.diagonal()
        alone = (np.bincount(rows[beside], minlength=count) == 0) & (sizes != 0.0)
        alone[stay] = False
        if count == len(stay) + np.count_nonzero(alone):
            alone[:] = False  # a factor has to have something inside
        self.others: Ints = np.flatnonzero(~alone)
        self._alone: Ints = np.flatnonzero(alone)
        self._sizes = sizes[self._alone]
        of_others = matrix[self.others]
        self.rest: Sparse = of_others[:, self.others].tocsr()
        self._acting: Sparse = of_others[:, self._alone].tocsr()

    def solution(self, b: Floats, solve: Callable[[Floats], Floats]) -> Floats:
        """Solve for all unknowns.

        Args:
            b: Right-hand side, (n,).
            solve: Solves with `rest`, and what is added to it, for the others, (m,).
        """
        x = np.empty_like(b)
        x[self._alone] = known = b[self._alone] / self._sizes
        given = b[self.others]
        if known.any():
            given -= self._acting @ known
        x[self.others] = solve(given)
        return x
