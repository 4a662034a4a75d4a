"""The part of a matrix that one of several processes eliminates, and the border between them."""

from __future__ import annotations

import numpy as np
import scipy

from anisocontact.base.array_types import Floats, Ints, Sparse
from anisocontact.base.fenicsx import MPI, Mat
from anisocontact.solver.strategies.condensed.border import Border
from anisocontact.solver.strategies.condensed.bordered import PartialLU
from anisocontact.solver.strategies.condensed.factor import singular
from anisocontact.solver.strategies.condensed.front import Reals
from anisocontact.solver.terms.term import SingularError


class OwnRows:
    """The rows of a matrix that this process owns; unknowns of nodes come in threes.

    Args:
        tangent: The matrix, with a place for (j, i) where there is one for (i, j).

    Attributes:
        comm: Its communicator.
        first: Number of the first row.
        matrix: The rows, columns of the whole system, (own, n).
    """

    def __init__(self, tangent: Mat) -> None:
        self.comm = tangent.getComm().tompi4py()
        self.first, last = tangent.getOwnershipRange()
        starts, columns, values = tangent.getValuesCSR()
        shape = (last - self.first, tangent.getSize()[1])
        self.matrix: Sparse = scipy.sparse.csr_array((values, columns, starts), shape=shape)

    def border(self, coupled: Ints) -> Ints:
        """What has to be known for the insides of the processes not to couple; collective.

        Args:
            coupled: Unknowns that are in it in any case, increasing.

        Returns:
            These, and of neighbours on two processes the one on the later process; every process
            with an inside has some of the border beside it. Increasing, (c,).
        """
        inside = np.ones(self.matrix.shape[1], dtype=np.bool_)
        inside[coupled] = False
        columns = self.matrix.indices
        row = np.repeat(np.arange(self.matrix.shape[0]), np.diff(self.matrix.indptr))
        earlier = inside[columns] & (columns < self.first)
        inside[self._shared(row[earlier])] = False
        own = inside[self.first : self.first + self.matrix.shape[0]]
        alone = inside[columns[own[row]]].all()
        first_inside = np.flatnonzero(own)[:1] if alone else np.zeros(0, dtype=np.int64)
        inside[self._shared(first_inside)] = False
        return np.flatnonzero(~inside)

    def of(self, unknowns: Ints) -> Sparse:
        """Rows of any process, on every process, (k, n); collective."""
        last = self.first + self.matrix.shape[0]
        own = unknowns[(unknowns >= self.first) & (unknowns < last)] - self.first
        return scipy.sparse.vstack(self.comm.allgather(self.matrix[own]), format="csr")

    def _shared(self, rows: Ints) -> Ints:
        """Unknowns of the nodes of some rows of each process, on every process; collective."""
        nodes = np.unique(rows // 3)
        own = self.first + (3 * nodes[:, None] + np.arange(3)).ravel()
        return np.concatenate(self.comm.allgather(own))


class Subdomain:
    """What one process eliminates, and what it leaves on the border; all calls are collective.

    Args:
        rows: The rows of the matrix that it owns.
        border: Unknowns of the border, increasing, (c,).
        single: Whether MUMPS works in single precision, where this PETSc can.

    Raises:
        SingularError: A process has no factor.

    Attributes:
        of_border: The matrix in the border before anything is eliminated, (c, c).
        size: Cost and number of entries of the factor, see `PartialLU`.
    """

    def __init__(self, rows: OwnRows, border: Ints, single: bool) -> None:
        self._comm = rows.comm
        first, own = rows.first, rows.matrix.shape[0]
        of_border = rows.of(border)
        self.of_border: Sparse = of_border[:, border]
        mine = (border >= first) & (border < first + own)
        self._mine = np.flatnonzero(mine)
        self._border = border[mine] - first
        self._inner = np.setdiff1d(np.arange(own), self._border)
        inside = rows.matrix[self._inner]
        into, out_of = inside[:, border], of_border[:, first + self._inner]
        beside = (np.diff(into.tocsc().indptr) > 0) | (np.diff(out_of.indptr) > 0)
        self._beside = np.flatnonzero(beside)
        self._known = self._given = np.zeros(0)
        self._dense: Border | None = None
        self._lu: PartialLU | None = None
        self.size, failed = (0.0, 1.0), False
        if len(self._inner):
            none = scipy.sparse.csr_array((len(self._beside), len(self._beside)))
            blocks = [
                [inside[:, first + self._inner], into[:, self._beside]],
                [out_of[self._beside], none],
            ]
            try:
                self._lu = self._eliminated(scipy.sparse.block_array(blocks, format="csr"), single)
            except SingularError:
                failed = True
        if self._comm.allreduce(failed, MPI.LOR):
            self.close()
            raise singular()

    def _eliminated(self, matrix: Sparse, single: bool) -> PartialLU:
        matrix.sort_indices()
        border = np.arange(len(self._inner), matrix.shape[0])
        lu = PartialLU(matrix, border, single, self._answer)
        self.size = lu.cost, lu.entries
        return lu

    def summed(self, left: Sparse | None) -> Reals | None:
        """The Schur complement of all processes, single precision, (c, c); on the first one.

        Args:
            left: What the first one adds, (c, c); None on the others.
        """
        own = None
        if self._lu is not None:
            own = self._beside, self._lu.schur
            del self._lu.schur  # gives the memory back
        if left is None:
            self._comm.send(own, 0)
            return None
        total: Reals = left.astype(np.float32).toarray(order="F")
        for process in range(self._comm.size):
            found = self._comm.recv(source=process) if process else own
            if found is not None:
                beside, schur = found
                total[np.ix_(beside, beside)] += schur
        return total

    def solution(self, b: Floats, dense: Border | None) -> Floats:
        """Solution of the whole matrix, with what is added to its border.

        Args:
            b: Right-hand side of the unknowns that this process owns.
            dense: The border, on the first process.
        """
        self._given, self._dense = b[self._border], dense
        x = np.empty_like(b)
        if self._lu is None:
            self._answer(np.zeros(0))
        else:
            given = np.concatenate([b[self._inner], np.zeros(len(self._beside))])
            x[self._inner] = self._lu.solution(given)[: len(self._inner)]
        x[self._border] = self._known[self._mine]
        return x

    def close(self) -> None:
        """Give back the memory."""
        if self._lu is not None:
            self._lu.close()
        self._lu = None

    def _answer(self, condensed: Floats) -> Floats:
        """Solve for the border with what all processes have condensed on it."""
        own, total = np.zeros(self.of_border.shape[0]), np.empty(self.of_border.shape[0])
        own[self._beside[: len(condensed)]] = condensed
        own[self._mine] += self._given
        self._comm.Reduce(own, total)
        if self._dense is not None:
            total[:] = self._dense.solution(total)
        self._comm.Bcast(total)
        self._known = total
        return total[self._beside[: len(condensed)]]
