"""Materials with a history: internal variables at the quadrature points of a body."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import basix, compiled_expression, fem, ufl
from anisocontact.bulk.hyperelastic import cauchy_stress
from anisocontact.mesh import Model

Floats = npt.NDArray[np.float64]

#: In front of the names of internal variables among arrays that are kept.
_VARIABLE = "history/"


@dataclass(frozen=True)
class Before:
    """What a material knows of the last accepted increment.

    Attributes:
        variables: Internal variables by name, UFL, zero at the start.
        dt: Time increment from there to now, UFL; 0 where the stiffness at rest is asked for.
    """

    variables: Mapping[str, Any]
    dt: Any

    def __getitem__(self, name: str) -> Any:
        """An internal variable by name."""
        return self.variables[name]


class HistoryMaterial(Protocol):
    """What is asked of a material with a history, beside `linear = False` and `young`.

    The tangent is the derivative of `piola`, in which the variables of before are constant: where
    `piola` uses the new ones that `advance` gives, it is the consistent tangent of their update.

    Attributes:
        history: Internal variables by name with their shape, () of a number.
    """

    history: Mapping[str, tuple[int, ...]]

    def piola(self, u: Any, before: Before) -> Any:
        """First Piola-Kirchhoff stress at the end of an increment, (3, 3), UFL, stress."""
        ...

    def advance(self, u: Any, before: Before) -> Mapping[str, Any]:
        """All internal variables at the end of an increment, UFL, by name."""
        ...


class BodyHistory:
    """A material with a history, bound to what the points of a body have gone through.

    Args:
        material: The material.
        model: Mesh of the body.
        body: Its name.
        u: Displacement, a DOLFINx function.
        dt: Time increment, a constant of DOLFINx.
        degree: Degree of the quadrature at whose points the variables live.

    Raises:
        InputError: The material advances other variables than it has.

    Attributes:
        before: Accepted state, as the material is told of it.
    """

    linear = False

    def __init__(
        self, material: HistoryMaterial, model: Model, body: str, u: Any, dt: Any, degree: int
    ) -> None:
        self._material, self._mesh = material, model.mesh
        self._cells = np.sort(model.cells(body))
        self._owned = int(np.searchsorted(self._cells, model.mesh.topology.index_map(3).size_local))
        cell = model.mesh.basix_cell()
        self.points: Floats = np.asarray(basix.make_quadrature(cell, degree)[0], dtype=np.float64)
        variables = {n: self._zero(shape, degree) for n, shape in material.history.items()}
        self.before = Before(variables, dt)
        self._stress = self._zero((3, 3), degree)
        after = dict(material.advance(u, self.before))
        if after.keys() != variables.keys():
            text = f"advance gives {', '.join(after)}, history has {', '.join(variables)}"
            raise InputError(text, f"material.{body}")
        self._updates = [(variables[name], self._at_points(after[name])) for name in variables]
        self._updates.append((self._stress, self._at_points(cauchy_stress(self, u))))
        places = self._at_points(ufl.SpatialCoordinate(self._mesh))
        self._reference = places.eval(self._mesh, self._cells[: self._owned]).reshape(-1, 3)

    def piola(self, u: Any) -> Any:
        """First Piola-Kirchhoff stress, (3, 3), UFL, stress."""
        return self._material.piola(u, self.before)

    def stress(self) -> tuple[npt.NDArray[np.int32], Floats]:
        """Cells of the body on this rank, (n,), and true stress at their points, (n, points, 3, 3).

        It is that of the last accepted increment.
        """
        rows = self._rows(self._stress, len(self._cells))
        values = self._stress.x.array.reshape(-1, 3, 3)[rows]
        points = len(values) // max(len(self._cells), 1)
        return self._cells, values.reshape(len(self._cells), points, 3, 3)

    def commit(self) -> None:
        """Accept the increment: the displacement and the time increment are those of its end."""
        # all are evaluated from what was before, and then kept
        found = [expression.eval(self._mesh, self._cells) for _, expression in self._updates]
        for (variable, _), values in zip(self._updates, found, strict=True):
            self._write(variable, len(self._cells), values)

    def persistent(self) -> dict[str, Floats]:
        """Values at the points of cells this rank owns, (points, ...), and where these are."""
        kept = {
            name: variable.x.array.reshape(-1, variable.function_space.dofmap.bs)[
                self._rows(variable, self._owned)
            ]
            for name, variable in self._named().items()
        }
        return {"reference": self._reference} | kept

    def restore(self, kept: Mapping[str, Floats]) -> None:
        """Go on from what `persistent` gave; collective."""
        for name, variable in self._named().items():
            self._write(variable, self._owned, kept[name])
            variable.x.scatter_forward()

    def _named(self) -> dict[str, Any]:
        named = {f"{_VARIABLE}{name}": v for name, v in self.before.variables.items()}
        return named | {"stress": self._stress}

    def _zero(self, shape: tuple[int, ...], degree: int) -> Any:
        cell = self._mesh.basix_cell()
        element = basix.ufl.quadrature_element(cell, value_shape=shape, degree=degree)
        return fem.Function(fem.functionspace(self._mesh, element))

    def _at_points(self, expression: Any) -> Any:
        return compiled_expression(expression, self.points, self._mesh.comm)

    def _rows(self, variable: Any, cells: int) -> npt.NDArray[np.int32]:
        """Places of the points of the first cells of the body in the array of a variable."""
        return np.asarray(variable.function_space.dofmap.list[self._cells[:cells]].reshape(-1))

    def _write(self, variable: Any, cells: int, values: Floats) -> None:
        size = variable.function_space.dofmap.bs
        rows = self._rows(variable, cells)
        variable.x.array.reshape(-1, size)[rows] = values.reshape(-1, size)
