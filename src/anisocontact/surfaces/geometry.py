"""Differential geometry of a surface at points."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
import numpy.typing as npt

from anisocontact import _core
from anisocontact.base.array_types import Floats
from anisocontact.base.arrays import blocks
from anisocontact.base.errors import InputError


@dataclass(frozen=True, eq=False)
class PointGeometry:
    """Metric, normal, curvature and connection at n points.

    Symbols are those of the notation table; index order is that of the name.

    Args:
        a_co: Metric a_ij, (n, 2, 2).
        a_contra: Its inverse a^ij, (n, 2, 2).
        area: sqrt(det a_ij), (n,).
        normal: Unit normal n, (n, 3).
        h_co: Curvature h_ij = rho_ij . n, (n, 2, 2).
        h_mixed: h^i_j = a^ik h_kj, (n, 2, 2).
        christoffel: Gamma^k_ij, k first, (n, 2, 2, 2).
    """

    a_co: Floats
    a_contra: Floats
    area: Floats
    normal: Floats
    h_co: Floats
    h_mixed: Floats
    christoffel: Floats

    @property
    def gaussian_curvature(self) -> Floats:
        """Determinant of h^i_j, (n,) [1/length^2]."""
        return np.asarray(np.linalg.det(self.h_mixed))

    @property
    def mean_curvature(self) -> Floats:
        """Half the trace of h^i_j, (n,) [1/length]; its sign follows the normal."""
        return np.asarray(0.5 * np.trace(self.h_mixed, axis1=1, axis2=2))


@dataclass(frozen=True, eq=False)
class Geometry(PointGeometry):
    """Geometry of an analytic surface, with derivatives along its coordinates.

    Args:
        core: The surface of the core.
        xi: Coordinates of the points, (n, 2).

    Example:
        >>> from anisocontact.surfaces import make_surface
        >>> ball = make_surface("sphere", centre=(0, 0, 0), radius=2.0)
        >>> at = ball.geometry([[0.0, 0.0]])
        >>> at.normal.tolist(), at.h_mixed[0].diagonal().tolist()  # curvatures -1/R
        ([[1.0, 0.0, 0.0]], [-0.5, -0.5])
    """

    core: _core.Surface = field(repr=False)
    xi: Floats

    def spatial_basis(self, gap: npt.ArrayLike) -> Floats:
        """Basis r_i = (a_i^k - h_i^k xi^3) rho_k, r_3 = n of the space around the surface.

        Args:
            gap: xi^3, (n,) or one number [length].

        Returns:
            r_1, r_2, r_3 in global components, (n, 3, 3)
            [Konyukhov Schweizerhof 2006, eq. (3)].

        Raises:
            InputError: An array of another shape was given.
        """
        return self.core.spatial_basis(self.xi, blocks(gap, (len(self.xi),), "gap"))

    def covariant_derivative(
        self,
        components: npt.ArrayLike,
        derivatives: npt.ArrayLike,
        index: Literal["co", "contra"],
    ) -> Floats:
        """Covariant derivative of a field of tangent vectors along the coordinates.

        Args:
            components: T_i (index "co") or v^i (index "contra") at the points, (n, 2).
            derivatives: Their partial derivatives, last index the coordinate, (n, 2, 2).
            index: Place of the components' index.

        Returns:
            T_i|j = T_i,j - Gamma^k_ij T_k or v^i_|j = v^i_,j + Gamma^i_jk v^k, (n, 2, 2).

        Raises:
            InputError: An array of another shape, or another index, was given.
        """
        n = len(self.xi)
        u = blocks(components, (n, 2), "components")
        du = blocks(derivatives, (n, 2, 2), "derivatives")
        if index == "co":
            return self.core.covariant_derivative_co(self.xi, u, du)
        if index == "contra":
            return self.core.covariant_derivative_contra(self.xi, u, du)
        raise InputError(f"{index!r} given, allowed: co, contra", field="index")


@dataclass(frozen=True, eq=False)
class GeometryDerivatives:
    """Derivatives of a surface's geometry along its coordinates at n points.

    Args:
        a_co: a_ij,k, (n, 2, 2, 2).
        normal: n_k, k first, (n, 2, 3).
        h_co: h_ij,k, (n, 2, 2, 2).

    Example:
        >>> from anisocontact.surfaces import make_surface
        >>> drum = make_surface("cylinder", point=(0, 0, 0), axis=(0, 0, 1), radius=2.0)
        >>> found = drum.geometry_derivatives([[0.0, 0.0]])
        >>> bool(abs(found.a_co).max() == 0.0)  # the metric is the same everywhere
        True
    """

    a_co: Floats
    normal: Floats
    h_co: Floats
