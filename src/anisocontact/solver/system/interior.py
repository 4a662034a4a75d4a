"""The interior of bodies of which a checkpoint has the state of the touched unknowns only."""

from __future__ import annotations

import numpy as np

from anisocontact.base.array_types import Flags, Floats
from anisocontact.base.fenicsx import PETSc, Vec
from anisocontact.solver.terms.bodies import Bulk, mean_diagonal

#: In front of the names of what `with_interior` needs.
PENDING = "pending_"


def with_interior(bulk: Bulk, known: Flags, values: Floats, force: Floats) -> Floats:
    """Displacements of all nodes from those that can be touched or are prescribed; collective.

    Equilibrium of the others is `K_ii u_i = f_i - K_ic u_c - K_ip u_p`: one linear solution, on
    any number of ranks.

    Args:
        bulk: Linear bulk.
        known: Which unknowns are known, of those this rank owns, (n,).
        values: Displacements, true where they are known, (n,), length.
        force: Forces on the unknowns, (n,).
    """
    stiffness = bulk.stiffness.copy()
    u, right = stiffness.createVecs()
    u.array[:], right.array[:] = values, force
    first, _ = stiffness.getOwnershipRange()
    rows = (first + np.flatnonzero(known)).astype(PETSc.IntType)
    scale = mean_diagonal(np.array(bulk.diagonal.array_r), stiffness.comm.tompi4py())
    stiffness.zeroRowsColumns(rows, scale, u, right)
    _solve(stiffness, right, u)
    found = np.array(u.array_r)
    found[known] = values[known]  # without rounding
    return found


def _solve(matrix: PETSc.Mat, right: Vec, left: Vec) -> None:
    solver = PETSc.KSP().create(matrix.comm)
    solver.setOperators(matrix)
    solver.setType(PETSc.KSP.Type.PREONLY)
    solver.getPC().setType(PETSc.PC.Type.LU)
    solver.getPC().setFactorSolverType(PETSc.Mat.SolverType.MUMPS)
    solver.setErrorIfNotConverged(True)
    solver.solve(right, left)
    solver.destroy()
    matrix.destroy()
