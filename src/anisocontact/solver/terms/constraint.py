"""Linear constraints: unknowns that follow from others, and what becomes of the equations."""

from __future__ import annotations

import numpy as np
import scipy

from anisocontact.base.array_types import Flags, Floats, Ints
from anisocontact.base.fenicsx import Mat, PETSc, Vec


class Constraint:
    """Unknowns `u_s = sum of c_sm u_m + d_s`, on top of a system `r(u) = 0`.

    The equation of a slave is its constraint; its force goes to the masters, as virtual work says:
    `r <- R r + s (u_s - c u - d)`, with R the unit matrix without the rows of slaves and with c^T,
    and the same for the tangent.

    Args:
        like: A vector of the unknowns.
        slaves: Slave of each coefficient, number over all ranks; it lives on this rank.
        masters: Master of each coefficient, number over all ranks.
        factors: The coefficients c.
        handed: Shares of the force of a slave that its masters are handed, if they are others.

    Attributes:
        dependents: Slaves on this rank, local numbers.
        offset: The d of the unknowns of this rank, length; None where they are zero.
    """

    def __init__(
        self,
        like: Vec,
        slaves: Ints,
        masters: Ints,
        factors: Floats,
        handed: Floats | None = None,
    ) -> None:
        first, last = like.getOwnershipRange()
        dependents = np.unique(slaves)
        self.dependents: Ints = dependents - first
        free = np.setdiff1d(np.arange(first, last), dependents)
        alone, own = np.ones(len(free)), np.ones(len(dependents))
        shares = factors if handed is None else handed
        self._gather = _matrix(like, (free, free, alone), (masters, slaves, shares))
        self._involved = like.duplicate()
        self._involved.zeroEntries()
        coupled = np.concatenate([slaves[factors != 0.0], masters[factors != 0.0]])
        ones = np.ones(len(coupled))
        self._involved.setValues(coupled.astype(PETSc.IntType), ones, PETSc.InsertMode.ADD_VALUES)
        self._involved.assemble()
        self.offset: Floats | None = None
        self._constrain = _matrix(like, (dependents, dependents, own), (slaves, masters, -factors))

    def gather(self, force: Vec) -> Vec:
        """Forces handed from slaves to masters, `R f`, a new vector."""
        out = force.duplicate()
        self._gather.mult(force, out)
        return out

    def violation(self, u: Vec) -> Vec:
        """`u_s - c u - d` of the slaves, zero elsewhere, a new vector."""
        out = u.duplicate()
        self._constrain.mult(u, out)
        if self.offset is not None:
            out.array[:] -= self.offset
        return out

    def gathering(self) -> scipy.sparse.csr_array:
        """R, (n, n); rows of slaves are empty. On one process."""
        starts, columns, values = self._gather.getValuesCSR()
        n = len(starts) - 1
        return scipy.sparse.csr_array((values, columns, starts), shape=(n, n))

    def involved(self) -> Flags:
        """Unknowns of this rank that follow from others, or others from them."""
        return np.asarray(self._involved.array_r > 0.0)

    def spread(self, columns: Mat) -> Mat:
        """Displacements in which slaves follow their masters, `R^T U`; takes the matrix over."""
        out = self._gather.transposeMatMult(columns)
        columns.destroy()
        return out

    def transform(self, matrix: Mat, scale: float) -> None:
        """Make the tangent of the system that of the constrained one, in place.

        The pattern stays: masters are to be coupled with all that their slaves are.
        """
        product = self._gather.matMult(matrix)
        matrix.zeroEntries()
        subset = PETSc.Mat.Structure.SUBSET_NONZERO_PATTERN
        matrix.axpy(1.0, product, structure=subset)
        matrix.axpy(scale, self._constrain, structure=subset)
        product.destroy()

    def close(self) -> None:
        """Give back the matrices."""
        for part in (self._gather, self._constrain, self._involved):
            part.destroy()


type _Entries = tuple[Ints, Ints, Floats]


def _matrix(like: Vec, diagonal: _Entries, others: _Entries) -> Mat:
    matrix = PETSc.Mat().create(like.getComm())
    matrix.setSizes((like.getSizes(), like.getSizes()))
    matrix.setType(PETSc.Mat.Type.AIJ)
    rows, columns, values = (np.concatenate(pair) for pair in zip(diagonal, others, strict=True))
    matrix.setPreallocationCOO(rows.astype(PETSc.IntType), columns.astype(PETSc.IntType))
    matrix.setValuesCOO(values, PETSc.InsertMode.INSERT_VALUES)
    return matrix
