"""Materials with a history in UFL: internal variables at the quadrature points of a body."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, Protocol

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import ufl
from anisocontact.bulk.at_points import AtPoints
from anisocontact.bulk.expansion import Heated
from anisocontact.bulk.hyperelastic import cauchy_stress
from anisocontact.mesh import Model


@dataclass(frozen=True)
class PreviousState:
    """Internal variables of the last accepted increment, and the time since.

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
    """Protocol of a material with internal variables, beside `linear = False` and `young`.

    The tangent is the derivative of `piola`, in which the variables of before are constant: where
    `piola` uses the new ones that `advance` gives, it is the consistent tangent of their update.
    With `stored(u, before)` and `dissipated(u, before)`, per reference volume, at the end of an
    increment and in it, a run has a balance of energy.

    Attributes:
        history: Internal variables by name with their shape, () of a number.

    Example:
        A dashpot: it remembers the strain of the increment before.

        >>> class Dashpot:
        ...     linear, young = False, 1.0
        ...     history = {"strain": (3, 3)}
        ...     def advance(self, u, before):
        ...         return {"strain": ufl.sym(ufl.grad(u))}
        ...     def piola(self, u, before):
        ...         return 2.0 * (ufl.sym(ufl.grad(u)) - before["strain"]) / before.dt
        >>> sorted(Dashpot.history)
        ['strain']
    """

    history: Mapping[str, tuple[int, ...]]

    def piola(self, u: Any, before: PreviousState) -> Any:
        """First Piola-Kirchhoff stress at the end of an increment.

        Args:
            u: Displacement at the end of the increment, UFL.
            before: Accepted variables by name, and the time increment `dt`.

        Returns:
            The stress, (3, 3), UFL, stress.
        """
        ...

    def advance(self, u: Any, before: PreviousState) -> Mapping[str, Any]:
        """All internal variables at the end of an increment.

        Args:
            u: Displacement at the end of the increment, UFL.
            before: Accepted variables by name, and the time increment `dt`.

        Returns:
            Each by its name, UFL, of the shape in `history`.
        """
        ...


class BodyHistory(AtPoints):
    """A material with a history, bound to what the points of a body have gone through.

    Args:
        material: The material.
        model: Mesh of the body.
        body: Its name.
        u: Displacement, a DOLFINx function.
        dt: Time increment, a constant of DOLFINx.
        degree: Degree of the quadrature at whose points the variables live.
        heated: How gradients are seen where the body expands; as those of the mesh if left out.

    Raises:
        InputError: The material advances other variables than it has.

    Attributes:
        before: Accepted state, as the material sees it.
        stores: Whether the material says what it stores and dissipates.
    """

    def __init__(
        self,
        material: HistoryMaterial,
        model: Model,
        body: str,
        u: Any,
        dt: Any,
        degree: int,
        heated: Heated | None = None,
    ) -> None:
        super().__init__(model, body, material.history, degree, heated)
        self._material = material
        self.before = PreviousState(self.variables, dt)
        after = dict(material.advance(u, self.before))
        if after.keys() != self.variables.keys():
            text = f"advance gives {', '.join(after)}, history has {', '.join(self.variables)}"
            raise InputError(text, f"material.{body}")
        # in the plane grad(u) has more than the derivatives along it
        seen = partial(self._ideal.seen, u=u)
        parts = [(v, seen(after[name])) for name, v in self.variables.items()]
        parts.append((self._stress, seen(cauchy_stress(self, u))))
        told: Any = material
        self.stores = hasattr(told, "stored")
        if self.stores:
            lost = seen(told.dissipated(u, self.before)) * (heated.stretch**3 if heated else 1.0)
            stored = seen(told.stored(u, self.before))
            parts += [(self.stored, stored), (self.dissipated, self.dissipated + lost)]
            if heated:
                stress, gradient = seen(self.piola(u)), seen(ufl.grad(u))
                parts.append((self.thermal_force, heated.thermal_force(stored, stress, gradient)))
        self._kept = [variable for variable, _ in parts]
        # one expression: what the parts share is compiled and evaluated once
        components = [one for _, part in parts for one in _components(part)]
        self._after = self._at_points(ufl.as_vector(components))

    def piola(self, u: Any) -> Any:
        """First Piola-Kirchhoff stress, (3, 3), UFL, stress."""
        return self._material.piola(u, self.before)

    def commit(self) -> None:
        """Accept the increment: the displacement and the time increment are those of its end."""
        for variable, values in zip(self._kept, self._now(), strict=True):
            self._write(variable, values)

    def _trial_stress(self) -> Floats:
        return self._now()[self._kept.index(self._stress)]

    def _trial_thermal_force(self) -> Floats:
        return self._now()[self._kept.index(self.thermal_force)]

    def _now(self) -> list[Floats]:
        """What is kept of an accepted increment, of the displacement now, each (points, ...)."""
        found = np.asarray(self._after.eval(self._mesh, self._cells), dtype=np.float64)
        widths = [variable.function_space.dofmap.bs for variable in self._kept]
        return np.split(found.reshape(-1, sum(widths)), np.cumsum(widths)[:-1], axis=1)


def _components(part: Any) -> list[Any]:
    """Components of a number or a tensor in UFL, row by row."""
    part = ufl.as_ufl(part)
    return [part[i] for i in np.ndindex(part.ufl_shape)] if part.ufl_shape else [part]
