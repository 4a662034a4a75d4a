"""LU of the interior of a matrix that comes again with other values: analysed once."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from anisocontact.base.array_types import Ints, Sparse
from anisocontact.base.fenicsx import Mat, PETSc
from anisocontact.base.petsc_calls import check_memory
from anisocontact.solver.strategies.condensed.factor import singular
from anisocontact.solver.strategies.condensed.mumps import (
    TOO_SMALL,
    WORKSPACE,
    partial_factor,
)
from anisocontact.solver.strategies.database import Database, OptionValue
from anisocontact.solver.terms.term import SingularError


class Interior:
    """MUMPS' factor of a matrix but for its border, on one process.

    Args:
        matrix: The matrix; it is kept, and overwritten.
        border: Numbers of the border unknowns.
        prefix: Prefix of PETSc's options.
        options: These options.

    Raises:
        SingularError: There is no factor.

    Attributes:
        factor: PETSc's matrix that solves.
        entries: Entries of the factor.
        operations: Floating-point operations that it has cost.
    """

    def __init__(
        self, matrix: Mat, border: Ints, prefix: str, options: Mapping[str, OptionValue]
    ) -> None:
        self._matrix, self._border = matrix, border
        self._prefix, self._options = prefix, options
        self._analyse()
        try:
            self._check()
        except SingularError:
            self.close()
            raise

    def take(self, matrix: Sparse) -> bool:
        """Factorise another matrix, with the analysis that there is.

        Args:
            matrix: The matrix, columns in order.

        Returns:
            Whether its entries have the places that the analysis is of; nothing is done if not.

        Raises:
            SingularError: There is no factor.
        """
        starts, columns = self._matrix.getRowIJ()
        same = np.array_equal(starts, matrix.indptr) and np.array_equal(columns, matrix.indices)
        if not same:
            return False
        self._matrix.setValuesCSR(starts, columns, matrix.data)
        self._matrix.assemble()
        failed = self.factor.getMumpsInfog(1) < 0
        if not failed:
            self._pc.setUp()
        # after a failure PETSc leaves out all factorisations that go by the same analysis
        if failed or self.factor.getMumpsInfog(1) in TOO_SMALL:
            self._pc.destroy()
            self._analyse()
        self._check()
        return True

    def close(self) -> None:
        """Give back the memory."""
        self._pc.destroy()
        self._matrix.destroy()

    def _analyse(self) -> None:
        """Analyse and factorise the matrix, with more workspace until it is enough."""
        for extra in WORKSPACE:
            with Database(self._prefix, self._options):
                made = partial_factor(self._matrix, self._border, extra, self._prefix)
            self._pc, self.factor = made
            if self.factor.getMumpsInfog(1) not in TOO_SMALL:
                return
            if extra != WORKSPACE[-1]:
                self._pc.destroy()

    def _check(self) -> None:
        """Look whether there is a factor.

        Raises:
            SingularError: There is none.
        """
        if self._pc.getFailedReason() != PETSc.PC.FailedReason.NOERROR:
            check_memory(self._pc)
            raise singular()
        entries = float(self.factor.getMumpsInfog(29))
        self.entries = entries if entries >= 0.0 else -1e6 * entries
        self.operations = float(self.factor.getMumpsRinfog(3))
