"""Matrix of a bilinear form that is assembled at every state."""

from __future__ import annotations

from typing import Any

import numpy as np

from anisocontact.base.fenicsx import Mat, PETSc, Vec, assemble_into, create_stiffness, fem, la
from anisocontact.base.places_in_matrix import PlacesInMatrix


class FormMatrix:
    """A bilinear form, assembled anew wherever its coefficients have changed.

    On one process DOLFINx puts the matrices of the cells into rows of its own, in a third of the
    time that PETSc takes for it; from there entries are copied to where PETSc has them.

    Args:
        form: The compiled form.

    Attributes:
        matrix: Matrix at the coefficients of now; its pattern stays.

    Example:
        >>> from anisocontact.base.compiled_forms import compiled
        >>> from anisocontact.base.fenicsx import ufl
        >>> from anisocontact.mesh import BoxSpec, build_box
        >>> model = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1))})
        >>> u, v = ufl.TrialFunction(model.space), ufl.TestFunction(model.space)
        >>> mass = FormMatrix(compiled(ufl.inner(u, v) * ufl.dx, model.mesh.comm))
        >>> out = mass.matrix.duplicate()
        >>> mass.write(out)
        >>> float(round(out.getDiagonal().sum(), 9))
        0.888888889
    """

    def __init__(self, form: Any) -> None:
        self._form = form
        self.matrix: Mat = create_stiffness(form)
        self._rows: Any = None
        self._wrapped: Mat
        if form.mesh.comm.size > 1:
            self._wrapped = self.matrix.duplicate()
        else:
            self._rows = fem.create_matrix(form, la.BlockMode.expanded)
            parts = (self._rows.indptr, self._rows.indices)
            sides = [side.astype(PETSc.IntType) for side in parts]
            sizes = self.matrix.getSizes()
            csr = (*sides, self._rows.data)
            self._wrapped = PETSc.Mat().createAIJWithArrays(sizes, csr, comm=form.mesh.comm)
            self._places = PlacesInMatrix(self._wrapped)

    def write(self, out: Mat, *, again: bool = False) -> None:
        """Write the matrix into one that has room for it, assembled.

        Args:
            out: Where to.
            again: Whether it is that of the last call instead of that at the coefficients of now.
        """
        out.zeroEntries()
        if not again:
            self._assemble()
        if self._rows is None or not self._places.copy(out):
            add_matrix(out, self._wrapped)
        out.assemble(PETSc.Mat.AssemblyType.FINAL)

    def _assemble(self) -> None:
        """Take the coefficients of now."""
        if self._rows is None:
            self._wrapped.zeroEntries()
            assemble_into(self._wrapped, self._form)
        else:
            self._rows.data[:] = 0.0
            fem.assemble_matrix(self._rows, self._form)
        self._wrapped.assemble()

    def times(self, x: Vec, out: Vec) -> None:
        """The product of what was last written with a vector."""
        self._wrapped.mult(x, out)


def add_matrix(out: Mat, matrix: Mat) -> None:
    """Add a matrix to one that has room for it and may have more unknowns; not assembled yet."""
    if out.getSizes() == matrix.getSizes():
        out.axpy(1.0, matrix, structure=PETSc.Mat.Structure.SUBSET_NONZERO_PATTERN)
        return
    first, _ = matrix.getOwnershipRange()
    starts, columns, values = matrix.getValuesCSR()
    rows = first + np.arange(len(starts) - 1, dtype=PETSc.IntType)
    out.setValuesIJV(starts, columns, values, PETSc.InsertMode.ADD_VALUES, rows)
