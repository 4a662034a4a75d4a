"""Nodes that a mortar contact can couple where bodies move past each other."""

from __future__ import annotations

import numpy as np
import scipy

from anisocontact.base.array_types import Floats, Ints, Locals
from anisocontact.contact.reachable import NodePairs
from anisocontact.contact.sides import Sides
from anisocontact.contact.slave_nodes import SlaveNodes
from anisocontact.surfaces.facets import FACET_STATUS


def mortar_reachable(
    sides: Sides, points: SlaveNodes, now: Floats, way: Floats, margin: float
) -> list[NodePairs]:
    """Nodes that a tangent can couple where slave nodes go along a way.

    A slave node couples the nodes around it with those of all facets of the master that these
    facets may lie on, and the latter with each other.

    Args:
        sides: Slave and master; the surface is where the nodes are.
        points: The slave nodes.
        now: Positions of the nodes, (nodes, 3), length.
        way: Displacement of each slave node against the master at places along the way, or one
            for all, (w, n or 1, 3), length.
        margin: How far beside the way a node can be, length.
    """
    nodes, named = sides.gathered.local_names(points.nodes), sides.gathered.coupled
    own = nodes[:, : points.quadrature.rows]
    if not (len(nodes) and len(sides.master.nodes)):
        return [(named(own), named(nodes))]
    x = points.positions(now)
    sweep = sides.master.sweep
    near = points.nodes if sweep is None else sweep.in_plane(points.nodes)
    radius = np.linalg.norm(now[near] - x[:, None], axis=2).max()
    limit = sides.reach + float(np.linalg.norm(way, axis=2).max())
    places = (x + way).reshape(-1, 3)
    which = np.tile(np.arange(len(x)), len(way))
    excluded = None if sides.excluded is None else sides.excluded.take(which)
    hit = sides.surface.project(places, max_distance=limit, exclude=excluded)
    found = np.flatnonzero(hit.status <= FACET_STATUS.index("off"))
    below = sides.surface.within(hit.position[found], margin + radius)
    point = np.repeat(found, np.diff(below.offsets)) % len(x)
    count = len(sides.master.nodes)
    point, facet = np.divmod(np.unique(point * count + below.facets), count)
    both = _incidence(point, sides.gathered.local_names(sides.master.nodes)[facet], len(x))
    first, second = both.nonzero()
    masters = (both.T @ both).nonzero()
    own_masters = second[:, None].astype(np.int32)
    pairs = [
        (own, nodes),
        (own[first], own_masters),
        (own_masters, nodes[first]),
        (masters[0][:, None].astype(np.int32), masters[1][:, None].astype(np.int32)),
    ]
    return [(named(rows), named(columns)) for rows, columns in pairs]


def _incidence(point: Ints, nodes: Locals, count: int) -> scipy.sparse.csr_array:
    """Which nodes of the master are near each point: a matrix (points, nodes)."""
    rows = np.repeat(point, nodes.shape[1])
    shape = (count, int(nodes.max(initial=-1)) + 1)
    return scipy.sparse.csr_array((np.ones(len(rows)), (rows, nodes.reshape(-1))), shape=shape)
