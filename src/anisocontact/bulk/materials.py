"""Materials of the bodies as UFL, by name."""

from __future__ import annotations

import reprlib
from typing import Any, ClassVar, Protocol

import numpy as np

from anisocontact.base import registry
from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import fem, ufl
from anisocontact.base.registry import Entry, Parameter
from anisocontact.base.sealed import Sealed
from anisocontact.bulk.volume import Volume
from anisocontact.mesh import Model


class Material(Protocol):
    """What the solver asks of a material.

    Linear materials have `stress(u)`, the stress conjugate to `sym(grad(v))`. The others have
    `piola(u)`, the first Piola-Kirchhoff stress conjugate to `grad(v)`, and `energy(u)`, terms of
    the energy per reference volume that are zero at rest, or one of the two.

    With `volume(u)`, a `Volume`, a material keeps the energy of its change of volume apart, so that
    cells do not lock: it is in `stress` and `piola`, and not in `parts` and `energy`.

    Attributes:
        linear: Whether the stress is linear in the displacement, so that the stiffness is constant.
        young: Young's modulus at rest, stress; scale of the default penalty.

    One that is not linear and takes displacement gradients to be small has `small_strain = True`.
    """

    linear: bool
    young: float


def small_strain(material: Any) -> bool:
    """Whether a material takes displacement gradients to be small: a linear one, or a law does.

    Args:
        material: The material.

    Returns:
        Whether it does.

    Raises:
        InputError: It is no material.

    Example:
        >>> from anisocontact.bulk import make_material
        >>> small_strain(make_material("neo-hookean", E=1.0, nu=0.3))
        False
    """
    if not hasattr(material, "linear"):
        raise InputError(f"{reprlib.repr(material)} given, a material needed", "material")
    of_law = material.linear or getattr(material, "strain", "") == "small"
    return bool(getattr(material, "small_strain", of_law))


#: A term of an energy per reference volume, UFL, and the degree of its quadrature, None for the
#: default.
type Density = tuple[Any, int | None]


def linear_parts(material: Any, u: Any) -> list[tuple[Any, int | None]]:
    """Stresses whose sum is that of a linear material, with the degree of quadrature of each."""
    return material.parts(u) if hasattr(material, "parts") else [(material.stress(u), None)]


def body_measure(model: Model) -> Any:
    """Measure of a form over bodies, numbered in the order of their names."""
    names = enumerate(model.body_names())
    cells = [(number, np.sort(model.cells(name))) for number, name in names]
    return ufl.Measure("dx", domain=model.mesh, subdomain_data=cells)


def constant(u: Any, value: float) -> Any:
    """A number of a form, so that one compiled form serves all values, UFL."""
    return fem.Constant(ufl.domain.extract_unique_domain(u), value)


#: Largest Poisson's ratio.
INCOMPRESSIBLE = 0.4999995


class Isotropic(Sealed):
    """A material of two moduli at rest.

    Where it is `incompressible`, nu = 0.5 is allowed and taken as `INCOMPRESSIBLE`, with a bulk
    modulus of 1e6 G: a pressure of the size of G changes the volume by 1e-6.

    Args:
        E: Young's modulus at rest, > 0, stress.
        nu: Poisson's ratio at rest, -1 < nu < 0.5.
        field: Where the material was written, for messages.
        **others: Other parameters of the entry.

    Raises:
        InputError: A value is out of range.
    """

    entry: Entry
    incompressible: ClassVar[bool] = False

    def __init__(self, *, E: float, nu: float, field: str = "", **others: Any) -> None:
        given = registry.values(self.entry, {"E": E, "nu": nu, **others}, field)
        (self.young,), (self.nu,) = given["E"], given["nu"]
        if self.incompressible and INCOMPRESSIBLE < self.nu <= 0.5:
            self.nu = INCOMPRESSIBLE
        if not -1.0 < self.nu < 0.5:
            path, bound = f"{field}.nu" if field else "nu", "<=" if self.incompressible else "<"
            text = f"{nu!r} given, must be > -1 and {bound} 0.5"
            if nu == 0.5:
                text += "; what keeps its volume is a material whose name ends on -incompressible"
            raise InputError(text, field=path)
        self._given = given

    @property
    def shear(self) -> float:
        """Shear modulus G, stress."""
        return self.young / (2.0 * (1.0 + self.nu))

    @property
    def lame(self) -> float:
        """First Lame constant lambda, stress."""
        return self.young * self.nu / ((1.0 + self.nu) * (1.0 - 2.0 * self.nu))

    @property
    def bulk_modulus(self) -> float:
        """Bulk modulus K, stress."""
        return self.lame + 2.0 / 3.0 * self.shear

    def constants(self, u: Any) -> tuple[Any, Any]:
        """Both as constants of a form, so that one compiled form serves all values.

        Args:
            u: UFL displacement.

        Returns:
            Lame constant and shear modulus, UFL, stress.
        """
        return constant(u, self.lame), constant(u, self.shear)


class LinearElastic(Isotropic):
    """Isotropic Hooke: `sigma = lambda tr(eps) I + 2 G eps`, `eps = sym(grad(u))`.

    Args:
        E: Young's modulus, > 0, stress.
        nu: Poisson's ratio, -1 < nu < 0.5.
        field: Where the material was written, for messages.

    Raises:
        InputError: A value is out of range.

    Example:
        >>> steel = LinearElastic(E=200.0, nu=0.25)
        >>> steel.shear, steel.lame
        (80.0, 80.0)
    """

    linear = True
    entry = Entry(
        "linear-elastic",
        "material",
        "isotropic linear elasticity at small strain",
        (
            Parameter("E", "scalar", "stress", "Young's modulus", "positive"),
            Parameter("nu", "scalar", "1", "Poisson's ratio, between -1 and 0.5"),
        ),
    )

    def stress(self, u: Any) -> Any:
        """UFL stress of the displacement `u`.

        Args:
            u: UFL displacement.

        Returns:
            Stress, (3, 3), UFL.
        """
        lame, shear = self.constants(u)
        strain = ufl.sym(ufl.grad(u))
        return lame * ufl.tr(strain) * ufl.Identity(3) + 2.0 * shear * strain


class LinearElasticIncompressible(LinearElastic):
    """`sigma = 2 G dev(eps) + K tr(eps) I`, incompressible or nearly so, see `Volume`.

    Args:
        E: Young's modulus, > 0, stress.
        nu: Poisson's ratio, -1 < nu <= 0.5, see `Isotropic`.
        field: Where the material was written, for messages.

    Raises:
        InputError: A value is out of range.

    Example:
        >>> round(LinearElasticIncompressible(E=3.0, nu=0.5).shear, 6)
        1.0
    """

    entry = Entry(
        "linear-elastic-incompressible",
        "material",
        "linear elasticity with a pressure in every cell, nu up to 0.5",
        (
            LinearElastic.entry.parameters[0],
            Parameter("nu", "scalar", "1", "Poisson's ratio, from above -1 to 0.5"),
        ),
    )
    incompressible = True

    def parts(self, u: Any) -> list[tuple[Any, int | None]]:
        """The deviator alone, (3, 3), UFL, stress."""
        return [(2.0 * constant(u, self.shear) * ufl.dev(ufl.sym(ufl.grad(u))), None)]

    def stress(self, u: Any) -> Any:
        """UFL stress of the displacement `u`, with the pressure of every point."""
        ((deviator, _),) = self.parts(u)
        return deviator + self.volume(u).stress(u)

    def volume(self, u: Any) -> Volume:
        """`tr(eps)`."""
        return Volume(constant(u, self.bulk_modulus), ufl.tr)
