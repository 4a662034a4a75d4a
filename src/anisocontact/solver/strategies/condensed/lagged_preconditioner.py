"""A lagged preconditioner: an old tangent with the contacts of now; on one process, and for all."""

from __future__ import annotations

from typing import Protocol

import scipy

from anisocontact.base.array_types import Floats, Ints, Sparse
from anisocontact.base.fenicsx import Mat
from anisocontact.solver.strategies.condensed.border import PARTS
from anisocontact.solver.strategies.condensed.bordered import BorderedLU
from anisocontact.solver.strategies.condensed.touched import Touched
from anisocontact.solver.system.problem import Problem
from anisocontact.solver.terms.persistent import Arrays
from anisocontact.solver.terms.term import SingularError

#: What is kept of the factor, and of its border.
_MATRIX, _UNKNOWNS, _BORDER = "lagged.matrix", "lagged.unknowns", "lagged.border."


class LaggedPreconditioner(Protocol):
    """`P = J_old + C - C_old`, C what acts on the unknowns that contact can couple.

    Vectors are those of the unknowns that this process owns; all calls are collective.

    Attributes:
        solutions_per_factor: Solutions that cost as much as a factorisation.
        border: Number of unknowns in the border.
    """

    solutions_per_factor: float
    border: int

    def take(self, tangent: Mat, single: bool) -> None:
        """Factorise a tangent; the one that there is stays where there is no factor.

        Args:
            tangent: J, the last one that the problem has written.
            single: Whether MUMPS works in single precision, where this PETSc can.

        Raises:
            SingularError: There is no factor.
        """
        ...

    def renew(self) -> float:
        """Take what contacts do now.

        Returns:
            What it has cost, in solutions.

        Raises:
            SingularError: The border has no inverse.
        """
        ...

    def solution(self, b: Floats) -> Floats:
        """Solution of `P x = b`; `renew` comes first."""
        ...

    def outgrown(self) -> bool:
        """Whether contacts of now couple unknowns outside the border."""
        ...

    def persistent(self) -> Arrays:
        """What it is made of; nothing where it cannot be made again."""
        ...

    def restore(self, kept: Arrays, single: bool) -> None:
        """Make it again."""
        ...

    def close(self) -> None:
        """Give back the memory."""
        ...


class BorderedPreconditioner:
    """A `LaggedPreconditioner` on one process, by one `BorderedLU`.

    Args:
        problem: The problem.
    """

    def __init__(self, problem: Problem) -> None:
        self._problem = problem
        self._factor: BorderedLU | None = None
        self._touched: Touched | None = None
        self._of_factor: Sparse = scipy.sparse.csr_array((0, 0))
        self.solutions_per_factor, self.border = 0.0, 0

    def take(self, tangent: Mat, single: bool) -> None:
        """As of the protocol."""
        touched, before = Touched(self._problem), self._of_factor
        starts, columns, values = tangent.getValuesCSR()
        given = scipy.sparse.csr_array((values, columns, starts), tangent.getSize())
        self._of_factor = touched.without(given)
        try:
            factor = self._retaken(touched.unknowns, before, single)
            factor = factor or BorderedLU(self._of_factor, touched.unknowns, single)
        except SingularError:
            self._of_factor = before
            raise
        if factor is not self._factor:
            self.close()
        self._begin(factor, touched)

    def renew(self) -> float:
        """As of the protocol."""
        assert self._factor is not None, "`take` comes first"
        assert self._touched is not None, "`take` comes first"
        shares = self._touched.shares()
        assert shares is not None, "all is on this process"
        return self._factor.renew(self._touched.tangent(), *shares)

    def solution(self, b: Floats) -> Floats:
        """As of the protocol."""
        assert self._factor is not None, "`take` comes first"
        return self._factor.solution(b)

    def outgrown(self) -> bool:
        """As of the protocol."""
        return self._touched is None or self._touched.outgrown()

    def persistent(self) -> Arrays:
        """The matrices behind the factor: it is made again from these in the same order."""
        if self._factor is None or self._touched is None:
            return {}
        border = self._factor.persistent()
        return {
            _UNKNOWNS: self._touched.unknowns,
            **{f"{_MATRIX}.{part}": getattr(self._of_factor, part) for part in PARTS},
            **{f"{_BORDER}{name}": one for name, one in border.items()},
        }

    def restore(self, kept: Arrays, single: bool) -> None:
        """As of the protocol."""
        n, unknowns = self._problem.unknowns, kept[_UNKNOWNS]
        parts = tuple(kept[f"{_MATRIX}.{part}"] for part in PARTS)
        self._of_factor = scipy.sparse.csr_array(parts, (n, n))
        factor = BorderedLU(self._of_factor, unknowns, single)
        begin = len(_BORDER)
        own = {name[begin:]: one for name, one in kept.items() if name.startswith(_BORDER)}
        factor.restore(own)
        self._begin(factor, Touched(self._problem, unknowns))

    def close(self) -> None:
        """As of the protocol."""
        if self._factor is not None:
            self._factor.close()
        self._factor = None

    def _begin(self, factor: BorderedLU, touched: Touched) -> None:
        self._factor, self._touched = factor, touched
        self.solutions_per_factor = factor.solutions_per_factor
        self.border = len(touched.unknowns)

    def _retaken(self, unknowns: Ints, before: Sparse, single: bool) -> BorderedLU | None:
        """The factor that there is, now of what has been taken of a tangent, if it has the places.

        Args:
            unknowns: Of the border.
            before: What it is of.
            single: Its precision from now on.

        Raises:
            SingularError: There is none; it is that of before again.
        """
        factor = self._factor
        if factor is None:
            return None
        try:
            return factor if factor.take(self._of_factor, unknowns, single) else None
        except SingularError:
            factor.take(before, unknowns, single)
            raise
