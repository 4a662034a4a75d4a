"""What factorisations that failed say of memory."""

from __future__ import annotations

from typing import Any

import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.base.errors import MachineError
from anisocontact.base.fenicsx import MPI, PETSc
from anisocontact.base.petsc_calls import check_memory, not_finite


class Failed:
    """A factorisation by MUMPS of a matrix of one number, which has failed with a code."""

    def __init__(self, value: float, code: int) -> None:
        self._code = code
        self._matrix = PETSc.Mat().createDense((1, 1), array=[value], comm=MPI.COMM_SELF)

    def __getattr__(self, name: str) -> Any:
        answers = {
            "getType": PETSc.PC.Type.LU,
            "getFactorSolverType": PETSc.Mat.SolverType.MUMPS,
            "getFactorMatrix": self,
            "getOperators": (self._matrix, self._matrix),
            "getFailedReason": PETSc.PC.FailedReason.FACTOR_NUMERIC_ZEROPIVOT,
        }
        return lambda: answers[name]

    def getMumpsInfog(self, _: int) -> int:  # noqa: N802 - of petsc4py
        return self._code


def test_a_matrix_without_numbers_is_no_lack_of_memory() -> None:
    """Requirement: where a tangent is not finite an increment has failed, and the machine not:
    MUMPS says INFOG(1) = -9 there, as its workspace is full of pivots that it puts off."""
    with pytest.raises(MachineError, match="the workspace of MUMPS was too small"):
        check_memory(Failed(1.0, -9))
    with pytest.raises(MachineError, match="had no memory"):
        check_memory(Failed(1.0, -13))
    check_memory(Failed(1.0, -10))
    for code in (-9, -13):
        check_memory(Failed(float("nan"), code))
    assert not_finite(Failed(float("inf"), -9))
    assert not not_finite(Failed(1.0, -9))
