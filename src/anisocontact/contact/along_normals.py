"""Places of a master of facets that slave nodes meet along their averaged normals.

The closest point jumps where two facets are equally near, on the hollow side of every edge between
them. Along a normal that does not turn there it passes the edge without a jump
[Puso Laursen 2004]: the place p of a slave node x is where with P = I - n n

    d_a . P (x - p) = 0 ,

d_a the tangents of the facet: p = x - s n inside the surface, and beyond its border the point of it
that is closest as seen along n.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from anisocontact.base.array_types import Flags, Floats, Ints, Locals
from anisocontact.contact.facet_mesh import beyond_sides
from anisocontact.contact.sides import Sides, located
from anisocontact.surfaces.facets import FACET_STATUS, FEATURES, FacetProjections

#: Corrections of a place on a facet, and the last one that is good enough.
MOST, ENOUGH = 12, 1e-14
#: Facets that are tried one after the other.
TRIED = 8
#: Least cosine between a normal and that of a facet that it meets.
OPPOSED = 0.1
#: How far coordinates may be beyond the sides of a facet: rounding.
ROUNDING = 1e-10
#: Sides of facets: where they start, and their directions.
_BORDERS = {
    "tri": (((0.0, 0.0), (1.0, 0.0)), ((0.0, 0.0), (0.0, 1.0)), ((1.0, 0.0), (-1.0, 1.0))),
    "quad": (
        ((0.0, 0.0), (1.0, 0.0)),
        ((0.0, 1.0), (1.0, 0.0)),
        ((0.0, 0.0), (0.0, 1.0)),
        ((1.0, 0.0), (0.0, 1.0)),
    ),
}
#: Share by which another place on the border has to be nearer than that on the edge of before.
NEARER = 1e-3


@dataclass(frozen=True)
class NormalProjections:
    """Places on the master.

    Attributes:
        facet: Facets, (n,); -1 where there is none.
        xi: Coordinates on them, (n, 2).
        edge: Direction of the border of the surface on which a place is, in coordinates, (n, 2);
            not a number inside the surface; zero where the place does not follow the slave node.
    """

    facet: Locals
    xi: Floats
    edge: Floats


def along_normals(
    sides: Sides,
    x: Floats,
    normal: Floats,
    hit: FacetProjections,
    before: NormalProjections | None = None,
) -> NormalProjections:
    """Where normals of slave nodes meet the master.

    Args:
        sides: Both sides; the surface is where it is now.
        x: Slave nodes, (n, 3), length.
        normal: Unit normals there, (n, 3).
        hit: Closest points of the slave nodes. Nodes whose normal meets nothing that is near to
            these keep them.
        before: Places at the accepted increment, if there are any.
    """
    there = hit.status <= FACET_STATUS.index("off")
    facet = np.where(there, hit.facet, -1).astype(np.int32)
    places = NormalProjections(facet, np.nan_to_num(hit.xi), np.zeros((len(facet), 2)))
    rest, at = np.flatnonzero(there), hit.take(np.flatnonzero(there))
    for tried in range(TRIED):
        found, xi = _met(sides, x[rest], normal[rest], at)
        _put(places, rest[found], at.facet[found], xi[found], np.nan)
        if tried:
            off = ~found & ~located(at)
            border = _border(sides, x[rest], normal[rest], at)
            _put(places, rest[off], at.facet[off], border.xi[off], border.edge[off])
            found |= off
        if found.all():
            break
        rest = rest[~found]
        ahead, opposed = _ahead(sides, x[rest], normal[rest], at.take(np.flatnonzero(~found)))
        rest, ahead = rest[opposed], ahead[opposed]
        excluded = None if sides.excluded is None else sides.excluded.take(rest)
        at = sides.surface.project(ahead, None, sides.reach, excluded)
        near = np.flatnonzero(at.status <= FACET_STATUS.index("off"))
        rest, at = rest[near], at.take(near)
    if before is not None:
        _stay(sides, x, normal, places, before)
    return places


def _stay(
    sides: Sides, x: Floats, normal: Floats, places: NormalProjections, before: NormalProjections
) -> None:
    """Leave places on the edges of the border where they were, unless others are nearer.

    A border that is hollow as seen from a node has two closest points, between which it would hop.
    One that was not on an edge stays on one of the facet where it was.
    """
    on_edge, was_on_edge = (
        one.edge.any(axis=1) & ~np.isnan(one.edge[:, 0]) for one in (places, before)
    )
    moved = (places.facet >= 0) & (before.facet >= 0) & (places.facet != before.facet) & on_edge
    if not moved.any():
        return
    stayed = _kept(sides, x, normal, places, before, np.flatnonzero(moved & was_on_edge))
    for start, along in _BORDERS[sides.master.topology.rstrip("0123456789")]:
        n = len(before.facet)
        side = NormalProjections(before.facet, np.tile(start, (n, 1)), np.tile(along, (n, 1)))
        rest = np.flatnonzero(moved & ~was_on_edge & ~stayed)
        stayed |= _kept(sides, x, normal, places, side, rest)


def _kept(
    sides: Sides,
    x: Floats,
    normal: Floats,
    places: NormalProjections,
    other: NormalProjections,
    rows: Ints,
) -> Flags:
    """Take the places on other edges that next to none of some places, (m,), are nearer than.

    Returns:
        Which places have been taken, (n,).
    """
    taken = np.zeros(len(places.facet), dtype=bool)
    if not rows.size:
        return taken
    x, normal = x[rows], normal[rows]
    now, then = (
        NormalProjections(p.facet[rows], p.xi[rows], p.edge[rows]) for p in (places, other)
    )
    then = _border(sides, x, normal, then)
    away, stayed = (
        np.linalg.norm(_across(x - sides.surface.jet(p.facet, p.xi).position, normal), axis=1)
        for p in (now, then)
    )
    kept = (stayed <= (1.0 + NEARER) * away) & then.edge.any(axis=1)
    _put(places, rows[kept], then.facet[kept], then.xi[kept], then.edge[kept])
    taken[rows[kept]] = True
    return taken


def _put(
    places: NormalProjections, rows: Ints, facet: Locals, xi: Floats, edge: Floats | float
) -> None:
    places.facet[rows], places.xi[rows], places.edge[rows] = facet, xi, edge


def _dot(a: Floats, b: Floats) -> Floats:
    return np.asarray(np.einsum("ni,ni->n", a, b))


def _across(v: Floats, normal: Floats) -> Floats:
    """What of vectors, (n, 3), is across unit normals, (n, 3)."""
    return np.asarray(v - _dot(v, normal)[:, None] * normal)


def _met(sides: Sides, x: Floats, normal: Floats, at: FacetProjections) -> tuple[Flags, Floats]:
    """Whether normals meet facets inside, (n,), and where, (n, 2)."""
    inside = at.feature == FEATURES.index("interior")
    xi = np.where(inside[:, None], at.xi, np.clip(at.xi, 0.0, 1.0))
    xi, met = sides.surface.met_along(at.facet, xi, x, normal, OPPOSED)
    return met & (beyond_sides(sides.master.topology, xi) <= ROUNDING), xi


def _ahead(sides: Sides, x: Floats, normal: Floats, at: FacetProjections) -> tuple[Floats, Flags]:
    """Where normals meet the planes of what is closest, (n, 3), and whether they do, (n,)."""
    jet = sides.surface.jet(at.facet, at.xi)
    plane = np.cross(jet.d1[:, 0], jet.d1[:, 1])
    plane /= np.linalg.norm(plane, axis=1)[:, None]
    ridge = located(at) & (at.feature != FEATURES.index("interior"))
    plane[ridge] = at.normal[ridge]
    cosine = _dot(plane, normal)
    opposed = np.abs(cosine) > OPPOSED
    way = _dot(jet.position - x, plane) / np.where(opposed, cosine, 1.0)
    return x + way[:, None] * normal, opposed


def _border(
    sides: Sides, x: Floats, normal: Floats, at: FacetProjections | NormalProjections
) -> NormalProjections:
    """Places on the edges of the border that are closest as seen along normals."""
    edge, xi = at.edge.copy(), at.xi.copy()
    least, most = _ends(xi, edge)
    along = np.zeros(len(xi))
    for _ in range(MOST):
        jet = sides.surface.jet(at.facet, xi + along[:, None] * edge)
        tangent = np.einsum("na,nad->nd", edge, jet.d1)
        second = np.stack([edge[:, 0] ** 2, 2.0 * edge[:, 0] * edge[:, 1], edge[:, 1] ** 2], axis=1)
        rest = _across(x - jet.position, normal)
        slope = (_across(tangent, normal) ** 2).sum(axis=1)
        slope -= np.einsum("nk,nkd,nd->n", second, jet.d2, rest)
        step = _dot(tangent, rest) / np.where(slope > 0.0, slope, np.inf)
        new = np.clip(along + step, least, most)
        done, along = np.abs(new - along).max(initial=0.0) <= ENOUGH, new
        if done:
            break
    edge[(along <= least) | (along >= most)] = 0.0
    return NormalProjections(at.facet, xi + along[:, None] * at.edge, edge)


def _ends(xi: Floats, edge: Floats) -> tuple[Floats, Floats]:
    """How far an edge goes on from places on it, in both directions, (n,) each."""
    with np.errstate(divide="ignore", invalid="ignore"):
        ends = np.sort(np.stack([-xi / edge, (1.0 - xi) / edge], axis=2), axis=2)
    ends[edge == 0.0] = -np.inf, np.inf
    least, most = ends[..., 0].max(axis=1), ends[..., 1].min(axis=1)
    still = (edge == 0.0).all(axis=1)
    return np.where(still, 0.0, least), np.where(still, 0.0, most)
