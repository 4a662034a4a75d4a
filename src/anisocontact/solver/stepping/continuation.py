"""Stiff laws: the increment is solved with what is easier, which is taken away.

Stiff penalties are come to by way of multipliers, see `contact.compliant`, stiff adhesion by a
compliant layer behind it.

A point sticks only while it slips by less than `mu N / k`. Where the stiffness k of adhesion is
far beyond that of the bodies, this is so little that a correction throws every point from one side
of the yield ellipse to the other. With multipliers and a layer of the compliance of the bodies
Newton's method converges, see `contact.layer`; the layer is made stiffer until it matters no more,
and what is left is an equilibrium of the user's law, which has to converge without layer.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

from anisocontact.base.fenicsx import Vec
from anisocontact.contact import Contact
from anisocontact.solver.stepping.compliant_penalties import as_they_are, comply
from anisocontact.solver.strategies.newton import NewtonResult
from anisocontact.solver.strategies.strategy import IncrementSolver
from anisocontact.solver.system.problem import Problem

#: Name of the way by what is easier than stiff laws.
LAYERED = "layered"
#: Stiffness of penalties or adhesion over that of the bodies beyond which this is tried.
STIFF = 100.0
#: Stiffness of the first layer over that of the bodies, where the first try fails a second one, and
#: how much stiffer the next one is.
LAYERS, STIFFER = (3.0, 10.0), 50.0
#: What the residual has to have fallen to where the iterations did not suffice, so that they go on;
#: how often they may.
FALLS, ROUNDS = 0.1, 4


class Continuation:
    """Solves with what is easier than stiff laws first, then with the laws as they are."""

    def __init__(self, problem: Problem, newton: IncrementSolver) -> None:
        self._problem = problem
        self._newton = newton

    def stiff(self) -> list[Contact]:
        """Contacts that are much stiffer than their bodies, the same on all ranks."""
        return [*self._by_layers(), *self._by_multipliers()]

    @property
    def easy(self) -> bool:
        """Whether it is quicker than the laws as they are: with multipliers, and no layers."""
        return not (self._problem.contact_term.simultaneous or self._by_layers())

    def _hardness(self, contact: Contact) -> float:
        """Normal penalty of a contact over the stiffness of the bodies behind it."""
        return float(contact.trials.interface.penalties()[0] / contact.body_stiffness)

    def _by_multipliers(self) -> list[Contact]:
        """Those whose penalties are; at integration points layers and the line search do more."""
        nodes = [c for c in self._problem.contacts if c.trials.penalised and c.trials.at_nodes]
        return [c for c in nodes if self._hardness(c) > STIFF]

    def _by_layers(self) -> list[Contact]:
        """Others whose adhesion is."""
        others = set(self._problem.contacts) - set(self._by_multipliers())
        return [c for c in self._problem.contacts if c in others and self.ratio(c) > STIFF]

    def ratio(self, contact: Contact) -> float:
        """Stiffness of a contact's adhesion over that of the bodies behind it."""
        return contact.slip_stiffness(self._problem.dt) / contact.body_stiffness

    def hint(self) -> str:
        """What stiff laws there are, and what to do about them; empty where there is none."""
        dt = self._problem.dt
        penalties = [
            f"the penalty of {c.name} is {self._hardness(c):.0e} times as stiff as the bodies "
            f"behind it: one below {STIFF * c.body_stiffness:.0e}, or 'augmented', is easier"
            for c in self._by_multipliers()
        ]
        adhesion = [
            f"adhesion of {c.name} is {self.ratio(c):.0e} times as stiff as the bodies behind it "
            f"({c.slip_stiffness(dt):.2g} against {c.body_stiffness:.2g} stress/length, about "
            f"E/h): a stiffness below {STIFF * c.body_stiffness:.0e}, or smaller increments, "
            "are easier"
            for c in self._by_layers()
        ]
        return "; ".join(penalties + adhesion)

    def solve(self, x: Vec) -> NewtonResult:
        """Correct `x` until it is in equilibrium, or no more can be done.

        Full steps come first; where they fail another layer at the pace of `Newton` is tried.

        Args:
            x: Start, overwritten by the last iterate, length.
        """
        layered, start = self._by_layers(), x.copy()
        result = self._softened(x, layered, LAYERS[0], lambda: 1.0)
        if result.reason and layered:
            self.end()
            start.copy(x)
            again = self._softened(x, layered, LAYERS[1], None)
            result = replace(again, iterations=result.iterations + again.iterations)
        self.end()
        return as_they_are(result, x, self._newton)

    def end(self) -> None:
        """Take all layers away, and multipliers that are a way to penalties."""
        for contact in self._problem.contacts:
            contact.trials.take_away()

    def _softened(
        self,
        x: Vec,
        layered: Sequence[Contact],
        stiffness: float,
        damping: Callable[[], float] | None,
    ) -> NewtonResult:
        """Newton's method with multipliers for stiff penalties, and one layer after the other.

        Each layer is stiffer than the last; without any there is nothing to go on to.
        """
        comply(self._by_multipliers())
        if not layered:
            return self._newton.solve(x)
        most, spent = max(self.ratio(contact) for contact in layered), 0
        while True:
            for contact in layered:
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
