"""Matrices of bilinear forms, summed by DOLFINx in rows of its own."""

from __future__ import annotations

import ctypes
from typing import Any

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.csr_blocks import keyed_entries
from anisocontact.base.fenicsx import Mat, PETSc, assemble_into, create_form_matrix, fem, la
from anisocontact.base.petsc_calls import call_petsc

__all__ = ["FormRows", "create_stiffness"]


class FormRows:
    """Rows into which DOLFINx sums the matrices of the cells of a bilinear form; collective.

    It takes a third of the time that PETSc takes to insert each of them.

    Args:
        form: The compiled form, one that `has` says to have them.

    Attributes:
        starts: Where the rows that this rank owns start, (rows + 1,).
        columns: Their columns, global numbers that increase in each row.

    Example:
        >>> from anisocontact.base.compiled_forms import compiled
        >>> from anisocontact.base.fenicsx import ufl
        >>> from anisocontact.mesh import BoxSpec, build_box
        >>> model = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1))})
        >>> u, v = ufl.TrialFunction(model.space), ufl.TestFunction(model.space)
        >>> rows = FormRows(compiled(ufl.inner(u, v) * ufl.dx, model.mesh.comm))
        >>> float(round(rows.assemble().sum(), 9))
        3.0
    """

    def __init__(self, form: Any) -> None:
        self._form = form
        self._rows = fem.create_matrix(form, la.BlockMode.expanded)
        above, sides = self._rows.index_map(0), self._rows.index_map(1)
        starts = self._rows.indptr[: above.size_local + 1].astype(np.int64)
        local = self._rows.indices[: starts[-1]].astype(np.int32)
        columns = sides.local_to_global(local)
        # ghosts stand behind what is owned: rows without any are in order
        filled = np.flatnonzero(np.diff(starts))
        mixed = filled[local[starts[filled + 1] - 1] >= sides.size_local]
        entries, keys = keyed_entries(mixed, starts, columns, sides.size_global)
        self._moved, self._order = entries, entries[np.argsort(keys, kind="stable")]
        columns[self._moved] = columns[self._order]
        self.starts = starts.astype(PETSc.IntType)
        self.columns = columns.astype(PETSc.IntType, copy=False)
        self._sizes = tuple((m.size_local, m.size_global) for m in (above, sides))

    @staticmethod
    def has(form: Any) -> bool:
        """Whether DOLFINx has them: it has none with more components of rows than of columns."""
        return len({space.dofmap.index_map_bs for space in form.function_spaces}) == 1

    def assemble(self) -> Floats:
        """Entries at the coefficients of now, overwritten by the next call; collective."""
        self._rows.data[:] = 0.0
        fem.assemble_matrix(self._rows, self._form)
        self._rows.scatter_reverse()
        data = self._rows.data[: self.starts[-1]]
        data[self._moved] = data[self._order]
        return data

    def matrix(self) -> Mat:
        """A matrix of PETSc with these rows, to be brought up to date by `update`."""
        comm = self._form.mesh.comm
        csr = (self.starts, self.columns, self._rows.data[: self.starts[-1]])
        if comm.size == 1:  # it has no entries of its own
            return PETSc.Mat().createAIJWithArrays(self._sizes, csr, comm=comm)
        return PETSc.Mat().createAIJ(self._sizes, csr=csr, comm=comm)

    def update(self, matrix: Mat) -> None:
        """Bring one of `matrix` to the coefficients of now; collective."""
        entries = self.assemble()
        if self._form.mesh.comm.size == 1:
            matrix.assemble()
        else:
            call_petsc("MatUpdateMPIAIJWithArray", matrix, ctypes.c_void_p(entries.ctypes.data))


def create_stiffness(form: Any) -> Mat:
    """Assembled matrix of a bilinear form, without boundary conditions; collective.

    Rows that are emptied later keep their place in the pattern, so that one symbolic
    factorisation serves a whole run.

    Args:
        form: The compiled form.

    Returns:
        The matrix.
    """
    matrix = create_form_matrix(form)
    if FormRows.has(form):
        rows = FormRows(form)
        matrix.setValuesCSR(rows.starts, rows.columns, rows.assemble())
    else:
        assemble_into(matrix, form)
    matrix.assemble()
    matrix.setOption(PETSc.Mat.Option.KEEP_NONZERO_PATTERN, True)
    return matrix
