"""A further level: aggregates of a coarse level are its interior, contact goes to the next one."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from anisocontact.base.array_types import Ints
from anisocontact.base.fenicsx import Mat, PETSc, Vec
from anisocontact.solver.strategies.iterative.coarse import CoarseLevel, Inverse
from anisocontact.solver.strategies.iterative.cycle import Smoother, cycle, residual
from anisocontact.solver.strategies.iterative.factor import Factor
from anisocontact.solver.strategies.iterative.interpolation import (
    Aggregates,
    smoothed,
    tentative,
)


@dataclass(frozen=True)
class Columns:
    """Where the unknowns of a coarse level are, see `LevelUnknowns`."""

    interior: PETSc.IS
    patch: PETSc.IS
    given: Ints


class MultilevelInverse:
    """Approximate inverse of the matrix of a coarse level by one cycle from zero.

    Args:
        matrix: The matrix.
        columns: Where its unknowns are.
        rough: From the next level, without smoothing; taken over.
        scale: Diagonal of coarse unknowns that move nothing, force/length.
        prefix: Prefix of the options of its parts.
        inverse: Makes the inverse on the next level from its matrix and the interpolation.
    """

    def __init__(
        self,
        matrix: Mat,
        columns: Columns,
        rough: Mat,
        scale: float,
        prefix: str,
        inverse: Callable[[Mat, Mat], Inverse],
    ) -> None:
        self._matrix, self._interior = matrix, columns.interior
        self._inside = matrix.createSubMatrix(self._interior, self._interior)
        prolong = smoothed(rough, matrix, self._inside, columns)
        self._smoother = Smoother(
            self._inside, self._interior, matrix.getOwnershipRange()[0], prefix
        )
        self._coarse = CoarseLevel(
            matrix, prolong, columns.patch, scale, lambda below: inverse(below, prolong)
        )
        self._rest, self._x = matrix.createVecs()

    @property
    def single(self) -> bool:
        """Whether the factor at the end of the levels is in single precision."""
        return self._coarse.single

    def renew(self, matrix: Mat, grown: bool, bodies: bool) -> bool:
        """See `Inverse.renew`."""
        self._matrix = matrix
        if grown:
            self._coarse.outgrow()
        if bodies:
            self._inside.destroy()
            self._inside = matrix.createSubMatrix(self._interior, self._interior)
            self._smoother.renew(self._inside)
            self._coarse.renew_bodies(matrix)
        return self._coarse.renew(matrix)

    def solve(self, right: Vec) -> Vec:
        """See `Inverse.solve`."""
        self._x.zeroEntries()
        right.copy(self._rest)
        balance = residual(self._matrix)
        cycle(balance, self._smoother, self._coarse, right, self._rest, self._x)
        return self._x

    def destroy(self) -> None:
        """Give back PETSc's objects."""
        for part in (self._smoother, self._coarse, self._inside):
            part.destroy()


@dataclass(frozen=True)
class Below:
    """Makes what solves coarse levels.

    Attributes:
        patch: Unknowns of the patch of this rank: the last ones of each level.
        scale: Diagonal of coarse unknowns that move nothing, force/length.
        prefix: Prefix of the options of solvers.
        single: Whether the factor is in single precision.
        note: Called with a line where there is no room for it.
    """

    patch: int
    scale: float
    prefix: str
    single: bool
    note: Callable[[str], None]

    def inverse(
        self, matrix: Mat, levels: Sequence[Aggregates], prolongs: Sequence[Mat]
    ) -> Inverse:
        """Inverse of the matrix of a coarse level: a cycle while there are levels, then a factor.

        Args:
            matrix: The matrix.
            levels: The aggregates of this level and of those below.
            prolongs: Interpolations from here to all unknowns, the finest one last.
        """
        if len(levels) == 1:
            return Factor(matrix, prolongs, f"{self.prefix}coarse_", self.single, self.note)
        first, comm = matrix.getOwnershipRange()[0], matrix.getComm()
        own = levels[0].own
        columns = Columns(
            PETSc.IS().createStride(own, first, 1, comm),
            PETSc.IS().createStride(self.patch, first + own, 1, comm),
            np.zeros(0, dtype=np.int64),
        )
        return MultilevelInverse(
            matrix,
            columns,
            tentative(levels[1], columns, matrix),
            self.scale,
            self.prefix,
            lambda a, prolong: self.inverse(a, levels[1:], (prolong, *prolongs)),
        )
