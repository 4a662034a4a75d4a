"""The border of a factor, dense, with what contacts do there: it changes while the rest stays."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import scipy

from anisocontact.base.array_types import Flags, Floats, Sparse
from anisocontact.solver.strategies.condensed.factor import singular
from anisocontact.solver.strategies.condensed.front import Front, Reals, whole
from anisocontact.solver.strategies.condensed.updated import UpdatedFactor
from anisocontact.solver.strategies.costs import operation_cost

#: Share of the diagonal that the largest entry of a row has to change by to count.
_CLEARLY = 0.1
#: Rows that are put right in a factor of the border, at most, over all; a column of many costs this
#: times what a column costs a factorisation: solutions run at half of its speed, and have no third.
_UPDATED, _COLUMN = 0.15, 6.0
#: Share of what is opposite to a slave node that may be another before masters are eliminated anew.
_DRIFT = 0.3
#: Arrays of a sparse matrix.
PARTS = ("data", "indices", "indptr")


class Border:
    """LU of `S + C` in single precision: S for good, C another one for every correction.

    Args:
        schur: S, what is left on the border of a factor, (c, c), single precision.
        entries: Entries of that factor, which a solution reads.
        changing: Unknowns in which C may be, (c,); all if not given. Others are eliminated once.
    """

    def __init__(self, schur: Reals, entries: float, changing: Flags | None = None) -> None:
        self._schur, self._entries = schur, entries
        self._changing = np.ones(len(schur), dtype=np.bool_) if changing is None else changing
        self._front: Front | None = None
        self._updated: UpdatedFactor | None = None
        self._given: Sparse | None = None
        self._diagonal = np.abs(np.diagonal(schur))
        self._shares: Sparse = whole(len(schur))[0]

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
        return operation_cost(operations) / self._entries

    def _near(self, front: Front, shares: Sparse) -> bool:
        """Whether slave nodes are still about where they were when masters were eliminated."""
        if not front.shares.nnz:
            return not shares.nnz
        drift = abs(front.shares_with(shares) - front.shares).sum(axis=1)
        return float(drift.max()) < 2.0 * _DRIFT

    def _eliminated(self, contact: Sparse, shares: Sparse, slaves: Flags) -> Front:
        """S with all eliminated that contacts of now do not hold."""
        moves = (scipy.sparse.eye_array(len(self._schur)) + shares).tocsr()
        stays = slaves | self._clearly(moves.T @ contact @ moves) | (self._diagonal == 0.0)
        try:
            if shares.nnz:
                return Front(self._copy, shares, stays)
        except ZeroDivisionError:
            pass
        none, _ = whole(len(self._schur))
        try:
            return Front(self._copy, none, self._changing)
        except ZeroDivisionError:
            raise singular() from None

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
        """Solution of `(S + C) x = b`; `renew` comes first."""
        size = float(np.abs(b).max(initial=0.0)) or 1.0  # what is small is no zero
        front, updated = self._front, self._updated
        assert front is not None, "`renew` comes first"
        assert updated is not None, "`renew` comes first"
        given = (b / size).astype(np.float32)
        if self._shares.nnz:
            given += self._shares.T @ given
        own = front.solution(updated, given)
        return size * (own + self._shares @ own if self._shares.nnz else own)


def _kept(kept: Mapping[str, Any], name: str, count: int) -> Sparse:
    """A sparse matrix that was kept, (count, count)."""
    parts = tuple(kept[f"{name}.{part}"] for part in PARTS)
    return scipy.sparse.csr_array(parts, (count, count))
