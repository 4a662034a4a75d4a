"""Cells that the displacement has inverted."""

from __future__ import annotations

import numpy as np

from anisocontact.base.array_types import Floats, Locals
from anisocontact.base.fenicsx import basix, scalar_element
from anisocontact.mesh import Model


class DeformedCells:
    """Change of volume `det F` of the cells of a model at their quadrature points.

    Args:
        model: The mesh.
        bodies: Bodies whose cells count.
    """

    def __init__(self, model: Model, bodies: list[str]) -> None:
        element = scalar_element(model.space)
        points, _ = basix.make_quadrature(element.cell_type, 2 * element.degree)
        table = np.asarray(element.tabulate(1, points))[1:, :, :, 0]
        self._gradient: Floats = np.ascontiguousarray(np.moveaxis(table, 0, -1))
        self._shape: Floats = np.asarray(element.tabulate(0, points))[0, :, :, 0]
        self._idealisation = model.idealisation
        owned = model.mesh.topology.index_map(model.idealisation.dim).size_local
        cells = np.concatenate([np.zeros(0, dtype=np.int32), *map(model.cells, bodies)])
        self._nodes: Locals = model.space.dofmap.list[np.sort(cells[cells < owned])]
        self._reference = np.asarray(model.space.tabulate_dof_coordinates())
        self._rest = self._volumes(self._reference)

    def inverted(self, u: Floats) -> Floats:
        """Middles of the cells of this rank that are inverted, where they are now.

        Args:
            u: Displacement of the local nodes, (nodes, 3), length.

        Returns:
            Positions (n, 3), length.
        """
        now = self._reference + u
        with np.errstate(invalid="ignore", over="ignore"):
            ratio = self._volumes(now) / self._rest
        wrong = ~(ratio > 0.0).all(axis=1)
        return np.asarray(now[self._nodes[wrong]].mean(axis=1))

    def _volumes(self, at: Floats) -> Floats:
        """Determinant of the Jacobian, (cells, points)."""
        # columns of the Jacobian, (d, i, cells, points): a product of large matrices, and a sum of
        # six products takes a tenth of the time of an elimination for every small matrix
        table = self._gradient.transpose(2, 1, 0)[:, None]
        nodes = at[self._nodes]
        columns = list(nodes.transpose(2, 0, 1) @ table)
        if len(columns) == 2:  # in the plane: the tangent across it
            columns.append(self._idealisation.across(self._shape @ nodes).transpose(2, 0, 1))
        a, b, c = columns
        return np.asarray(
            a[0] * (b[1] * c[2] - b[2] * c[1])
            + a[1] * (b[2] * c[0] - b[0] * c[2])
            + a[2] * (b[0] * c[1] - b[1] * c[0])
        )
