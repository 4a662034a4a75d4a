"""The coarse level: what the bodies give is kept, contact comes new with every tangent.

Its factor is in single precision, in half of the memory and of the time, while that tells stiff
contacts from soft bodies: Krylov iterations need no more of a preconditioner.
"""

from __future__ import annotations

import numpy as np

from anisocontact.base.fenicsx import Mat, PETSc, Vec
from anisocontact.base.petsc_calls import check_memory
from anisocontact.solver.strategies.iterative.split import UnknownSplit, sparse
from anisocontact.solver.strategies.newton import Database

#: Diagonal over its largest entry below which a coarse unknown moves nothing.
IDLE = 1e-13
#: Error of a known solution, over it, up to which a factor in single precision is trusted.
TRUSTED = 0.05
#: Stiffness against motions of the aggregates that depend on each other, over the largest one.
SHIFT = 1e-9
#: Share of such a motion that is left of it in the bodies, up to which they are at rest.
AT_REST = 1e-3


class CoarseLevel:
    """Factor of `P^T J P`.

    With E the rows of P in the patch and the patch's block of J, `P^T J P = G + E^T J_pp E`; G
    changes with the bodies alone.

    Args:
        tangent: Tangent J of all unknowns.
        prolong: P, which is taken over.
        split: Where the patch is.
        scale: Diagonal of coarse unknowns that move nothing, force/length.
        prefix: Prefix of the options of the solver.
        single: Whether its factor is in single precision, where this PETSc can.

    Attributes:
        single: Whether it still is: from where that is not enough on it is in double precision.
    """

    def __init__(
        self,
        tangent: Mat,
        prolong: Mat,
        split: UnknownSplit,
        scale: float,
        prefix: str,
        single: bool = True,
    ) -> None:
        self._prolong, self._patch, self._scale = prolong, split.patch, scale
        first, last = prolong.getOwnershipRangeColumn()
        columns = PETSc.IS().createStride(last - first, first, 1, prolong.getComm())
        self._lift = prolong.createSubMatrix(split.patch, columns)
        self._entries, self._grown = -1.0, False
        self._block: Mat | None = None
        self._contact: Mat | None = None
        self._matrix: Mat | None = None
        self.single, self._prefix = single, prefix
        self._solver = self._new_solver(tangent.getComm())
        self._right, self._rest = prolong.createVecs()
        self._left, self._correction = self._right.duplicate(), self._rest.duplicate()
        self._bodies = self._without_contact(tangent)

    def renew(self, tangent: Mat) -> None:
        """Take bodies that have changed."""
        self._bodies.destroy()
        self._bodies = self._without_contact(tangent)

    def factorise(self, tangent: Mat) -> bool:
        """Take the contact of a tangent; whether the coarse level has an inverse."""
        self._take_contact(tangent)
        if self._matrix is None or self._grown:
            self._grown = False
            if self._matrix is not None:
                # on several processes PETSc would keep the symbolic factorisation
                self._solver.reset()
                self._matrix.destroy()
            self._matrix = self._bodies.copy()
            different = PETSc.Mat.Structure.DIFFERENT_NONZERO_PATTERN
            self._matrix.axpy(1.0, self._contact, structure=different)
        else:
            subset = PETSc.Mat.Structure.SUBSET_NONZERO_PATTERN
            self._matrix.zeroEntries()
            for part in (self._bodies, self._contact):
                self._matrix.axpy(1.0, part, structure=subset)
        found = self._factorised()
        if self.single and not (found and self._trusted()):
            self.single = False
            self._solver.destroy()
            self._solver = self._new_solver(tangent.getComm())
            found = self._factorised()
        return found or self._factorised_with_shift()

    def solve(self, rest: Vec) -> Vec:
        """Correction of all unknowns for a residual; overwritten by the next call."""
        self._prolong.multTranspose(rest, self._right)
        self._solver.solve(self._right, self._left)
        self._prolong.mult(self._left, self._correction)
        return self._correction

    def destroy(self) -> None:
        """Give back PETSc's objects."""
        parts = (self._solver, self._matrix, self._bodies, self._contact, self._block)
        for part in (*parts, self._lift, self._prolong):
            if part is not None:
                part.destroy()

    def _new_solver(self, comm: object) -> PETSc.KSP:
        solver = PETSc.KSP().create(comm)
        solver.setOptionsPrefix(self._prefix)
        solver.setFromOptions()
        return solver

    def _factorised(self) -> bool:
        """Factorise the matrix; whether it has an inverse."""
        self._solver.setOperators(self._matrix)
        with Database(self._prefix, {"pc_precision": "single" if self.single else "double"}):
            self._solver.setUp()
        failed = self._solver.getPC().getFailedReason() != 0
        if failed:  # else every later factorisation would be said to have failed too
            check_memory(self._solver.getPC())
            self._solver.reset()
        return not failed

    def _factorised_with_shift(self) -> bool:
        """Factorise where motions of aggregates depend on each other, as those of few nodes may.

        Their combination moves nothing, so that any stiffness serves for it.

        Returns:
            Whether there are such motions alone that nothing holds.
        """
        assert self._matrix is not None
        diagonal = self._matrix.getDiagonal()
        diagonal.abs()
        self._matrix.shift(SHIFT * diagonal.max()[1])
        if not self._factorised():
            return False
        _set_any(self._right)
        self._solver.solve(self._right, self._left)
        self._prolong.mult(self._left, self._correction)
        return bool(self._correction.norm() <= AT_REST * self._left.norm())

    def _trusted(self) -> bool:
        """Whether the factor finds a known solution: of pivots that are rounding nothing tells."""
        assert self._matrix is not None
        known = self._left.duplicate()
        _set_any(known)
        self._matrix.mult(known, self._right)
        self._solver.solve(self._right, self._left)
        self._left.axpy(-1.0, known)
        error, size = self._left.norm(), known.norm()
        known.destroy()
        return bool(error <= TRUSTED * size)

    def _take_contact(self, tangent: Mat) -> None:
        """Set `E^T J_pp E`."""
        entries = tangent.getInfo(PETSc.Mat.InfoType.GLOBAL_SUM)["nz_used"]
        if entries != self._entries:
            self._entries, self._grown = entries, True
            for part in (self._block, self._contact):
                if part is not None:
                    part.destroy()
            self._block = self._contact = None
        self._block = tangent.createSubMatrix(self._patch, self._patch, self._block)
        self._contact = self._block.ptap(self._lift, self._contact)

    def _without_contact(self, tangent: Mat) -> Mat:
        """G, with a diagonal where neither the bodies nor contact have one."""
        whole = tangent.ptap(self._prolong)
        diagonal = np.abs(whole.getDiagonal().array_r)
        comm = tangent.getComm()
        largest = max(comm.tompi4py().allgather(float(diagonal.max(initial=0.0))))
        first, _ = whole.getOwnershipRange()
        idle = first + np.flatnonzero(diagonal <= IDLE * largest)
        own, _ = whole.getLocalSize()
        unit = sparse(own, own, comm, (idle, idle), np.full(len(idle), self._scale))
        self._take_contact(tangent)
        different = PETSc.Mat.Structure.DIFFERENT_NONZERO_PATTERN
        for factor, part in ((1.0, unit), (-1.0, self._contact)):
            whole.axpy(factor, part, structure=different)
        unit.destroy()
        return whole


def _set_any(vector: Vec) -> None:
    """Any numbers without symmetry, the same on any number of processes."""
    first, last = vector.getOwnershipRange()
    vector.array[:] = np.modf(np.arange(first, last) * 0.754877666)[0] - 0.5
