"""What a body keeps at its quadrature points from one accepted increment to the next."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from anisocontact.base.array_types import Floats, Locals
from anisocontact.base.compiled_forms import compiled_expression
from anisocontact.base.fenicsx import basix, fem, ufl
from anisocontact.bulk.expansion import Heated
from anisocontact.mesh import Model

#: In front of the names of internal variables among arrays that are kept.
_VARIABLE = "history/"


class AtPoints:
    """Internal variables, stress and energies of a body at its quadrature points; zero at first.

    Args:
        model: Mesh of the body.
        body: Its name.
        history: Internal variables by name with their shape, () of a number.
        degree: Degree of the quadrature at whose points they live.
        heated: How gradients are seen where the body expands; as those of the mesh if left out.

    Attributes:
        points: The points in the reference cell, (points, 3).
        variables: Internal variables by name, DOLFINx functions.
        stored: Energy per reference volume that the accepted state has stored, a function.
        dissipated: What has been dissipated until then, per volume of the reference.
        thermal_force: Force conjugate to a stretch by temperature in the accepted state, energy per
            volume without stress, where the body expands; see `Heated.thermal_force`.
        chosen_thermal_force: The same of the state that `choose_thermal_force` was asked for.
    """

    linear = False
    #: Whether the material says what it stores.
    stores: bool

    def __init__(
        self,
        model: Model,
        body: str,
        history: Mapping[str, tuple[int, ...]],
        degree: int,
        heated: Heated | None = None,
    ) -> None:
        self._mesh = model.mesh
        self._cells = np.sort(model.cells(body))
        self._ideal = heated or model.idealisation
        owned = model.mesh.topology.index_map(model.idealisation.dim).size_local
        self._owned = int(np.searchsorted(self._cells, owned))
        cell = model.mesh.basix_cell()
        self._degree = degree
        self.points: Floats = np.asarray(basix.make_quadrature(cell, degree)[0], dtype=np.float64)
        self.variables = {name: self._zero(shape) for name, shape in history.items()}
        self._stress = self._zero((3, 3))
        self.stored, self.dissipated = self._zero(()), self._zero(())
        self.thermal_force: Any = self._zero(()) if heated else None
        self.chosen_thermal_force: Any = self._zero(()) if heated else None
        places = self._at_points(ufl.SpatialCoordinate(self._mesh))
        self.places: Floats = places.eval(self._mesh, self._cells).reshape(-1, 3)

    def stress(self, trial: bool = False) -> tuple[Locals, Floats]:
        """Cells of the body on this rank, (n,), and true stress at their points, (n, points, 3, 3).

        Args:
            trial: Whether it is that of the last trial; else of the last accepted increment.
        """
        values = self._trial_stress() if trial else self._read(self._stress)
        return self._cells, values.reshape(len(self._cells), len(self.points), 3, 3)

    def _trial_stress(self) -> Floats:
        """True stress at the points, of the displacement now."""
        raise NotImplementedError

    def choose_thermal_force(self, trial: bool) -> None:
        """Bring `chosen_thermal_force` to a state, of a body that expands.

        Args:
            trial: Whether that is the last trial; else it is the last accepted increment.
        """
        given = self._trial_thermal_force() if trial else self._read(self.thermal_force)
        self._write(self.chosen_thermal_force, given)

    def _trial_thermal_force(self) -> Floats:
        """What a stretch by temperature gives to the displacement now, (n,), energy/volume."""
        raise NotImplementedError

    @property
    def own_cells(self) -> Locals:
        """Cells of the body that this rank owns, (n,)."""
        return self._cells[: self._owned]

    def means(self, name: str) -> tuple[Locals, Floats]:
        """Cells of the body on this rank, (n,), and means over their points of a number."""
        values = self._read(self.variables[name])
        return self._cells, values.reshape(len(self._cells), len(self.points)).mean(axis=1)

    def persistent(self) -> dict[str, Floats]:
        """Values at the points of cells this rank owns, (points, ...), and where these are.

        Points of some rules lie on faces of cells, two in one place: half-way to the mean of those
        of their cell no two do.
        """
        owned = self._owned * len(self.points)
        of_cells = self.places[:owned].reshape(self._owned, len(self.points), 3)
        inside = 0.5 * (of_cells + of_cells.mean(axis=1, keepdims=True))
        kept = {
            name: self._read(v)[:owned].reshape(owned, v.function_space.dofmap.bs)
            for name, v in self._named().items()
        }
        return {"reference": inside.reshape(-1, 3)} | kept

    def restore(self, kept: Mapping[str, Floats]) -> None:
        """Go on from what `persistent` gave; collective."""
        for name, variable in self._named().items():
            self._write(variable, kept[name], self._owned)
            variable.x.scatter_forward()

    def _named(self) -> dict[str, Any]:
        named = {f"{_VARIABLE}{name}": v for name, v in self.variables.items()}
        named |= {"stress": self._stress, "stored": self.stored, "dissipated": self.dissipated}
        return named | ({"thermal_force": self.thermal_force} if self.thermal_force else {})

    def _zero(self, shape: tuple[int, ...]) -> Any:
        cell = self._mesh.basix_cell()
        element = basix.ufl.quadrature_element(cell, value_shape=shape, degree=self._degree)
        return fem.Function(fem.functionspace(self._mesh, element))

    def _at_points(self, expression: Any) -> Any:
        return compiled_expression(expression, self.points, self._mesh.comm)

    def _rows(self, variable: Any, cells: int) -> Locals:
        """Places of the points of the first cells of the body in the array of a variable."""
        return np.asarray(variable.function_space.dofmap.list[self._cells[:cells]].reshape(-1))

    def _read(self, variable: Any) -> Floats:
        """Values at the points of all cells of the body, (n, ...)."""
        rows = self._rows(variable, len(self._cells))
        values: Floats = variable.x.array.reshape(-1, variable.function_space.dofmap.bs)[rows]
        return values.reshape(-1, *variable.ufl_shape)

    def _write(self, variable: Any, values: Floats, cells: int | None = None) -> None:
        size = variable.function_space.dofmap.bs
        rows = self._rows(variable, len(self._cells) if cells is None else cells)
        variable.x.array.reshape(-1, size)[rows] = values.reshape(-1, size)
