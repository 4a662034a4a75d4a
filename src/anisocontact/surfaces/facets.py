"""Surfaces made of facets: geometry, closest point, neighbours, orientation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from anisocontact import _core
from anisocontact.base.array_types import Codes, Flags, Floats, Ints, Locals
from anisocontact.base.arrays import points
from anisocontact.base.copied_by_arguments import CopiedByArguments
from anisocontact.base.errors import InputError
from anisocontact.base.typed import typed
from anisocontact.surfaces.analytic import Jet, default_threads, threads_of
from anisocontact.surfaces.facet_blocks import FacetBlocks, finite
from anisocontact.surfaces.geometry import PointGeometry
from anisocontact.surfaces.orientation import Orientation, orientation, triangular

#: Names of the codes in `FacetProjections.status`.
FACET_STATUS = ("on", "off", "beyond", "failed")

#: Names of the codes in `FacetProjections.feature`.
FEATURES = ("interior", "edge", "vertex")


@dataclass(frozen=True, eq=False)
class FacetProjections:
    """Closest points of a surface of facets.

    Args:
        facet: Facet with the closest point, (n,); -1 where there is none.
        xi: Coordinates on it, (n, 2).
        position: The closest points, (n, 3) [length].
        gap: (x - position) . normal, (n,) [length].
        normal: Unit normals, (n, 3): of the facet; on an edge or vertex along x - position,
            outward.
        status: A code of `FACET_STATUS`, (n,): 0 on; 1 off, x lies beyond the border of the
            surface; 2 beyond the largest distance; 3 failed. For 2 and 3 the numbers are NaN.
        feature: A code of `FEATURES`, (n,): 0 interior, x - position is normal to the facet (also
            if the point is on an edge); 1 normal to an edge alone; 2 to none, a vertex.
        entity: Edge or vertex of the facet, (n,); -1 in the interior.
        edge: Direction of the edge in coordinates, (n, 2); zero unless on an edge.

    Example:
        >>> square = FacetSurface([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], [[0, 1, 2, 3]],
        ...                       "quad4")
        >>> found = square.project([[0.25, 0.5, -0.1], [2.0, 0.5, -0.1]])
        >>> [FACET_STATUS[code] for code in found.status], found.xi[0].tolist()
        (['on', 'off'], [0.25, 0.5])
    """

    facet: Locals
    xi: Floats
    position: Floats
    gap: Floats
    normal: Floats
    status: Codes
    feature: Codes
    entity: Codes
    edge: Floats

    def take(self, which: Ints) -> FacetProjections:
        """Projections of some of the points, (k,).

        Args:
            which: Numbers or flags of points.

        Returns:
            Their projections.
        """
        return FacetProjections(**{name: value[which] for name, value in vars(self).items()})


@dataclass(frozen=True, eq=False)
class FacetSets:
    """A set of facets for each of n points.

    Args:
        offsets: Where the set of each point begins in `facets`, (n + 1,).
        facets: The sets one after the other, each in ascending order.

    Example:
        >>> sets = FacetSets(np.array([0, 2, 3]), np.array([4, 7, 1]))
        >>> len(sets), sets[0].tolist(), sets[1].tolist()
        (2, [4, 7], [1])
    """

    offsets: Ints
    facets: Locals

    def __getitem__(self, i: int) -> Locals:
        return self.facets[self.offsets[i] : self.offsets[i + 1]]

    def __len__(self) -> int:
        return len(self.offsets) - 1

    def take(self, which: Ints) -> FacetSets:
        """Sets of some of the points.

        Args:
            which: Points, in any order and as often as wanted, (k,).

        Returns:
            The set of each of them.
        """
        counts = np.diff(self.offsets)[which]
        offsets = np.concatenate(([0], np.cumsum(counts))).astype(np.int64)
        within = np.arange(offsets[-1]) - np.repeat(offsets[:-1], counts)
        return FacetSets(offsets, self.facets[np.repeat(self.offsets[which], counts) + within])

    @classmethod
    def of_pairs(cls, points: Ints, facets: Locals, count: int) -> FacetSets:
        """Sets from pairs, in any order and as often as they come.

        Args:
            points: A point of each pair, (p,).
            facets: Its facet, (p,).
            count: Number of points.
        """
        width = int(facets.max(initial=0)) + 1
        pairs = np.unique(points * width + facets)
        offsets = np.searchsorted(pairs, np.arange(count + 1) * width)
        return cls(offsets.astype(np.int64), (pairs % width).astype(np.int32))


@typed
class FacetSurface(CopiedByArguments):
    """A surface of facets of any of the `TOPOLOGIES`, mixed if need be.

    The mesh has to conform: facets are neighbours where they name the same points.

    Args:
        coordinates: Points, (m, 3) [length].
        connectivity: Points of each facet, (k, nodes) of integers; a list of such blocks for a
            mixed mesh. Facets are numbered through the blocks.
        topology: Name of the topology; one for each block.
        flip: Facets whose normal is to be turned round, (number of facets,); their two
            coordinates are exchanged. None: no facet.

    Raises:
        InputError: Unknown topology, another number of nodes, a point that does not exist.

    Example:
        >>> square = FacetSurface([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], [[0, 1, 2, 3]],
        ...                       "quad4")
        >>> square.project([[0.25, 0.5, -0.1]]).gap
        array([-0.1])
    """

    def __init__(
        self,
        coordinates: npt.ArrayLike,
        connectivity: npt.ArrayLike | Sequence[npt.ArrayLike],
        topology: str | Sequence[str],
        flip: npt.ArrayLike | None = None,
    ) -> None:
        mesh = FacetBlocks.of(connectivity, topology, flip)
        x = finite(points(coordinates, 3, "coordinates"))
        try:
            self.core = _core.FacetSurface(x, mesh.topologies, mesh.counts, mesh.nodes, mesh.flip)
        except ValueError as error:
            raise InputError(str(error), field="connectivity") from None
        self._count = len(mesh.flip)
        self._points = x.shape[0]

    def __len__(self) -> int:
        """Number of facets."""
        return self._count

    def update(self, coordinates: npt.ArrayLike) -> None:
        """Moves the points. Not to be called while another thread projects.

        Args:
            coordinates: New positions of the same points, (m, 3) [length]. With values that are
                not finite every projection fails until the next update.
        """
        self.core.update(points(coordinates, 3, "coordinates", rows=self._points))

    def project(
        self,
        x: npt.ArrayLike,
        hint: FacetProjections | npt.ArrayLike | None = None,
        max_distance: npt.ArrayLike = np.inf,
        exclude: FacetSets | None = None,
        threads: int | None = None,
        named: Locals | None = None,
    ) -> FacetProjections:
        """Closest point of the whole surface, by true distance, for each x.

        Args:
            x: Points, (n, 3) [length].
            hint: Projections of the same points some time ago, or the facets, (n,): it takes less
                time. The closest point does not depend on it but where two places are equally near
                to rounding.
            max_distance: Largest distance of interest, one or (n,) [length]: points farther away
                are `beyond`.
            exclude: Facets that do not count, for each point; a point nearest to a side or
                vertex that an excluded facet shares is `off`.
            threads: Number of threads; all processors if left out.
            named: Facet that is named for each point where facets share the closest point and are
                turned alike from x, (n,); that of the hint if left out.

        Returns:
            The projections.

        Raises:
            InputError: Shapes that do not agree, a distance that is negative or not a number.
        """
        x = points(x, 3)
        n = x.shape[0]
        facet, start = _hint(hint, n)
        named = np.zeros(0, np.int32) if named is None else _of_each(named, n, "named")
        limit = np.atleast_1d(np.asarray(max_distance, dtype=np.float64))
        if limit.shape not in {(1,), (n,)}:
            raise InputError(
                f"shape {limit.shape} given, one number or ({n},) needed", field="max_distance"
            )
        if not np.all(limit >= 0.0):
            raise InputError(f"given {limit.min()}, must not be negative", field="max_distance")
        if exclude is not None and len(exclude) != n:
            raise InputError(f"sets for {len(exclude)} points given, {n} needed", field="exclude")
        sets = exclude or FacetSets(np.zeros(0, np.int64), np.zeros(0, np.int32))
        return FacetProjections(
            **self.core.project(
                x,
                facet,
                named,
                start,
                limit,
                sets.offsets,
                sets.facets,
                threads_of(threads),
            )
        )

    def jet(self, facet: npt.ArrayLike, xi: npt.ArrayLike) -> Jet:
        """Position and derivatives at coordinates of facets.

        Args:
            facet: Facets, (n,).
            xi: Coordinates, (n, 2).

        Returns:
            rho, rho_i and rho_ij.
        """
        return Jet(**self.core.jet(*self._at(facet, xi)))

    def geometry(self, facet: npt.ArrayLike, xi: npt.ArrayLike) -> PointGeometry:
        """Metric, normal, curvature and connection at coordinates of facets.

        Args:
            facet: Facets, (n,).
            xi: Coordinates, (n, 2).

        Returns:
            The geometry.
        """
        return PointGeometry(**self.core.geometry(*self._at(facet, xi)))

    def shapes(self, facet: npt.ArrayLike, xi: npt.ArrayLike) -> tuple[Floats, Floats, Floats]:
        """Shape functions of the nodes of facets.

        Args:
            facet: Facets, (n,).
            xi: Coordinates, (n, 2).

        Returns:
            Values (n, 9), first derivatives (n, 9, 2), second derivatives 11, 12, 22 (n, 9, 3);
            zero for nodes that a facet does not have.
        """
        r = self.core.shapes(*self._at(facet, xi))
        return r["value"], r["d1"], r["d2"]

    def met_along(
        self, facet: npt.ArrayLike, xi: npt.ArrayLike, x: Floats, normal: Floats, opposed: float
    ) -> tuple[Floats, Flags]:
        """Where lines meet facets, or what these go on as beyond their sides.

        Args:
            facet: Facets, (n,).
            xi: Coordinates from which to search, (n, 2).
            x: Points of the lines, (n, 3), length.
            normal: Unit vectors along them, (n, 3).
            opposed: Least cosine of the angle to the normal of a facet that is met.

        Returns:
            Coordinates, (n, 2), and whether there is such a place, (n,).
        """
        found: tuple[Floats, Flags] = self.core.met_along(
            *self._at(facet, xi),
            np.ascontiguousarray(x),
            np.ascontiguousarray(normal),
            opposed,
            default_threads(),
        )
        return found

    def within(self, x: npt.ArrayLike, distance: float, threads: int | None = None) -> FacetSets:
        """Facets within a distance of each x; in the reference state, what self-contact excludes.

        Args:
            x: Points, (n, 3) [length].
            distance: The distance [length].
            threads: Number of threads; all processors if left out.

        Returns:
            A set of facets for each point.

        Raises:
            InputError: The distance is negative.
        """
        if not distance >= 0.0:
            raise InputError(f"given {distance}, must not be negative", field="distance")
        return FacetSets(*self.core.within(points(x, 3), distance, threads_of(threads)))

    def rings(self, facet: npt.ArrayLike, count: int = 1) -> FacetSets:
        """Facets and their neighbours, those that share a vertex, `count` rings of them.

        Args:
            facet: Facets, (n,).
            count: Number of rings; none gives the facet alone.

        Returns:
            A set of facets for each facet given.
        """
        f = self._at(facet, np.zeros((np.size(facet), 2)))[0]
        return FacetSets(*self.core.rings(f, count))

    def orientation(self) -> Orientation:
        """Which way the normals point, from the sides and the enclosed volume.

        Returns:
            Whether the surface is closed, which facets disagree, the volume.
        """
        return orientation(self.core)

    def _at(self, facet: npt.ArrayLike, xi: npt.ArrayLike) -> tuple[Locals, Floats]:
        f = np.ascontiguousarray(np.atleast_1d(facet), dtype=np.int32)
        if f.size and not 0 <= f.min() <= f.max() < self._count:
            given = f.min() if f.min() < 0 else f.max()
            raise InputError(f"given {given}, 0 to {self._count - 1} allowed", field="facet")
        return f, points(xi, 2, "xi", rows=f.size)


def outward_flips(
    coordinates: npt.ArrayLike,
    connectivity: npt.ArrayLike | Sequence[npt.ArrayLike],
    topology: str | Sequence[str],
    inside: npt.ArrayLike,
) -> Flags:
    """Which facets have to be flipped so that their normals leave the body.

    Args:
        coordinates: Points, (m, 3) [length].
        connectivity: As of `FacetSurface`.
        topology: As of `FacetSurface`.
        inside: A point of the body behind each facet, for instance the midpoint of its cell,
            (number of facets, 3) [length].

    Returns:
        `flip` of `FacetSurface`.

    Example:
        >>> triangle = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
        >>> outward_flips(triangle, [[0, 1, 2]], "tri3", [[0.3, 0.3, 1.0]]).tolist()
        [True]
    """
    surface = FacetSurface(coordinates, connectivity, topology)
    behind = points(inside, 3, "inside", rows=len(surface))
    middle = np.where(triangular(surface.core), 1.0 / 3.0, 0.5)
    j = surface.jet(np.arange(len(surface)), np.column_stack((middle, middle)))
    outward = np.cross(j.d1[:, 0], j.d1[:, 1])
    flips: Flags = np.sum((j.position - behind) * outward, axis=1) < 0.0
    return flips


def _hint(hint: FacetProjections | npt.ArrayLike | None, n: int) -> tuple[Locals, Floats]:
    if hint is None:
        return np.zeros(0, np.int32), np.zeros((0, 2))
    if isinstance(hint, FacetProjections):
        facet, start = hint.facet, hint.xi
    else:
        facet, start = np.atleast_1d(hint), np.zeros((0, 2))
    return _of_each(facet, n, "hint"), start


def _of_each(facet: npt.ArrayLike, n: int, field: str) -> Locals:
    """A facet for each of n points."""
    found: Locals = np.ascontiguousarray(facet, dtype=np.int32)
    if found.shape != (n,):
        raise InputError(f"shape {found.shape} given, ({n},) needed", field=field)
    return found
