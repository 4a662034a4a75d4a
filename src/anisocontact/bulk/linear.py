"""Bodies whose stiffness does not change: assembled once for a whole run."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from anisocontact._fenicsx import Mat, PETSc, Vec, compiled, create_stiffness, ufl
from anisocontact.bulk.materials import Material
from anisocontact.mesh import Model


class LinearBulk:
    """Stiffness of all bodies, `K u` and `u.K u / 2`.

    Args:
        model: Mesh with its bodies.
        materials: Body name -> linear material, one for each body.
    """

    #: Length whose strain is round-off where nothing moves: none, `K 0` is exactly zero.
    rest_length = 0.0

    def __init__(self, model: Model, materials: Mapping[str, Material]) -> None:
        self.stiffness = create_stiffness(
            compiled(_bilinear_form(model, materials), model.mesh.comm)
        )
        self._force = self.stiffness.createVecLeft()
        #: Diagonal of K: the scale of forces that displacements of one unit make.
        self.diagonal = self.stiffness.getDiagonal()

    def force(self, u: Vec) -> Vec:
        """Internal force `K u`; the vector is overwritten by the next call."""
        self.stiffness.mult(u, self._force)
        return self._force

    def energy(self, u: Vec) -> float:
        """Elastic energy `u.K u / 2`."""
        return 0.5 * float(u.dot(self.force(u)))

    def tangent(self, out: Mat) -> None:
        """Write the stiffness into a matrix that has room for it and may have more unknowns."""
        out.zeroEntries()
        if out.getSizes() == self.stiffness.getSizes():
            subset = PETSc.Mat.Structure.SUBSET_NONZERO_PATTERN
            out.axpy(1.0, self.stiffness, structure=subset)
            return
        first, _ = self.stiffness.getOwnershipRange()
        starts, columns, values = self.stiffness.getValuesCSR()
        rows = first + np.arange(len(starts) - 1, dtype=PETSc.IntType)
        out.setValuesIJV(starts, columns, values, PETSc.InsertMode.ADD_VALUES, rows)
        out.assemble()


def _bilinear_form(model: Model, materials: Mapping[str, Material]) -> Any:
    u, v = ufl.TrialFunction(model.space), ufl.TestFunction(model.space)
    names = model.body_names()
    cells = [(i, np.sort(model.cells(name))) for i, name in enumerate(names)]
    dx = ufl.Measure("dx", domain=model.mesh, subdomain_data=cells)
    if model.mesh.topology.cell_name() == "hexahedron":
        # full integration; UFL's own estimate counts the bending of the cell's sides, three times
        # the points
        dx = dx(metadata={"quadrature_degree": 2 * model.order})
    law: Mapping[str, Any] = materials
    return sum(
        ufl.inner(law[name].stress(u), ufl.sym(ufl.grad(v))) * dx(i) for i, name in enumerate(names)
    )
