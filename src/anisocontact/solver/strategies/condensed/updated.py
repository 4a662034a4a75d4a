"""A factor whose matrix has changed clearly in a few rows: their part is put right exactly."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import scipy

from anisocontact.base.array_types import Ints, Sparse
from anisocontact.solver.strategies.condensed.front import Reals, difference, factorised

#: Shares of the largest entry of its column in the factor that an entry has to change by to count:
#: the first with which columns are not too many. What changes less is left to Krylov iterations.
_CLEARLY = (0.05, 0.2, 0.8)
#: Stiffness of the bodies up to times which a change is none: it takes few iterations.
_MILD = 10.0
#: Solutions for one vector in the time of one column of many: those read the factor once for all.
COLUMN = 0.1


class UpdatedFactor:
    """Solves with `P = P_0 + e_I E`, given what solves with P_0; I are the rows of clear changes.

    `P^-1 = P_0^-1 - Z (1 + E Z)^-1 E P_0^-1` with `Z = P_0^-1 e_I` [Sherman Morrison 1950; Woodbury
    1950; Hager 1989]. Columns of Z are found together and kept: nodes that stick and slip in turn
    cost one solution. An entry counts by its share of its column, for it acts on what the factor
    gives there: constraints that turn a little leave that as it is, however stiff they are.

    Args:
        solve: Solves with P_0, for one vector (n,) or several (n, k).
        held: What contacts do in P_0, (n, n).
        stiff: Diagonal of the bodies' stiffness, (n,).
        clearly: Shares of the largest entry of its column, one tried after the other.
        mild: Stiffness of the bodies up to times which a change is none.

    Attributes:
        first: `held` as it was given.
        held: What contacts do in P, (n, n).
    """

    def __init__(
        self,
        solve: Callable[[Reals], Reals],
        held: Sparse,
        stiff: Reals,
        clearly: Sequence[float] = _CLEARLY,
        mild: float = _MILD,
    ) -> None:
        self._known, self.first, self._clearly = solve, held, clearly
        self.held = held
        self._found: list[Ints] = []
        self._size, self._mild = stiff + abs(held).max(axis=0).toarray().ravel(), mild * stiff
        self._place: Ints = np.full(len(stiff), -1)
        self._columns: Reals = np.zeros((len(stiff), 0), dtype=held.dtype, order="F")
        self._rows: Sparse | None = None
        self._own: Ints = np.zeros(0, dtype=np.int64)

    @property
    def columns(self) -> int:
        """Columns of Z found so far."""
        return int(self._columns.shape[1])

    def take(self, held: Sparse, most: int) -> int | None:
        """Solve with the clear part of what has changed up to `held` from now on.

        Args:
            held: What contacts do now, (n, n).
            most: Most columns of Z.

        Returns:
            How many columns had to be found; None where they are too many, or there is no inverse.
        """
        change = difference(held, self.first)
        change.data[np.abs(change.data) <= self._mild[change.indices]] = 0.0
        change.eliminate_zeros()
        size, column = np.abs(change.data), change.indices
        row = np.repeat(np.arange(change.shape[0]), np.diff(change.indptr))
        for share in self._clearly:
            change.data[size <= share * self._size[column]] = 0.0
            rows = np.unique(row[change.data != 0.0])
            missing = rows[self._place[rows] < 0]
            if self.columns + len(missing) <= most:
                break
        else:
            return None
        change.eliminate_zeros()
        self._find(missing)
        self._own, self._rows = self._place[rows], change[rows].tocsr() if len(rows) else None
        self.held = (self.first + change).tocsr() if len(rows) else self.first
        if self._rows is not None:
            small = np.asfortranarray((self._rows @ self._columns)[:, self._own])
            small[np.diag_indices(len(rows))] += 1.0
            try:
                self._small = factorised(small)
            except ZeroDivisionError:
                return None
        return len(missing)

    def __call__(self, b: Reals) -> Reals:
        """Solve for one vector, (n,)."""
        x = self._known(b)
        if self._rows is None:
            return x
        shares = np.zeros(self.columns, dtype=x.dtype)
        shares[self._own] = self._small(self._rows @ x)
        (product,) = scipy.linalg.get_blas_funcs(("gemv",), (self._columns,))
        return np.asarray(product(-1.0, self._columns, shares, beta=1.0, y=x))

    def persistent(self) -> dict[str, Any]:
        """Which columns of Z have been found together."""
        ends = np.cumsum([len(rows) for rows in self._found], dtype=np.int64)
        return {"rows": np.concatenate([self._own[:0], *self._found]), "ends": ends}

    def restore(self, kept: Mapping[str, Any]) -> None:
        """Find them again."""
        for rows in np.split(kept["rows"], kept["ends"])[:-1]:
            self._find(rows)

    def _find(self, rows: Ints) -> None:
        """Columns of Z of some rows."""
        if not len(rows):
            return
        units: Any = np.zeros((len(self._size), len(rows)), dtype=self._columns.dtype, order="F")
        units[rows, np.arange(len(rows))] = 1.0
        self._found.append(rows)
        self._place[rows] = self.columns + np.arange(len(rows))
        self._columns = np.concatenate([self._columns.T, self._known(units).T]).T
