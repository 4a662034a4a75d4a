"""When the tangent of the bodies that a correction began with is good enough for the next one."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from anisocontact.solver.system.problem import Problem

#: Share of the forces out of balance that is due to a tangent of the bodies before it is made anew.
SHARE = 0.1


class KeptStiffness:
    """Keeps the tangent of the bodies while it is contact that is out of balance.

    Forces in the bodies say what their last tangent has missed. Where that is a small share of what
    is out of balance, the next correction would gain next to nothing by one of now.

    Args:
        problem: The problem.

    Attributes:
        made: Tangents of the bodies so far.
    """

    def __init__(self, problem: Problem) -> None:
        self._problem = problem
        self._known = False
        self.made = 0

    def begin(self) -> None:
        """Take it that an increment begins, and with it loads, temperatures and time move on."""
        self._known = False

    @contextmanager
    def chosen(self, *, lasting: bool) -> Iterator[None]:
        """Around the making of a tangent at the state of the last evaluation.

        Args:
            lasting: Whether that of the bodies may be the last one.
        """
        bodies = self._problem.assembly.bodies
        bodies.again = lasting and self._known and self._lasts()
        self.made += not bodies.again
        try:
            yield
            self._known = True  # one that could not be made is none to keep
        finally:
            bodies.again = False

    def _lasts(self) -> bool:
        problem = self._problem
        balance, held = problem.balance, problem.constrained()
        if balance.fields:  # forces and equations of other fields have no common measure
            return False
        missed = problem.constraints.tied(problem.assembly.bodies.missed())
        missed[held[held < len(missed)]] = 0.0
        residual = balance.residual
        missing, moved, norm = problem.layout.norms(missed, residual[held], residual)
        if problem.contact_term.simultaneous:
            norm = balance.norm
        left = max(norm**2 - moved**2, 0.0) ** 0.5
        return bool(missing < SHARE * left)
