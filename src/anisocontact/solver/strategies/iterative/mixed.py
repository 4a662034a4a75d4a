"""FGMRES on displacements and pressures, where bodies all but keep their volume.

With pressures eliminated in cells the tangent is `J = A + B^T C^-1 B`, whose eigenvalues spread as
C goes to zero: smoothers and aggregates know motions, not that volume is kept. In the mixed form,
where pressures are unknowns of their own, what is left of C is harmless [Benzi Golub Liesen 2005,
sections 5 and 10], and the levels serve for bodies that give way more.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.fenicsx import Mat, PETSc, Vec
from anisocontact.base.form_matrix import add_matrix
from anisocontact.bulk.pressures import OF_BOTH, CellPressures
from anisocontact.solver.strategies.costs import factor_bytes, too_large
from anisocontact.solver.strategies.iterative.levels import Levels
from anisocontact.solver.strategies.krylov_backoff import KrylovBackoff
from anisocontact.solver.strategies.notes import without_repeats
from anisocontact.solver.strategies.whole import WholeLU
from anisocontact.solver.system.problem import Problem

#: Stiffness against changes of volume over the rest, at most: of the bodies that the levels are
#: given, and of what pressures give way by in the Schur complement, beside those.
SOFT, GIVING = 1.0, 0.5
#: Pressures far from a solution are many times the shear modulus, and under them bodies that are
#: softened have no stiffness against some changes of shape. They keep more where a pressure is
#: more than about a fifth of the modulus, and all of it where it is five times that.
STRAINED = 30.0


class DisplacementPressureForm:
    """The mixed form with unknowns u and s, and what preconditions it, as contexts of PETSc.

    By s pressures are off what displacements say: `p = (1 - t) C^-1 B u + s`, where a share t of
    each stays with the displacements. The equations are

        J u + B^T s = b,  s = 0,

    and the preconditioner is that of `J_0 = J - B^T (1 - t) C^-1 B`, of bodies that are softened,
    by levels, with the Schur complement of the pressures as a multiple of C. Pressures are counted
    with the forces that they make, see `OF_BOTH`.

    Args:
        problem: The problem.
        volume: Changes of volume of its bodies.

    Attributes:
        sizes: Forces that pressures of one count for, (pressures,).
    """

    def __init__(self, problem: Problem, volume: CellPressures) -> None:
        self._problem, self._volume = problem, volume
        self._bodies, self._pressures = volume.slope.createVecs()
        self._u, self._f = problem.new_vector(), problem.new_vector()
        self._n, self._m = self._u.getLocalSize(), self._bodies.getLocalSize()
        self._hard = np.maximum(volume.hardnesses, np.finfo(np.float64).tiny)
        none = np.zeros_like(self._hard)
        self._beyond, self._schur = none, none
        self.sizes = np.ones_like(none)
        self._tangent: Mat | None = None
        self._softened: Mat | None = None

    @property
    def softened(self) -> Mat:
        """`J_0` of the last tangent."""
        assert self._softened is not None
        return self._softened

    def new_vector(self) -> Vec:
        """Vector of both unknowns."""
        vector = PETSc.Vec().create(self._problem.comm)
        vector.setSizes((self._n + len(self._hard), None))
        vector.setType(PETSc.Vec.Type.STANDARD)
        return vector

    def take(self, tangent: Mat) -> None:
        """Take over the tangent J that has been written last."""
        self._tangent = tangent
        # what is linear has no stiffness of stresses
        strains = 0.0 if self._problem.linear else self._volume.strains()
        wild = (STRAINED * self._hard * strains) ** 2
        kept = np.minimum(SOFT * (1.0 + wild) / self._hard, 1.0)
        self._beyond = 1.0 - kept
        self._schur = self._beyond / (1.0 + self._beyond / (kept + GIVING / self._hard))
        beyond = self._volume.stiffness_beyond(kept)
        inside = tangent.duplicate()
        inside.setOption(PETSc.Mat.Option.KEEP_NONZERO_PATTERN, True)
        add_matrix(inside, beyond)
        inside.assemble()
        self._problem.constraints.transform(inside, 0.0)
        first, _ = tangent.getOwnershipRange()
        inside.zeroRows((first + self._problem.constrained()).astype(PETSc.IntType), 0.0)
        before, self._softened = self._softened, tangent.copy()
        self._softened.axpy(-1.0, inside, structure=PETSc.Mat.Structure.SUBSET_NONZERO_PATTERN)
        for part in (before, inside, beyond):
            if part is not None:
                part.destroy()
        self.sizes = self._volume.force_sizes()

    def mult(self, _: Mat, x: Vec, y: Vec) -> None:
        """The mixed form times unknowns, for PETSc."""
        assert self._tangent is not None
        given, n = x.array_r, self._n
        self._u.array[:] = given[:n]
        self._tangent.mult(self._u, self._f)
        y.array[:n] = self._f.array_r + self._forces(given[n:] / self.sizes)
        y.array[n:] = given[n:]

    def preconditioned(self, right: Floats, u: Floats) -> Floats:
        """Both unknowns from those of the displacements, (n + pressures,).

        Args:
            right: Right-hand side, (n + pressures,).
            u: What the levels find for its part of the displacements, (n,).
        """
        off = right[self._n :] / self.sizes
        self._bodies.array[:] = u[: self._m]
        self._volume.slope.mult(self._bodies, self._pressures)
        says = self._volume.stiffened(self._pressures.array_r)
        pressures = self._schur * (says + off / np.where(self._beyond > 0.0, self._beyond, 1.0))
        return np.concatenate([u, self.sizes * (pressures - self._beyond * says)])

    def _forces(self, pressures: Floats) -> Floats:
        """`B^T s` as the equations have it, empty where unknowns are prescribed, (n,)."""
        self._pressures.array[:] = pressures
        self._volume.slope.multTranspose(self._pressures, self._bodies)
        forces = np.zeros(self._n)
        forces[: self._m] = self._problem.constraints.handed(np.array(self._bodies.array_r))
        forces[self._problem.constrained()] = 0.0
        return forces


class MixedLevels:
    """Preconditioner of the mixed form, as a Python context of PETSc.

    Args:
        form: The mixed form.
        levels: Preconditioner of the bodies that are softened.
        like: Vector of the displacements.
    """

    def __init__(self, form: DisplacementPressureForm, levels: Levels, like: Vec) -> None:
        self._form, self._levels = form, levels
        self._rest, self._u = like, like.duplicate()

    def apply(self, _: PETSc.PC, b: Vec, x: Vec) -> None:
        """Levels for the displacements, what they say of the pressures, and what is off."""
        right = b.array_r
        self._rest.array[:] = right[: self._rest.getLocalSize()]
        self._levels.solve(self._rest, self._u)
        x.array[:] = self._form.preconditioned(right, self._u.array_r)


class MixedKrylov:
    """Krylov method of SNES that solves the mixed form, as a Python context of PETSc.

    Args:
        problem: The problem.
        volume: Changes of volume of its bodies.
        levels: Preconditioner of tangents.
        prefix: Prefix of the options of the Krylov method.
        note: Called with a line the first time that all unknowns are factorised.
    """

    def __init__(
        self,
        problem: Problem,
        volume: CellPressures,
        levels: Levels,
        prefix: str,
        note: Callable[[str], None],
    ) -> None:
        self._count, self._comm = problem.solved_for, problem.comm
        self._note = without_repeats(note)
        self._form = DisplacementPressureForm(problem, volume)
        self._levels, self._backoff = levels, KrylovBackoff()
        self._right, self._found = self._form.new_vector(), self._form.new_vector()
        size = self._right.getSizes()
        matrix = PETSc.Mat().createPython((size, size), self._form, problem.comm)
        preconditioner = MixedLevels(self._form, levels, problem.new_vector())
        self._krylov = PETSc.KSP().create(problem.comm)
        self._krylov.setOptionsPrefix(prefix)
        self._krylov.setFromOptions()
        self._krylov.setOperators(matrix)
        self._krylov.getPC().setType(PETSc.PC.Type.PYTHON)
        self._krylov.getPC().setPythonContext(preconditioner)

    def solve(self, ksp: PETSc.KSP, b: Vec, x: Vec) -> None:
        """Solution for a right-hand side, for PETSc."""
        tangent, _ = ksp.getOperators()
        failed = PETSc.KSP.ConvergedReason.DIVERGED_MAX_IT
        reason = int(failed)
        if not (self._backoff.skips() and self._room()):
            reason = self._iterate(ksp, tangent, b, x)
            self._backoff.add(float(reason == failed), 0.5)
        if reason == failed and self._room():
            reason = self._factorise(tangent, b, x)
        ksp.setConvergedReason(reason)

    def _factorise(self, tangent: Mat, b: Vec, x: Vec) -> int:
        """Solution by a factorisation of all unknowns; how it has ended."""
        whole = WholeLU()
        found = whole.solve(tangent, b.array_r)
        whole.close()
        if found is None:
            return int(PETSc.KSP.ConvergedReason.DIVERGED_PCSETUP_FAILED)
        x.array[:] = found
        return int(PETSc.KSP.ConvergedReason.CONVERGED_ITS)

    def _iterate(self, ksp: PETSc.KSP, tangent: Mat, b: Vec, x: Vec) -> int:
        """Krylov iterations with the levels; the reason of their end."""
        self._form.take(tangent)
        if not self._levels.take(self._form.softened):
            return int(PETSc.KSP.ConvergedReason.DIVERGED_PCSETUP_FAILED)
        krylov, n = self._krylov, b.getLocalSize()
        rtol, *others = ksp.getTolerances()
        krylov.setTolerances(rtol / OF_BOTH, *others)
        self._right.zeroEntries()
        self._right.array[:n] = b.array_r
        krylov.solve(self._right, self._found)
        ksp.setIterationNumber(krylov.getIterationNumber())
        x.array[:] = self._found.array_r[:n]
        return int(krylov.getConvergedReason())

    def _room(self) -> bool:
        """Whether there is room for a factor of all unknowns; said the first time."""
        what = f"a factorisation of {self._count} unknowns"
        full = next(too_large(what, factor_bytes(self._count)), "")
        if any(self._comm.allgather(full)):
            return False
        self._note(
            "the Krylov method does not find every correction of bodies that keep their volume: "
            'all unknowns are factorised for those that it does not find, as "direct" does'
        )
        return True

    def destroy(self, _: Any = None) -> None:
        """Give back PETSc's objects."""
        self._krylov.destroy()
