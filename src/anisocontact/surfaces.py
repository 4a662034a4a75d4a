"""Surfaces: position, geometry and closest point."""

from __future__ import annotations

import os
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from anisocontact import _core, registry
from anisocontact.errors import InputError

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Jet:
    """Position and derivatives of a surface at n points.

    Args:
        position: rho, (n, 3) [length].
        d1: rho_i, (n, 2, 3).
        d2: rho_11, rho_12, rho_22, (n, 3, 3).
    """

    position: Floats
    d1: Floats
    d2: Floats


@dataclass(frozen=True)
class Geometry:
    """Metric, normal, curvature and connection of a surface at n points.

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
        return np.linalg.det(self.h_mixed)

    @property
    def mean_curvature(self) -> Floats:
        """Half the trace of h^i_j, (n,) [1/length]; its sign follows the normal."""
        return 0.5 * np.trace(self.h_mixed, axis1=1, axis2=2)


#: Names of the status codes of a projection.
PROJECTION_STATUS = ("interior", "edge", "failed")


@dataclass(frozen=True)
class Projection:
    """Closest points of a surface.

    Args:
        xi: Coordinates of the closest points, (n, 2).
        gap: xi^3 = (x - rho) . n, (n,) [length].
        status: 0 interior, 1 on an edge, 2 failed, (n,).
    """

    xi: Floats
    gap: Floats
    status: npt.NDArray[np.int8]


def points(x: npt.ArrayLike, columns: int, name: str = "x") -> Floats:
    """`x` as a contiguous (n, columns) array of doubles.

    Raises:
        InputError: Another shape was given.
    """
    a = np.ascontiguousarray(np.atleast_2d(np.asarray(x, dtype=np.float64)))
    if a.ndim != 2 or a.shape[1] != columns:
        raise InputError(f"an array of shape {a.shape} given, (n, {columns}) needed", field=name)
    return a


def default_threads() -> int:
    """Number of processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


class Surface:
    """An analytic surface; make one with `make_surface`.

    Args:
        name: Name in the registry.
        core: The surface of the core.
    """

    def __init__(self, name: str, core: _core.Surface) -> None:
        self.name = name
        self.core = core

    def __repr__(self) -> str:
        return f"Surface({self.name!r})"

    def jet(self, xi: npt.ArrayLike) -> Jet:
        """Position and derivatives.

        Args:
            xi: Coordinates, (n, 2).

        Returns:
            rho, rho_i and rho_ij.
        """
        return Jet(**self.core.jet(points(xi, 2, "xi")))

    def position(self, xi: npt.ArrayLike) -> Floats:
        """Position rho, (n, 3), at coordinates (n, 2)."""
        return self.jet(xi).position

    def geometry(self, xi: npt.ArrayLike) -> Geometry:
        """Geometry at coordinates [Konyukhov Schweizerhof 2006, eq. (3), (8)].

        Args:
            xi: Coordinates, (n, 2).

        Returns:
            Metric, normal, curvature and Christoffel symbols.

        Example:
            >>> plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
            >>> plane.geometry([[1.0, 2.0]]).a_co[0].tolist()
            [[1.0, 0.0], [0.0, 1.0]]
        """
        return Geometry(**self.core.geometry(points(xi, 2, "xi")))

    def project(self, x: npt.ArrayLike, threads: int | None = None) -> Projection:
        """Closest points [Konyukhov Schweizerhof 2006, eq. (1), (2)].

        Args:
            x: Points, (n, 3) [length].
            threads: Number of threads; all processors if left out.

        Returns:
            Coordinates, gap and status of each point.
        """
        return Projection(**self.core.project(points(x, 3), threads or default_threads()))

    @property
    def domain(self) -> tuple[tuple[float, float], tuple[float, float], tuple[bool, bool]]:
        """Lower and upper ends of the coordinates and whether each is periodic."""
        return self.core.domain()


def make_surface(name: str, **parameters: object) -> Surface:
    """A surface of the registry.

    Args:
        name: Name in `registry.surfaces()`.
        **parameters: Its parameters; lengths in the units of the problem, angles in radians.

    Returns:
        The surface.

    Raises:
        InputError: Unknown name or parameter, or a value out of range.

    Example:
        >>> make_surface("plane", point=(0, 0, 1), normal=(0, 0, 2)).project([[1, 2, 4]]).gap
        array([3.])
    """
    e = registry.entry(registry.surfaces(), name, "shape")
    v = registry.values(e, parameters)
    try:
        return Surface(name, _core.Surface(name, v))
    except ValueError as error:
        raise InputError(f"surface {name!r}: {error}") from None
