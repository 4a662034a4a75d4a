"""What SNES asks for in every iteration of Newton's method."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from anisocontact.base.fenicsx import SNES, Mat, PETSc, Vec
from anisocontact.solver.strategies.backtracking import Backtracking, Begun
from anisocontact.solver.strategies.mixed_search import MixedSearch
from anisocontact.solver.strategies.residual_history import PATIENCE, ResidualHistory
from anisocontact.solver.strategies.settled_contact import SettledContact
from anisocontact.solver.strategies.symmetric import check_symmetric
from anisocontact.solver.strategies.system import System
from anisocontact.solver.terms.contacts import Marks

#: Share of the elastic tangent where bodies flow, over the residual over the forces at work; the
#: most, and the least that is taken: near equilibrium tangents are exact, and convergence is
#: quadratic, as with the regularisation of [Levenberg 1944], which may fall with the residual
#: [Yamashita Fukushima 2001]. The first correction is exact as well, it comes from equilibrium.
ELASTIC_SHARE, MOST_ELASTIC, LEAST_ELASTIC = 0.3, 0.5, 1e-3


class NewtonIteration:
    """Residual, tangent, share of a correction and convergence, as callbacks of SNES.

    SNES refers to this object, which keeps no SNES: what a solver lets go of is gone at once.

    Args:
        system: The system of equations.
        on_iteration: Called with the number of the iteration and the residual.
        settled: Settles contact within a correction, where that pays.

    Attributes:
        search: The line search where multipliers follow.
        mixed: That where pressures do, and penalties press.
        mixes: Whether it is taken.
        patience: Corrections after which only a residual that falls is waited for.
    """

    def __init__(
        self,
        system: System,
        on_iteration: Callable[[int, float], None],
        settled: SettledContact,
    ) -> None:
        self._system, self._on_iteration, self._settled = system, on_iteration, settled
        self._damping: Callable[[], float] | None = None
        self.search, self.mixed, self.mixes = Backtracking(system), MixedSearch(system), False
        self.patience: float = PATIENCE
        self._history = ResidualHistory(system.contact_term, self.patience)

    @property
    def residuals(self) -> list[float]:
        """Residual over the forces at work, of the start and after each correction."""
        return self._history.residuals

    def damp_by(self, damping: Callable[[], float] | None, full: bool) -> None:
        """Take it that a solution begins.

        Args:
            damping: Asked before every correction what share of it is to be taken, 0 to 1.
            full: Whether corrections are to be taken in full.
        """
        self._damping, self.search.whole = damping, full

    def begin(self) -> None:
        """Take it that iterations begin, with the multipliers as they are."""
        self._history = ResidualHistory(self._system.contact_term, self.patience)
        self.search.begin()
        self.mixed.begin()

    def function(self, _: SNES, x: Vec, f: Vec) -> None:
        """Write the residual at `x` into `f`, for PETSc."""
        # An iterate far off overflows; it is judged by its residual, which is then no number.
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            known = self.search.evaluated(x)
            f.array[:] = self._system.evaluate(x) if known is None else known

    def jacobian(self, snes: SNES, x: Vec, matrix: Mat, _: Mat) -> None:
        """Write the tangent at `x`, for PETSc."""
        # on several processes PETSc would go on with the symbolic factorisation of the old pattern
        if self.tangent(snes, x, matrix) and self._system.comm.size > 1:
            snes.getKSP().reset()

    def tangent(self, snes: SNES, x: Vec, matrix: Mat) -> bool:
        """Write the tangent at `x`; whether its pattern has grown.

        Raises:
            InputError: It is not symmetric, and the factorisation of the options needs that.
        """
        self._system.take_elastic_share(self._elastic_share())
        try:
            with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
                grown = self._system.tangent(x, matrix)
        finally:
            self._system.take_elastic_share(0.0)
        check_symmetric(snes.getKSP(), matrix)
        return grown

    def _elastic_share(self) -> float:
        """Share of the elastic tangent in the next one where bodies flow.

        None where they are slender: a sheet that is wiped over a shoulder took 317 corrections for
        268 with it, before contact was settled, as it bends by flowing.
        """
        if len(self.residuals) < 2 or not self._system.contact_term.compact:
            return 0.0
        share = min(MOST_ELASTIC, ELASTIC_SHARE * self.residuals[-1])
        return share if share >= LEAST_ELASTIC else 0.0

    def damp(self, x: Vec, direction: Vec) -> bool:
        """Shorten a correction, for PETSc; whether it was."""
        share, changed = 1.0 if self._damping is None else self._damping(), False
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            if self._system.contact_term.simultaneous:
                begun, ends = Begun.of(self._system), self._settle(x, direction)
                share, changed = self.search.share(x, direction, share, begun, ends), bool(ends)
            elif self.mixes:
                share = self.mixed.share(x, direction, share)
        if share != 1.0:
            direction.scale(share)
        return share != 1.0 or changed

    def _settle(self, x: Vec, direction: Vec) -> Marks | None:
        """Where multipliers are at the end of a correction with settled contact; None of others."""
        if self._damping is not None or not self._settled.pays:
            return None
        contacts = self._system.contact_term
        with contacts.apart():
            return contacts.marks() if self._settled.settle(x, direction) else None

    def converged(
        self, snes: SNES, iteration: int, norms: tuple[float, float, float]
    ) -> PETSc.SNES.ConvergedReason:
        """Why to end, or to go on, for PETSc.

        Args:
            snes: Has the tolerances.
            iteration: Number of corrections.
            norms: Of the iterate, of the last correction and of the residual.
        """
        reasons = PETSc.SNES.ConvergedReason
        balance, contacts = self._system.balance, self._system.contact_term
        norm = balance.norm if contacts.simultaneous or balance.fields else norms[2]
        rtol, atol, _, _ = snes.getTolerances()
        fields = balance.of_fields(norm)
        relative = max(field.relative(rtol) for field in fields)
        self.residuals.append(relative)
        self._history.violations.append(norms[2])
        self._on_iteration(iteration, relative)
        if not np.isfinite(norm):
            return reasons.DIVERGED_FUNCTION_NANORINF
        small = balance.reached and all(field.small(rtol, atol) for field in fields)
        if small and contacts.consistent():
            return reasons.CONVERGED_FNORM_RELATIVE
        if self.mixes and self.mixed.stuck:
            return reasons.DIVERGED_LINE_SEARCH
        searching = snes.getLineSearch().getType() != PETSc.SNESLineSearch.Type.BASIC
        diverged = self._history.divergence(searching, self._damping is not None)
        return reasons.ITERATING if diverged is None else diverged
