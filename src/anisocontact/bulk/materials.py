"""Materials of the bodies as UFL, by name."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

from anisocontact import registry
from anisocontact._fenicsx import fem, ufl
from anisocontact.errors import InputError
from anisocontact.registry import Entry, Parameter


class Material(Protocol):
    """What the solver asks of a material.

    Attributes:
        linear: Whether the stress is linear in the displacement, so that the stiffness is constant.
        young: Young's modulus at rest, stress; scale of the default penalty.
    """

    linear: bool
    young: float

    def stress(self, u: Any) -> Any:
        """UFL stress, work conjugate to `sym(grad(v))`, of the UFL displacement `u`."""
        ...


class LinearElastic:
    """Isotropic Hooke: `sigma = lambda tr(eps) I + 2 G eps`, `eps = sym(grad(u))`.

    Args:
        E: Young's modulus, > 0, stress.
        nu: Poisson's ratio, -1 < nu < 0.5.
        field: Where the material was written, for messages.

    Raises:
        InputError: A value is out of range.
    """

    linear = True

    def __init__(self, *, E: float, nu: float, field: str = "") -> None:
        given = registry.values(LINEAR_ELASTIC, {"E": E, "nu": nu}, field)
        (self.young,), (self.nu,) = given["E"], given["nu"]
        if not -1.0 < self.nu < 0.5:
            path = f"{field}.nu" if field else "nu"
            raise InputError(f"{nu!r} given, must be > -1 and < 0.5", field=path)

    @property
    def shear(self) -> float:
        """Shear modulus G, stress."""
        return self.young / (2.0 * (1.0 + self.nu))

    @property
    def lame(self) -> float:
        """First Lame constant lambda, stress."""
        return self.young * self.nu / ((1.0 + self.nu) * (1.0 - 2.0 * self.nu))

    def stress(self, u: Any) -> Any:
        """UFL stress of the displacement `u`; the moduli are constants of the form."""
        domain = ufl.domain.extract_unique_domain(u)
        lame, shear = fem.Constant(domain, self.lame), fem.Constant(domain, self.shear)
        strain = ufl.sym(ufl.grad(u))
        return lame * ufl.tr(strain) * ufl.Identity(3) + 2.0 * shear * strain


LINEAR_ELASTIC = Entry(
    "linear-elastic",
    "material",
    "isotropic linear elasticity at small strain",
    (
        Parameter("E", "scalar", "stress", "Young's modulus", "positive"),
        Parameter("nu", "scalar", "1", "Poisson's ratio, between -1 and 0.5"),
    ),
)

_MATERIALS: dict[str, tuple[Entry, Callable[..., Material]]] = {
    LINEAR_ELASTIC.name: (LINEAR_ELASTIC, LinearElastic),
}


def materials() -> tuple[Entry, ...]:
    """The registered materials with their parameters."""
    return tuple(entry for entry, _ in _MATERIALS.values())


def make_material(model: str, *, field: str = "", **parameters: float) -> Material:
    """Material by name.

    Args:
        model: Name of a registered material.
        field: Where the material was written, for messages.
        **parameters: Its parameters.

    Returns:
        The material.

    Raises:
        InputError: Unknown name or parameter, a parameter missing or out of range.

    Example:
        >>> make_material("linear-elastic", E=210e3, nu=0.3).young
        210000.0
    """
    entry = registry.entry(materials(), model, f"{field}.model" if field else "model")
    registry.values(entry, parameters, field)
    return _MATERIALS[model][1](**parameters, field=field)
