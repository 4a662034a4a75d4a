"""Partial factorisation front by front, with the products of matrices that SciPy has."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from typing import Any, override

import numpy as np
import numpy.typing as npt
import scipy

from anisocontact import _core
from anisocontact.base.array_types import Flags, Floats, Ints, Locals
from anisocontact.base.fenicsx import PETSc
from anisocontact.solver.strategies.condensed.factor import (
    Eliminated,
    aij,
    mirror,
    singular,
    solves,
)
from anisocontact.solver.strategies.condensed.supernodes import supernodes

#: PETSc's name of nested dissection by METIS.
_METIS = "metisnd"


@cache
def reachable() -> bool:
    """Whether this PETSc can order a matrix by METIS."""
    graph = aij(scipy.sparse.csr_array(np.ones((2, 2))))
    try:
        graph.getOrdering(_METIS)
    except PETSc.Error:
        return False
    finally:
        graph.destroy()
    return True


@dataclass(frozen=True)
class Front:
    """Columns that are eliminated together.

    Attributes:
        columns: Their numbers in the order of elimination.
        rows: Numbers below them in which they have entries, increasing; those of the border too.
        places: Where these are in the front that takes what is left.
        above: Number of that front; of the border the number of fronts.
    """

    columns: slice
    rows: Locals
    places: Locals
    above: int


class MultifrontalFactor(Eliminated):
    """An interior eliminated front by front [Duff Reid 1983]; arguments as of `Way`.

    Unknowns of a node have the same neighbours, so that nodes are put in order: by nested
    dissection. A front has its columns of Cholesky's factor, and what these leave of the rows
    below, a lower triangle, is added to the next front and in the end to the border.

    Example:
        >>> springs = scipy.sparse.csr_array([[2.0, -1.0], [-1.0, 2.0]])
        >>> factor = MultifrontalFactor(springs, np.array([0]))
        >>> factor.schur.tolist(), factor.interior(np.array([[7.0], [4.0]])).round(9).tolist()
        ([[1.5]], [[0.0], [2.0]])
    """

    def __init__(self, matrix: scipy.sparse.csr_array, border: Ints) -> None:
        self._border = border
        self._order, self._fronts = fronts(matrix, border)
        # of each front the columns of the factor, by rows: its own rows, then those below
        self._columns: list[Floats] = []
        self.schur = self._eliminate(matrix)
        if not solves(self, matrix, border):
            self.close()
            raise singular()

    @override
    def interior(self, b: Floats) -> Floats:
        x = np.ascontiguousarray(b[self._order])
        inside = len(x) - len(self._border)
        x[inside:] = 0.0
        for front, own in zip(self._fronts, self._columns, strict=True):
            top = _solved(own, x[front.columns], transposed=True)
            x[front.rows] -= own[len(top) :] @ top
        x[inside:] = 0.0
        for front, own in zip(reversed(self._fronts), reversed(self._columns), strict=True):
            some = x[front.columns]
            some -= own[len(some) :].T @ x[front.rows]
            _solved(own, some, transposed=False)
        out = np.empty_like(x, order="F")
        out[self._order] = x
        return out

    @override
    def close(self) -> None:
        self._columns, self._fronts = [], []

    def _eliminate(self, matrix: scipy.sparse.csr_array) -> Floats:
        """Make the factor; S remains."""
        ordered = matrix[self._order][:, self._order].tocsr()
        border = slice(len(self._order) - len(self._border), len(self._order))
        place = np.zeros(len(self._order), dtype=np.int32)
        left: list[list[tuple[Floats, Locals]]] = [[] for _ in range(len(self._fronts) + 1)]
        for number, front in enumerate(self._fronts):
            own = _assembled(ordered, front.columns, front.rows, place)
            rest = np.zeros((len(front.rows), len(front.rows)))
            for one, places in left[number]:
                _core.add_front(own, rest, one, places)
            left[number] = []  # gives the memory back
            self._columns.append(own)
            left[front.above].append((_pivoted(own, rest), front.places))
        schur: Floats = ordered[border][:, border].toarray()
        none = np.zeros((0, 0))
        for one, places in left[-1]:
            _core.add_front(none, schur, one, places)
        mirror(schur)
        return schur.T


def fronts(matrix: scipy.sparse.csr_array, border: Ints) -> tuple[Ints, list[Front]]:
    """The order in which unknowns are eliminated, the border last, and the fronts.

    Args:
        matrix: A symmetric matrix, columns in order, (n, n).
        border: Numbers of the border unknowns, increasing.
    """
    last = np.zeros(matrix.shape[0], dtype=np.bool_)
    last[border] = True
    begin = np.append(_groups(matrix, last), len(last)).astype(np.int32)
    graph = matrix[begin[:-1]][:, begin[:-1]].tocsr()
    outside = last[begin[:-1]]
    inside = np.flatnonzero(~outside)
    order = np.append(inside[_dissected(graph[inside][:, inside])], np.flatnonzero(outside))
    graph = graph[order][:, order].tocsr()
    found = supernodes(graph, len(inside))
    order[: len(inside)] = order[found.order]
    sizes = np.diff(begin)[order]
    starts = np.append(0, np.cumsum(sizes)).astype(np.int32)
    unknowns = _ranges(begin[order], sizes).astype(np.int64)
    below = [_ranges(starts[some], sizes[some]) for some in found.rows]
    return unknowns, _linked(starts[found.begin], below, found.above)


def _linked(ends: Locals, below: list[Locals], above: list[int]) -> list[Front]:
    """Fronts with their rows and where these are in the next ones."""
    made, inside = [], int(ends[-1])
    for (a, b), rows, next_one in zip(pairwise(ends), below, above, strict=True):
        if next_one == len(above):
            places = rows - inside
        else:
            first, width = ends[next_one], ends[next_one + 1] - ends[next_one]
            places = np.where(
                rows < first + width,
                rows - first,
                width + np.searchsorted(below[next_one], rows),
            )
        made.append(Front(slice(int(a), int(b)), rows, places.astype(np.int32), next_one))
    return made


def _groups(matrix: scipy.sparse.csr_array, last: Flags) -> Ints:
    """First unknowns of groups that follow each other and have the same neighbours."""
    starts, columns = matrix.indptr, matrix.indices
    length = np.diff(starts)
    alike = (length[1:] == length[:-1]) & (last[1:] == last[:-1])
    shift = np.repeat(np.append(0, length[:-1]), length)  # to the same place of the row before
    own = np.arange(len(columns))
    other = np.minimum(np.maximum(own - shift, 0), len(columns) - 1)
    differs = np.flatnonzero(columns != columns[other])
    row = np.searchsorted(starts, differs, side="right") - 1
    same = np.ones(len(length), dtype=np.bool_)
    same[row] = False
    return np.flatnonzero(np.append(True, ~(alike & same[1:])))


def _dissected(graph: scipy.sparse.csr_array) -> Ints:
    """Nodes in the order of nested dissection."""
    given = aij(graph)
    rows, columns = given.getOrdering(_METIS)
    order: Ints = rows.getIndices().astype(np.int64)
    for used in (rows, columns, given):
        used.destroy()
    return order


def _ranges(begin: npt.NDArray[Any], sizes: npt.NDArray[Any]) -> Locals:
    """Numbers from each `begin` on, as many as its size, one after the other."""
    ends = np.cumsum(sizes)
    total = int(ends[-1]) if len(ends) else 0
    places: Locals = (np.arange(total) + np.repeat(begin - (ends - sizes), sizes)).astype(np.int32)
    return places


def _assembled(
    ordered: scipy.sparse.csr_array, columns: slice, rows: Locals, place: Locals
) -> Floats:
    """Entries of a matrix in the columns of a front, (columns and rows, columns)."""
    width = columns.stop - columns.start
    own = np.zeros((width + len(rows), width))
    place[columns] = np.arange(width)
    place[rows] = width + np.arange(len(rows))
    starts = ordered.indptr[columns.start : columns.stop + 1]
    some = slice(starts[0], starts[-1])
    column = np.repeat(np.arange(width), np.diff(starts))
    row = ordered.indices[some]  # the matrix is symmetric
    lower = row >= column + columns.start
    own[place[row[lower]], column[lower]] = ordered.data[some][lower]
    return own


def _pivoted(own: Floats, rest: Floats) -> Floats:
    """Make columns those of Cholesky's factor, in place; what they leave of the rest."""
    width = own.shape[1]
    # by columns these are the transposes
    top, below = own[:width].T, own[width:].T
    _, info = scipy.linalg.lapack.dpotrf(top, lower=0, clean=0, overwrite_a=1)
    if info != 0:
        raise singular()
    if not len(rest):
        return rest
    scipy.linalg.blas.dtrsm(1.0, top, below, trans_a=1, overwrite_b=1)
    left: Floats = scipy.linalg.blas.dsyrk(
        -1.0, below, beta=1.0, c=rest.T, trans=1, overwrite_c=1
    ).T
    return left


def _solved(own: Floats, b: Floats, transposed: bool) -> Floats:
    """Solve with the triangle of a front, in place: L, or its transpose."""
    top = own[: own.shape[1]].T
    if b.shape[1] == 1:
        scipy.linalg.blas.dtrsv(top, b[:, 0], trans=int(transposed), overwrite_x=1)
    else:
        scipy.linalg.blas.dtrsm(1.0, top, b.T, side=1, trans_a=int(not transposed), overwrite_b=1)
    return b
