"""The coarse level: aggregates of the interior, and the patch as it is."""

from __future__ import annotations

from typing import Any

import numpy as np

from anisocontact.base.array_types import Floats, Ints
from anisocontact.base.fenicsx import Mat, PETSc
from anisocontact.solver.strategies.iterative.split import UnknownSplit, sparse, weights
from anisocontact.solver.system.problem import Problem

#: Damping of the smoothed aggregation over the largest eigenvalue of the scaled matrix.
DAMPING = 4.0 / 3.0
#: Lanczos steps of the estimate of that eigenvalue.
LANCZOS = 15
#: Share of a rigid motion that the others may leave of it, below which it is one of them.
DEPENDENT = 1e-8


def interpolation(
    problem: Problem, tangent: Mat, split: UnknownSplit, interior: Mat, prefix: str
) -> Mat:
    """From the coarse level to all unknowns.

    `P = (1 - w M J) T`: T takes the rigid motions of aggregates of the interior, and the patch as
    it is; one Jacobi step smooths it in the interior, where M is the inverse diagonal and w is 4/3
    over the largest eigenvalue of M J [Vanek, Mandel, Brezina 1996]. Given unknowns are left out,
    constrained ones follow.

    Args:
        problem: The problem.
        tangent: Tangent J of all unknowns.
        split: Interior and patch.
        interior: Tangent of the interior.
        prefix: Prefix of the options of GAMG.
    """
    tentative = problem.constraints.spread(_tentative(problem, split, interior, prefix))
    if split.empty:
        return tentative
    diagonal = interior.getDiagonal()
    size = DAMPING / largest_eigenvalue(interior)
    scaled = weights(problem.new_vector(), split.interior, 1.0 / diagonal)
    scaled.array[split.given] = 0.0
    step = tangent.matMult(tentative)
    step.diagonalScale(L=scaled)
    tentative.axpy(-size, step, PETSc.Mat.Structure.DIFFERENT_NONZERO_PATTERN)
    step.destroy()
    return _without_zeros(tentative)


def _without_zeros(matrix: Mat) -> Mat:
    """The same with no place for zeros: those of the patch would fill the whole coarse level."""
    starts, columns, values = matrix.getValuesCSR()
    (rows, _), (own, _) = matrix.getSizes()
    first, _ = matrix.getOwnershipRange()
    row = first + np.repeat(np.arange(rows), np.diff(starts))
    there = values != 0.0
    out = sparse(rows, own, matrix.getComm(), (row[there], columns[there]), values[there])
    matrix.destroy()
    return out


def largest_eigenvalue(matrix: Mat) -> float:
    """Largest eigenvalue of a matrix over its diagonal, estimated from below by Lanczos steps."""
    ksp = PETSc.KSP().create(matrix.getComm())
    ksp.setOperators(matrix)
    ksp.setType(PETSc.KSP.Type.CG)
    ksp.getPC().setType(PETSc.PC.Type.JACOBI)
    ksp.setComputeSingularValues(True)
    ksp.setTolerances(rtol=0.0, atol=0.0, max_it=LANCZOS)
    x, b = matrix.createVecs()
    first, last = b.getOwnershipRange()
    # any vector without symmetry, the same on any number of processes
    b.array[:] = np.modf(np.arange(first, last) * 0.754877666)[0] - 0.5
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


def _tentative(problem: Problem, split: UnknownSplit, interior: Mat, prefix: str) -> Mat:
    """Rigid motions of the aggregates and the patch, without smoothing; given unknowns empty."""
    rows, columns, values, own = _aggregates(split, interior, prefix)
    inner, patch = split.interior.getIndices(), split.patch.getIndices()
    comm = problem.comm
    # columns of this rank: its aggregates, then its patch
    counts = np.array(comm.allgather((own, len(patch)))).reshape(-1, 2)
    starts = np.concatenate([[0], np.cumsum(counts[:, 0])])
    shift = np.concatenate([[0], np.cumsum(counts[:, 1])])
    owner = np.searchsorted(starts, columns, side="right") - 1
    first = starts[comm.rank] + shift[comm.rank] + own
    at_rows = np.concatenate([inner[rows], patch])
    at_columns = np.concatenate([columns + shift[owner], first + np.arange(len(patch))])
    entries = np.concatenate([values, np.ones(len(patch))])
    given = np.zeros(split.last - split.first, dtype=bool)
    given[split.given] = True
    kept = ~given[at_rows - split.first]
    return sparse(
        split.last - split.first,
        own + len(patch),
        comm,
        (at_rows[kept], at_columns[kept]),
        entries[kept],
    )


def _aggregates(split: UnknownSplit, interior: Mat, prefix: str) -> tuple[Ints, Ints, Floats, int]:
    """Entries of the rigid motions of aggregates of nodes, as GAMG makes them.

    Returns:
        Row in this rank's part of the interior, column, value, and number of columns of this rank.
    """
    nothing = np.zeros(0, dtype=np.int64)
    if split.empty:
        return nothing, nothing, np.zeros(0), 0
    set_rigid_modes(interior, split.places)
    pc = PETSc.PC().create(interior.getComm())
    pc.setOptionsPrefix(prefix)
    pc.setOperators(interior)
    pc.setType(PETSc.PC.Type.GAMG)
    pc.setFromOptions()
    pc.setUp()
    if pc.getMGLevels() < 2:
        pc.destroy()
        return nothing, nothing, np.zeros(0), 0
    found = pc.getMGInterpolation(pc.getMGLevels() - 1)
    starts, columns, values = found.getValuesCSR()
    rows = np.repeat(np.arange(len(starts) - 1), np.diff(starts))
    (_, _), (own, _) = found.getSizes()
    pc.destroy()
    return rows, columns.astype(np.int64), values, int(own)
