"""Thermal expansion: what a body is strained beyond what its temperature makes of it.

A temperature given from outside stretches the body alike in all directions by `s = 1 + a dT`; its
material answers to what is left, `e - a dT I` at small strain, `F/s` at finite strain, where the
volume without stress is `s^3` of the reference [Holzapfel 2000, ch. 7].
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from anisocontact.base.array_types import Floats
from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import fem, ufl
from anisocontact.base.processes import on_all
from anisocontact.base.sampled import sampled
from anisocontact.base.sealed import Sealed
from anisocontact.base.typed import typed
from anisocontact.bulk.materials import Material, small_strain
from anisocontact.mesh import Idealisation, Model


@typed
class ThermalExpansion(Sealed):
    """A material with thermal expansion; see `Step.temperature`.

    Args:
        material: The material.
        expansion: Coefficient a of linear expansion, 1/temperature.
        profile: How much of the body's temperature there is at places (3, n), (n,); the same
            everywhere if left out.
        field: Where the coefficient was written, for messages.

    Raises:
        InputError: The coefficient is no finite number.

    Example:
        >>> from anisocontact.bulk import make_material
        >>> ThermalExpansion(make_material("linear-elastic", E=210e3, nu=0.3), 1.2e-5).young
        210000.0
    """

    linear = False

    def __init__(
        self,
        material: Material,
        expansion: float,
        profile: Callable[[Floats], Floats] | None = None,
        field: str = "expansion",
    ) -> None:
        if not math.isfinite(expansion):
            raise InputError(f"{expansion!r} given, a finite number needed", field)
        self.material, self.expansion, self.profile = material, expansion, profile
        self.young, self.small_strain = material.young, small_strain(material)


def without_expansion(material: Material) -> Any:
    """A material without its expansion.

    Args:
        material: The material.

    Returns:
        What it is made of; the material itself if it does not expand.

    Example:
        >>> from anisocontact.bulk import make_material
        >>> steel = make_material("linear-elastic", E=210e3, nu=0.3)
        >>> without_expansion(ThermalExpansion(steel, 1.2e-5)) is steel
        True
    """
    return material.material if isinstance(material, ThermalExpansion) else material


class Heated(Idealisation):
    """Mechanical part of the gradients of a body with thermal expansion.

    Args:
        law: Its material.
        model: The mesh.

    Raises:
        InputError: The profile of its temperature fails, or is none.

    Attributes:
        stretch: What it has at its temperature without stress where strain is finite, UFL; else 1.
        stretches: Its derivative by the temperature, 1/temperature, UFL; that of the strain at
            small strain.
    """

    def __init__(self, law: ThermalExpansion, model: Model) -> None:
        self._ideal = model.idealisation
        self._small = law.small_strain
        self._temperature: Any = fem.Constant(model.mesh, 0.0)
        self.stretches: Any = law.expansion
        if law.profile is not None:
            share = fem.Function(fem.functionspace(model.mesh, ("Lagrange", model.order)))
            of = _profile(law.profile)
            on_all(model.mesh.comm, lambda: share.interpolate(of))
            self.stretches = law.expansion * share
        self._strain = self.stretches * self._temperature
        self.stretch: Any = 1.0 if self._small else 1.0 + self._strain

    @property
    def temperature(self) -> float:
        """Temperature over that without stress."""
        return float(self._temperature.value)

    def set_temperature(self, value: float) -> None:
        """Take over the temperature over that without stress."""
        self._temperature.value = value

    def thermal_force(self, stored: Any, stress: Any, gradient: Any) -> Any:
        """Thermodynamic force conjugate to a stretch s by temperature.

        What it gives where displacements and internal variables stay is `d(s^3 W(F/s)) / ds =
        s^2 (3 W - P : F/s)`, here without `s^2`, and `-tr(P)` at small strain.

        Args:
            stored: Energy W per volume without stress.
            stress: First Piola-Kirchhoff stress P of `F/s`, (3, 3).
            gradient: `F/s - I`, (3, 3); all of them UFL.

        Returns:
            UFL, energy/volume.
        """
        if self._small:
            return -ufl.tr(stress)
        return 3.0 * stored - ufl.inner(stress, ufl.Identity(3) + gradient)

    def gradient(self, u: Any) -> Any:
        """As of `Idealisation`."""
        return self._ideal.gradient(u)

    def seen(self, expression: Any, u: Any) -> Any:
        """An expression of `grad(u)` as one of what is not made by the temperature, UFL."""
        return self._ideal.seen(self._left(expression, u), u)

    def stress(self, expression: Any, u: Any) -> Any:
        """As of `Idealisation`."""
        return self._ideal.stress(self._left(expression, u), u)

    def at_nodes(self, expression: Any, u: Any) -> Any:
        """As of `Idealisation`."""
        return self._ideal.at_nodes(self._left(expression, u), u)

    def _left(self, expression: Any, u: Any) -> Any:
        eye, gradient = ufl.Identity(3), ufl.grad(u)
        left = gradient - self._strain * eye
        if not self._small:
            left = (eye + gradient) / self.stretch - eye
        return ufl.replace(expression, {gradient: left})


def _profile(given: Callable[[Floats], Floats]) -> Callable[[Floats], Floats]:
    """A profile whose answers are looked at: DOLFINx takes some that have another length."""
    return lambda x: sampled(given, x, x.shape[1:], field="profile", axis=1)
