"""Elastic energy cell by cell, from the form of that of all bodies."""

from __future__ import annotations

from typing import Any

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.compiled_forms import compiled
from anisocontact.base.fenicsx import fem, ufl
from anisocontact.mesh import Model


class CellIntegrals:
    """Integrals of a functional over each cell.

    Args:
        functional: Form of rank 0.
        model: Mesh of the bodies.

    Example:
        >>> from anisocontact.mesh import BoxSpec, build_box
        >>> model = build_box({"block": BoxSpec((0, 0, 0), (3, 1, 1), (3, 1, 1))})
        >>> x = ufl.SpatialCoordinate(model.mesh)
        >>> sorted(CellIntegrals(x[0] * ufl.dx, model)().round(9).tolist())
        [0.5, 1.5, 2.5]
    """

    def __init__(self, functional: Any, model: Model) -> None:
        space = fem.functionspace(model.mesh, ("DG", 0))
        v = ufl.TestFunction(space)
        weighed = [
            part.reconstruct(integrand=part.integrand() * v) for part in functional.integrals()
        ]
        self._form = compiled(ufl.Form(weighed), model.mesh.comm)
        topology = model.mesh.topology
        self._places = space.dofmap.list[: topology.index_map(topology.dim).size_local, 0]

    def __call__(self) -> Floats:
        """Those of the cells of this rank, (cells,)."""
        return np.asarray(fem.assemble_vector(self._form).array[self._places])


def volumes(model: Model) -> Floats:
    """Volume of the cells of this rank, with the thickness or the circumference, (cells,)."""
    weight = model.idealisation.weight(model.mesh) * fem.Constant(model.mesh, 1.0)
    return CellIntegrals(weight * ufl.dx(domain=model.mesh, degree=2 * model.order), model)()
