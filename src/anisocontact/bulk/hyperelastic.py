"""Materials at finite strain, by their energy per reference volume or their stress."""

from __future__ import annotations

import math
import reprlib
from abc import ABC, abstractmethod
from collections.abc import Callable
from numbers import Real
from typing import Any

from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import ufl
from anisocontact.base.registry import Entry, Parameter
from anisocontact.base.sealed import Sealed
from anisocontact.base.typed import typed
from anisocontact.bulk.materials import Density, Isotropic, constant, small_strain
from anisocontact.bulk.user_function import check_function
from anisocontact.bulk.volume import (
    Volume,
    derivative_at,
    volume_of,
    volume_ratio,
    without_variables,
)

_MODULI = (
    Parameter("E", "scalar", "stress", "Young's modulus at rest", "positive"),
    Parameter("nu", "scalar", "1", "Poisson's ratio at rest, between -1 and 0.5"),
)


def deformation_gradient(u: Any) -> Any:
    """`F = I + grad(u)`, UFL.

    Args:
        u: UFL displacement.

    Returns:
        F, (3, 3), UFL.

    Raises:
        InputError: Something else than a vector of three components was given.

    Example:
        >>> from anisocontact.base.fenicsx import fem
        >>> from anisocontact.mesh import BoxSpec, build_box
        >>> model = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1))})
        >>> deformation_gradient(fem.Function(model.space)).ufl_shape
        (3, 3)
    """
    return ufl.Identity(3) + ufl.grad(_displacement(u))


def _displacement(u: Any) -> Any:
    """What was given, if it can be one."""
    if isinstance(u, ufl.core.expr.Expr) and u.ufl_shape == (3,):
        return u
    raise InputError(f"{reprlib.repr(u)} given, a UFL vector of 3 components needed", "u")


def cauchy_stress(material: Any, u: Any, pressure: Any = None) -> Any:
    """True stress of any material, UFL: `P F^T / J` at finite strain.

    Args:
        material: The material.
        u: UFL displacement.
        pressure: That of the cells where the material keeps its change of volume apart, UFL; that
            of every point if left out.

    Returns:
        Stress tensor, (3, 3), stress.

    Raises:
        InputError: One of them is something else, or the material keeps no change of volume apart.

    Example:
        >>> from anisocontact.base.fenicsx import fem
        >>> from anisocontact.mesh import BoxSpec, build_box
        >>> model = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1))})
        >>> cauchy_stress(NeoHookean(E=3.0, nu=0.25), fem.Function(model.space)).ufl_shape
        (3, 3)
    """
    small, u = small_strain(material), _displacement(u)
    stress = material.stress(u) if material.linear else material.piola(u)
    if pressure is not None:
        stress += _stress_of_pressure(material, u, pressure)
    if small:
        return stress
    gradient = deformation_gradient(u)
    return stress * gradient.T / ufl.det(gradient)


def _stress_of_pressure(material: Any, u: Any, pressure: Any) -> Any:
    """What a pressure of the cells adds to the stress, in the place of that of every point."""
    volume = volume_of(material, u)
    if volume is None:
        name = type(material).__name__
        raise InputError(f"given, {name} keeps no change of volume apart", "pressure")
    if not isinstance(pressure, ufl.core.expr.Expr | Real) or ufl.shape(pressure) != ():
        text = f"{reprlib.repr(pressure)} given, a UFL expression of one number needed"
        raise InputError(text, "pressure")
    return volume.stress(u, pressure) - volume.stress(u)


class Hyperelastic(ABC):
    """A material by its energy."""

    linear = False

    def piola(self, u: Any) -> Any:
        """First Piola-Kirchhoff stress, the derivative of the energy with respect to F, UFL."""
        stress = derivative_at(
            lambda gradient: sum(w for w, _ in self._terms(u, gradient)), deformation_gradient(u)
        )
        volume = volume_of(self, u)
        return stress if volume is None else stress + volume.stress(u)

    def energy(self, u: Any) -> list[Density]:
        """Terms of the energy with the degree of the quadrature each asks for."""
        return self._terms(u, deformation_gradient(u))

    @abstractmethod
    def _terms(self, u: Any, gradient: Any) -> list[Density]:
        """Terms of the energy for a deformation gradient."""


class StVenantKirchhoff(Isotropic, Hyperelastic):
    """`W = lambda/2 (tr E)^2 + G E:E` of the Green-Lagrange strain E.

    For large rotations at small strain; it softens in strong compression.

    Args:
        E: Young's modulus, > 0, stress.
        nu: Poisson's ratio, -1 < nu < 0.5.
        field: Where the material was written, for messages.

    Raises:
        InputError: A value is out of range.

    Example:
        >>> StVenantKirchhoff(E=200.0, nu=0.25).shear
        80.0
    """

    entry = Entry(
        "st-venant-kirchhoff",
        "material",
        "linear in the Green-Lagrange strain, for large rotations at small strain",
        _MODULI,
    )

    def _terms(self, u: Any, gradient: Any) -> list[Density]:
        lame, shear = self.constants(u)
        strain = 0.5 * (gradient.T * gradient - ufl.Identity(3))
        return [
            (0.5 * lame * ufl.tr(strain) ** 2 + shear * ufl.inner(strain, strain), None),
        ]


