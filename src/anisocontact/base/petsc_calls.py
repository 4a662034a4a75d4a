"""What PETSc has and petsc4py no name for, and what its factorisations say of memory."""

from __future__ import annotations

import ctypes
from functools import cache
from typing import Any

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.errors import MachineError
from anisocontact.base.fenicsx import PETSc
from anisocontact.base.machine import MEMORY

#: What MUMPS calls INFOG(1) where it could allocate no memory, or no more than it was allowed to.
_NO_MEMORY = (-5, -7, -13, -19)
#: ... and where the workspace that it had estimated was too small.
_TOO_SMALL = (-8, -9, -11, -12, -14, -15, -17, -20)


def check_memory(pc: Any) -> None:
    """Say so where a factorisation has failed for memory, and not for its matrix.

    Args:
        pc: Preconditioner that has failed; the call is collective.

    Raises:
        MachineError: There was too little memory.
    """
    if not_finite(pc):
        return  # MUMPS puts off such pivots until its workspace is full
    mumps = _is_direct(pc) and pc.getFactorSolverType() == PETSc.Mat.SolverType.MUMPS
    code = pc.getFactorMatrix().getMumpsInfog(1) if mumps else 0
    if code in _TOO_SMALL:
        raise MachineError(
            f"the workspace of MUMPS was too small (INFOG(1) = {code})",
            "solver.options = { mat_mumps_icntl_14 = 200 } gives it three times as much",
        )
    if code in _NO_MEMORY or pc.getFailedReason() == PETSc.PC.FailedReason.FACTOR_OUTMEMORY:
        name = f"MUMPS (INFOG(1) = {code})" if mumps else "PETSc"
        raise MachineError(f"{name} had no memory for the factors of a matrix", MEMORY)


def forget_failure(ksp: Any) -> None:
    """Let a solver that has failed solve again: PETSc would say of all later ones that they fail.

    Args:
        ksp: It.
    """
    ksp.reset()
    ksp.getPC().setFailedReason(PETSc.PC.FailedReason.NOERROR)


def not_finite(pc: Any) -> bool:
    """Whether the matrix of a factorisation has values that are not finite; collective."""
    return _is_direct(pc) and not np.isfinite(pc.getOperators()[1].norm())


def _is_direct(pc: Any) -> bool:
    return pc.getType() in (PETSc.PC.Type.LU, PETSc.PC.Type.CHOLESKY)


def has_petsc(*functions: str) -> bool:
    """Whether PETSc has these functions of its C interface."""
    return all(hasattr(_petsc_library(), name) for name in functions)


def call_petsc(function: str, *arguments: Any) -> None:
    """Call a function of PETSc's C interface that petsc4py has no name for.

    Args:
        function: Its name.
        arguments: PETSc objects, or what ctypes passes on.

    Raises:
        PETSc.Error: It failed.
    """
    passed = [ctypes.c_void_p(a.handle) if hasattr(a, "handle") else a for a in arguments]
    code = getattr(_petsc_library(), function)(*passed)
    if code != 0:
        raise PETSc.Error(code)


def numbers_of(function: str, matrix: Any, count: int) -> tuple[ctypes.c_void_p, Floats]:
    """The numbers of a matrix where PETSc has them, to read or overwrite.

    Args:
        function: What gives them, as `MatSeqAIJGetArray`.
        matrix: A matrix of PETSc, or its handle.
        count: How many there are.

    Returns:
        Their address, for what gives them back, and an array that does not own them, (count,).

    Raises:
        PETSc.Error: It failed.
    """
    address = ctypes.c_void_p()
    call_petsc(function, matrix, ctypes.byref(address))
    return address, array_at(address, count, np.float64)


def array_at(address: ctypes.c_void_p, count: int, of: Any) -> Any:
    """An array that does not own its numbers, as PETSc has them.

    Args:
        address: Where they are.
        count: How many there are.
        of: Their type of NumPy.
    """
    if not count or address.value is None:
        return np.zeros(0, dtype=of)
    # NumPy makes an array of a pointer by a cast, which refers to itself
    kind = np.ctypeslib.as_ctypes_type(of)
    return np.frombuffer((kind * count).from_address(address.value), dtype=of)


def pattern_of(matrix: Any) -> tuple[float, int] | None:
    """What tells whether the pattern of a matrix, or of its copies, has changed; collective.

    Args:
        matrix: A matrix of PETSc.

    Returns:
        Its number of entries and one that PETSc counts up where they come to other places; None
        where PETSc does not say it.
    """
    if not has_petsc("MatGetNonzeroState"):
        return None
    state = ctypes.c_int64()
    call_petsc("MatGetNonzeroState", matrix, ctypes.byref(state))
    return float(matrix.getInfo(PETSc.Mat.InfoType.GLOBAL_SUM)["nz_used"]), state.value


@cache
def _petsc_library() -> ctypes.CDLL:
    """The library that petsc4py is linked to: a search in it goes on to what it needs."""
    return ctypes.CDLL(PETSc.__file__)
