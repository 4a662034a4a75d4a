"""Newton's method on all unknowns whose corrections come from an old factor and GMRES."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, override

import numpy as np

from anisocontact.base.fenicsx import SNES, Mat, PETSc, Vec
from anisocontact.solver.strategies.condensed.kept_stiffness import KeptStiffness
from anisocontact.solver.strategies.condensed.lagged import LaggedFactor
from anisocontact.solver.strategies.database import OptionValue
from anisocontact.solver.strategies.forcing import Forcing
from anisocontact.solver.strategies.newton import Newton, NewtonResult
from anisocontact.solver.strategies.stability import least_eigenvalue, may_buckle
from anisocontact.solver.system.problem import Problem
from anisocontact.solver.terms.persistent import Arrays

#: Residual of a correction over its right-hand side, far from the solution: ten times rougher,
#: points of a stiff contact end an iteration in another status, and iterations are more.
ROUGH = 1e-3
#: The same where the last one has gained next to nothing: 1e-5 takes a tenth more Krylov iterations
#: and as many of Newton's method.
CAREFUL = 1e-4
#: The linear system is solved by `LaggedNewton.apply`.
LINEAR: dict[str, OptionValue] = {"ksp_type": "preonly", "pc_type": "python"}


class LaggedNewton(Newton):
    """SNES as `direct` has it, with inexact corrections by a `LaggedFactor`.

    Residual, tangent and line search are those of `direct`.

    Args:
        problem: The problem.
        prefix: Prefix of the PETSc options.
        options: PETSc options of SNES without prefix.
        on_iteration: Called with the number of the iteration and the residual.
        note: Called with lines for the log.
        kept: What `persistent` gave of a run that goes on; nothing for one that begins.
    """

    def __init__(
        self,
        problem: Problem,
        prefix: str,
        options: Mapping[str, OptionValue],
        on_iteration: Callable[[int, float], None],
        note: Callable[[str], None],
        kept: Arrays,
    ) -> None:
        super().__init__(problem, prefix, dict(options) | LINEAR, on_iteration)
        self._note = note
        self._system, self._stiffness = problem, KeptStiffness(problem)
        self._factor = LaggedFactor(problem, note, kept)
        self._forcing = Forcing(self.snes.getTolerances()[0], ROUGH, CAREFUL)
        self._may_buckle = may_buckle(problem)
        pc = self.snes.getKSP().getPC()
        pc.setType(PETSc.PC.Type.PYTHON)
        pc.setPythonContext(self)
        self.snes.setJacobian(self._jacobian)

    @override
    def solve(
        self, x: Vec, full_steps: bool = False, damping: Callable[[], float] | None = None
    ) -> NewtonResult:
        self._forcing.begin(self._system.in_full)
        self._stiffness.begin()
        return super().solve(x, full_steps, damping)

    @override
    def persistent(self) -> Arrays:
        return self._factor.persistent()

    @override
    def close(self) -> None:
        krylov = self._factor.krylov
        if krylov:
            self._note(
                f"{self._factor.factors} factorisations for {len(krylov)} corrections; Krylov "
                f"iterations of a correction: {np.mean(krylov):.1f} on average, at most "
                f"{max(krylov)}; tangents of the bodies: {self._stiffness.made}"
            )
        self._factor.close()
        super().close()

    def apply(self, pc: Any, b: Vec, x: Vec) -> None:
        """Newton correction, for PETSc: a preconditioner that is the solution."""
        tangent, _ = pc.getOperators()
        right = np.array(b.array_r)
        (size,) = self._system.layout.norms(right)
        rtol = self._forcing.rtol(self._problem, size)
        found = self._factor.solve(tangent, right, rtol)
        if found is None:
            pc.setFailedReason(PETSc.PC.FailedReason.FACTOR_NUMERIC_ZEROPIVOT)
            found = np.zeros(len(right))
        x.array[:] = found

    @override
    def _unstable(self) -> bool:
        inverse = self._factor.inverse() if self._may_buckle else None
        if inverse is None:
            return False
        tangent, _ = self.snes.getKSP().getOperators()
        return least_eigenvalue(tangent, inverse) < 0.0

    def _jacobian(self, snes: SNES, x: Vec, matrix: Mat, _: Mat) -> None:
        self._system.evaluate_at(x)
        iteration = self._iteration
        with self._stiffness.chosen(lasting=not iteration.search.whole):
            grown = iteration.tangent(snes, x, matrix)
        if grown:
            self._factor.outgrow()
