"""An old tangent with the contacts of now, factorised by several processes."""

from __future__ import annotations

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.fenicsx import MPI, Mat
from anisocontact.solver.strategies.condensed.border import Border
from anisocontact.solver.strategies.condensed.factor import singular
from anisocontact.solver.strategies.condensed.subdomain import OwnRows, Subdomain
from anisocontact.solver.strategies.condensed.touched import Touched
from anisocontact.solver.system.problem import Problem
from anisocontact.solver.terms.persistent import Arrays
from anisocontact.solver.terms.term import SingularError


class Substructures:
    """A `LaggedPreconditioner` on several processes, by static condensation of the part of each.

    The border has the unknowns that contact can couple, and of those between the parts the ones
    that belong to the later process. Each process eliminates what is inside its own part; the first
    one sums what is left, and has the dense factor [Przemieniecki 1963].

    Args:
        problem: The problem, without constraints between nodes.
    """

    def __init__(self, problem: Problem) -> None:
        self._problem, self._comm = problem, problem.comm
        self._touched: Touched | None = None
        self._subdomain: Subdomain | None = None
        self._dense: Border | None = None
        self.solutions_per_factor, self.border = 0.0, 0

    def take(self, tangent: Mat, single: bool) -> None:
        """As of `LaggedPreconditioner`."""
        rows = OwnRows(tangent)
        coupled = Touched(self._problem).unknowns
        border = rows.border(coupled)
        touched = Touched(self._problem, border)
        contact, subdomain = touched.tangent(), Subdomain(rows, border, single)
        left = None if contact is None else subdomain.of_border - contact
        schur = subdomain.summed(left)
        cost, entries = (self._comm.allreduce(one, MPI.MAX) for one in subdomain.size)
        self.close()
        self._subdomain, self._touched = subdomain, touched
        if schur is not None:
            self._dense = Border(schur, entries, np.isin(border, coupled))
        self.solutions_per_factor, self.border = cost / entries, len(coupled)

    def renew(self) -> float:
        """As of `LaggedPreconditioner`."""
        assert self._touched is not None, "`take` comes first"
        contact, shares = self._touched.tangent(), self._touched.shares()
        cost: float | None = None
        if self._dense is not None and shares is not None:
            try:
                cost = self._dense.renew(contact, *shares)
            except SingularError:
                cost = None
        cost = self._comm.bcast(cost)
        if cost is None:
            raise singular()
        return cost

    def solution(self, b: Floats) -> Floats:
        """As of `LaggedPreconditioner`."""
        assert self._subdomain is not None, "`take` comes first"
        return self._subdomain.solution(b, self._dense)

    def outgrown(self) -> bool:
        """As of `LaggedPreconditioner`."""
        return self._touched is None or self._touched.outgrown()

    def persistent(self) -> Arrays:
        """Nothing: a run that goes on, on as many processes or others, begins with a new factor."""
        return {}

    def restore(self, kept: Arrays, single: bool) -> None:
        """Nothing is kept."""

    def close(self) -> None:
        """As of `LaggedPreconditioner`."""
        if self._subdomain is not None:
            self._subdomain.close()
        self._subdomain = self._dense = None
