"""The forces of a problem at a state of all unknowns."""

from __future__ import annotations

from anisocontact.base.fenicsx import Vec
from anisocontact.solver.system.assembly import Assembly
from anisocontact.solver.system.configuration import Configuration
from anisocontact.solver.system.force_balance import ForceBalance


class Evaluation:
    """Brings the bodies of a problem to states, and sums the forces there.

    Args:
        assembly: The terms.
        bodies: Where the bodies are.

    Attributes:
        balance: Forces of the last state.
    """

    def __init__(self, assembly: Assembly, bodies: Configuration) -> None:
        self._assembly, self._bodies = assembly, bodies
        self.balance = ForceBalance.none(assembly.layout.owned)

    def evaluate(self, x: Vec) -> ForceBalance:
        """Forces at a state of all unknowns, length; see `Problem.evaluate`."""
        self.balance = self._assembly.balance(self._bodies.take(x))
        return self.balance

    def at(self, x: Vec) -> ForceBalance:
        """The same, evaluated anew unless the state is that of the last one; collective."""
        return self.balance if self._bodies.is_at(x) else self.evaluate(x)
