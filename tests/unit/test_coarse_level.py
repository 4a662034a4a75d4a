"""The matrix of a coarse level is the Galerkin product `P^T A P`, whatever A was before."""

import numpy as np
import pytest
import scipy

from anisocontact.base.fenicsx import PETSc
from anisocontact.solver.strategies.iterative.coarse import CoarseLevel

RNG = np.random.default_rng(11)
N, PATCH = 12, 3


def _rows(shift):
    """Stiff neighbours `shift` apart beside the diagonal: as many entries for each shift."""
    far = RNG.uniform(0.1, 1.0, N - shift)
    rows = scipy.sparse.diags_array([far, far], offsets=[-shift, shift], shape=(N, N))
    return scipy.sparse.csr_array(rows + 4.0 * scipy.sparse.eye_array(N))


def _with_entries(one, other):
    """The first matrix with small entries in its first row, so that it has as many as the other."""
    missing = other.nnz - one.nnz
    corner = scipy.sparse.coo_array(
        (np.full(missing, 1e-3), (np.zeros(missing, int), np.arange(N - missing, N))), (N, N)
    )
    full = scipy.sparse.csr_array(one + corner)
    assert full.nnz == other.nnz
    return full


def _lay_out(matrix, rows):
    sides = (rows.indptr.astype(PETSc.IntType), rows.indices.astype(PETSc.IntType))
    matrix.setPreallocationCSR((*sides, rows.data))
    matrix.assemble()


def _interpolation():
    """Pairs of interior unknowns become one; the patch, the last ones, stays."""
    interior = N - PATCH
    columns = [
        *(np.arange(interior) // 2),
        *range((interior + 1) // 2, (interior + 1) // 2 + PATCH),
    ]
    starts = np.arange(N + 1, dtype=PETSc.IntType)
    return scipy.sparse.csr_array((RNG.uniform(0.5, 1.0, N), np.array(columns), starts))


class _Kept:
    """An inverse that keeps the matrix it was given last."""

    single = False

    def renew(self, matrix, grown, bodies):
        starts, columns, values = matrix.getValuesCSR()
        self.dense = scipy.sparse.csr_array((values, columns, starts)).toarray()
        return True

    def destroy(self):
        pass


def test_a_product_is_laid_out_anew_where_entries_are_elsewhere():
    """Neighbours two apart, then one, then the same with other values: `P^T A P` to rounding.

    The first two have as many entries, which does not tell that they are elsewhere.
    """
    near = _rows(1)
    far = _with_entries(_rows(2), near)
    prolong, kept = _interpolation(), _Kept()
    sides = (prolong.indptr.astype(PETSc.IntType), prolong.indices.astype(PETSc.IntType))
    patch = PETSc.IS().createStride(PATCH, N - PATCH, 1)
    matrix = PETSc.Mat().create(PETSc.COMM_SELF)
    matrix.setSizes((N, N))
    matrix.setType(PETSc.Mat.Type.AIJ)
    _lay_out(matrix, far)
    given = PETSc.Mat().createAIJ(prolong.shape, csr=(*sides, prolong.data))
    level = CoarseLevel(matrix, given, patch, 1.0, lambda _: kept)
    for rows in (far, near, 2.0 * near, far):
        _lay_out(matrix, rows)
        level.renew_bodies(matrix)
        assert level.renew(matrix)
        assert kept.dense == pytest.approx(prolong.T @ rows @ prolong.toarray(), rel=1e-13)
    level.destroy()
