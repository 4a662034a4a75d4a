"""The interior of bodies of which a checkpoint has the state of the touched unknowns only."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from anisocontact.base.fenicsx import PETSc, Vec
from anisocontact.solver.system.persistent import Arrays
from anisocontact.solver.system.reduction import Kept

if TYPE_CHECKING:
    from anisocontact.solver.system.problem import Problem

Floats = npt.NDArray[np.float64]

#: In front of the names of what `Interior` needs.
PENDING = "pending_"
_NEVER = "the interior has to be solved for before anything is accepted"


class Interior:
    """Answers for a bulk whose interior is not yet solved for, and ends with the first answer.

    With the unknowns that can be touched and the prescribed ones known, equilibrium of the others
    is `K_ii u_i = f_i - K_ic u_c - K_ip u_p`: one linear solution, on any number of ranks.

    Args:
        problem: The problem; its accepted state is true where bodies can be touched.
        known: What `pending` gave: nodes that can be touched, loads and contact forces.
    """

    def __init__(self, problem: Problem, known: Arrays) -> None:
        self._problem, self._known = problem, known

    def pending(self) -> Arrays:
        """What is needed to bring the state of all unknowns up to date."""
        return self._known

    def recover(self) -> None:
        """Solve for the interior."""
        problem, known = self._problem, self._known
        problem.reduction = None
        load, contact = (known[name].reshape(-1) for name in ("load", "contact_force"))
        given = np.repeat(known["in_reach"], 3)
        given[problem.supports.unknowns] = True
        stiffness = problem.bulk.stiffness.copy()
        u, force = stiffness.createVecs()
        u.array[:] = problem.accepted().array_r[: len(given)]
        force.array[:] = load + contact
        first, _ = stiffness.getOwnershipRange()
        rows = (first + np.flatnonzero(given)).astype(PETSc.IntType)
        scale = problem.bulk.diagonal.sum() / problem.bulk.diagonal.getSize()
        stiffness.zeroRowsColumns(rows, scale, u, force)
        _solve(stiffness, force, u)
        found = np.array(u.array_r)
        found[given] = problem.accepted().array_r[: len(given)][given]  # without rounding
        problem.complete(found, contact, load)

    def commit(self, x: Vec) -> float:
        """Never: a run begins with `recover`."""
        raise AssertionError(_NEVER)

    def reactions(self) -> dict[str, Floats]:
        """Force of the supports of each facet group on the bodies, (3,), force."""
        self.recover()
        return self._problem.reactions()

    def elastic(self) -> float:
        """Elastic energy of the accepted state."""
        self.recover()
        return self._problem.energies()["elastic"]

    def mean(self, group: str, weights: Floats, x: Vec | None = None) -> Floats:
        """Sum of the displacements of all nodes times their weights, (3,), length."""
        assert x is None, _NEVER
        self.recover()
        return self._problem.mean_displacement(group, weights)

    def kept(self, x: Vec) -> Kept:
        """Never: no trial state is asked of."""
        raise AssertionError(_NEVER)

    def displacement(self, x: Vec) -> Floats:
        """Never: no trial state is asked of."""
        raise AssertionError(_NEVER)


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
