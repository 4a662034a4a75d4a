"""Cells that the displacement has inverted, or folded at a corner."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from anisocontact.base.array_types import Flags, Floats, Ints, Locals
from anisocontact.base.fenicsx import basix, scalar_element
from anisocontact.mesh import Model

#: Jacobian at a corner over the largest of its cell that is none: on the axis.
_NONE = 1e-12


class DeformedCells:
    """Change of volume `det F` of the cells of a model at their quadrature points and corners.

    Args:
        model: The mesh.
        bodies: Bodies whose cells count.
    """

    def __init__(self, model: Model, bodies: list[str]) -> None:
        element = scalar_element(model.space)
        points, _ = basix.make_quadrature(element.cell_type, 2 * element.degree)
        self._idealisation = model.idealisation
        owned = model.mesh.topology.index_map(model.idealisation.dim).size_local
        found = [(cells := model.cells(name))[cells < owned] for name in bodies]
        cells = np.concatenate([np.zeros(0, dtype=np.int32), *found])
        order = np.argsort(cells)
        self._names, of = bodies, np.repeat(np.arange(len(bodies)), [len(one) for one in found])
        self._bodies: Ints = of[order]
        self._nodes: Locals = model.space.dofmap.list[cells[order]]
        self._reference = np.asarray(model.space.tabulate_dof_coordinates())
        self._inside = self._at_rest(element.tabulate(1, points))
        self._corners = self._at_rest(element.tabulate(1, basix.geometry(element.cell_type)))

    def inverted(self, u: Floats) -> Floats:
        """Middles of the cells of this rank that are inverted, where they are now.

        Args:
            u: Displacement of the local nodes, (nodes, 3), length.

        Returns:
            Positions (n, 3), length.
        """
        return self._middles(u, self._wrong(u, self._inside))

    def folded(self, u: Floats) -> dict[str, Floats]:
        """Middles of those with a corner where `det F <= 0`, which no quadrature point sees.

        Args:
            u: Displacement of the local nodes, (nodes, 3), length.

        Returns:
            Positions by body, (n, 3), length; bodies without any are left out.
        """
        wrong = self._wrong(u, self._corners)
        return {
            self._names[body]: self._middles(u, wrong & (self._bodies == body))
            for body in np.unique(self._bodies[wrong])
        }

    def _middles(self, u: Floats, which: Flags) -> Floats:
        now = self._reference + u
        return np.asarray(now[self._nodes[which]].mean(axis=1))

    def _wrong(self, u: Floats, points: _Points) -> Flags:
        with np.errstate(invalid="ignore", over="ignore"):
            ratio = self._volumes(self._reference + u, points) / points.rest
        return np.asarray(~((ratio > 0.0) | np.isinf(points.rest)).all(axis=1))

    def _at_rest(self, table: Floats) -> _Points:
        """Points from values and derivatives of the basis there, (1 + d, points, nodes, 1)."""
        gradient = np.ascontiguousarray(np.moveaxis(table[1:, :, :, 0], 0, -1))
        points = _Points(gradient, np.asarray(table[0, :, :, 0]), np.zeros(0))
        rest = self._volumes(self._reference, points)
        some = np.abs(rest) > _NONE * np.abs(rest).max(axis=1, initial=0.0, keepdims=True)
        return points._replace(rest=np.where(some, rest, np.inf))

    def _volumes(self, at: Floats, points: _Points) -> Floats:
        """Determinant of the Jacobian, (cells, points)."""
        # columns of the Jacobian, (d, i, cells, points): a product of large matrices, and a sum of
        # six products takes a tenth of the time of an elimination for every small matrix
        table = points.gradient.transpose(2, 1, 0)[:, None]
        nodes = at[self._nodes]
        columns = list(nodes.transpose(2, 0, 1) @ table)
        if len(columns) == 2:  # in the plane: the tangent across it
            columns.append(self._idealisation.across(points.shape @ nodes).transpose(2, 0, 1))
        a, b, c = columns
        return np.asarray(
            a[0] * (b[1] * c[2] - b[2] * c[1])
            + a[1] * (b[2] * c[0] - b[0] * c[2])
            + a[2] * (b[0] * c[1] - b[1] * c[0])
        )


class _Points(NamedTuple):
    """Points of the reference cell.

    Attributes:
        gradient: Derivatives of the basis there, (points, nodes, d).
        shape: The basis, (points, nodes).
        rest: Determinant of the Jacobian at rest, (cells, points); infinite where there is none,
            at a corner on the axis.
    """

    gradient: Floats
    shape: Floats
    rest: Floats
