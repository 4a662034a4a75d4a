"""Materials of the bodies as UFL, by name."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np

from anisocontact.base import registry
from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import fem, ufl
from anisocontact.base.registry import Entry, Parameter
from anisocontact.mesh import Model


class Material(Protocol):
    """What the solver asks of a material.

    Linear materials have `stress(u)`, the stress conjugate to `sym(grad(v))`. The others have
    `piola(u)`, the first Piola-Kirchhoff stress conjugate to `grad(v)`, and `energy(u)`, terms of
    the energy per reference volume, or one of the two.

    Attributes:
        linear: Whether the stress is linear in the displacement, so that the stiffness is constant.
        young: Young's modulus at rest, stress; scale of the default penalty.

    One that is not linear and takes displacement gradients to be small has `small_strain = True`.
    """

    linear: bool
    young: float


def small_strain(material: Any) -> bool:
    """Whether a material takes displacement gradients to be small: a linear one, or a law does."""
    of_law = material.linear or getattr(material, "strain", "") == "small"
    return bool(getattr(material, "small_strain", of_law))


#: A term of an energy per reference volume, UFL, and the degree of its quadrature, None for the
#: default.
type Density = tuple[Any, int | None]


def reduced_degree(u: Any) -> int:
    """Degree of a quadrature with so few points that cells do not lock.

    One point of a cell, of second-order hexahedra eight: as many constraints as the displacement
    can meet [Malkus Hughes 1978, equivalence of reduced integration and a pressure of lower order].
    Hexahedra and second-order tetrahedra do not lock with it; first-order tetrahedra have one point
    anyway, and do.

    Args:
        u: Displacement, a DOLFINx function or an argument of a form.
    """
    element = u.ufl_function_space().element.basix_element
    tensor = element.cell_type.name in ("hexahedron", "quadrilateral")
    return 2 if tensor and element.degree == 2 else 1


def linear_parts(material: Any, u: Any) -> list[tuple[Any, int | None]]:
    """Stresses whose sum is that of a linear material, with the degree of quadrature of each."""
    return material.parts(u) if hasattr(material, "parts") else [(material.stress(u), None)]


def body_measure(model: Model) -> Any:
    """Measure of a form over bodies, numbered in the order of their names."""
    names = enumerate(model.body_names())
    cells = [(number, np.sort(model.cells(name))) for number, name in names]
    return ufl.Measure("dx", domain=model.mesh, subdomain_data=cells)


class Isotropic:
    """A material of two moduli at rest.

    Args:
        E: Young's modulus at rest, > 0, stress.
        nu: Poisson's ratio at rest, -1 < nu < 0.5.
        field: Where the material was written, for messages.
        **others: Other parameters of the entry.

    Raises:
        InputError: A value is out of range.
    """

    entry: Entry

    def __init__(self, *, E: float, nu: float, field: str = "", **others: Any) -> None:
        given = registry.values(self.entry, {"E": E, "nu": nu, **others}, field)
        (self.young,), (self.nu,) = given["E"], given["nu"]
        if not -1.0 < self.nu < 0.5:
            path = f"{field}.nu" if field else "nu"
            raise InputError(f"{nu!r} given, must be > -1 and < 0.5", field=path)
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
        domain = ufl.domain.extract_unique_domain(u)
        return fem.Constant(domain, self.lame), fem.Constant(domain, self.shear)


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
    """`sigma = 2 G dev(eps) + K tr(eps) I` whose second term is integrated at fewer points.

    Args:
        E: Young's modulus, > 0, stress.
        nu: Poisson's ratio, -1 < nu < 0.5; its stiffness grows as 1 / (1 - 2 nu).
        field: Where the material was written, for messages.

    Raises:
        InputError: A value is out of range.
    """

    entry = Entry(
        "linear-elastic-incompressible",
        "material",
        "nearly incompressible linear elasticity, volume term by reduced integration",
        LinearElastic.entry.parameters,
    )

    def parts(self, u: Any) -> list[tuple[Any, int | None]]:
        """Deviator, and pressure at the points of `reduced_degree`, (3, 3) each, UFL, stress."""
        domain = ufl.domain.extract_unique_domain(u)
        bulk, (_, shear) = fem.Constant(domain, self.bulk_modulus), self.constants(u)
        strain = ufl.sym(ufl.grad(u))
        deviator = 2.0 * shear * (strain - ufl.tr(strain) / 3.0 * ufl.Identity(3))
        return [(deviator, None), (bulk * ufl.tr(strain) * ufl.Identity(3), reduced_degree(u))]
