"""Whether a state in equilibrium is stable, by the factor of its tangent."""

from __future__ import annotations

from typing import Any

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.fenicsx import Mat, PETSc

#: Real part of the determinant, between 0.5 and 1 of either sign [MUMPS users' guide].
_RINFOG_DETERMINANT = 12
#: Solutions at most for the mode of least stiffness, and what of it may be left.
_SOLUTIONS, _LEFT = 8, 0.2


def unstable(ksp: Any, comm: Any) -> bool:
    """Whether the tangent of a factor has a negative eigenvalue, as far as found; collective.

    An odd number of them makes the determinant negative. An even one, as of a column of square
    section, is found where inverse iteration leads to one of them, as just beyond its load.

    Args:
        ksp: Linear solver of the tangent; nothing is said of one without a factor of MUMPS.
        comm: Communicator of the unknowns.

    Example:
        Two springs of which none pushes back where it is pushed:

        >>> import scipy
        >>> from mpi4py import MPI
        >>> from anisocontact.solver.strategies.condensed.factor import aij
        >>> springs = aij(scipy.sparse.csr_array([[-1.0, 0.1], [0.1, -2.0]]))
        >>> ksp = PETSc.KSP().create(springs.getComm())
        >>> ksp.setType("preonly")
        >>> ksp.getPC().setType("lu")
        >>> ksp.getPC().setFactorSolverType("mumps")
        >>> ksp.setOperators(springs)
        >>> ksp.setUp()
        >>> unstable(ksp, MPI.COMM_SELF)
        True
    """
    pc = ksp.getPC()
    factorised = pc.getType() == PETSc.PC.Type.LU
    if not factorised or pc.getFactorSolverType() != PETSc.Mat.SolverType.MUMPS:
        return False
    determinant = pc.getFactorMatrix().getMumpsRinfog(_RINFOG_DETERMINANT)
    return bool(comm.bcast(determinant < 0.0)) or _least(ksp) < 0.0


def _least(ksp: Any) -> float:
    """The eigenvalue next to zero by inverse iteration; zero where it is not found."""
    tangent, _ = ksp.getOperators()
    mode, given = tangent.createVecs()
    free = _free(tangent)
    given.array[:] = np.random.default_rng(0).standard_normal(len(free)) * free
    value = 0.0
    for _ in range(_SOLUTIONS):
        given.normalize()
        ksp.getPC().apply(given, mode)
        size = mode.norm()
        if not 0.0 < size < np.inf:
            return 0.0
        value = mode.dot(given) / size**2
        given.axpy(-value, mode)
        left = given.norm()
        mode.copy(given)
        if left < _LEFT:
            return float(value)
    return 0.0


def _free(tangent: Mat) -> Floats:
    """One for unknowns of this rank that others are coupled to, zero for those that are given."""
    diagonal, whole = tangent.createVecs()
    tangent.getDiagonal(diagonal)
    tangent.getRowSum(whole)
    return np.asarray(diagonal.array_r != whole.array_r, dtype=np.float64)