class NeoHookean(Isotropic, Hyperelastic):
    """`W = G/2 (tr C - 3 - 2 ln J) + lambda/2 (ln J)^2`, compressible.

    Args:
        E: Young's modulus at rest, > 0, stress.
        nu: Poisson's ratio at rest, -1 < nu < 0.5.
        field: Where the material was written, for messages.

    Raises:
        InputError: A value is out of range.

    Example:
        >>> rubber = NeoHookean(E=3.0, nu=0.25)
        >>> rubber.shear, rubber.lame
        (1.2, 1.2)
    """

    entry = Entry("neo-hookean", "material", "compressible neo-Hookean rubber", _MODULI)

    def _terms(self, u: Any, gradient: Any) -> list[Density]:
        lame, shear = self.constants(u)
        log_j = ufl.ln(ufl.det(gradient))
        first = ufl.tr(gradient.T * gradient)
        return [(0.5 * shear * (first - 3.0 - 2.0 * log_j) + 0.5 * lame * log_j**2, None)]


class NeoHookeanIncompressible(Isotropic, Hyperelastic):
    """`W = G/2 (J^(-2/3) tr C - 3) + K/2 (J - 1)^2`, incompressible or nearly so, see `Volume`.

    Args:
        E: Young's modulus at rest, > 0, stress.
        nu: Poisson's ratio at rest, -1 < nu <= 0.5, see `Isotropic`.
        field: Where the material was written, for messages.

    Raises:
        InputError: A value is out of range.

    Example:
        >>> round(NeoHookeanIncompressible(E=3.0, nu=0.5).shear, 5)
        1.0
    """

    entry = Entry(
        "neo-hookean-incompressible",
        "material",
        "neo-Hookean rubber with a pressure in every cell, nu up to 0.5",
        _MODULI,
    )
    incompressible = True

    def _terms(self, u: Any, gradient: Any) -> list[Density]:
        shear, first = constant(u, self.shear), ufl.tr(gradient.T * gradient)
        return [(0.5 * shear * (ufl.det(gradient) ** (-2.0 / 3.0) * first - 3.0), None)]

    def volume(self, u: Any) -> Volume:
        """`J - 1`."""
        return Volume(constant(u, self.bulk_modulus), volume_ratio)


@typed
class UserEnergy(Sealed, Hyperelastic):
    """A material by the user's own energy.

    Args:
        energy: Takes the UFL deformation gradient, returns the energy per reference volume; it
            counts from what it is at F = I.
        young: Young's modulus at rest, the scale of the default penalty, stress.
        name: What the energy is called in messages.

    Raises:
        InputError: The energy fails, is no number or does not depend on its argument.

    Example:
        >>> rubber = UserEnergy(lambda F: 0.5 * ufl.inner(F, F) - ufl.ln(ufl.det(F)), young=2.0)
        >>> rubber.linear
        False
    """

    def __init__(self, energy: Callable[[Any], Any], young: float, *, name: str = "energy") -> None:
        check_function(energy, name, ())
        self._energy = energy
        self.young = _scale(young)

    def energy(self, u: Any) -> list[Density]:
        """The energy, less that at F = I: bodies that are not strained store none."""
        ((stored, degree),) = super().energy(u)
        at_rest = without_variables(ufl.as_ufl(self._energy(ufl.variable(ufl.Identity(3)))))
        return [(stored - at_rest, degree)]

    def _terms(self, u: Any, gradient: Any) -> list[Density]:
        return [(self._energy(gradient), None)]


@typed
class UserStress(Sealed):
    """A material by the user's own stress; it need not come from an energy.

    Args:
        piola: Takes the UFL deformation gradient, returns the first Piola-Kirchhoff stress.
        young: Young's modulus at rest, the scale of the default penalty, stress.
        name: What the stress is called in messages.

    Raises:
        InputError: The stress fails, is no tensor or does not depend on its argument.

    Example:
        >>> spring = UserStress(lambda F: 2.0 * (F - ufl.Identity(3)), young=2.0)
        >>> spring.linear
        False
    """

    linear = False

    def __init__(self, piola: Callable[[Any], Any], young: float, *, name: str = "piola") -> None:
        check_function(piola, name, (3, 3))
        self._piola = piola
        self.young = _scale(young)

    def piola(self, u: Any) -> Any:
        """First Piola-Kirchhoff stress.

        Args:
            u: Displacement, UFL.

        Returns:
            The stress, (3, 3), UFL, stress.
        """
        return self._piola(deformation_gradient(u))


def _scale(young: float) -> float:
    """Young's modulus at rest, of which penalties are made."""
    if not 0.0 < young < math.inf:
        raise InputError(f"{young!r} given, Young's modulus at rest needed, > 0", "young")
    return young
