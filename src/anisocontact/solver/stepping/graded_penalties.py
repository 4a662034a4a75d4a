"""Continuation in the penalty: equilibrium with soft penalties, which are raised to those given.

The active set of stiff penalties on a slender body, which bends, changes by a point at the edge of
the contact in each correction, and points that slip change sides. Soft ones spread the pressure
over all points that will touch: most have their status when penalties are those of the law.

Adhesion has to be so soft to begin with that the points stick: where their elastic force is beyond
friction in the first corrections all of them slip, and go on slipping to and fro.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import sqrt

from anisocontact.base.fenicsx import Vec
from anisocontact.contact import Contact
from anisocontact.solver.strategies.newton import NewtonResult
from anisocontact.solver.strategies.strategy import IncrementSolver

#: Share of the penalties to begin with; what they are raised by, and the least after failures.
SOFT, RAISE, LEAST = 1e-4, 10.0, 1.5


class GradedPenalties:
    """Solves with soft penalties first, then with stiffer ones, up to those of the laws.

    Args:
        contacts: The contacts of a problem.
        newton: Its solver.
    """

    def __init__(self, contacts: Sequence[Contact], newton: IncrementSolver) -> None:
        self._all = contacts
        self._newton = newton

    @property
    def contacts(self) -> list[Contact]:
        """Those whose penalties can be softened, the same on all ranks."""
        return [contact for contact in self._all if contact.trials.by_penalty]

    def solve(self, x: Vec) -> NewtonResult:
        """Correct `x` until it is in equilibrium with the laws as they are, or no more can be done.

        Where a raise is too large a smaller one is tried, its square root.

        Args:
            x: Start, overwritten by the last iterate, length.

        Returns:
            What came of it; contacts have the penalties of their laws.
        """
        try:
            return self._raised(x)
        finally:
            self._take(1.0)

    def _raised(self, x: Vec) -> NewtonResult:
        share, raised, spent, known = SOFT, RAISE, 0, 0.0
        last = x.copy()
        while True:
            self._take(share)
            result = self._newton.solve(x, full_steps=True)
            spent += result.iterations
            if not result.reason:
                if share == 1.0:
                    break
                known = share
                x.copy(last)
            elif known == 0.0 or sqrt(raised) < LEAST:
                break
            else:
                raised = sqrt(raised)
                last.copy(x)
            share = min(raised * known, 1.0)
        last.destroy()
        return replace(result, iterations=spent)

    def _take(self, share: float) -> None:
        for contact in self.contacts:
            contact.trials.soften_laws(share)
