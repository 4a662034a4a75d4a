"""Matrix of a bilinear form that is assembled at every state."""

from __future__ import annotations

from typing import Any

import numpy as np

from anisocontact.base.fenicsx import Mat, PETSc, Vec
from anisocontact.base.form_rows import FormRows, create_stiffness
from anisocontact.base.places_in_matrix import PlacesInMatrix


class FormMatrix:
    """A bilinear form, assembled anew wherever its coefficients have changed.

    DOLFINx puts the matrices of the cells into rows of its own, in a third of the time that PETSc
    takes for it; from there entries are copied to where PETSc has them.

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
        self.matrix: Mat = create_stiffness(form)
        self._rows = FormRows(form)
        self._wrapped: Mat = self._rows.matrix()
        self._places = PlacesInMatrix(self._wrapped)

    def write(self, out: Mat, *, again: bool = False) -> None:
        """Write the matrix into one that has room for it, assembled; collective.

        Args:
            out: Where to.
            again: Whether it is that of the last call instead of that at the coefficients of now.
        """
        out.zeroEntries()
        if not again:
            self._rows.update(self._wrapped)
        if not self._places.copy(out):
            add_matrix(out, self._wrapped)
        out.assemble(PETSc.Mat.AssemblyType.FINAL)

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
