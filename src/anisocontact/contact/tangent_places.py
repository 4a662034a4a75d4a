"""Tangents of the master at the places that slave nodes meet."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from anisocontact.contact.along_normals import Places
from anisocontact.contact.contact_planes import Opposite
from anisocontact.contact.sides import Sides

Ints = npt.NDArray[np.int32]
Floats = npt.NDArray[np.float64]


def tangent_places(sides: Sides, places: Places) -> Opposite:
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
    sides: Sides, facet: Ints, xi: Floats, gradient: Floats, second: Floats
) -> tuple[Ints, Floats, Floats]:
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
    x = sides.reference[nodes]
    own, bend = gradient @ x, np.einsum("nabk,nki->nabi", second, x)
    smooth = sides.surface_gradient
    return smooth.nodes[facet], *smooth.tangents(facet, xi, own, bend)
