"""Rows of an interior in single precision, and where they are trusted."""

import shutil
import subprocess
import sys
import tracemalloc

import numpy as np
import pytest
import scipy

from anisocontact import _core
from anisocontact.base.fenicsx import PETSc
from anisocontact.solver.strategies.iterative import single_rows
from anisocontact.solver.strategies.iterative.single_rows import (
    InteriorRows,
    MixedResidual,
    SingleInterior,
)

#: Rounding of single precision, of rows of some 20 entries.
SINGLE = 1e-6
NODES = 12
INTERIOR = [0, 2, 3, 5, 6, 7, 10, 11]
#: Rows of a Laplacian, nine at a time, of which the second process has none; its largest error.
ON_TWO = """
import numpy as np
from anisocontact.base.fenicsx import MPI, PETSc
from anisocontact.solver.strategies.iterative import single_rows

single_rows.AT_ONCE, comm, n = 9, MPI.COMM_WORLD, 20
first = 3 * n * comm.rank
matrix = PETSc.Mat().createAIJ(((3 * n, None), (3 * n, None)), nnz=5, comm=comm)
for row in range(first, first + 3 * n):
    for column in range(max(row - 1, 0), min(row + 2, 6 * n)):
        matrix[row, column] = 2.0 if row == column else -1.0
matrix.assemble()
nodes = np.arange(0 if comm.rank else n, dtype=np.int32)
rows = single_rows.InteriorRows(matrix, PETSc.IS().createBlock(3, nodes, comm))
x = matrix.createVecRight()
x.array[:] = np.arange(first, first + 3 * n) ** 2
wanted = matrix.createVecLeft()
matrix.mult(x, wanted)
off = np.abs(rows.times(x) - wanted.array_r[rows.here]).max(initial=0.0)
count, off = comm.allreduce(len(rows.here)), comm.allreduce(off, MPI.MAX)
print(f"{count} {off}" if comm.rank else "")
"""


def of_nodes(nodes):
    """Unknowns of nodes as an index set."""
    return PETSc.IS().createBlock(3, np.array(nodes, dtype=np.int32), PETSc.COMM_SELF)


@pytest.fixture
def entries():
    """A matrix with a third of its entries, in blocks that are not full."""
    rng = np.random.default_rng(3)
    size = (3 * NODES, 3 * NODES)
    dense = np.where(rng.random(size) < 0.3, rng.standard_normal(size), 0.0)
    return dense + 4.0 * np.eye(len(dense))


@pytest.fixture
def matrix(entries):
    whole = scipy.sparse.csr_array(entries)
    csr = (whole.indptr.astype(np.int32), whole.indices.astype(np.int32), whole.data)
    return PETSc.Mat().createAIJ(whole.shape, csr=csr, comm=PETSc.COMM_SELF)


def vectors(matrix, count):
    """Any vectors, and one to be filled."""
    found = [matrix.createVecRight() for _ in range(count)]
    rng = np.random.default_rng(4)
    for one in found:
        one.array[:] = rng.standard_normal(len(one.array))
    return found


@pytest.mark.parametrize("at_once", [3, 15, 24, 9000])
def test_products(entries, matrix, at_once, monkeypatch):
    """Rows of some nodes times a vector are those of the matrix, to single precision.

    However many are taken over at once: the last part is as long as the others, shorter or alone.
    """
    monkeypatch.setattr(single_rows, "AT_ONCE", at_once)
    rows = InteriorRows(matrix, of_nodes(INTERIOR))
    (x,) = vectors(matrix, 1)
    wanted = (entries @ x.array_r)[rows.here]
    assert np.abs(rows.times(x) - wanted).max() < SINGLE * np.abs(wanted).max()
    assert np.array_equal(rows.diagonal, np.diag(entries)[rows.here])


@pytest.mark.mpi
@pytest.mark.skipif(shutil.which("mpirun") is None, reason="no mpirun")
def test_a_process_without_rows_takes_part():
    """Others have rows left to take over, also of columns that are not theirs. Exact: integers."""
    command = ["timeout", "100", "mpirun", "-n", "2", sys.executable, "-c", ON_TWO]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.stdout.split() == ["60", "0.0"], done.stderr


