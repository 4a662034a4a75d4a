"""Tangents of the master at the places that slave nodes meet."""

from __future__ import annotations

import numpy as np

from anisocontact import _core
from anisocontact.base.array_types import Floats, Locals
from anisocontact.contact.along_normals import NormalProjections, along_normals
from anisocontact.contact.contact_planes import Opposite
from anisocontact.contact.facet_mesh import node_coordinates
from anisocontact.contact.sides import Sides
from anisocontact.surfaces.facets import FacetProjections

#: Coordinates of the corners of facets.
CORNERS = {
    "tri": np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]),
    "quad": np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]]),
}


def met_along(
    sides: Sides, x: Floats, normal: Floats, hit: FacetProjections, then: Opposite
) -> Opposite:
    """Where the tangents of the master are taken along normals of slave nodes.

    Args:
        sides: Slave nodes and facets.
        x: Slave nodes, (n, 3), length.
        normal: Unit normals there, (n, 3).
        hit: Closest points of the slave nodes.
        then: What was opposite at the accepted increment.

    Returns:
        As of `tangent_places`.
    """
    return tangent_places(sides, along_normals(sides, x, normal, hit, places_of(sides, then)))


def places_of(sides: Sides, then: Opposite) -> NormalProjections:
    """Places that tangents were taken at, see `tangent_places`."""
    topology = sides.master.topology
    coordinates = node_coordinates(topology, CORNERS[topology.rstrip("0123456789")])
    if not len(sides.master.nodes):
        return NormalProjections(then.facet, np.zeros((len(then.facet), 2)), then.edge)
    xi = then.shape @ coordinates
    flipped = sides.master.flip[np.maximum(then.facet, 0)]  # whose coordinates change places
    return NormalProjections(then.facet, np.where(flipped[:, None], xi[:, ::-1], xi), then.edge)


def tangent_places(sides: Sides, places: NormalProjections) -> Opposite:
    """Where the tangents of the master are taken, opposite to no nodes yet.

    Args:
        sides: Slave nodes and facets.
        places: Where the normals of the slave nodes meet the master.

    Returns:
        Facets, nodes and the shape functions there; no facet where there is no place.
    """
    nodes, facet = sides.master.nodes, places.facet
    if not len(nodes):
        return Opposite.none(len(facet), nodes.shape[1])
    which = np.maximum(facet, 0)
    found = sides.surface.shapes(which, places.xi)
    shape, gradient, second = (one[:, : nodes.shape[1]] for one in found)
    second = np.moveaxis(second[:, :, [[0, 1], [1, 2]]], 1, 3)
    none = np.zeros((len(facet), 0))
    gradient = np.ascontiguousarray(gradient.swapaxes(1, 2))
    around, along, bending = _material(sides, which, places.xi, gradient, second)
    return Opposite(
        none.astype(np.int32),
        none,
        facet,
        nodes[which],
        np.ascontiguousarray(shape),
        gradient,
        np.ascontiguousarray(second),
        places.edge,
        around,
        along,
        bending,
        np.tile(np.eye(2, 3), (len(facet), 1, 1)),
    )


def _material(
    sides: Sides, facet: Locals, xi: Floats, gradient: Floats, second: Floats
) -> tuple[Locals, Floats, Floats]:
    """Nodes that material tangents depend on, what they are made of, and its derivatives.

    Args:
        sides: Slave nodes and facets.
        facet: Facets, (n,).
        xi: Places on them, (n, 2).
        gradient: Derivatives of their shape functions, (n, 2, k).
        second: Second ones, (n, 2, 2, k).
    """
    nodes = sides.master.nodes[facet]
    if sides.master.sweep is not None:  # facets in a row, which have no width on an axis
        return nodes, gradient, np.ascontiguousarray(second)
    both = np.concatenate([gradient, second.reshape(-1, 4, second.shape[3])], axis=1)
    found = _core.node_sums(nodes, both, sides.reference)
    own, bend = found[:, :2], found[:, 2:].reshape(-1, 2, 2, 3)
    smooth = sides.surface_gradient
    return smooth.nodes[facet], *smooth.tangents(facet, xi, own, bend)
