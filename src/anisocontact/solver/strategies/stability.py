"""Whether a state in equilibrium is stable: the eigenvalue of least value of its tangent."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.fenicsx import Mat, PETSc, Vec
from anisocontact.mesh.slenderness import slenderness
from anisocontact.solver.system.problem import Problem

#: Real part of the determinant, between 0.5 and 1 of either sign [MUMPS users' guide].
_RINFOG_DETERMINANT = 12
#: Solutions at most for the least eigenvalue; the share of its mode that one may still add where
#: it is negative; and its change over itself below which it stays positive.
_SOLUTIONS, _ADDED, _STEADY = 30, 0.2, 0.05
#: Imaginary part of an eigenvalue over its size up to which it is real.
_REAL = 1e-9
#: Length over thickness, see `slenderness`, from which on bodies may buckle at moderate strain: a
#: column 4.3 times as long as wide, a strip of 9.
BUCKLES = 10.0


def unstable(ksp: Any, comm: Any) -> bool:
    """Whether the tangent of a factor has a negative eigenvalue, as far as found; collective.

    An odd number of them makes the determinant negative. An even one, as of a column of square
    section, is found by `least_eigenvalue`.

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
    if comm.bcast(determinant < 0.0):
        return True
    tangent, _ = ksp.getOperators()
    return least_eigenvalue(tangent, pc.apply) < 0.0


def may_buckle(problem: Problem) -> bool:
    """Whether a body is so slender that its stability is worth some solutions; collective."""
    names = problem.model.body_names()
    return not problem.linear and slenderness(problem.model, names) > BUCKLES


def least_eigenvalue(tangent: Mat, inverse: Callable[[Vec, Vec], None]) -> float:
    """Least real eigenvalue of a tangent, roughly; zero where it is not found; collective.

    By the method of Davidson [Davidson 1975]: eigenvalues are sought in a space to which the
    inverse of what is left of the best mode is added. With an exact inverse that is the method of
    Lanczos for the inverse; another one takes more solutions.

    Args:
        tangent: The tangent K.
        inverse: Writes the solution of about `K x = b`, given b and x, into x.

    Example:
        >>> import scipy
        >>> from anisocontact.solver.strategies.condensed.factor import aij
        >>> springs = aij(scipy.sparse.csr_array([[3.0, 1.0], [1.0, -2.0]]))
        >>> def diagonal(b, x):
        ...     x.array[:] = b.array_r / [3.0, -2.0]
        >>> round(least_eigenvalue(springs, diagonal), 3)
        -2.193
    """
    modes: list[Vec] = []
    images: list[Vec] = []
    found, left = tangent.createVecs()
    free = _free(tangent)
    left.array[:] = np.random.default_rng(0).standard_normal(len(free)) * free
    inverse(left, found)
    value, before = 0.0, np.inf
    for _ in range(_SOLUTIONS):
        if not _added(found, modes):
            return 0.0
        images.append(tangent.createVecLeft())
        tangent.mult(modes[-1], images[-1])
        value, shares = _least(np.array([mode.mDot(images) for mode in modes]))
        if shares is None:
            return 0.0
        left.set(0.0)
        left.maxpy(shares, images)
        left.maxpy(-value * shares, modes)
        inverse(left, found)
        if found.norm() < _ADDED if value < 0.0 else before - value <= _STEADY * value:
            return value
        before = value
    return 0.0


def _added(found: Vec, modes: list[Vec]) -> bool:
    """Add to orthonormal modes what a vector has beside them; whether there is something."""
    size = found.norm()
    if not 0.0 < size < np.inf:
        return False
    mode = found.copy()
    mode.scale(1.0 / size)
    for _ in range(2 if modes else 0):  # twice is enough for orthogonality to rounding
        mode.maxpy(-np.asarray(mode.mDot(modes)), modes)
    if mode.norm() == 0.0:
        return False
    mode.normalize()
    modes.append(mode)
    return True


def _least(matrix: Floats) -> tuple[float, Floats | None]:
    """The least real eigenvalue of a small matrix and its vector, where there is one."""
    values, vectors = np.linalg.eig(matrix)
    real = np.abs(np.imag(values)) <= _REAL * np.abs(values)
    if not real.any():
        return 0.0, None
    least = int(np.argmin(np.where(real, np.real(values), np.inf)))
    shares = np.real(vectors[:, least])
    return float(np.real(values[least])), shares / np.linalg.norm(shares)


def _free(tangent: Mat) -> Floats:
    """One for unknowns of this rank that others are coupled to, zero for those that are given."""
    diagonal, whole = tangent.createVecs()
    tangent.getDiagonal(diagonal)
    tangent.getRowSum(whole)
    return np.asarray(diagonal.array_r != whole.array_r, dtype=np.float64)