def test_taken_over_in_little_memory(monkeypatch):
    """Beside the rows in single precision, twice while parts of them are joined, there is little.

    A copy of the matrix alone takes 12 bytes an entry, these rows 4.4 of each time.
    """
    monkeypatch.setattr(single_rows, "AT_ONCE", 30)
    nodes, beside = 1000, 40
    band = scipy.sparse.diags_array(np.ones(beside), offsets=range(beside), shape=(nodes, nodes))
    whole = scipy.sparse.kron(band, np.ones((3, 3)), format="csr")
    csr = (whole.indptr.astype(np.int32), whole.indices.astype(np.int32), whole.data)
    matrix = PETSc.Mat().createAIJ(whole.shape, csr=csr, comm=PETSc.COMM_SELF)
    tracemalloc.start()
    InteriorRows(matrix, of_nodes(range(nodes)))
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert peak < 12.0 * whole.nnz


@pytest.mark.parametrize("exponent", [-140, 140])
def test_products_in_any_units(entries, matrix, exponent):
    """Numbers beyond the range of single precision: the same products to the last bit."""
    (x,) = vectors(matrix, 1)
    usual = InteriorRows(matrix, of_nodes(INTERIOR)).times(x)
    matrix.scale(2.0**exponent)
    x.scale(2.0**-exponent)  # as what solves for a right-hand side of usual size
    assert np.array_equal(InteriorRows(matrix, of_nodes(INTERIOR)).times(x), usual)


def test_interior_alone(entries, matrix):
    """The interior has rows and columns of given unknowns emptied, as the one in double precision.

    The patch moves nothing, given unknowns have the diagonal that is asked for.
    """
    rows, given = InteriorRows(matrix, of_nodes(INTERIOR)), np.array([7, 8, 20, 30])
    alone = SingleInterior(rows, matrix.createVecRight(), given, 5.0).matrix(PETSc.COMM_SELF)
    inside = entries.copy()
    inside[given], inside[:, given], inside[given, given] = 0.0, 0.0, 5.0
    inside = inside[np.ix_(rows.here, rows.here)]
    (x,) = vectors(alone, 1)
    y, diagonal = alone.createVecLeft(), alone.createVecLeft()
    for _ in range(2):  # nothing stays of a product before
        alone.mult(x, y)
        assert np.abs(y.array_r - inside @ x.array_r).max() < SINGLE * np.abs(y.array_r).max()
    alone.getDiagonal(diagonal)
    assert np.array_equal(diagonal.array_r, np.diag(inside))


def test_residual_has_the_patch_in_double_precision(entries, matrix):
    """Contact may be a million times as stiff as bodies: its rows are those of double precision."""
    rows = InteriorRows(matrix, of_nodes(INTERIOR))
    patch = of_nodes([node for node in range(NODES) if node not in INTERIOR])
    mixed = MixedResidual(rows, patch)
    mixed.take(matrix)
    b, x, found = vectors(matrix, 3)
    mixed(b, x, found)
    wanted = b.array_r - entries @ x.array_r
    off = np.abs(found.array_r - wanted)
    assert off[patch.getIndices()].max() < 1e-14 * np.abs(wanted).max()
    assert 0.0 < off.max() < SINGLE * np.abs(wanted).max()


def test_what_single_precision_spoils_is_seen_once_for_each_matrix(matrix):
    """Beside a right-hand side of 1e-8 of `A x` the residual is rounding alone."""
    rows, (b, x) = InteriorRows(matrix, of_nodes(INTERIOR)), vectors(matrix, 2)
    mixed = MixedResidual(rows, of_nodes([1, 4, 8, 9]))
    for size, trusted in ((1.0, True), (1e-8, False)):
        b.scale(size)
        mixed.take(matrix)
        assert mixed.trusted(b, x) == trusted
        assert mixed.trusted(b, x)  # asked again it costs nothing


def test_numbers_that_do_not_fit_are_refused():
    starts, columns = np.array([0, 1], dtype=np.int32), np.zeros(1, dtype=np.int32)
    with pytest.raises(ValueError, match="nine numbers for each column and one more needed"):
        _core.multiply_block_rows(starts, columns, np.zeros(9, np.float32), np.zeros(3, np.float32))
