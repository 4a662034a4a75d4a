"""Newton's method whose corrections are found by FGMRES."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import override

from anisocontact.base.fenicsx import SNES, Mat, PETSc, Vec
from anisocontact.solver.strategies.database import OptionValue
from anisocontact.solver.strategies.forcing import Forcing
from anisocontact.solver.strategies.iterative.defaults import DEFAULTS, MIXED
from anisocontact.solver.strategies.iterative.levels import Levels
from anisocontact.solver.strategies.iterative.mixed import MixedKrylov
from anisocontact.solver.strategies.iterative.patch import Patch
from anisocontact.solver.strategies.newton import Newton, NewtonResult
from anisocontact.solver.strategies.stability import least_eigenvalue, may_buckle
from anisocontact.solver.system.problem import Problem
from anisocontact.solver.terms.step import Step

#: Residual of a correction over its right-hand side, at most, and over the forces out of balance
#: where multipliers follow: of linear bodies that supports hold, which take as many iterations as
#: with those of others, and a tenth more with 1e-1; and of others. At finite strain 1e-2 takes a
#: twentieth more, and where contact alone holds a body up to 2.6 times as many.
OF_LINEAR, OF_OTHERS = (1e-2, 1e-5), (1e-4, 1e-8)
#: Residual over the forces at work beyond which bodies may come to be quite different ones.
FAR = 0.1
#: Solutions without convergence after which the log says what else there is.
TOLD = 3


class IterativeNewton(Newton):
    """SNES with FGMRES and levels, see `Levels`.

    A correction is as precise as Newton's next residual asks for, see `Forcing`.

    Args:
        problem: The problem.
        steps: What will be done.
        prefix: Prefix of the PETSc options.
        options: PETSc options without prefix; those already in the PETSc database come first.
        on_iteration: Called with the number of the iteration and the residual.
        note: Called with lines for the log.

    Attributes:
        krylov: Krylov iterations of every correction so far.
    """

    def __init__(
        self,
        problem: Problem,
        steps: Sequence[Step],
        prefix: str,
        options: Mapping[str, OptionValue],
        on_iteration: Callable[[int, float], None],
        note: Callable[[str], None],
    ) -> None:
        super().__init__(problem, prefix, DEFAULTS | dict(options), on_iteration)
        self.krylov: list[int] = []
        self._note, self._nodal = note, problem
        self._failures, self._may_buckle = 0, may_buckle(problem)
        self._forcing = self._new_forcing()
        given = [*options, *PETSc.Options(prefix).getAll()]
        self._adapts = "ksp_rtol" not in given
        self._asked = any(name.startswith("ksp_") for name in given)
        self.snes.setJacobian(self._jacobian)
        ksp = self.snes.getKSP()
        ksp.setPostSolve(self._count)
        self._levels: Levels | None = None
        self._lags = True
        if ksp.getPC().getType() == PETSc.PC.Type.PYTHON:
            self._levels = Levels(problem, Patch(problem, steps), prefix, note)
            ksp.getPC().setPythonContext(self._levels)
            if not self._asked:
                self._solve_mixed(self._levels, prefix)

    def solve(
        self, x: Vec, full_steps: bool = False, damping: Callable[[], float] | None = None
    ) -> NewtonResult:
        """See `Newton.solve`."""
        self._forcing = self._new_forcing()
        if self._levels is not None:
            self._levels.begin(lags=self._lags)
        result = super().solve(x, full_steps, damping)
        if self.snes.getKSP().getConvergedReason() < 0:
            self._failures += 1
            if self._failures == TOLD:
                self._note(
                    f"the Krylov method has not converged in {TOLD} solutions: "
                    'if the bodies are held, take the strategy "direct"'
                )
        return result

    def _new_forcing(self) -> Forcing:
        """How precise corrections of an increment are."""
        held = self._nodal.linear and not self._nodal.stabilisation.watches
        rough, fine = OF_LINEAR if held else OF_OTHERS
        return Forcing(self.snes.getTolerances()[0], rough, rough, fine)

    def _solve_mixed(self, levels: Levels, prefix: str) -> None:
        """Solve for pressures, too, where bodies all but keep their volume."""
        problem, ksp = self._nodal, self.snes.getKSP()
        volume = problem.bulk.volume
        # moments of faces that follow rigid bodies are beyond what pressures are handed to
        if volume is None or problem.bulk.hardness < MIXED or problem.coupled:
            return
        with self._database:
            mixed = MixedKrylov(problem, volume, levels, prefix, self._note)
        ksp.setType(PETSc.KSP.Type.PYTHON)
        ksp.setPythonContext(mixed)
        self._lags = False  # pressures of now need bodies of now
        ksp.getPC().setType(PETSc.PC.Type.NONE)

    def close(self) -> None:
        """Give back PETSc's objects."""
        if self.krylov:
            mean = sum(self.krylov) / len(self.krylov)
            self._note(
                f"Krylov iterations of {len(self.krylov)} corrections: "
                f"{mean:.1f} on average, at most {max(self.krylov)}"
            )
        if self._levels is not None:
            self._levels.close()
        super().close()

    @override
    def _equilibrium(self, x: Vec) -> NewtonResult:
        """As of `Newton`, with a factor of all unknowns from where the levels lead nowhere on."""
        result = super()._equilibrium(x)
        if self._levels is not None and self._levels.lagging and self._exhausted:
            self._lags = False
            self._levels.begin(lags=False)
            result = self._again(x, result)
        if self._levels is None or self._asked or not self._exhausted:
            return result
        count = self.krylov[-1]
        if self._levels.give_up():
            return result
        self._note(
            f"the Krylov method has not converged in {count} iterations, as with bodies that keep "
            'their volume: all unknowns are factorised from now on, as "direct" does'
        )
        return self._again(x, result)

    @override
    def _unstable(self) -> bool:
        if self._levels is None:
            return super()._unstable()
        tangent, _ = self.snes.getKSP().getOperators()
        return self._may_buckle and least_eigenvalue(tangent, self._levels.solve) < 0.0

    def _again(self, x: Vec, before: NewtonResult) -> NewtonResult:
        """Go on from where the last try has ended, with its iterations counted."""
        result = super()._equilibrium(x)
        return replace(result, iterations=before.iterations + result.iterations)

    @property
    def _exhausted(self) -> bool:
        """Whether the last solution has taken all iterations that there are, for nothing."""
        reason = self.snes.getKSP().getConvergedReason()
        return bool(reason == PETSc.KSP.ConvergedReason.DIVERGED_MAX_IT)

    def _jacobian(self, snes: SNES, x: Vec, matrix: Mat, other: Mat) -> None:
        self._iteration.jacobian(snes, x, matrix, other)
        if self._levels is not None and self._iteration.residuals[-1] > FAR:
            self._levels.begin(lags=self._lags)
        if self._adapts:
            size = snes.getFunction()[0].norm()
            snes.getKSP().setTolerances(rtol=self._forcing.rtol(self._problem, size))

    def _count(self, ksp: PETSc.KSP, _: Vec, __: Vec) -> None:
        self.krylov.append(ksp.getIterationNumber())
        if self._levels is not None:
            self._levels.count(self.krylov[-1])

    def _explain(self, reason: int) -> str:
        if reason != PETSc.SNES.ConvergedReason.DIVERGED_LINEAR_SOLVE:
            return super()._explain(reason)
        ksp = self.snes.getKSP()
        if ksp.getConvergedReason() == PETSc.KSP.ConvergedReason.DIVERGED_PCSETUP_FAILED:
            return "the coarse level could not be factorised (a body without support?)"
        return f"the Krylov method did not converge in {ksp.getIterationNumber()} iterations"
