"""What acts on nodes that can be touched: the part of a tangent that changes at once."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import scipy

from anisocontact.base.array_types import Flags, Floats, Ints, Sparse
from anisocontact.contact.remote_nodes import globally
from anisocontact.solver.strategies.condensed.assembly_map import AssemblyMap
from anisocontact.solver.strategies.condensed.front import whole
from anisocontact.solver.system.problem import Problem


class Touched:
    """Unknowns that contact can couple, and the derivatives there of all but the bodies.

    On several processes the first one has them all; others have nothing where it has matrices. All
    calls are collective.

    Args:
        problem: The problem; several processes have no constraints between nodes.
        unknowns: The unknowns, if they are known; those that contact couples now if not.

    Attributes:
        unknowns: Their numbers in the whole system, increasing, (c,).
    """

    def __init__(self, problem: Problem, unknowns: Ints | None = None) -> None:
        self._problem, self._comm = problem, problem.comm
        self._space = problem.layout.unknowns.nodes
        self._places = AssemblyMap(np.arange(problem.unknowns))
        self.unknowns: Ints = self._select() if unknowns is None else unknowns

    def tangent(self) -> Sparse:
        """Derivatives of contacts, loads, springs and rigid bodies in these unknowns, (c, c).

        Constraints are worked in; rows of prescribed unknowns are empty. They are those of the last
        `Problem.tangent`.
        """
        problem, n = self._problem, self._problem.unknowns
        blocks = [
            (self._named(rows), self._named(columns), values)
            for rows, columns, values in problem.assembly.acting.blocks()
        ]
        placed = None if problem.coupled_tangent is None else problem.coupled_tangent.placed()
        gathered, free = self._gathered((blocks, placed)), self._free()
        if gathered is None:
            return None
        total = self._places.total([one for blocks, _ in gathered for one in blocks], n)
        for _, placed in gathered:
            if placed is not None:
                row, column, values = placed
                total = total + _by_rows(row, column, values, n // 3)
        gathering = problem.constraints.gathering() if self._comm.size == 1 else None
        if gathering is not None:
            total = gathering @ total
        own = total[self.unknowns][:, self.unknowns]
        return (free @ own).tocsr()

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

    def shares(self) -> tuple[Sparse, Flags] | None:
        """How slave nodes follow what is opposite, see `Front`, and which unknowns are theirs."""
        problem, contacts = self._problem, self._problem.contact_term
        alone = self._comm.size > 1 or problem.constraints.gathering() is None
        pairs = (contacts.opposite(), contacts.beside()) if alone else ([], [])
        opposite, beside = (
            [(self._named(one), self._named(others), shares) for one, others, shares in side]
            for side in pairs
        )
        gathered, free = self._gathered((opposite, beside)), self._free(np.float32)
        if gathered is None:
            return None
        opposite = [one for opposite, _ in gathered for one in opposite]
        if not opposite:
            return whole(len(self.unknowns))
        shares, slaves = self._places.shares(opposite, problem.unknowns)
        if shares.nnz:
            follow = [one for _, beside in gathered for one in beside]
            shares = shares + self._places.following(follow, problem.unknowns) @ shares
        own = shares[self.unknowns][:, self.unknowns]
        return (free @ own).tocsr(), slaves[self.unknowns]

    def _free(self, kind: type = np.float64) -> Sparse:
        """One for each unknown that nothing prescribes, on a diagonal."""
        free: npt.NDArray[Any] = np.ones(self._problem.unknowns, dtype=kind)
        first = 3 * int(self._space.dofmap.index_map.local_range[0])
        for held in self._comm.allgather(first + self._problem.constrained()):
            free[held] = 0.0
        return scipy.sparse.diags_array(free[self.unknowns])

    def _select(self) -> Ints:
        problem = self._problem
        found = [self._named(c.couplable()).ravel() for c in problem.contacts if not c.meshed]
        extra = np.arange((problem.unknowns - problem.layout.rigid) // 3, problem.unknowns // 3)
        if problem.coupled_tangent is not None:
            row, column, _ = problem.coupled_tangent.placed()
            found += [row, column]
        own = np.unique(np.concatenate([extra, *found]))
        nodes = np.unique(np.concatenate(self._comm.allgather(own)))
        unknowns = (3 * nodes[:, None] + np.arange(3)).reshape(-1)
        gathering = problem.constraints.gathering() if self._comm.size == 1 else None
        if gathering is not None:
            marks = np.zeros(problem.unknowns)
            marks[unknowns] = 1.0
            # forces on what follows others go to these
            unknowns = np.union1d(unknowns, np.flatnonzero(abs(gathering) @ marks))
        # an interior there has to be, if of one node
        return unknowns[: problem.unknowns - 3]

    def _named(self, nodes: npt.NDArray[Any]) -> Ints:
        """Nodes by their numbers in the whole mesh; what is no node stays so."""
        if self._comm.size == 1:
            return nodes.astype(np.int64)
        return np.where(nodes < 0, -1, globally(np.maximum(nodes, 0), self._space))

    def _gathered(self, own: Any) -> list[Any] | None:
        """What all processes have, in their order; None but on the first."""
        return [own] if self._comm.size == 1 else self._comm.gather(own)


def _by_rows(row: Ints, column: Ints, blocks: Floats, nodes: int) -> Sparse:
    """Blocks of 3 x 3 between nodes as a matrix; in any order, one for each pair."""
    if np.any(np.diff(row) < 0):  # numbers of this process are not in the order of the mesh
        order = np.argsort(row, kind="stable")
        row, column, blocks = row[order], column[order], blocks[order]
    starts = np.searchsorted(row, np.arange(nodes + 1))
    pairs = (blocks.reshape(-1, 3, 3), column, starts)
    return scipy.sparse.bsr_array(pairs, shape=(3 * nodes, 3 * nodes)).tocsr()
