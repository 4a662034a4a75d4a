"""Rows of the interior in single precision: the products of a cycle are bound by memory."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt
import scipy

from anisocontact import _core
from anisocontact.base.array_types import Floats, Ints
from anisocontact.base.fenicsx import MPI, Mat, PETSc, Vec
from anisocontact.solver.strategies.binary_scale import binary_scale
from anisocontact.solver.strategies.iterative.cycle import residual

Singles = npt.NDArray[np.float32]

#: Rows, three a node, that are taken over at once: only these stand in double precision as well.
AT_ONCE = 9_000
#: Numbers that are read past the last block, see `block_rows.hpp`.
_PAST = 1
#: Difference to double precision, over the right-hand side, up to which single precision is used.
TRUSTED = 0.05


class InteriorRows:
    """Rows of the interior of a matrix in blocks of 3 x 3 and single precision; collective.

    They need 4.4 bytes an entry, rows of single entries in double precision 12. A power of two
    brings them into the range of single precision, in any units.

    Args:
        matrix: Matrix of all unknowns, three a node.
        interior: Unknowns of the interior.

    Attributes:
        here: Local numbers of the interior's unknowns, (m,).
        diagonal: Of their rows, (m,).
    """

    def __init__(self, matrix: Mat, interior: PETSc.IS) -> None:
        first, last = matrix.getOwnershipRange()
        self._own = last - first
        self.here: Ints = interior.getIndices() - first
        self.diagonal: Floats = matrix.getDiagonal().array_r[self.here]
        self._binary = binary_scale(float(np.abs(self.diagonal).max(initial=0.0)))
        starts, columns, blocks = [np.zeros(1, dtype=np.int32)], [], []
        for part in _blocks(matrix, self.here):
            starts.append(starts[-1][-1] + part.indptr[1:])
            columns.append(part.indices)
            entries = self._binary * part.data.transpose(0, 2, 1)
            blocks.append(entries.astype(np.float32).reshape(-1))
        self._starts = np.concatenate(starts).astype(np.int32)
        self._blocks = np.concatenate([*blocks, np.zeros(_PAST, dtype=np.float32)])
        blocks.clear()
        node = np.concatenate([np.zeros(0, dtype=np.int64), *columns])
        outside = (node < first // 3) | (node >= last // 3)
        others = np.unique(node[outside])
        place = np.where(outside, self._own // 3 + np.searchsorted(others, node), node - first // 3)
        self._columns = place.astype(np.int32)
        self._x = np.zeros(self._own + 3 * len(others), dtype=np.float32)
        self._beside = PETSc.Vec().createSeq(3 * len(others))
        source = PETSc.IS().createBlock(3, others.astype(PETSc.IntType), PETSc.COMM_SELF)
        self._gather = PETSc.Scatter().create(matrix.createVecRight(), source, self._beside, None)

    def times(self, x: Vec) -> Singles:
        """These rows times all unknowns, (m,)."""
        self._gather.scatter(x, self._beside)
        back = 1.0 / self._binary
        np.multiply(x.array_r, back, out=self._x[: self._own], casting="same_kind")
        np.multiply(self._beside.array_r, back, out=self._x[self._own :], casting="same_kind")
        found: Singles = _core.multiply_block_rows(
            self._starts, self._columns, self._blocks, self._x
        )
        return found

    def destroy(self) -> None:
        """Give back PETSc's objects."""
        self._gather.destroy()
        self._beside.destroy()


def _blocks(matrix: Mat, rows: Ints) -> Iterator[Any]:
    """Some rows of a matrix that this process owns in blocks, some at a time; collective."""
    (first, last), comm = matrix.getOwnershipRange(), matrix.getComm()
    every = PETSc.IS().createStride(last - first, first, 1, comm)
    ends = range(AT_ONCE, AT_ONCE + comm.tompi4py().allreduce(len(rows), MPI.MAX), AT_ONCE)
    for end in ends:
        here = (first + rows[end - AT_ONCE : end]).astype(PETSc.IntType)
        some = PETSc.IS().createGeneral(here, comm)
        part = matrix.createSubMatrix(some, every)
        starts, columns, values = part.getValuesCSR()
        shape = (len(here), matrix.getSize()[1])
        if len(here):  # others may have rows left
            yield scipy.sparse.csr_array((values, columns, starts), shape=shape).tobsr((3, 3))
        part.destroy()
        some.destroy()
    every.destroy()


