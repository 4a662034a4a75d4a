"""Which part of a slave facet lies on which master facet, as points of a quadrature."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from anisocontact.base.fenicsx import basix
from anisocontact.contact.facet_mesh import FacetMesh, FacetShapes, facet_corners
from anisocontact.surfaces.facets import FacetSets, FacetSurface

Ints = npt.NDArray[np.int64]
Floats = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

#: Share of a facet that may be missing from its overlaps: more is not covered.
UNCOVERED = 1e-6
#: Overlaps below this share of a facet are nothing but rounding.
SLIVER = 1e-14
#: Distance over the size of a facet within which a corner lies on a border: where edges lie on each
#: other rounding would say where they cross, and so how the overlap is cut into triangles.
ON_BORDER = 1e-10
#: Newton iterations to the coordinates of a point on a facet; one on a parallelogram.
ITERATIONS = 8
CONVERGED = 1e-13


class Facing(Protocol):
    """Facets of two sides, see `Sides`."""

    @property
    def slave(self) -> FacetMesh:
        """Facets of the slave."""

    @property
    def master(self) -> FacetMesh:
        """Facets of the master."""

    @property
    def surface(self) -> FacetSurface:
        """The same where it is."""

    @property
    def reach(self) -> float:
        """Distance within which the master is searched, length."""

    @property
    def near(self) -> FacetSets | None:
        """Facets of the master that each of the slave cannot meet; None where it can meet all."""

    @property
    def reference(self) -> Floats:
        """Positions of the nodes in the reference configuration, (nodes, 3), length."""

    @property
    def threads(self) -> int:
        """Threads of the kernel."""


@dataclass(frozen=True)
class Overlaps:
    """Quadrature over the parts of slave facets that lie on one master facet each.

    Attributes:
        owner: Slave facet of each point, ascending, (n,).
        at: Coordinates on the reference facet, (n, 2).
        weight: Area of the reference facet that belongs to the point, (n,).
        facet: Master facet that the point was put on, (n,).
        covered: Whether the overlaps of a slave facet make up the whole of it, (facets,).
    """

    owner: Ints
    at: Floats
    weight: Floats
    facet: npt.NDArray[np.int32]
    covered: Mask


def overlaps(
    slave: FacetMesh,
    master: FacetMesh,
    surface: FacetSurface,
    now: Floats,
    reach: float,
    excluded: FacetSets | None = None,
) -> Overlaps:
    """Cut slave facets along the borders of the master facets that face them.

    The corners of both go to the plane at the middle of the slave facet along its normal, where
    the polygon of the master is clipped to that of the slave [Sutherland Hodgman 1974].

    Args:
        slave: Facets that are cut.
        master: Facets that cut them.
        surface: The master where it is now.
        now: Positions of the nodes, (nodes, 3), length.
        reach: Distance from the middle of a slave facet within which a master facet counts, length.
        excluded: Master facets that do not count, for each slave facet.

    Returns:
        Points on the facets that are covered.
    """
    shapes = FacetShapes(slave.topology)
    x = now[slave.nodes]
    planes = _Planes.of(slave, shapes, now)
    flat = planes.flat(np.arange(len(x)), x)
    border = flat[:, facet_corners(slave.topology)]
    f, g = facing(slave, shapes, x, surface, master, now, reach, excluded)
    polygons = planes.flat(f, now[master.nodes[g][:, facet_corners(master.topology)]])
    counts = np.full(len(f), polygons.shape[1])
    for i in range(border.shape[1]):
        start, side = border[:, i], np.roll(border, -1, axis=1)[:, i] - border[:, i]
        outward = np.stack([side[:, 1], -side[:, 0]], axis=1)
        on = ON_BORDER * np.sum(side**2, axis=1)
        bound = np.sum(outward * start, axis=1)
        polygons, counts = _clip(polygons, counts, outward[f], bound[f], on[f])
    area = _area(border)
    points, weight, pair = _fan(polygons, counts, area[f] * SLIVER, shapes.overlap_degree)
    owner = f[pair]
    total = np.bincount(owner, weights=weight, minlength=len(x))
    covered = np.abs(total - area) < UNCOVERED * area
    kept = np.flatnonzero(covered[owner])
    kept = kept[np.argsort(owner[kept], kind="stable")]
    owner = owner[kept]
    at, stretch = _coordinates(shapes, flat, owner, points[kept])
    return Overlaps(owner, at, weight[kept] / stretch, g[pair[kept]].astype(np.int32), covered)


@dataclass(frozen=True)
class _Planes:
    """Planes at the middles of facets, with the normals of the facets there."""

    middle: Floats  # (facets, 3)
    axes: Floats  # (facets, 2, 3), orthonormal, such that the corners turn to the left

    @classmethod
    def of(cls, mesh: FacetMesh, shapes: FacetShapes, now: Floats) -> _Planes:
        value, gradient = shapes.at(shapes.middle[None])
        x = now[mesh.nodes]
        t = np.einsum("kd,mki->mdi", gradient[0], x)
        first = t[:, 0] / np.linalg.norm(t[:, 0], axis=1)[:, None]
        second = t[:, 1] - np.sum(t[:, 1] * first, axis=1)[:, None] * first
        second /= np.linalg.norm(second, axis=1)[:, None]
        return cls(np.einsum("k,mki->mi", value[0], x), np.stack([first, second], axis=1))

    def flat(self, which: Ints, x: Floats) -> Floats:
        """Points (n, k, 3) in the planes of facets, (n, k, 2)."""
        return np.asarray((x - self.middle[which][:, None]) @ self.axes[which].swapaxes(1, 2))


def _area(polygons: Floats) -> Floats:
    after = np.roll(polygons, -1, axis=1)
    cross = polygons[..., 0] * after[..., 1] - polygons[..., 1] * after[..., 0]
    return np.asarray(0.5 * cross.sum(axis=1))


def largest_radius(slave: FacetMesh, now: Floats) -> float:
    """Largest distance of a node from the middle of its facet, length; 0 without facets."""
    return float(_ball(now[slave.nodes])[1].max(initial=0.0))


def facing(
    slave: FacetMesh,
    shapes: FacetShapes,
    x: Floats,
    surface: FacetSurface,
    master: FacetMesh,
    now: Floats,
    reach: float,
    excluded: FacetSets | None,
) -> tuple[Ints, Ints]:
    """Pairs of facets within reach that oppose each other and may overlap along the normal."""
    middle, radius = _ball(x)
    sets = surface.within(middle, reach)
    f = np.repeat(np.arange(len(x)), np.diff(sets.offsets))
    g = sets.facets.astype(np.int64)
    normal, other = _normals(shapes, slave, now), _outward(master, now)
    centre, size = _ball(now[master.nodes])
    apart, normals = centre[g] - middle[f], normal[f]
    along = np.einsum("pi,pi->p", apart, normals)
    beside = np.einsum("pi,pi->p", apart, apart) - along**2
    kept = beside <= (radius[f] + size[g]) ** 2
    kept &= np.einsum("pi,pi->p", normals, other[g]) < 0.0
    if excluded is not None:
        n = len(master.nodes)
        who = np.repeat(np.arange(len(x)), np.diff(excluded.offsets))
        kept &= ~np.isin(f * n + g, who * n + excluded.facets)
    return f[kept], g[kept]


def _ball(x: Floats) -> tuple[Floats, Floats]:
    """Middles of facets and the distance of the farthest node, (facets, 3) and (facets,)."""
    middle = x.mean(axis=1)
    return middle, np.linalg.norm(x - middle[:, None], axis=2).max(axis=1)


def _outward(mesh: FacetMesh, now: Floats) -> Floats:
    return _normals(FacetShapes(mesh.topology), mesh, now)


def _normals(shapes: FacetShapes, mesh: FacetMesh, now: Floats) -> Floats:
    """Outward unit normals at the middles of facets, (facets, 3)."""
    gradient = shapes.at(shapes.middle[None])[1][0]
    t = np.einsum("kd,mki->mdi", gradient, now[mesh.nodes])
    normal = np.cross(t[:, 0], t[:, 1])
    return np.asarray(
        np.where(mesh.flip, -1.0, 1.0)[:, None] * normal / np.linalg.norm(normal, axis=1)[:, None]
    )


def _coordinates(
    shapes: FacetShapes, flat: Floats, owner: Ints, points: Floats
) -> tuple[Floats, Floats]:
    """Coordinates on facets of points in their planes, (n, 2), and area over that of reference."""
    eta = np.tile(shapes.middle, (len(owner), 1))
    corners = flat[owner]
    for _ in range(ITERATIONS):
        value, gradient = shapes.at(eta)
        tangents = corners.swapaxes(1, 2) @ gradient
        apart = points - np.einsum("pk,pki->pi", value, corners)
        step = _solved(tangents, apart)
        eta = eta + step
        if not np.abs(step).max(initial=0.0) > CONVERGED:
            break
    tangents = corners.swapaxes(1, 2) @ shapes.at(eta)[1]
    stretch = np.abs(np.linalg.det(tangents))
    return eta, np.where(stretch > 0.0, stretch, np.inf)


def _solved(a: Floats, b: Floats) -> Floats:
    """Solutions of systems of two equations; zero where a facet has no area at the point."""
    det = a[..., 0, 0] * a[..., 1, 1] - a[..., 0, 1] * a[..., 1, 0]
    x = a[..., 1, 1] * b[..., 0] - a[..., 0, 1] * b[..., 1]
    y = a[..., 0, 0] * b[..., 1] - a[..., 1, 0] * b[..., 0]
    return np.asarray(np.stack([x, y], axis=-1) / np.where(det != 0.0, det, np.inf)[..., None])


def _clip(
    polygons: Floats, counts: Ints, normal: Floats, bound: Floats, on: Floats
) -> tuple[Floats, Ints]:
    """The parts of polygons with normal . p <= bound; only the first `counts` corners count.

    A corner beyond the bound by no more than `on` is within.
    """
    n, most, _ = polygons.shape
    corner = np.arange(most)
    there = corner < counts[:, None]
    after = np.where(corner + 1 < counts[:, None], corner + 1, 0)
    follower = np.take_along_axis(polygons, after[..., None], axis=1)
    d, e = (np.einsum("nci,ni->nc", p, normal) - bound[:, None] for p in (polygons, follower))
    d, e = (np.where(np.abs(apart) <= on[:, None], 0.0, apart) for apart in (d, e))
    crossing = (d <= 0.0) != (e <= 0.0)
    share = d / np.where(crossing, d - e, 1.0)
    out = np.stack([polygons, polygons + share[..., None] * (follower - polygons)], axis=2)
    held = np.stack([there & (d <= 0.0), there & crossing], axis=2).reshape(n, 2 * most)
    order = np.argsort(~held, axis=1, kind="stable")
    counts = held.sum(axis=1)
    order = order[:, : max(int(counts.max(initial=0)), 3)]
    return np.take_along_axis(out.reshape(n, 2 * most, 2), order[..., None], axis=1), counts


def _fan(polygons: Floats, counts: Ints, least: Floats, degree: int) -> tuple[Floats, Floats, Ints]:
    """Quadrature over polygons cut into triangles: points, weights, polygon of each point."""
    second = np.arange(1, polygons.shape[1] - 1)
    edges = polygons[:, 1:] - polygons[:, :1]
    a, b = edges[:, second - 1], edges[:, second]
    area = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    area = np.where(second + 1 < counts[:, None], area, 0.0)
    area *= np.sign(area.sum(axis=1))[:, None]
    pair, triangle = np.nonzero(np.abs(area) > least[:, None])
    rule: Any = basix.make_quadrature(basix.CellType.triangle, degree)
    points, weights = np.asarray(rule[0]), np.asarray(rule[1])
    at = (
        polygons[pair, 0][:, None]
        + points[:, :1] * a[pair, triangle][:, None]
        + points[:, 1:] * b[pair, triangle][:, None]
    )
    weight = area[pair, triangle][:, None] * weights
    return at.reshape(-1, 2), weight.reshape(-1), np.repeat(pair, len(weights))
