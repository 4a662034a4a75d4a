"""Factors with a border: what is put right in them, kept, or made anew."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import scipy.sparse
from tests.unit.condensed_samples import matrix_of

from anisocontact.base.fenicsx import PETSc
from anisocontact.solver.strategies.condensed.bordered import BorderedLU
from anisocontact.solver.strategies.condensed.bordered import reachable as borders
from anisocontact.solver.strategies.condensed.factor import aij
from anisocontact.solver.strategies.condensed.front import whole
from anisocontact.solver.strategies.condensed.interior import Interior
from anisocontact.solver.strategies.condensed.mumps import schur_matrix


@pytest.mark.skipif(not borders(), reason="PETSc without MUMPS")
def test_border_without_masters() -> None:
    """The border of a sparse LU, whose masters are eliminated, answers as a dense solution does.

    Both are in single precision but the sparse part; what slave nodes follow is that of now.
    """
    rng = np.random.default_rng(8)
    n, border = 300, np.arange(50, 260)
    matrix = matrix_of(n, 5)
    slaves, shares = border[:30] - 50, scipy.sparse.lil_array((210, 210), dtype=np.float32)
    for i in slaves:
        shares[i, rng.choice(np.arange(60, 150), 4, replace=False)] = rng.dirichlet(np.ones(4))
    held = scipy.sparse.lil_array((210, 210))
    held[:30, :30] = 1e3 * np.diag(rng.random(30)) + rng.random((30, 30))  # not symmetric
    turned = scipy.sparse.eye_array(210) - shares  # u -> v
    contact = (turned.T @ held @ turned).tocsr()
    factor = BorderedLU(matrix, border)
    flags = np.isin(np.arange(210), slaves)
    assert factor.renew(contact, shares.tocsr(), flags) > 0.0
    assert factor.renew(contact, shares.tocsr(), flags) == 0.0
    b = rng.random(n)
    x = factor.solution(b)
    whole = matrix.toarray()
    whole[np.ix_(border, border)] += contact.toarray()
    np.testing.assert_allclose(x, np.linalg.solve(whole, b), atol=1e-5)
    again = BorderedLU(matrix, border)
    again.restore(factor.persistent())
    again.renew(contact, shares.tocsr(), flags)
    np.testing.assert_array_equal(again.solution(b), x)
    assert len(factor.persistent()["stays"].nonzero()[0]) == 30


@pytest.mark.skipif(not borders(), reason="PETSc without MUMPS")
def test_few_rows_of_a_border_are_put_right() -> None:
    """Points of few nodes change their status: their rows cost less than a factorisation.

    Source of the solution: NumPy's dense one; of the border, in single precision, 1e-7 times its
    condition is left. A run that goes on has the same bits.
    """
    rng = np.random.default_rng(3)
    n, border, none = 900, np.arange(100, 800), whole(700)
    matrix = matrix_of(n, 6)
    size = float(matrix.diagonal().max())
    matrix = (matrix + scipy.sparse.diags_array(np.full(n, size))).tocsr()
    factor = BorderedLU(matrix, border)
    stick = rng.random(700) < 0.8
    first = factor.renew(scipy.sparse.diags_array(8.0 * size * stick).tocsr(), *none)
    stick[:60] = ~stick[:60]
    now = scipy.sparse.diags_array(8.0 * size * stick).tocsr()
    assert 0.0 < factor.renew(now, *none) < 0.7 * first
    b = rng.random(n)
    x = factor.solution(b)
    dense = matrix.toarray()
    dense[np.ix_(border, border)] += now.toarray()
    np.testing.assert_allclose(x, np.linalg.solve(dense, b), atol=1e-5)
    again = BorderedLU(matrix, border)
    again.restore(factor.persistent())
    np.testing.assert_array_equal(again.solution(b), x)


@pytest.mark.skipif(not borders(), reason="PETSc without MUMPS")
def test_a_factor_of_other_values_needs_no_other_analysis() -> None:
    """Other values in the same places, and matrices of other places.

    Requirement: MUMPS analyses once; solutions are NumPy's dense ones up to the border's single
    precision; a matrix of other places is not taken, and leaves the factor as it is.
    """
    n, border, none = 300, np.arange(50, 150), whole(100)
    matrix = matrix_of(n, 5)
    matrix.sort_indices()
    other = matrix.copy()
    other.data *= 1.0 + 0.2 * np.random.default_rng(2).random(other.nnz)  # not symmetric
    PETSc.Log.begin()
    analysed = PETSc.Log.Event("MatLUFactorSym")
    factor = BorderedLU(matrix, border)
    before = analysed.getPerfInfo()["count"]

    def error(of: Any) -> float:
        factor.renew(scipy.sparse.csr_array((100, 100)), *none)
        x = factor.solution(of @ np.arange(1.0, n + 1.0))
        return float(np.abs(x - np.arange(1.0, n + 1.0)).max())

    assert error(matrix) < 1e-2
    assert not factor.take(scipy.sparse.eye_array(n, format="csr"), border, False)
    assert not factor.take(matrix, border[1:], False)
    assert error(matrix) < 1e-2
    assert factor.take(other, border, False)
    assert error(other) < 1e-2 < error(matrix)
    assert analysed.getPerfInfo()["count"] == before
    factor.close()


@pytest.mark.skipif(not borders(), reason="PETSc without MUMPS")
def test_what_is_prescribed_is_no_part_of_a_factor() -> None:
    """Rows with a diagonal alone, in the interior and in the border, whose columns stay.

    Requirement: none of the interior is among what MUMPS factorises; solutions are NumPy's dense
    ones up to the border's single precision, with right-hand sides there or not; a matrix that
    prescribes other unknowns is not taken, and leaves the factor as it is.
    """
    n, border, none = 300, np.arange(50, 150), whole(100)
    matrix = matrix_of(n, 5)
    matrix.sort_indices()
    rows = np.repeat(np.arange(n), np.diff(matrix.indptr))
    other, held = matrix.copy(), np.isin(np.arange(n), [0, 60, 200, 201, 299])
    matrix.data[held[rows] & (rows != matrix.indices)] = 0.0
    factor = BorderedLU(matrix, border)
    assert len(factor._interior._known.others) == n - 4
    factor.renew(scipy.sparse.csr_array((100, 100)), *none)
    for known in (np.arange(1.0, n + 1.0), np.where(held, 0.0, 1.0)):
        assert np.abs(factor.solution(matrix @ known) - known).max() < 1e-2
    assert not factor.take(other, border, False)
    assert np.abs(factor.solution(matrix @ known) - known).max() < 1e-2
    factor.close()


@pytest.mark.skipif(not borders(), reason="PETSc without MUMPS")
def test_a_factor_that_runs_out_of_workspace_is_analysed_anew(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """MUMPS needs more workspace for other values than it has for the first ones.

    Requirement: it is given more, and what is left on the border is NumPy's to rounding.
    PETSc factorises no more with an analysis of which a factorisation has failed.
    """
    n, border = 300, np.arange(50, 150)
    matrix = matrix_of(n, 5)
    matrix.sort_indices()
    interior = Interior(aij(matrix), border, "", {})
    monkeypatch.setattr("anisocontact.solver.strategies.condensed.interior.WORKSPACE", (-90, 30))
    interior.factor.setMumpsIcntl(14, -90)
    for scale in (1.5, 2.0):
        matrix.data *= scale
        assert interior.take(matrix)
        schur, dense = schur_matrix(interior.factor, 100)[1], matrix.toarray()
        rest = np.setdiff1d(np.arange(n), border)
        across = dense[np.ix_(border, rest)] @ np.linalg.inv(dense[np.ix_(rest, rest)])
        right = dense[np.ix_(border, border)] - across @ dense[np.ix_(rest, border)]
        np.testing.assert_allclose(schur, right, atol=1e-9 * np.abs(right).max())
    interior.close()
