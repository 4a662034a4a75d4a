"""From one level to the next: aggregates of its interior, and the patch as it is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from anisocontact.base.array_types import Floats, Ints
from anisocontact.base.fenicsx import Mat, PETSc, release_unreferenced
from anisocontact.solver.strategies.iterative.split import (
    UnknownSplit,
    by_rows,
    set_any,
    sparse,
    weights,
)

#: Damping of the smoothed aggregation over the largest eigenvalue of the scaled matrix.
DAMPING = 4.0 / 3.0
#: Lanczos steps of the estimate of that eigenvalue.
LANCZOS = 15
#: Share of a rigid motion that the others may leave of it, below which it is one of them.
DEPENDENT = 1e-8


@dataclass(frozen=True)
class Aggregates:
    """Rigid motions of the aggregates of a level's interior, as GAMG makes them.

    Attributes:
        rows: Row of each entry in this rank's part of the interior.
        columns: Motion of each entry, numbered over all ranks.
        values: The entries.
        own: Number of motions of this rank.
        count: Number of motions of all ranks.
    """

    rows: Ints
    columns: Ints
    values: Floats
    own: int
    count: int


_NONE = np.zeros(0, dtype=np.int64)
NOTHING = Aggregates(_NONE, _NONE, np.zeros(0), 0, 0)


class LevelUnknowns(Protocol):
    """Where the unknowns of a level are."""

    @property
    def interior(self) -> PETSc.IS:
        """Unknowns that have aggregates."""

    @property
    def patch(self) -> PETSc.IS:
        """Unknowns that stay."""

    @property
    def given(self) -> Ints:
        """Unknowns with a row of their own, local numbers."""


def tentative(found: Aggregates, parts: LevelUnknowns, matrix: Mat) -> Mat:
    """T: from motions of aggregates and the patch to the unknowns of a level, without smoothing.

    Columns of a process are its aggregates, then its patch. Given unknowns have empty rows.

    Args:
        found: The aggregates.
        parts: Where the unknowns of the level are.
        matrix: Matrix of the level.
    """
    comm, patch = matrix.getComm().tompi4py(), parts.patch.getIndices()
    counts = np.array(comm.allgather((found.own, len(patch)))).reshape(-1, 2)
    starts = np.concatenate([[0], np.cumsum(counts[:, 0])])
    shift = np.concatenate([[0], np.cumsum(counts[:, 1])])
    owner = np.searchsorted(starts, found.columns, side="right") - 1
    behind = starts[comm.rank] + shift[comm.rank] + found.own
    rows = np.concatenate([parts.interior.getIndices()[found.rows], patch])
    columns = np.concatenate([found.columns + shift[owner], behind + np.arange(len(patch))])
    values = np.concatenate([found.values, np.ones(len(patch))])
    first, last = matrix.getOwnershipRange()
    moves = np.ones(last - first, dtype=bool)
    moves[parts.given] = False
    kept = moves[rows - first]
    at = (rows[kept] - first, columns[kept])
    return sparse(last - first, found.own + len(patch), comm, at, values[kept])


def smoothed(rough: Mat, matrix: Mat, inside: Mat, parts: LevelUnknowns) -> Mat:
    """`P = (1 - w M A) T` from a tentative interpolation T, which is taken over.

    M is the inverse diagonal in the interior and zero elsewhere, w is 4/3 over the largest
    eigenvalue of M A [Vanek, Mandel, Brezina 1996]. M is zero, too, in rows that the patch is
    coupled with: smoothed, they would couple all of the patch that is near an aggregate.

    Args:
        rough: T.
        matrix: Matrix A of the level.
        inside: Its interior.
        parts: Where the unknowns of the level are.
    """
    if parts.interior.getSize() == 0:
        return rough
    size = DAMPING / largest_eigenvalue(inside)
    inverse = 1.0 / inside.getDiagonal()
    inverse.array[_beside(matrix, parts)] = 0.0
    scaled = weights(matrix.createVecLeft(), parts.interior, inverse)
    scaled.array[parts.given] = 0.0
    step = matrix.matMult(rough)
    step.diagonalScale(L=scaled)
    rough.axpy(-size, step, PETSc.Mat.Structure.DIFFERENT_NONZERO_PATTERN)
    step.destroy()
    return _without_zeros(rough)


def _beside(matrix: Mat, parts: LevelUnknowns) -> Ints:
    """Unknowns of the interior that the patch is coupled with, local numbers in it."""
    block = matrix.createSubMatrix(parts.interior, parts.patch)
    starts, _, values = block.getValuesCSR()
    block.destroy()
    return np.unique(np.repeat(np.arange(len(starts) - 1), np.diff(starts))[values != 0.0])


def _without_zeros(matrix: Mat) -> Mat:
    """The same with no place for zeros: those of the patch would fill the whole coarse level."""
    starts, columns, values = matrix.getValuesCSR()
    (rows, _), (own, _) = matrix.getSizes()
    comm = matrix.getComm()
    matrix.destroy()
    there = values != 0.0
    starts = np.concatenate([[0], np.cumsum(there)])[starts]
    return by_rows(rows, own, comm, (starts, columns[there], values[there]))


def largest_eigenvalue(matrix: Mat) -> float:
    """Largest eigenvalue of a matrix over its diagonal, estimated from below by Lanczos steps."""
    ksp = PETSc.KSP().create(matrix.getComm())
    ksp.setOperators(matrix)
    ksp.setType(PETSc.KSP.Type.CG)
    ksp.getPC().setType(PETSc.PC.Type.JACOBI)
    ksp.setComputeSingularValues(True)
    ksp.setTolerances(rtol=0.0, atol=0.0, max_it=LANCZOS)
    x, b = matrix.createVecs()
    set_any(b)
    ksp.solve(b, x)
    largest, _ = ksp.computeExtremeSingularValues()
    ksp.destroy()
    return float(largest)


def set_rigid_modes(interior: Mat, places: Floats) -> None:
    """Set the rigid motions as the near null space of a matrix.

    Args:
        interior: Matrix of nodes with three unknowns each.
        places: Where the nodes of this rank are, (nodes, 3), length.
    """
    comm = interior.getComm()
    total = comm.tompi4py().allreduce(np.append(places.sum(axis=0), len(places)))
    arms = places - total[:3] / total[3]
    fields = [np.tile(axis, (len(arms), 1)) for axis in np.eye(3)]
    fields += [np.cross(axis, arms) for axis in np.eye(3)]
    modes: list[Any] = []
    for field in fields:
        mode = interior.createVecLeft()
        mode.array[:] = field.reshape(-1)
        size = mode.norm()
        for before in modes:
            mode.axpy(-mode.dot(before), before)
        if mode.norm() > DEPENDENT * size:
            mode.normalize()
            modes.append(mode)
    interior.setNearNullSpace(PETSc.NullSpace().create(vectors=modes, comm=comm))


def aggregates(split: UnknownSplit, interior: Mat, prefix: str) -> list[Aggregates]:
    """Aggregates of the interior, aggregates of those, and so on, the finest ones first."""
    if split.empty:
        return [NOTHING]
    set_rigid_modes(interior, split.places)
    pc = PETSc.PC().create(interior.getComm())
    pc.setOptionsPrefix(prefix)
    pc.setOperators(interior)
    pc.setType(PETSc.PC.Type.GAMG)
    pc.setFromOptions()
    pc.setUp()
    levels = range(pc.getMGLevels() - 1, 0, -1)
    found = [_aggregates(pc.getMGInterpolation(level)) for level in levels]
    pc.destroy()
    release_unreferenced(interior.getComm().tompi4py())
    return found or [NOTHING]


def _aggregates(matrix: Mat) -> Aggregates:
    starts, columns, values = matrix.getValuesCSR()
    rows = np.repeat(np.arange(len(starts) - 1), np.diff(starts))
    (_, _), (own, count) = matrix.getSizes()
    return Aggregates(rows, columns.astype(np.int64), values, int(own), int(count))
