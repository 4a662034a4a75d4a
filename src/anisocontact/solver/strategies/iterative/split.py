"""Unknowns of the whole system cut into an interior and the patch that stays."""

from __future__ import annotations

import numpy as np

from anisocontact.base.array_types import Flags, Floats, Ints
from anisocontact.base.fenicsx import Mat, PETSc, Vec
from anisocontact.solver.system.problem import Problem


class UnknownSplit:
    """Where the unknowns of the interior and of the patch are.

    Args:
        problem: The problem.
        patch: Nodes of the mesh that stay, of those this rank owns, (owned,).

    Attributes:
        given: Unknowns that have a row of their own, local numbers; see `Problem.constrained`.
        interior: Unknowns of the other nodes, an index set.
        patch: Unknowns of the patch and of rigid bodies, an index set.
        given_inside: Unknowns among `given` that are of the interior, global numbers in it.
        places: Where the nodes of the interior are, (nodes, 3), length.
    """

    def __init__(self, problem: Problem, patch: Flags) -> None:
        like = problem.new_vector()
        self.first, self.last = like.getOwnershipRange()
        comm = problem.comm
        inner = np.flatnonzero(~patch)
        extra = np.arange(len(patch), (self.last - self.first) // 3)
        self.interior = self._set(inner, comm)
        self.patch = self._set(np.concatenate([np.flatnonzero(patch), extra]), comm)
        self.given = problem.constrained()
        self.places: Floats = problem.model.space.tabulate_dof_coordinates()[inner]
        before = 3 * int(comm.exscan(len(inner)) or 0)
        number = np.full(self.last - self.first, -1, dtype=np.int64)
        number[(3 * inner[:, None] + np.arange(3)).reshape(-1)] = np.arange(3 * len(inner))
        inside = number[self.given]
        self.given_inside: Ints = before + inside[inside >= 0]

    @property
    def empty(self) -> bool:
        """Whether there is no interior on any rank."""
        return bool(self.interior.getSize() == 0)

    def _set(self, nodes: Ints, comm: object) -> PETSc.IS:
        return PETSc.IS().createBlock(3, (self.first // 3 + nodes).astype(PETSc.IntType), comm)


def interior_matrix(
    tangent: Mat, split: UnknownSplit, scale: float, before: Mat | None = None
) -> Mat:
    """Tangent of the interior, rows and columns of given unknowns emptied.

    Args:
        tangent: Tangent of all unknowns.
        split: The interior.
        scale: What the diagonal of given unknowns becomes, force/length.
        before: Such a matrix, to be overwritten.
    """
    matrix = tangent.createSubMatrix(split.interior, split.interior, before)
    matrix.setBlockSize(3)
    matrix.setOption(PETSc.Mat.Option.KEEP_NONZERO_PATTERN, True)
    matrix.zeroRowsColumns(split.given_inside.astype(PETSc.IntType), scale)
    return matrix


def sparse(rows: int, columns: int, comm: object, at: tuple[Ints, Ints], values: Floats) -> Mat:
    """Matrix of entries.

    Args:
        rows: Rows of this rank.
        columns: Columns of this rank.
        comm: Communicator.
        at: Row and column of each entry: rows of this rank by their number on it, columns by that
            on all ranks.
        values: The entries.
    """
    order = np.lexsort(at[::-1])
    starts = np.concatenate([[0], np.cumsum(np.bincount(at[0], minlength=rows))])
    return by_rows(rows, columns, comm, (starts, at[1][order], values[order]))


def by_rows(rows: int, columns: int, comm: object, entries: tuple[Ints, Ints, Floats]) -> Mat:
    """Matrix of rows that each have a slice of the entries.

    Args:
        rows: Rows of this rank.
        columns: Columns of this rank.
        comm: Communicator.
        entries: Where the rows begin, columns numbered over all ranks, and the entries.
    """
    starts, places, values = entries
    matrix = PETSc.Mat().create(comm)
    matrix.setSizes(((rows, None), (columns, None)))
    matrix.setType(PETSc.Mat.Type.AIJ)
    sides = (side.astype(PETSc.IntType, copy=False) for side in (starts, places))
    matrix.setPreallocationCSR((*sides, values))
    return matrix


def weights(like: Vec, index_set: PETSc.IS, values: Vec) -> Vec:
    """Vector that has values in an index set and zero elsewhere."""
    out = like.duplicate()
    out.zeroEntries()
    out.isaxpy(index_set, 1.0, values)
    return out


def set_any(vector: Vec) -> None:
    """Any numbers without symmetry, the same on any number of processes."""
    first, last = vector.getOwnershipRange()
    vector.array[:] = np.modf(np.arange(first, last) * 0.754877666)[0] - 0.5
