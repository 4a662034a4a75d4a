"""Elasticity with directions: wood, rolled sheet, weave, wound rings.

The stiffness is that of the engineering constants along three orthogonal axes of the body
[Ting 1996, ch. 2]. The axes are the same everywhere, or those of a cylinder: outwards, around and
along its axis.
"""

from __future__ import annotations

from abc import abstractmethod
from typing import Any

import numpy as np

from anisocontact.base import registry
from anisocontact.base.array_types import Floats
from anisocontact.base.errors import InputError, within
from anisocontact.base.fenicsx import fem, ufl
from anisocontact.base.registry import Entry, Parameter
from anisocontact.base.sealed import Sealed
from anisocontact.bulk.axes import AROUND, SECOND, MaterialAxes, check_axes, first_axis
from anisocontact.bulk.hyperelastic import Hyperelastic
from anisocontact.bulk.materials import Density

#: Pairs of axes of the shear components, after the three normal ones.
_SHEARS = ((0, 1), (0, 2), (1, 2))
_STRAINS = ("small", "green-lagrange")
_STRAIN = Parameter(
    "strain",
    "choice",
    "1",
    "strain that the stress is linear in: small, or of Green and Lagrange for bodies that turn",
    default=(0.0,),
    choices=_STRAINS,
)


def stiffness(moduli: Floats, ratios: Floats, shears: Floats) -> Floats:
    """Stiffness along the axes from engineering constants, (6, 6), stress.

    Args:
        moduli: E1, E2, E3, stress.
        ratios: nu12, nu13, nu23: strain along the second index for one along the first.
        shears: G12, G13, G23, stress.

    Returns:
        D in `(s11, s22, s33, s12, s13, s23) = D (e11, e22, e33, 2 e12, 2 e13, 2 e23)`.

    Raises:
        InputError: No such material can be stable: D is not positive definite.

    Example:
        >>> one = np.ones(3)
        >>> stiffness(2.0 * one, 0.0 * one, one).diagonal().tolist()
        [2.0, 2.0, 2.0, 1.0, 1.0, 1.0]
    """
    compliance = np.diag([*(1.0 / moduli), *(1.0 / shears)])
    for (i, j), nu in zip(_SHEARS, ratios, strict=True):
        compliance[i, j] = compliance[j, i] = -nu / moduli[i]
    # sizes of the moduli have no part in it: unit diagonal
    scaled = compliance / np.sqrt(np.outer(compliance.diagonal(), compliance.diagonal()))
    least = float(np.linalg.eigvalsh(scaled)[0])
    if least <= 1e-12:
        raise InputError(
            "the Poisson's ratios make the elastic energy indefinite: |nu_ij| < sqrt(E_i / E_j) is "
            "needed for each pair, and together the smallest eigenvalue of the scaled compliance, "
            f"{least:.3g}, has to be > 0"
        )
    found: Floats = np.linalg.inv(compliance)
    return found


class _Directed(Sealed, Hyperelastic):
    """A linear law between strain and stress along axes of the body."""

    entry: Entry

    def __init__(self, *, field: str = "", **parameters: Any) -> None:
        given = registry.values(self.entry, parameters, field)
        with within(field):
            self._stiffness = self._of({name: np.array(v) for name, v in given.items()})
        #: Largest of the moduli: a penalty is to be stiff against every direction.
        self.young = float(1.0 / np.linalg.inv(self._stiffness).diagonal()[:3].min())
        self.linear = _STRAINS[int(given["strain"][0])] == "small"
        first, second = self._directions(given)
        check_axes(self.entry.parameters, parameters, field)
        self._axes = MaterialAxes(first, second, given["around"], field)

    @abstractmethod
    def _of(self, given: dict[str, Floats]) -> Floats:
        """Stiffness along the axes, (6, 6), of the checked values."""

    @abstractmethod
    def _directions(self, given: dict[str, list[float]]) -> tuple[Floats, Floats]:
        """Two vectors that span the plane of the first two axes."""

    def _along_axes(self, u: Any, strain: Any) -> tuple[Any, Any]:
        """Stress in the order of `stiffness` and strain, both along the axes, UFL, (6,)."""
        axes = self._axes.form(u)
        e = axes.T * strain * axes
        listed = ufl.as_vector([*(e[i, i] for i in range(3)), *(2.0 * e[i, j] for i, j in _SHEARS)])
        domain = ufl.domain.extract_unique_domain(u)
        return fem.Constant(domain, self._stiffness) * listed, listed

    def stress(self, u: Any) -> Any:
        """UFL stress of the displacement `u` at small strain.

        Returns:
            Stress, (3, 3), UFL.
        """
        s, _ = self._along_axes(u, ufl.sym(ufl.grad(u)))
        t = ufl.as_matrix([[s[0], s[3], s[4]], [s[3], s[1], s[5]], [s[4], s[5], s[2]]])
        axes = self._axes.form(u)
        return axes * t * axes.T

    def _terms(self, u: Any, gradient: Any) -> list[Density]:
        """Half of stress times strain of Green and Lagrange."""
        strain = 0.5 * (gradient.T * gradient - ufl.Identity(3))
        stress, listed = self._along_axes(u, strain)
        return [(0.5 * ufl.dot(stress, listed), None)]


