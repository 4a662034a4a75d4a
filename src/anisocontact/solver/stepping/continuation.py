"""Stiff adhesion: the increment is solved with a compliant layer behind it, which is taken away.

A point sticks only while it slips by less than `mu N / k`. Where the stiffness k of adhesion is
far beyond that of the bodies, this is so little that a correction throws every point from one side
of the yield ellipse to the other. With multipliers and a layer of the compliance of the bodies
Newton's method converges, see `contact.layer`; the layer is made stiffer until it matters no more,
and what is left is an equilibrium of the user's law, which has to converge without layer.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from anisocontact.base.fenicsx import Vec
from anisocontact.contact import Contact
from anisocontact.solver.strategies.newton import NewtonResult
from anisocontact.solver.strategies.strategy import IncrementSolver
from anisocontact.solver.system.problem import Problem

#: Stiffness of adhesion over that of the bodies beyond which an attempt with a layer is made.
STIFF = 100.0
#: Stiffness of the first layer over that of the bodies, where the first try fails a second one, and
#: how much stiffer the next one is.
LAYERS, STIFFER = (3.0, 10.0), 50.0
#: What the residual has to have fallen to where the iterations did not suffice, so that they go on;
#: how often they may.
FALLS, ROUNDS = 0.1, 4


class Continuation:
    """Solves with a layer behind stiff adhesion first, then with the laws as they are."""

    def __init__(self, problem: Problem, newton: IncrementSolver) -> None:
        self._problem = problem
        self._newton = newton

    def stiff(self) -> list[Contact]:
        """Contacts whose adhesion is much stiffer than their bodies, the same on all ranks."""
        return [c for c in self._problem.contacts if self.ratio(c) > STIFF]

    def ratio(self, contact: Contact) -> float:
        """Stiffness of a contact's adhesion over that of the bodies behind it."""
        return contact.slip_stiffness(self._problem.dt) / contact.body_stiffness

    def hint(self) -> str:
        """What stiff adhesion there is, and what to do about it; empty where there is none."""
        dt = self._problem.dt
        return "; ".join(
            f"adhesion of {c.name} is {self.ratio(c):.0e} times as stiff as the bodies behind it "
            f"({c.slip_stiffness(dt):.2g} against {c.body_stiffness:.2g} stress/length, about "
            f"E/h): a stiffness below {STIFF * c.body_stiffness:.0e}, or smaller increments, "
            "are easier"
            for c in self.stiff()
        )

    def solve(self, x: Vec) -> NewtonResult:
        """Correct `x` until it is in equilibrium, or no more can be done.

        Full steps come first; where they fail another layer at the pace of `Newton` is tried.

        Args:
            x: Start, overwritten by the last iterate, length.
        """
        start, result = x.copy(), self._with_layers(x, LAYERS[0], lambda: 1.0)
        if result.reason:
            self.end()
            start.copy(x)
            again = self._with_layers(x, LAYERS[1], None)
            result = replace(again, iterations=result.iterations + again.iterations)
        self.end()
        if result.reason:
            return result
        final = self._newton.solve(x, full_steps=True)
        return replace(final, iterations=result.iterations + final.iterations)

    def end(self) -> None:
        """Take all layers away."""
        for contact in self._problem.contacts:
            contact.trials.take_away()

    def _with_layers(
        self, x: Vec, stiffness: float, damping: Callable[[], float] | None
    ) -> NewtonResult:
        """Newton's method with one layer after the other, each stiffer than the last."""
        stiff, spent = self.stiff(), 0
        most = max(self.ratio(contact) for contact in stiff)
        while True:
            for contact in stiff:
                softer = 1.0 / (stiffness * contact.body_stiffness)
                contact.trials.lay(softer, self._problem.dt)
            for _ in range(ROUNDS):
                result = self._newton.solve(x, full_steps=True, damping=damping)
                spent += result.iterations
                if not result.reason or result.residuals[-1] > FALLS:
                    break
            stiffness *= STIFFER
            if result.reason or stiffness >= most:
                return replace(result, iterations=spent)
