"""Which way the normals of a surface of facets point."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from anisocontact import _core
from anisocontact.base.array_types import Flags, Locals


@dataclass(frozen=True, eq=False)
class Orientation:
    """Which way the normals of a surface point.

    Args:
        closed: Every edge belongs to two facets.
        inconsistent: Facets whose normal disagrees with that of a neighbour across an edge, (k,).
        volume: Enclosed volume, positive where normals point outward [length^3]; NaN if the
            surface is not closed.

    Example:
        >>> from anisocontact.surfaces import FacetSurface
        >>> square = FacetSurface([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], [[0, 1, 2, 3]],
        ...                       "quad4")
        >>> print(square.orientation())
        the surface is open: it has no outside
    """

    closed: bool
    inconsistent: Locals
    volume: float

    @property
    def outward(self) -> bool | None:
        """Whether the normals of a closed surface point outward; None if it cannot be said."""
        if not self.closed or self.inconsistent.size:
            return None
        return self.volume > 0.0

    def __str__(self) -> str:
        if self.inconsistent.size:
            return (
                f"normals of {self.inconsistent.size} facets disagree with a neighbour, "
                f"the first is facet {self.inconsistent[0]}"
            )
        if not self.closed:
            return "the surface is open: it has no outside"
        return "normals point outward" if self.outward else "normals point inward"


def orientation(core: _core.FacetSurface) -> Orientation:
    """Orientation of a surface from its sides and its volume.

    Two neighbours agree where they run along their side in opposite directions.

    Returns:
        Whether the surface is closed, which facets disagree, the volume.
    """
    facet, first, second = core.sides().T
    ends = np.column_stack((np.minimum(first, second), np.maximum(first, second)))
    _, edge, number = np.unique(ends, axis=0, return_inverse=True, return_counts=True)
    turns = np.bincount(edge, weights=np.where(first < second, 1.0, -1.0))
    wrong = (number[edge] == 2) & (turns[edge] != 0.0)
    closed = bool(np.all(number == 2))
    return Orientation(closed, np.unique(facet[wrong]), _volume(core) if closed else np.nan)


def triangular(core: _core.FacetSurface) -> Flags:
    """Which facets have three sides.

    Returns:
        A flag for each, (number of facets,).
    """
    three: Flags = np.bincount(core.sides()[:, 0]) == 3
    return three


def _volume(core: _core.FacetSurface) -> float:
    """1/3 of the integral of x . n by three Gauss points a direction, exact for every topology.

    Triangles are integrated as collapsed squares, xi = (s, t (1 - s)).
    """
    three = triangular(core)
    facets = np.arange(three.size, dtype=np.int32)
    origin = core.jet(facets[:1], np.zeros((1, 2)))["position"]
    a, w = np.polynomial.legendre.leggauss(3)
    total = 0.0
    for i, j in np.ndindex(3, 3):
        s, t = 0.5 * (1.0 + a[i]), 0.5 * (1.0 + a[j])
        xi = np.where(three[:, None], [s, t * (1.0 - s)], [s, t])
        jet = core.jet(facets, xi)
        cross = np.cross(jet["d1"][:, 0], jet["d1"][:, 1])
        flux = np.sum((jet["position"] - origin) * cross, axis=1)
        total += float(0.25 * w[i] * w[j] * np.sum(flux * np.where(three, 1.0 - s, 1.0)))
    return total / 3.0
