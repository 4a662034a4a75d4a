"""Factorisations that read one half of a matrix."""

from __future__ import annotations

import numpy as np

from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import Mat, PETSc

#: Factorisations of symmetric matrices, and how far entries may differ from those across the
#: diagonal, over the largest sum of a row: rounding of what is symmetric.
SYMMETRIC, ASYMMETRY = (PETSc.PC.Type.CHOLESKY, PETSc.PC.Type.ICC), 1e-8


def check_symmetric(ksp: PETSc.KSP, matrix: Mat) -> None:
    """Refuse a factorisation of symmetric matrices as the solution where the tangent is none.

    As the preconditioner of Krylov iterations, which look at the whole matrix, it may serve.

    Raises:
        InputError: The tangent is not symmetric.
    """
    kind = ksp.getPC().getType()
    if kind not in SYMMETRIC or ksp.getType() != PETSc.KSP.Type.PREONLY:
        return
    size = matrix.norm(PETSc.NormType.NORM_INFINITY)
    if np.isfinite(size) and not matrix.isSymmetric(ASYMMETRY * size):
        text = (
            f"{kind!r} given, which needs a symmetric tangent: prescribed displacements, friction "
            "and loads that follow make it unsymmetric; allowed: lu, or another one for any matrix"
        )
        raise InputError(text, field="options.pc_type")
