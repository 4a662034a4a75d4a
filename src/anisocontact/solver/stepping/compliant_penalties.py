"""Penalties by way of multipliers, which keep their compliance, see `contact.compliant`.

Under a force that turns round points slide to and fro: a correction says nothing of what a force
less than friction moves. Multipliers remember where such a point stuck. What they lead to has to be
an equilibrium of the penalties as well.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from anisocontact.base.fenicsx import Vec
from anisocontact.contact import Contact
from anisocontact.solver.strategies.newton import NewtonResult
from anisocontact.solver.strategies.strategy import IncrementSolver


def comply(contacts: Sequence[Contact]) -> None:
    """Let multipliers stand for the penalties of contacts, until `Contact.trials.take_away`."""
    for contact in contacts:
        contact.trials.comply(contact.body_stiffness, contact.facet_size)


def as_they_are(before: NewtonResult, x: Vec, newton: IncrementSolver) -> NewtonResult:
    """Go on to an equilibrium of the laws as they are, from one with what is easier.

    Args:
        before: What came of that.
        x: Its state, overwritten by the last iterate, length.
        newton: The solver.

    Returns:
        What came of both; what came of the easier one if that failed.
    """
    if before.reason:
        return before
    final = newton.solve(x, full_steps=True)
    return replace(final, iterations=before.iterations + final.iterations)


class CompliantPenalties:
    """Solves with multipliers for penalties first, then with the penalties.

    Args:
        contacts: The contacts of a problem.
        newton: Its solver.
    """

    def __init__(self, contacts: Sequence[Contact], newton: IncrementSolver) -> None:
        self._all = contacts
        self._newton = newton

    @property
    def contacts(self) -> list[Contact]:
        """Those whose penalties multipliers can lead to, the same on all ranks."""
        return [contact for contact in self._all if contact.trials.penalised]

    def solve(self, x: Vec) -> NewtonResult:
        """Correct `x` until it is in equilibrium with the laws as they are, or no more can be done.

        Args:
            x: Start, overwritten by the last iterate, length.

        Returns:
            What came of it; contacts have their penalties alone.
        """
        contacts = self.contacts
        comply(contacts)
        try:
            easier = self._newton.solve(x)
        finally:
            for contact in contacts:
                contact.trials.take_away()
        return as_they_are(easier, x, self._newton)
