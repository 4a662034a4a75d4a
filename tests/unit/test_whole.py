"""Factorisations of all unknowns that share an analysis."""

import numpy as np
import pytest
import scipy.sparse
from tests.unit.condensed_samples import matrix_of

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.base.fenicsx import PETSc
from anisocontact.solver.strategies.condensed.bordered import reachable
from anisocontact.solver.strategies.condensed.factor import aij
from anisocontact.solver.strategies.whole import WholeLU

pytestmark = pytest.mark.skipif(not reachable(), reason="a PETSc without MUMPS")


def test_matrices_of_one_pattern_are_analysed_once() -> None:
    """Newton's tangent, with other values every time, then without a row, then as in the beginning.

    Requirement: solutions in double precision (a condition of 10 to 100 leaves 1e-12); one analysis
    until it is closed, None for a matrix that has no inverse, and the next one is solved again.
    """
    given = matrix_of(60, 3)
    matrix, lu = aij(given), WholeLU()
    starts, columns, values = matrix.getValuesCSR()
    known = np.arange(1.0, 61.0)
    PETSc.Log.begin()
    analysed = PETSc.Log.Event("MatLUFactorSym")
    before = analysed.getPerfInfo()["count"]

    def solved(now: np.ndarray) -> float | None:
        matrix.setValuesCSR(starts, columns, now)
        matrix.assemble()
        b = scipy.sparse.csr_array((now, columns, starts), shape=(60, 60)) @ known
        found = lu.solve(matrix, b)
        return None if found is None else float(np.abs(found - known).max())

    for scale in (1.0, 2.0):
        error = solved(scale * values)
        assert error is not None and error < 1e-10
    assert analysed.getPerfInfo()["count"] == before + 1
    assert solved(0.0 * values) is None
    error = solved(values)
    assert error is not None and error < 1e-10
    assert analysed.getPerfInfo()["count"] == before + 2
    assert lu.made == 4
    lu.close()
