"""Surfaces: position, geometry and closest point."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from anisocontact import _core
from anisocontact.base import registry
from anisocontact.base.array_types import Codes, Floats
from anisocontact.base.arrays import points
from anisocontact.base.copied_by_arguments import CopiedByArguments
from anisocontact.base.errors import InputError
from anisocontact.base.read_only import read_only
from anisocontact.base.typed import typed
from anisocontact.surfaces.geometry import Geometry, GeometryDerivatives


@dataclass(frozen=True, eq=False)
class Jet:
    """Position and derivatives of a surface at n points.

    Args:
        position: rho, (n, 3) [length].
        d1: rho_i, (n, 2, 3).
        d2: rho_11, rho_12, rho_22, (n, 3, 3).

    Example:
        >>> plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
        >>> at = plane.jet([[0.5, 0.2]])
        >>> at.position.shape, at.d1.shape, float(abs(at.d2).max())
        ((1, 3), (1, 2, 3), 0.0)
    """

    position: Floats
    d1: Floats
    d2: Floats


#: Names of the status codes of a projection.
PROJECTION_STATUS = ("interior", "edge", "corner", "singular", "ambiguous", "failed")


@dataclass(frozen=True, eq=False)
class Projection:
    """Closest points of a surface.

    Args:
        xi: Coordinates of the closest points, (n, 2).
        gap: xi^3 = (x - rho) . n, (n,) [length].
        status: A code of `PROJECTION_STATUS`, (n,): 0 interior, x - rho is normal to the surface;
            1 on an edge; 2 in a corner; 3 at a pole or apex, where the coordinates are singular;
            4 ambiguous, others are as near or x is a centre of curvature; 5 failed, the numbers
            are NaN.
        dxi_dx: d xi^i/dx, (n, 2, 3); empty where derivatives were not asked for.
        dgap_dx: d xi^3/dx, (n, 3).

    Example:
        >>> floor = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
        >>> found = floor.project([[0.3, 0.1, -0.2]])
        >>> found.gap.tolist(), PROJECTION_STATUS[found.status[0]]
        ([-0.2], 'interior')
    """

    xi: Floats
    gap: Floats
    status: Codes
    dxi_dx: Floats
    dgap_dx: Floats


def default_threads() -> int:
    """Number of processors this process may use.

    Returns:
        Their number, at least 1.

    Example:
        >>> default_threads() >= 1
        True
    """
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def threads_of(given: int | None) -> int:
    """Number of threads of a batch.

    Args:
        given: What the user gave; all processors if nothing.

    Raises:
        InputError: It is below 1.

    Example:
        >>> threads_of(2)
        2
    """
    if given is not None and given < 1:
        raise InputError(f"{given} given, must be > 0", "threads")
    return given or default_threads()


class Surface(CopiedByArguments):
    """An analytic surface; make one with `make_surface`.

    Args:
        name: Name in the registry.
        values: Its parameters as the core takes them.

    Example:
        >>> ball = make_surface("sphere", centre=(0, 0, 0), radius=2)
        >>> hit = ball.project([[0, 0, 3.0]])
        >>> hit.gap.round(12).tolist()
        [1.0]
    """

    def __init__(self, name: str, values: dict[str, list[float]]) -> None:
        self.name = name
        self.named = name, read_only(values)
        self.core = _core.Surface(name, values)

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
        """Position rho, (n, 3), at coordinates (n, 2).

        Args:
            xi: Coordinates, (n, 2).

        Returns:
            Positions, (n, 3) [length].
        """
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
        xi = points(xi, 2, "xi")
        return Geometry(core=self.core, xi=xi, **self.core.geometry(xi))

    def geometry_derivatives(self, xi: npt.ArrayLike) -> GeometryDerivatives:
        """Exact derivatives of metric, normal and curvature along the coordinates.

        Args:
            xi: Coordinates, (n, 2).

        Returns:
            a_ij,k and n_k and h_ij,k, by dual numbers.
        """
        return GeometryDerivatives(**self.core.geometry_derivatives(points(xi, 2, "xi")))

    def project(
        self,
        x: npt.ArrayLike,
        guess: npt.ArrayLike | None = None,
        *,
        derivatives: bool = True,
        threads: int | None = None,
    ) -> Projection:
        """Closest points [Konyukhov Schweizerhof 2006, eq. (1), (2)].

        Args:
            x: Points, (n, 3) [length].
            guess: Coordinates that may be near, such as the last ones, (n, 2). They can save time
                and do not change the closest point.
            derivatives: Whether the derivatives with respect to x are wanted.
            threads: Number of threads; all processors if left out.

        Returns:
            Coordinates, gap, status and derivatives of each point.

        Raises:
            InputError: An array of another shape was given.

        Example:
            >>> sphere = make_surface("sphere", centre=(0, 0, 0), radius=2.0)
            >>> p = sphere.project([[0.0, 3.0, 0.0]])
            >>> p.gap.round(12).tolist(), p.dgap_dx[0, 1].item()
            ([1.0], 1.0)
        """
        x = points(x, 3)
        if guess is not None:
            guess = points(guess, 2, "guess", rows=len(x))
        return Projection(**self.core.project(x, guess, derivatives, threads_of(threads)))

    @property
    def domain(self) -> tuple[tuple[float, float], tuple[float, float], tuple[bool, bool]]:
        """Lower and upper ends of the coordinates and whether each is periodic."""
        lower, upper, periodic = self.core.domain()
        return lower, upper, periodic

    @property
    def extent(self) -> float:
        """Largest lengths that it is made of, to a share of which its points are rounded, length.

        The same however it is turned about the origin.

        Example:
            >>> make_surface("sphere", centre=(0, 0, -1e4), radius=1e4).extent
            20000.0
        """
        name, values = self.named
        lengths = (
            p for p in registry.entry(registry.surfaces(), name).parameters if p.unit == "length"
        )
        return sum(_largest(values[p.name]) for p in lengths)


def _largest(values: Sequence[float]) -> float:
    """Largest of some lengths, or of the distances of some points from the origin."""
    rows = np.reshape(values, (-1, 3 if len(values) % 3 == 0 else 1))
    return float(np.linalg.norm(rows, axis=1).max(initial=0.0))


@typed
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
        return Surface(name, v)
    except ValueError as error:
        raise InputError(f"surface {name!r}: {error}") from None
