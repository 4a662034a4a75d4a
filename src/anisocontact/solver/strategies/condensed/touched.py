"""What acts on nodes that can be touched: the part of a tangent that changes at once."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import scipy

from anisocontact.base.array_types import Flags, Ints
from anisocontact.solver.strategies.condensed.front import Sparse, whole
from anisocontact.solver.strategies.condensed.places import Places
from anisocontact.solver.system.problem import Problem


class Touched:
    """Unknowns that contact can couple, and the derivatives there of all but the bodies.

    Args:
        problem: The problem, on one process.
        unknowns: The unknowns, if they are known; those that contact couples now if not.

    Attributes:
        unknowns: Their numbers, increasing, (c,).
    """

    def __init__(self, problem: Problem, unknowns: Ints | None = None) -> None:
        self._problem = problem
        self._places = Places(np.arange(problem.unknowns))
        self.unknowns: Ints = self._select() if unknowns is None else unknowns

    def tangent(self) -> scipy.sparse.csr_array:
        """Derivatives of contacts, loads, springs and rigid bodies in these unknowns, (c, c).

        Constraints are worked in; rows of prescribed unknowns are empty. They are those of the last
        `Problem.tangent`.
        """
        problem, n = self._problem, self._problem.unknowns
        total = self._places.total(problem.assembly.acting.blocks(), n)
        if problem.coupled_tangent is not None:
            row, column, blocks = problem.coupled_tangent.placed()
            pairs = (blocks.reshape(-1, 3, 3), column, _starts(row, n // 3))
            total = total + scipy.sparse.bsr_array(pairs, shape=(n, n)).tocsr()
        gathering = problem.constraints.gathering()
        if gathering is not None:
            total = gathering @ total
        own = total[self.unknowns][:, self.unknowns]
        return (self._free() @ own).tocsr()

    def outgrown(self) -> bool:
        """Whether contacts of now couple other unknowns than these."""
        return not np.isin(self._select(), self.unknowns).all()

    def without(self, tangent: Sparse) -> Sparse:
        """A tangent of all unknowns less `tangent`: of the bodies, and of nodes that are new.

        Its entries stay where they are, also those that are zero now.
        """
        n, own = self._problem.unknowns, self.tangent()
        own.eliminate_zeros()
        own = own.tocoo()
        places = np.repeat(np.arange(n) * n, np.diff(tangent.indptr)) + tangent.indices
        asked = self.unknowns[own.row] * n + self.unknowns[own.col]
        found = np.minimum(np.searchsorted(places, asked), len(places) - 1)
        there, left = places[found] == asked, tangent.copy()
        left.data[found[there]] -= own.data[there]
        if there.all():
            return left
        rows, columns = np.divmod(asked[~there], n)
        return left - scipy.sparse.csr_array((own.data[~there], (rows, columns)), shape=(n, n))

    def shares(self) -> tuple[Sparse, Flags]:
        """How slave nodes follow what is opposite, see `Front`, and which unknowns are theirs."""
        problem = self._problem
        alone = problem.constraints.gathering() is None
        opposite = problem.contact_term.opposite() if alone else []
        if not opposite:
            return whole(len(self.unknowns))
        shares, slaves = self._places.shares(opposite, problem.unknowns)
        if shares.nnz:
            beside = self._places.following(problem.contact_term.beside(), problem.unknowns)
            shares = shares + beside @ shares
        own = shares[self.unknowns][:, self.unknowns]
        return (self._free(np.float32) @ own).tocsr(), slaves[self.unknowns]

    def _free(self, kind: type = np.float64) -> Sparse:
        """One for each unknown that nothing prescribes, on a diagonal."""
        free: npt.NDArray[Any] = np.ones(self._problem.unknowns, dtype=kind)
        free[self._problem.constrained()] = 0.0
        return scipy.sparse.diags_array(free[self.unknowns])

    def _select(self) -> Ints:
        problem = self._problem
        found = [c.couplable().astype(np.int64) for c in problem.contacts if not c.meshed]
        extra = np.arange(problem.layout.owned // 3, problem.unknowns // 3)
        if problem.coupled_tangent is not None:
            row, column, _ = problem.coupled_tangent.placed()
            found += [row, column]
        nodes = np.unique(np.concatenate([extra, *found]))
        unknowns = (3 * nodes[:, None] + np.arange(3)).reshape(-1)
        gathering = problem.constraints.gathering()
        if gathering is not None:
            marks = np.zeros(problem.unknowns)
            marks[unknowns] = 1.0
            # forces on what follows others go to these
            unknowns = np.union1d(unknowns, np.flatnonzero(abs(gathering) @ marks))
        # an interior there has to be, if of one node
        return unknowns[: problem.unknowns - 3]


def _starts(row: Ints, nodes: int) -> Ints:
    """Where the rows of nodes begin in increasing numbers of rows."""
    return np.searchsorted(row, np.arange(nodes + 1))
