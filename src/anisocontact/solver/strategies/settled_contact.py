"""Corrections with contact in equilibrium where the bodies answer as their tangent says."""

from __future__ import annotations

import numpy as np

from anisocontact.base.fenicsx import SNES, PETSc, Vec
from anisocontact.base.petsc_calls import forget_failure
from anisocontact.solver.strategies.backtracking import Backtracking
from anisocontact.solver.strategies.system import System
from anisocontact.solver.terms.term import SingularError

#: Forces out of balance, over the most on the way, at which contact is settled.
SETTLED = 1e-3
#: Corrections of contact after which it is left to Newton's method as it is.
MOST = 20


class SettledContact:
    """Newton's method for generalised equations: only what is smooth is linear in a correction.

    Bodies answer by their last force and tangent, while laws and multipliers of contact are those
    of where a correction leads, until these forces are in balance [Josephy 1979]. A correction by
    the tangent alone keeps points in contact that a body leaves as it is let go: it is pulled along
    as far as the other goes, and metal flows there that does not flow in the end.

    Args:
        system: What is solved.
        snes: Has its tangent, and what solves with that; a weak reference does.
    """

    def __init__(self, system: System, snes: SNES) -> None:
        self._system, self._snes = system, snes

    @property
    def pays(self) -> bool:
        """Whether bodies touch that yield, and multipliers follow, which can go back."""
        contacts = self._system.contact_term
        return contacts.plastic and contacts.simultaneous and contacts.retraceable

    def settle(self, x: Vec, correction: Vec) -> bool:
        """Bring a correction to where contact is settled, and the multipliers with it.

        Args:
            x: Where the system was evaluated last.
            correction: What is to be subtracted from it; overwritten where that changes anything.

        Returns:
            Whether it does. Trials were none of Newton's, see `Contacts.apart`.
        """
        system, largest = self._system, self._system.balance.norm
        statuses = system.contact_term.statuses()
        search, there, residual = Backtracking(system), x.copy(), x.duplicate()
        last, total = correction.copy(), correction.copy()
        total.zeroEntries()
        with system.linearised():
            for i in range(MOST):
                share = search.share(there, last, 1.0)
                last.scale(share)
                there.axpy(-1.0, last)
                total.axpy(1.0, last)
                known = search.evaluated(there)
                residual.array[:] = system.evaluate(there) if known is None else known
                norm = system.balance.norm
                # at the start what is prescribed has moved, and all else may be in balance still
                largest = max(largest, norm)
                unchanged = i == 0 and share == 1.0 and system.contact_term.same(statuses)
                if unchanged or not np.isfinite(norm):
                    return False
                if norm < SETTLED * largest:
                    total.copy(correction)
                    return i > 0
                if not self._solve(there, residual, last):
                    return False
        return False

    def _solve(self, x: Vec, residual: Vec, correction: Vec) -> bool:
        """The next correction of contact; whether there is one."""
        ksp = self._snes.getKSP()
        matrix, _ = ksp.getOperators()
        try:
            self._snes.computeJacobian(x, matrix)
            ksp.setOperators(matrix, matrix)
            ksp.solve(residual, correction)
        except PETSc.Error as error:
            if isinstance(error.__cause__, SingularError):
                return False
            raise
        if ksp.getConvergedReason() < 0:
            forget_failure(ksp)
            return False
        return True
