"""Factor of the coarsest level, or multigrid where it would not fit into memory.

The factor is in single precision, in half of the memory and of the time, while that tells stiff
contacts from soft bodies: Krylov iterations need no more of a preconditioner. In units in which
its numbers are near the ends of single precision it is the factor of a multiple.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from anisocontact.base.fenicsx import MPI, Mat, PETSc, Vec
from anisocontact.base.petsc_calls import check_memory
from anisocontact.solver.strategies.binary_scale import binary_scale
from anisocontact.solver.strategies.costs import factor_bytes, too_large
from anisocontact.solver.strategies.database import Database, OptionValue
from anisocontact.solver.strategies.iterative.split import set_any

#: Options of the solver: of a factor, and where there is no room for one.
FACTORISED: dict[str, OptionValue] = {
    "ksp_type": "preonly",
    "pc_type": "lu",
    "pc_factor_mat_solver_type": "mumps",
}
ITERATED: dict[str, OptionValue] = {
    "ksp_type": "gmres",
    "ksp_rtol": 1e-2,
    "ksp_atol": 0.0,
    "ksp_max_it": 30,
}
#: Error of a known solution, over it, up to which a factor in single precision is trusted.
TRUSTED = 0.05
#: Largest entry, and one over it, beyond which it is brought to one: between 1 and 3e38, the end of
#: single precision.
LARGE = 1e15
#: Stiffness against motions of the aggregates that depend on each other, over the largest one.
SHIFT = 1e-9
#: Share of such a motion that is left of it in the bodies, up to which they are at rest.
AT_REST = 1e-3


class Factor:
    """Inverse of a matrix by factorisation; approximate, by multigrid, if there is no room for it.

    Args:
        matrix: The matrix, which is overwritten in place from one tangent to the next.
        prolongs: Interpolations from here to all unknowns, the finest one last.
        prefix: Prefix of the options of the solver.
        single: Whether it is in single precision, where this PETSc can.
        note: Called with a line where there is no room.

    Attributes:
        single: Whether it still is: from where that is not enough on it is in double precision.
    """

    def __init__(
        self,
        matrix: Mat,
        prolongs: Sequence[Mat],
        prefix: str,
        single: bool,
        note: Callable[[str], None],
    ) -> None:
        self.single, self._prefix, self._prolongs = single, prefix, prolongs
        self._matrix, self._options = matrix, FACTORISED
        chosen = "pc_type" in PETSc.Options(prefix).getAll()
        reason = "" if chosen else _no_room(matrix)
        self._exact = not reason
        if reason:
            kind = "hypre" if PETSc.Sys.hasExternalPackage("hypre") else "gamg"
            self._options = ITERATED | {"pc_type": kind}
            note(f"{reason}: it is solved by GMRES with {kind}")
        self._solver = self._new_solver()
        self._right, self._left = matrix.createVecs()
        self._binary = 1.0
        self._scaled: Mat | None = None

    def renew(self, matrix: Mat, grown: bool, bodies: bool) -> bool:
        """See `Inverse.renew`."""
        if grown:  # on several processes PETSc would keep the symbolic factorisation
            self._solver.reset()
        self._matrix = self._in_range(matrix)
        found = self._factorised()
        if self._exact and self.single and not (found and self._trusted()):
            self.single = False
            self._solver.destroy()
            self._solver = self._new_solver()
            found = self._factorised()
        return found or self._factorised_with_shift()

    def solve(self, right: Vec) -> Vec:
        """Solution for a right-hand side; overwritten by the next call."""
        self._solver.solve(right, self._left)
        if self._binary != 1.0:
            self._left.scale(self._binary)
        return self._left

    def destroy(self) -> None:
        """Give back PETSc's objects."""
        self._solver.destroy()
        if self._scaled is not None:
            self._scaled.destroy()

    def _in_range(self, matrix: Mat) -> Mat:
        """The matrix, or a multiple of it whose numbers are in the range of single precision."""
        diagonal = matrix.getDiagonal()
        diagonal.abs()
        largest = float(diagonal.max()[1])
        if self._scaled is not None:
            self._scaled.destroy()
            self._scaled = None
        self._binary = 1.0 if 1.0 / LARGE < largest < LARGE else binary_scale(largest)
        if self._binary == 1.0:
            return matrix
        self._scaled = matrix.copy()
        self._scaled.scale(self._binary)
        return self._scaled

    def _new_solver(self) -> PETSc.KSP:
        solver = PETSc.KSP().create(self._matrix.getComm())
        solver.setOptionsPrefix(self._prefix)
        with Database(self._prefix, self._options):
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
        diagonal = self._matrix.getDiagonal()
        diagonal.abs()
        self._matrix.shift(SHIFT * diagonal.max()[1])
        if not self._factorised():
            return False
        set_any(self._right)
        self._solver.solve(self._right, self._left)
        motion = self._left
        for prolong in self._prolongs:
            finer = prolong.createVecLeft()
            prolong.mult(motion, finer)
            motion = finer
        return bool(motion.norm() <= AT_REST * self._left.norm())

    def _trusted(self) -> bool:
        """Whether the factor finds a known solution: of pivots that are rounding nothing tells."""
        known = self._left.duplicate()
        set_any(known)
        self._matrix.mult(known, self._right)
        self._solver.solve(self._right, self._left)
        self._left.axpy(-1.0, known)
        error, size = self._left.norm(), known.norm()
        known.destroy()
        return bool(error <= TRUSTED * size)


def _no_room(matrix: Mat) -> str:
    """Why its factor would not fit, in the words of the first process that says so; collective.

    Processes of one machine share its memory. Contact fills what is in single precision so that it
    takes what an ordinary system takes in double precision.
    """
    comm = matrix.getComm().tompi4py()
    beside = comm.Split_type(MPI.COMM_TYPE_SHARED)
    needed = factor_bytes(matrix.getSize()[0]) * beside.size / comm.size
    beside.Free()
    found = comm.allgather(next(too_large("a factor of the coarse level", needed), ""))
    return next(filter(None, found), "")
