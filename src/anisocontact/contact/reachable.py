"""Facets of a master that slave points get to where bodies move past each other."""

from __future__ import annotations

import numpy as np
import scipy

from anisocontact.base.array_types import Floats, Ints, Locals
from anisocontact.contact.sides import Sides, located
from anisocontact.interface import State
from anisocontact.surfaces.facets import FACET_STATUS, FacetProjections

#: Nodes of rows and columns that are coupled, (p, r) and (p, c), named as in `Couplings`.
type NodePairs = tuple[Locals, Locals]


def reachable(sides: Sides, now: Floats, way: Floats, margin: float, hops: int) -> list[NodePairs]:
    """Nodes that a tangent can couple where the slave points go along a way.

    A point couples the nodes of its facet with those of the facet of the master below it, and these
    with those of the facet that was below it at the end of the last increment.

    Args:
        sides: Slave and master; the surface is where the nodes are.
        now: Positions of the nodes, (nodes, 3), length.
        way: Displacement of each slave point against the master at places along the way, or one
            for all, (w, n or 1, 3), length.
        margin: How far beside the way a point can be, length.
        hops: Places along the way that an increment goes.

    Returns:
        Rows and columns: facets of the slave, pairs of slave and master, of master and slave and
        of facets of the master.
    """
    first = sides.gathered.coupled(sides.slave.nodes)
    if not (len(first) and len(sides.master.nodes)):
        return [(first, first)]
    x = sides.points.positions(now)
    limit = sides.reach + float(np.linalg.norm(way, axis=2).max())
    everywhere = np.tile(np.arange(len(x)), len(way))
    excluded = None if sides.excluded is None else sides.excluded.take(everywhere)
    places = (x + way).reshape(-1, 3)
    hit = sides.surface.project(places, max_distance=limit, exclude=excluded)
    found = np.flatnonzero(hit.status <= FACET_STATUS.index("off"))
    near = sides.surface.within(hit.position[found], margin)
    which = np.repeat(found, np.diff(near.offsets))
    place, point = np.divmod(which, len(x))
    slave = sides.points.facet[point]
    own, other = _different(slave.astype(np.int64), near.facets, len(sides.master.nodes))
    to, back = _met(point * (len(way) + hops) + place, near.facets, len(sides.master.nodes), hops)
    second = sides.gathered.coupled(sides.master.nodes)
    return [
        (first, first),
        (first[own], second[other]),
        (second[other], first[own]),
        (second[to], second[back]),
    ]


def slid(sides: Sides, state: State, hit: FacetProjections) -> Floats:
    """How far the foot of each point has slid on the master since a state, (n, 3), length.

    Zero where there is no foot now or was none then. The surface is where `hit` found it.
    """
    out = np.zeros(hit.position.shape)
    both = np.flatnonzero(located(hit) & (state["facet"] >= 0))
    there = sides.surface.jet(state["facet"][both], state["xi"][both]).position
    out[both] = hit.position[both] - there
    return out


def _met(group: Ints, facet: Locals, facets: int, hops: int) -> tuple[Ints, Ints]:
    """Pairs of facets that are in one group, or in groups at most `hops` apart."""
    rows, columns = _different(group, facet, facets)
    shape = (int(rows.max(initial=0)) + hops + 1, facets)
    there = scipy.sparse.csr_array((np.ones(len(rows)), (rows, columns)), shape=shape)
    total = there.T @ there
    for apart in range(1, hops + 1):
        later = there[:-apart].T @ there[apart:]
        total = total + later + later.T
    to, back = total.nonzero()
    return to.astype(np.int64), back.astype(np.int64)


def _different(first: Ints, second: Locals, count: int) -> tuple[Ints, Ints]:
    """Each pair of numbers once; `second` is below `count`."""
    own, other = np.divmod(np.unique(first * count + second), count)
    return own, other
