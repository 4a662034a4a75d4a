"""Entries of a sparse matrix go to where a matrix of PETSc has them, whatever else is in it."""

import numpy as np
import pytest
import scipy

from anisocontact.base.compiled_forms import compiled
from anisocontact.base.fenicsx import PETSc, assemble_into, fem, ufl
from anisocontact.base.form_rows import create_stiffness
from anisocontact.base.places_in_matrix import PlacesInMatrix
from anisocontact.mesh import BoxSpec, build_box

RNG = np.random.default_rng(7)


def _pattern(n, density):
    ones = scipy.sparse.eye_array(n) + scipy.sparse.random_array((n, n), density=density, rng=RNG)
    own = ones.tocsr()
    own.sort_indices()
    return own


def _places_of(own):
    """Of a matrix of PETSc whose entries are those of `own`, at any time."""
    sides = (own.indptr.astype(PETSc.IntType), own.indices.astype(PETSc.IntType))
    return PlacesInMatrix(PETSc.Mat().createAIJWithArrays(own.shape, (*sides, own.data)))


def _petsc(of):
    sides = (of.indptr.astype(PETSc.IntType), of.indices.astype(PETSc.IntType))
    return PETSc.Mat().createAIJ(of.shape, csr=(*sides, of.data))


def _dense(matrix):
    starts, columns, values = matrix.getValuesCSR()
    return scipy.sparse.csr_array((values, columns, starts), matrix.getSize()).toarray()


def _with_room(own, more, density=0.1):
    """The matrix with other entries, zero, between its own, and further rows and columns."""
    n = own.shape[0] + more
    wide = scipy.sparse.csr_array((own.data, own.indices, own.indptr), (own.shape[0], n))
    rows = scipy.sparse.csr_array((more, n))
    room = abs(scipy.sparse.vstack([wide, rows])) + _pattern(n, density)
    room = scipy.sparse.csr_array(room)
    room.sort_indices()
    room.data[:] = 0.0
    return _petsc(room)


@pytest.mark.parametrize("more", [0, 6], ids=["same size", "more unknowns"])
def test_entries_come_to_their_places_beside_others(more):
    """Copies, so the same bits; what has no counterpart stays."""
    own = _pattern(30, 0.1)
    out, places = _with_room(own, more), _places_of(own)
    for _ in range(3):
        own.data[:] = RNG.standard_normal(own.nnz)
        assert places.copy(out)
        assert np.array_equal(_dense(out)[:30, :30], own.toarray())
        assert not _dense(out)[30:].any() and not _dense(out)[:, 30:].any()
    assert places.found == 1


def test_places_are_looked_for_again_in_another_matrix_and_in_one_that_has_grown():
    """Contacts that couple other nodes make a new matrix, or new entries in the one there is."""
    own = _pattern(30, 0.1)
    places = _places_of(own)
    first, second = _with_room(own, 0), _with_room(own, 3, 0.2)
    for out in (first, second, first):
        assert places.copy(out)
        assert np.array_equal(_dense(out)[:30, :30], own.toarray())
    first.setOption(PETSc.Mat.Option.NEW_NONZERO_ALLOCATION_ERR, False)
    for column in range(30):
        first.setValue(0, column, 0.0, PETSc.InsertMode.INSERT_VALUES)
    first.assemble()
    assert places.copy(first)
    assert np.array_equal(_dense(first), own.toarray())


def test_places_are_looked_for_again_where_a_matrix_is_laid_out_anew():
    """As contacts do it whose couplings have moved: as many entries as before, elsewhere."""
    own = scipy.sparse.csr_array(scipy.sparse.eye_array(30))
    places = _places_of(own)
    before = scipy.sparse.csr_array(scipy.sparse.diags_array([np.ones(29)], offsets=[-1]) + own)
    after = scipy.sparse.csr_array(before.T)
    out = _petsc(before)
    for pattern in (before, after, before):
        sides = (pattern.indptr.astype(PETSc.IntType), pattern.indices.astype(PETSc.IntType))
        out.setPreallocationCSR((*sides, np.zeros(pattern.nnz)))
        assert places.copy(out)
        assert np.array_equal(_dense(out), own.toarray())


def test_nothing_is_written_where_a_place_is_missing():
    """The caller then adds the matrix as PETSc does, which says what is wrong."""
    own = _pattern(30, 0.1)
    out = _petsc(scipy.sparse.csr_array(scipy.sparse.eye_array(30)))
    before = _dense(out)
    assert not _places_of(own).copy(out)
    assert np.array_equal(_dense(out), before)


def test_columns_out_of_order_are_not_taken():
    """Places are found by a merge of rows whose columns increase."""
    out = _petsc(scipy.sparse.csr_array(np.ones((2, 2))))
    sides = (np.array([0, 2, 3]), np.array([1, 0, 1]))
    own = scipy.sparse.csr_array((np.ones(3), sides[1], sides[0]), (2, 2))
    assert not _places_of(own).copy(out)


@pytest.mark.parametrize("components", [3, 1], ids=["one space", "two spaces"])
def test_matrix_of_a_form_is_the_one_that_petsc_sums_up(components):
    """Cells summed in rows of DOLFINx, or by PETSc where a form has two spaces: the same bits.

    Assembled again into the same matrix it is twice as large, so its places are PETSc's.
    """
    model = build_box({"block": BoxSpec((0, 0, 0), (1, 2, 3), (3, 2, 2))})
    u, v = ufl.TrialFunction(model.space), ufl.TestFunction(model.space)
    form = ufl.inner(ufl.sym(ufl.grad(u)), ufl.grad(v)) * ufl.dx
    if components == 1:
        other = fem.functionspace(model.mesh, ("Lagrange", 1))
        form = ufl.div(u) * ufl.TestFunction(other) * ufl.dx
    made = compiled(form, model.mesh.comm)
    found = create_stiffness(made)
    first = found.getValuesCSR()
    by_petsc = found.duplicate()
    assemble_into(by_petsc, made)
    by_petsc.assemble()
    for one, other in zip(first, by_petsc.getValuesCSR(), strict=True):
        assert np.array_equal(one, other)
    assemble_into(found, made)
    found.assemble()
    assert found.getValuesCSR()[2] == pytest.approx(2.0 * first[2], rel=1e-14, abs=1e-15)
