"""Which part of a slave facet lies on which master facet, as points of a quadrature."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from anisocontact._fenicsx import basix
from anisocontact.contact.facet_mesh import FacetMesh, FacetShapes, facet_corners
from anisocontact.facets import FacetSets, FacetSurface

Ints = npt.NDArray[np.int64]
Floats = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

#: Area of the overlaps over that of the reference facet: more missing than this is not covered.
UNCOVERED = 1e-6
#: Overlaps below this share of the reference facet are nothing but rounding.
SLIVER = 1e-14
#: Corrections to the coordinates of a master corner on a slave facet: on a parallelogram one is
#: exact, on others the overlaps move with it, not the sum of the weights.
CORRECTIONS = 3


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

    The corners of the master go to the coordinates of a slave facet along its normal; sides are
    taken as straight there, and clipped to the reference facet [Sutherland Hodgman 1974].

    Args:
        slave: Facets that are cut.
        master: Facets that cut them.
        surface: The master where it is now.
        now: Positions of the nodes, (nodes, 3), length.
        reach: Distance within which a master facet counts, length.
        excluded: Master facets that do not count, for each slave facet.

    Returns:
        Points on the facets that are covered.
    """
    shapes = FacetShapes(slave.topology)
    x = now[slave.nodes]
    f, g = _facing(slave, shapes, x, surface, master, now, reach, excluded)
    corners = now[master.nodes[g][:, facet_corners(master.topology)]]
    polygons = _coordinates(shapes, x[f], corners)
    edges = shapes.half_planes
    counts = np.full(len(f), polygons.shape[1])
    for normal, bound in edges:
        polygons, counts = _clip(polygons, counts, normal, bound)
    at, weight, pair = _fan(polygons, counts, shapes)
    owner = f[pair]
    total = np.bincount(owner, weights=weight, minlength=len(x))
    covered = np.abs(total - shapes.area) < UNCOVERED * shapes.area
    kept = np.flatnonzero(covered[owner])
    kept = kept[np.argsort(owner[kept], kind="stable")]
    facet = g[pair[kept]].astype(np.int32)
    return Overlaps(owner[kept], at[kept], weight[kept], facet, covered)


def _facing(
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
    sets = surface.within(middle, float(radius.max(initial=0.0)) + reach)
    f = np.repeat(np.arange(len(x)), np.diff(sets.offsets))
    g = sets.facets.astype(np.int64)
    normal, other = _normals(shapes, slave, now), _outward(master, now)
    centre, size = _ball(now[master.nodes])
    apart = centre[g] - middle[f]
    along = np.sum(apart * normal[f], axis=1)[:, None] * normal[f]
    near = np.linalg.norm(apart - along, axis=1) <= radius[f] + size[g]
    kept = near & (np.sum(normal[f] * other[g], axis=1) < 0.0)
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


def _coordinates(shapes: FacetShapes, x: Floats, corners: Floats) -> Floats:
    """Coordinates on slave facets of the feet of points, (pairs, corners, 2)."""
    pairs, count, k = *corners.shape[:2], x.shape[1]
    eta = np.tile(shapes.middle, (pairs, count, 1))
    for _ in range(CORRECTIONS):
        value, gradient = shapes.at(eta.reshape(-1, 2))
        value = value.reshape(pairs, count, k)
        t = np.einsum("pckd,pki->pcdi", gradient.reshape(pairs, count, k, 2), x)
        apart = corners - value @ x
        eta = eta + _solved(t @ t.swapaxes(2, 3), (t @ apart[..., None])[..., 0])
    return np.asarray(eta)


def _solved(a: Floats, b: Floats) -> Floats:
    """Solutions of systems of two equations; zero where a facet has no area at the point."""
    det = a[..., 0, 0] * a[..., 1, 1] - a[..., 0, 1] * a[..., 1, 0]
    x = a[..., 1, 1] * b[..., 0] - a[..., 0, 1] * b[..., 1]
    y = a[..., 0, 0] * b[..., 1] - a[..., 1, 0] * b[..., 0]
    return np.asarray(np.stack([x, y], axis=-1) / np.where(det > 0.0, det, np.inf)[..., None])


def _clip(polygons: Floats, counts: Ints, normal: Floats, bound: float) -> tuple[Floats, Ints]:
    """The parts of polygons with normal . p <= bound; only the first `counts` corners count."""
    n, most, _ = polygons.shape
    corner = np.arange(most)
    there = corner < counts[:, None]
    after = np.where(corner + 1 < counts[:, None], corner + 1, 0)
    follower = np.take_along_axis(polygons, after[..., None], axis=1)
    d, e = polygons @ normal - bound, follower @ normal - bound
    crossing = (d <= 0.0) != (e <= 0.0)
    share = d / np.where(crossing, d - e, 1.0)
    out = np.stack([polygons, polygons + share[..., None] * (follower - polygons)], axis=2)
    held = np.stack([there & (d <= 0.0), there & crossing], axis=2).reshape(n, 2 * most)
    order = np.argsort(~held, axis=1, kind="stable")
    counts = held.sum(axis=1)
    order = order[:, : max(int(counts.max(initial=0)), 3)]
    return np.take_along_axis(out.reshape(n, 2 * most, 2), order[..., None], axis=1), counts


def _fan(polygons: Floats, counts: Ints, shapes: FacetShapes) -> tuple[Floats, Floats, Ints]:
    """Quadrature over polygons cut into triangles: coordinates, weights, polygon of each point."""
    second = np.arange(1, polygons.shape[1] - 1)
    edges = polygons[:, 1:] - polygons[:, :1]
    a, b = edges[:, second - 1], edges[:, second]
    area = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    area = np.where(second + 1 < counts[:, None], area, 0.0)
    whole = area.sum(axis=1)
    area *= np.sign(whole)[:, None]
    pair, triangle = np.nonzero((np.abs(area) > SLIVER) & np.isfinite(whole)[:, None])
    rule: Any = basix.make_quadrature(basix.CellType.triangle, shapes.overlap_degree)
    points, weights = np.asarray(rule[0]), np.asarray(rule[1])
    at = (
        polygons[pair, 0][:, None]
        + points[:, :1] * a[pair, triangle][:, None]
        + points[:, 1:] * b[pair, triangle][:, None]
    )
    weight = area[pair, triangle][:, None] * weights
    return at.reshape(-1, 2), weight.reshape(-1), np.repeat(pair, len(weights))