class Orthotropic(_Directed):
    """Elasticity with three orthogonal planes of symmetry, by its nine engineering constants.

    Args:
        E: Young's moduli along the three axes, > 0, stress.
        nu: nu12, nu13, nu23, where `nu_ij = -e_j / e_i` under a stress along i.
        G: Shear moduli G12, G13, G23, > 0, stress.
        first: First axis; (1, 0, 0) if left out.
        second: Second axis, made orthogonal to the first; (0, 1, 0) if left out.
        around: A point and a direction: axes outwards from this line, around it and along it,
            instead of `first` and `second`.
        strain: "small", or "green-lagrange" for bodies that turn.
        field: Where the material was written, for messages.

    Raises:
        InputError: A value is out of range, or no such material can be stable.

    Example:
        >>> spruce = Orthotropic(E=(11e3, 900, 500), nu=(0.4, 0.4, 0.4), G=(700, 600, 40))
        >>> round(spruce.young)
        11000
    """

    entry = Entry(
        "orthotropic",
        "material",
        "linear elasticity with three orthogonal axes: wood, rolled sheet, weave, wound rings",
        (
            Parameter("E", "vector", "stress", "Young's moduli along the three axes", "positive"),
            Parameter("nu", "vector", "1", "Poisson's ratios nu12, nu13, nu23"),
            Parameter("G", "vector", "stress", "shear moduli G12, G13, G23", "positive"),
            first_axis("first", "first axis"),
            SECOND,
            AROUND,
            _STRAIN,
        ),
    )

    def _of(self, given: dict[str, Floats]) -> Floats:
        return stiffness(given["E"], given["nu"], given["G"])

    def _directions(self, given: dict[str, list[float]]) -> tuple[Floats, Floats]:
        return np.array(given["first"]), np.array(given["second"])


class TransverselyIsotropic(_Directed):
    """Elasticity with one axis: fibres, or layers that are stacked along it.

    Args:
        E_along: Young's modulus along the axis, > 0, stress.
        E_across: Young's modulus across it, > 0, stress.
        nu_along: Strain across for one along under a stress along the axis.
        nu_across: Poisson's ratio in the plane across the axis.
        G_along: Shear modulus of planes with the axis, > 0, stress; that across it is
            `E_across / (2 (1 + nu_across))`.
        along: The axis; (1, 0, 0) if left out.
        around: A point and a direction: the axis of the material goes around this line, as fibres
            of a wound ring do.
        strain: "small", or "green-lagrange" for bodies that turn.
        field: Where the material was written, for messages.

    Raises:
        InputError: A value is out of range, or no such material can be stable.

    Example:
        >>> fibres = TransverselyIsotropic(
        ...     E_along=10.0, E_across=1.0, nu_along=0.3, nu_across=0.3, G_along=0.5
        ... )
        >>> fibres.young
        10.0
    """

    entry = Entry(
        "transversely-isotropic",
        "material",
        "linear elasticity with one axis: fibres, stacked layers, wound rings",
        (
            Parameter("E_along", "scalar", "stress", "Young's modulus along the axis", "positive"),
            Parameter("E_across", "scalar", "stress", "Young's modulus across it", "positive"),
            Parameter("nu_along", "scalar", "1", "strain across for one along the axis"),
            Parameter("nu_across", "scalar", "1", "Poisson's ratio in the plane across the axis"),
            Parameter("G_along", "scalar", "stress", "shear modulus along the axis", "positive"),
            first_axis("along", "the axis"),
            Parameter(
                "around",
                "axis",
                "length",
                "axis of a cylinder that the axis of the material goes around",
                "nonzero",
                False,
            ),
            _STRAIN,
        ),
    )

    def _of(self, given: dict[str, Floats]) -> Floats:
        names = ("E_along", "E_across", "nu_along", "nu_across", "G_along")
        along, across, ratio, ratio_across, shear = (float(given[name][0]) for name in names)
        if ratio_across <= -1.0:
            raise InputError(f"nu_across: {ratio_across!r} given, must be > -1")
        shear_across = across / (2.0 * (1.0 + ratio_across))
        # the second axis is the one of the material where it goes around a cylinder
        order = [1, 0, 2] if given["around"].size else [0, 1, 2]
        moduli = np.array([along, across, across])[order]
        pairs = {
            (0, 1): (ratio, shear),
            (0, 2): (ratio, shear),
            (1, 2): (ratio_across, shear_across),
        }
        ratios, shears = [], []
        for i, j in _SHEARS:
            a, b = order[i], order[j]
            nu, g = pairs[min(a, b), max(a, b)]
            # nu_ij / E_i = nu_ji / E_j
            ratios.append(nu if a < b else nu * moduli[i] / moduli[j])
            shears.append(g)
        return stiffness(moduli, np.array(ratios), np.array(shears))

    def _directions(self, given: dict[str, list[float]]) -> tuple[Floats, Floats]:
        along = np.array(given["along"])
        return along, np.eye(3)[np.argmin(np.abs(along))]
