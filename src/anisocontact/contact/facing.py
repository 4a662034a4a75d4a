"""Which facets of a slave face which of the master, and which of these they can meet."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt

from anisocontact.contact.facet_mesh import FacetMesh, FacetShapes, facet_corners
from anisocontact.surfaces.facets import FacetSets, FacetSurface

Ints = npt.NDArray[np.int64]
Ints32 = npt.NDArray[np.int32]
Floats = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

#: How far behind each other facets lie at most that touch in a slit, as a share of their radius: a
#: thin wall is thicker.
BEHIND = 0.02
#: Least cosine between the normal of one and the reversed one of its neighbour at the tip of a
#: closed crack.
CLOSED = 0.9


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
    def near(self) -> Near | None:
        """Facets of the master near to each of the slave; None where it can meet all."""

    @property
    def reference(self) -> Floats:
        """Positions of the nodes in the reference configuration, (nodes, 3), length."""

    @property
    def threads(self) -> int:
        """Threads of the kernel."""


@dataclass(frozen=True)
class Near:
    """Facets near to each facet in the reference configuration, and its neighbours.

    Attributes:
        unmet: Those that it does not overlap: neighbours, but at the tip of a closed crack, and
            the other side of a thin wall.
        unseen: Those that its points do not look at: as well those that it does not face.
    """

    unmet: FacetSets
    unseen: FacetSets

    def by(self, change: Callable[[FacetSets], FacetSets]) -> Near:
        """Both changed alike."""
        return Near(change(self.unmet), change(self.unseen))


@dataclass(frozen=True)
class Pairs:
    """Pairs of facets that face each other.

    Attributes:
        slave: Facets of the slave, (p,).
        master: Facets of the master, (p,).
        apart: Distances of their middles, (p,), length.
    """

    slave: Ints
    master: Ints
    apart: Floats

    def take(self, which: Mask) -> Pairs:
        """Some of them."""
        return Pairs(self.slave[which], self.master[which], self.apart[which])


def largest_radius(slave: FacetMesh, now: Floats) -> float:
    """Largest distance of a node from the middle of its facet, length; 0 without facets."""
    nodes = slave.nodes if slave.sweep is None else slave.sweep.edges(slave.nodes)
    return float(_ball(now[nodes])[1].max(initial=0.0))


def facing(sides: Facing, slave: FacetMesh, now: Floats, radius: float) -> Pairs:
    """Pairs of facets within reach that oppose each other and may overlap along the normal.

    Args:
        sides: Slave and master, whose surface has to be there already.
        slave: Facets of the slave, to which `near` belongs.
        now: Positions of the nodes, (nodes, 3), length.
        radius: As of `largest_radius`, over all processes.
    """
    master, x = sides.master, now[slave.nodes]
    middle, radii = _ball(x)
    sets = sides.surface.within(middle, sides.reach + radius)
    f = np.repeat(np.arange(len(x)), np.diff(sets.offsets))
    g = sets.facets.astype(np.int64)
    normal, other = _outward(slave, now), _outward(master, now)
    centre, size = _ball(now[master.nodes])
    apart, normals = centre[g] - middle[f], normal[f]
    along = np.einsum("pi,pi->p", apart, normals)
    beside = np.einsum("pi,pi->p", apart, apart) - along**2
    kept = beside <= (radii[f] + size[g]) ** 2
    kept &= np.einsum("pi,pi->p", normals, other[g]) < 0.0
    if sides.near is not None:
        n, unmet = len(master.nodes), sides.near.unmet
        who = np.repeat(np.arange(len(x)), np.diff(unmet.offsets))
        kept &= ~np.isin(f * n + g, who * n + unmet.facets)
    return Pairs(f[kept], g[kept], np.linalg.norm(apart[kept], axis=1))


def near_facets(
    mesh: FacetMesh,
    numbers: Ints32,
    surface: FacetSurface,
    master: FacetMesh,
    x: Floats,
    apart: float,
) -> Near:
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
    return Near(*(FacetSets.of_pairs(f[one], g[one], count) for one in (unmet, unseen)))


def _looks(
    mesh: FacetMesh, master: FacetMesh, x: Floats, f: Ints, g: Ints32
) -> tuple[Floats, Floats]:
    """How far facets look at each other, behind by `BEHIND`, and how much their normals oppose."""
    normal, other = _outward(mesh, x), _outward(master, x)
    (middle, radius), (centre, _) = _ball(x[mesh.nodes]), _ball(x[master.nodes])
    ahead = 0.5 * np.einsum("pi,pi->p", centre[g] - middle[f], normal[f] - other[g])
    return ahead + BEHIND * radius[f], -np.einsum("pi,pi->p", normal[f], other[g])


def _ball(x: Floats) -> tuple[Floats, Floats]:
    """Middles of facets and the distance of the farthest node, (facets, 3) and (facets,)."""
    middle = x.mean(axis=1)
    return middle, np.linalg.norm(x - middle[:, None], axis=2).max(axis=1)


def _outward(mesh: FacetMesh, now: Floats) -> Floats:
    """Outward unit normals at the middles of facets, (facets, 3)."""
    shapes = FacetShapes(mesh.topology)
    gradient = shapes.at(shapes.middle[None])[1][0]
    t = np.einsum("kd,mki->mdi", gradient, now[mesh.nodes])
    normal = np.cross(t[:, 0], t[:, 1])
    return np.asarray(
        np.where(mesh.flip, -1.0, 1.0)[:, None] * normal / np.linalg.norm(normal, axis=1)[:, None]
    )
