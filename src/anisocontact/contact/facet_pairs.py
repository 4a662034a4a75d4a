"""Which facets of a slave face which of the master, and which of these they can meet."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from anisocontact import _core
from anisocontact.base.array_types import Flags, Floats, Ints, Locals
from anisocontact.contact.facet_mesh import FacetMesh, facet_corners, outward_normals
from anisocontact.contact.near_facets import NearFacets
from anisocontact.contact.sharp_edges import SMOOTH
from anisocontact.surfaces.facets import FacetSets, FacetSurface

Ints32 = Locals

#: How far behind each other facets lie at most that touch in a slit, as a share of their radius: a
#: thin wall is thicker.
BEHIND = 0.02
#: Least cosine between the normal of one and the reversed one of another that is in front of it.
OPPOSED = 0.1
#: The same of its neighbour at the tip of a closed crack.
CLOSED = 0.9
#: Distance up to which facets are met that go on from those within reach, over the reach.
FARTHER = 2.0


class FacingSides(Protocol):
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
    def near(self) -> NearFacets | None:
        """Facets of the master near to each of the slave; None where it can meet all."""

    @property
    def reference(self) -> Floats:
        """Positions of the nodes in the reference configuration, (nodes, 3), length."""

    @property
    def threads(self) -> int:
        """Threads of the kernel."""


@dataclass(frozen=True)
class FacetPairs:
    """Pairs of facets that face each other.

    Attributes:
        slave: Facets of the slave, (p,).
        master: Facets of the master, (p,).
        apart: Distances of their middles, (p,), length.
    """

    slave: Ints
    master: Ints
    apart: Floats

    def take(self, which: Flags) -> FacetPairs:
        """Some of them."""
        return FacetPairs(self.slave[which], self.master[which], self.apart[which])


def largest_radius(slave: FacetMesh, now: Floats) -> float:
    """Largest distance of a node from the middle of its facet, length; 0 without facets."""
    nodes = slave.nodes if slave.sweep is None else slave.sweep.edges(slave.nodes)
    return float(_ball(nodes, now)[1].max(initial=0.0))


def facing_pairs(
    sides: FacingSides,
    slave: FacetMesh,
    now: Floats,
    radius: float,
    across: Flags | None = None,
    *,
    farther: bool = False,
) -> FacetPairs:
    """Pairs of facets within reach that oppose each other and may overlap along the normal.

    Args:
        sides: Slave and master, whose surface has to be there already.
        slave: Facets of the slave, to which `near` belongs.
        now: Positions of the nodes, (nodes, 3), length.
        radius: As of `largest_radius`, over all processes.
        across: Facets of the slave that meet what faces them within 60 degrees alone, (m,), see
            `beside_edges`.
        farther: Whether what goes on in front of a facet from those within reach is met up to twice
            the reach: what rises steeply there would come and go.
    """
    master, near = sides.master, sides.near
    middle, radii = _ball(slave.nodes, now)
    centre, size = _ball(master.nodes, now)
    own, other = outward_normals(slave, now), outward_normals(master, now)
    none = FacetSets(np.zeros(0, np.int64), np.zeros(0, np.int32))
    unmet = none if near is None else near.unmet
    found = sides.surface.core.facing(
        middle,
        radii,
        own,
        centre,
        size,
        other,
        sides.reach + radius,
        (FARTHER if farther else 1.0) * sides.reach + radius,
        unmet.offsets,
        unmet.facets,
        sides.threads,
    )
    pairs = FacetPairs(*found)
    if across is None or not across.any():
        return pairs
    opposed = -np.einsum("pi,pi->p", own[pairs.slave], other[pairs.master])
    return pairs.take(~across[pairs.slave] | (opposed > SMOOTH))


def near_facets(
    mesh: FacetMesh,
    numbers: Ints32,
    surface: FacetSurface,
    master: FacetMesh,
    x: Floats,
    apart: float,
) -> NearFacets:
    """What is near facets in the reference configuration.

    Args:
        mesh: The facets.
        numbers: Their numbers on the surface, -1 for one that is not part of it, (m,).
        surface: The surface they are part of, in the reference configuration.
        master: Its facets.
        x: Positions of the nodes there, (nodes, 3), length.
        apart: Facets nearer than this to the middle or a corner of a facet are near.
    """
    corners = x[mesh.nodes[:, facet_corners(mesh.topology)]]
    points = np.concatenate([corners, corners.mean(axis=1, keepdims=True)], axis=1)
    count, each, _ = points.shape
    found = surface.within(points.reshape(-1, 3), apart)
    part = np.flatnonzero(numbers >= 0)
    rings = surface.rings(numbers[part])
    owner = np.repeat(np.arange(count * each) // each, np.diff(found.offsets))
    beside = np.repeat(part, np.diff(rings.offsets))
    pairs = FacetSets.of_pairs(
        np.concatenate([owner, beside]), np.concatenate([found.facets, rings.facets]), count
    )
    f, g = np.repeat(np.arange(count), np.diff(pairs.offsets)), pairs.facets
    ahead, opposed = _looks(mesh, master, x, f, g)
    m = len(master.nodes)
    neighbours = np.isin(f * m + g, beside * m + rings.facets)
    meets = ~neighbours | ((ahead > 0.0) & (opposed > CLOSED))
    walls = (ahead <= 0.0) & (opposed > 0.0)
    unmet, unseen = ~meets | walls, ~meets | (ahead <= 0.0) | (opposed <= 0.0)
    faced = ~unseen & (opposed > OPPOSED)
    return NearFacets(
        *(FacetSets.of_pairs(f[one], g[one], count) for one in (unmet, unseen, faced))
    )


def _looks(
    mesh: FacetMesh, master: FacetMesh, x: Floats, f: Ints, g: Ints32
) -> tuple[Floats, Floats]:
    """How far facets look at each other, behind by `BEHIND`, and how much their normals oppose."""
    normal, other = outward_normals(mesh, x), outward_normals(master, x)
    (middle, radius), (centre, _) = _ball(mesh.nodes, x), _ball(master.nodes, x)
    ahead = 0.5 * np.einsum("pi,pi->p", centre[g] - middle[f], normal[f] - other[g])
    return ahead + BEHIND * radius[f], -np.einsum("pi,pi->p", normal[f], other[g])


def _ball(nodes: Ints32, x: Floats) -> tuple[Floats, Floats]:
    """Middles of facets and the distance of the farthest node, (facets, 3) and (facets,)."""
    found: tuple[Floats, Floats] = _core.facet_balls(nodes, x)
    return found