class SingleInterior:
    """The interior of a level, given unknowns by themselves, as a Python matrix of PETSc.

    Args:
        rows: Rows of the interior.
        like: Vector of all unknowns.
        given: Unknowns with a row of their own, local numbers.
        scale: Diagonal of their rows, force/length.
    """

    def __init__(self, rows: InteriorRows, like: Vec, given: Ints, scale: float) -> None:
        self._rows, self._whole, self._scale = rows, like.duplicate(), scale
        self._given = np.flatnonzero(np.isin(rows.here, given))

    def mult(self, _: Mat, x: Vec, y: Vec) -> None:
        """Product with the unknowns of the interior, for PETSc."""
        moves = np.array(x.array_r)
        alone, moves[self._given] = moves[self._given], 0.0
        self._whole.array[self._rows.here] = moves
        y.array[:] = self._rows.times(self._whole)
        y.array[self._given] = self._scale * alone

    def getDiagonal(self, _: Mat, out: Vec) -> None:  # noqa: N802 (the name that PETSc calls)
        """Its diagonal, for PETSc."""
        out.array[:] = self._rows.diagonal
        out.array[self._given] = self._scale

    def matrix(self, comm: Any) -> Mat:
        """PETSc's matrix of it."""
        own = len(self._rows.here)
        made = PETSc.Mat().createPython(((own, None), (own, None)), self, comm)
        made.setUp()
        return made


class MixedResidual:
    """A residual with the interior in single precision, and the patch, where contact is, in double.

    Single precision leaves `6e-8 |A| |x|`, which is little beside the right-hand side unless the
    matrix is next to singular: slender bodies, stiff ones beside soft ones. Each matrix is tried.

    Args:
        rows: Rows of the interior.
        patch: Unknowns of the patch.
    """

    def __init__(self, rows: InteriorRows, patch: PETSc.IS) -> None:
        self._rows, self._patch = rows, patch
        self._matrix: Mat | None = None
        self._of_patch: Mat | None = None
        self._here: Ints = np.zeros(0, dtype=np.int64)
        self._untried = False

    def take(self, matrix: Mat) -> None:
        """Take the patch of another matrix."""
        first, last = matrix.getOwnershipRange()
        self._here = self._patch.getIndices() - first
        every = PETSc.IS().createStride(last - first, first, 1, matrix.getComm())
        if self._of_patch is not None:
            self._of_patch.destroy()
        self._matrix, self._of_patch = matrix, matrix.createSubMatrix(self._patch, every)
        self._out = self._of_patch.createVecLeft()
        self._untried = True

    def __call__(self, b: Vec, x: Vec, out: Vec) -> None:
        """See `Residual`."""
        assert self._of_patch is not None, "`take` comes first"
        self._of_patch.mult(x, self._out)
        off = self._rows.times(x)
        out.array[self._rows.here] = b.array_r[self._rows.here] - off
        out.array[self._here] = b.array_r[self._here] - self._out.array_r

    def trusted(self, b: Vec, x: Vec) -> bool:
        """Whether it is near that in double precision; asked once for each matrix."""
        if not self._untried:
            return True
        self._untried = False
        single, double = b.duplicate(), b.duplicate()
        self(b, x, single)
        residual(self._matrix)(b, x, double)
        single.axpy(-1.0, double)
        near = bool(single.norm() <= TRUSTED * b.norm())
        single.destroy()
        double.destroy()
        return near

    def destroy(self) -> None:
        """Give back PETSc's objects."""
        if self._of_patch is not None:
            self._of_patch.destroy()
        self._rows.destroy()
