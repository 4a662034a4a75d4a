"""A coarse level: what the bodies give is kept, contact comes new with every tangent."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np

from anisocontact.base.fenicsx import Mat, PETSc, Vec
from anisocontact.base.petsc_calls import pattern_of
from anisocontact.base.places_in_matrix import PlacesInMatrix
from anisocontact.solver.strategies.iterative.split import sparse

#: Diagonal over its largest entry below which a coarse unknown moves nothing.
IDLE = 1e-13


class Inverse(Protocol):
    """Exact or approximate inverse of the matrix of a coarse level."""

    @property
    def single(self) -> bool:
        """Whether the factor at its end is in single precision."""

    def renew(self, matrix: Mat, grown: bool, bodies: bool) -> bool:
        """Take another matrix.

        Args:
            matrix: The matrix.
            grown: Whether it has more entries than the last one.
            bodies: Whether not only contact is another one.

        Returns:
            Whether it has an inverse.
        """

    def solve(self, right: Vec) -> Vec:
        """Solution for a right-hand side; overwritten by the next call."""

    def destroy(self) -> None:
        """Give back PETSc's objects."""


class _Summand:
    """A matrix that is added to another one again and again, while both keep their patterns.

    Args:
        matrix: The matrix, which is taken over.
    """

    def __init__(self, matrix: Mat) -> None:
        self.matrix = matrix
        self._places = PlacesInMatrix(matrix)

    def add_to(self, out: Mat) -> None:
        """Add the matrix of now to one that has room for it."""
        if not self._places.add(out):
            subset = PETSc.Mat.Structure.SUBSET_NONZERO_PATTERN
            out.axpy(1.0, self.matrix, structure=subset)

    def destroy(self) -> None:
        """Give back PETSc's object."""
        self.matrix.destroy()


class CoarseLevel:
    """Correction on the columns of an interpolation P from the matrix A of a level.

    With E the rows of P in the patch and the patch's block of A, `P^T A P = G + E^T A_pp E`; G
    changes with the bodies alone.

    Args:
        matrix: Matrix A of the finer level.
        prolong: P, which is taken over.
        patch: Where the patch is on the finer level.
        scale: Diagonal of coarse unknowns that move nothing, force/length.
        inverse: Makes the inverse for the first matrix.
    """

    def __init__(
        self,
        matrix: Mat,
        prolong: Mat,
        patch: PETSc.IS,
        scale: float,
        inverse: Callable[[Mat], Inverse],
    ) -> None:
        self._prolong, self._patch, self._scale = prolong, patch, scale
        first, last = prolong.getOwnershipRangeColumn()
        columns = PETSc.IS().createStride(last - first, first, 1, prolong.getComm())
        self._lift = prolong.createSubMatrix(patch, columns)
        self._grown = False
        #: Of the last matrix, where contact has been taken from, and of the last product.
        self._pattern: tuple[float, int] | None = None
        self._of_product: tuple[float, int] | None = None
        self._block: Mat | None = None
        self._contact: _Summand | None = None
        self._matrix: Mat | None = None
        self._make_inverse = inverse
        self._inverse: Inverse | None = None
        self._right, self._correction = prolong.createVecs()
        self._product: Mat | None = None
        self._bodies, self._other_bodies = _Summand(self._without_contact(matrix)), False
        self._forget_product()  # it keeps copies of P, and linear bodies need none again

    @property
    def single(self) -> bool:
        """Whether the factor at the end of the levels is in single precision."""
        assert self._inverse is not None
        return self._inverse.single

    def renew_bodies(self, matrix: Mat) -> None:
        """Take bodies that have changed."""
        self._bodies.destroy()
        self._bodies, self._other_bodies = _Summand(self._without_contact(matrix)), True

    def outgrow(self) -> None:
        """Take it that the next matrix is a new one with other entries."""
        self._pattern = None
        self._forget_product()

    def renew(self, matrix: Mat) -> bool:
        """Take the contact of a matrix of the finer level; whether there is an inverse."""
        contact = self._take_contact(matrix)
        grown, self._grown = self._grown, False
        if self._matrix is None or grown:
            if self._matrix is not None:
                self._matrix.destroy()
            self._matrix = self._bodies.matrix.copy()
            different = PETSc.Mat.Structure.DIFFERENT_NONZERO_PATTERN
            self._matrix.axpy(1.0, contact.matrix, structure=different)
        else:
            self._matrix.zeroEntries()
            for part in (self._bodies, contact):
                part.add_to(self._matrix)
            self._matrix.assemble()
        if self._inverse is None:
            self._inverse = self._make_inverse(self._matrix)
        bodies, self._other_bodies = self._other_bodies, False
        return self._inverse.renew(self._matrix, grown, bodies)

    def solve(self, rest: Vec) -> Vec:
        """Correction of all unknowns of the finer level; overwritten by the next call."""
        assert self._inverse is not None
        self._prolong.multTranspose(rest, self._right)
        self._prolong.mult(self._inverse.solve(self._right), self._correction)
        return self._correction

    def destroy(self) -> None:
        """Give back PETSc's objects."""
        self._forget_product()
        parts = (self._inverse, self._matrix, self._bodies, self._contact, self._block)
        for part in (*parts, self._lift, self._prolong):
            if part is not None:
                part.destroy()

    def _take_contact(self, matrix: Mat) -> _Summand:
        """`E^T A_pp E` of now."""
        pattern = pattern_of(matrix)
        if pattern is None or pattern != self._pattern:
            self._pattern, self._grown = pattern, True
            for part in (self._block, self._contact):
                if part is not None:
                    part.destroy()
            self._block = self._contact = None
        self._block = matrix.createSubMatrix(self._patch, self._patch, self._block)
        if self._contact is None:
            self._contact = _Summand(self._block.ptap(self._lift))
        else:
            self._block.ptap(self._lift, self._contact.matrix)
        return self._contact

    def _galerkin(self, matrix: Mat) -> Mat:
        """`P^T A P`, in the places of the last one while the pattern of A stays."""
        pattern = pattern_of(matrix)
        if pattern is None or pattern != self._of_product:
            self._forget_product()
        self._of_product = pattern
        self._product = matrix.ptap(self._prolong, self._product)
        return self._product

    def _forget_product(self) -> None:
        if self._product is not None:
            self._product.destroy()
        self._product = self._of_product = None

    def _without_contact(self, matrix: Mat) -> Mat:
        """G, with a diagonal where neither the bodies nor contact have one."""
        whole = self._galerkin(matrix).copy()
        diagonal = np.abs(whole.getDiagonal().array_r)
        comm = matrix.getComm()
        largest = max(comm.tompi4py().allgather(float(diagonal.max(initial=0.0))))
        idle = np.flatnonzero(diagonal <= IDLE * largest)
        (own, _), _ = whole.getSizes()
        at = (idle, whole.getOwnershipRange()[0] + idle)
        unit = sparse(own, own, comm, at, np.full(len(idle), self._scale))
        contact = self._take_contact(matrix)
        different = PETSc.Mat.Structure.DIFFERENT_NONZERO_PATTERN
        for factor, part in ((1.0, unit), (-1.0, contact.matrix)):
            whole.axpy(factor, part, structure=different)
        unit.destroy()
        return whole
