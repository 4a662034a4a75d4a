"""Places on the master that are closest to the slave nodes, where contact planes touch it."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from anisocontact.contact.contact_planes import Opposite
from anisocontact.contact.sides import Sides
from anisocontact.surfaces.facets import FACET_STATUS, FEATURES, FacetProjections

Ints = npt.NDArray[np.int32]
Floats = npt.NDArray[np.float64]


def tangent_places(sides: Sides, hit: FacetProjections) -> Opposite:
    """Where the tangents of the master are taken, opposite to no nodes yet.

    Args:
        sides: Slave nodes and facets.
        hit: Projections of the slave nodes.

    Returns:
        Facets, nodes and the shape functions there; no facet where there is no projection.
    """
    nodes = sides.master.nodes
    if not len(nodes):
        return Opposite.none(len(hit.facet), nodes.shape[1])
    there = hit.status <= FACET_STATUS.index("off")
    facet = np.where(there, hit.facet, -1).astype(np.int32)
    which = np.maximum(facet, 0)
    found = sides.surface.shapes(which, np.nan_to_num(hit.xi))
    shape, gradient, second = (one[:, : nodes.shape[1]] for one in found)
    second = np.moveaxis(second[:, :, [[0, 1], [1, 2]]], 1, 3)
    inside = hit.feature == FEATURES.index("interior")
    none = np.zeros((len(facet), 0))
    gradient = np.ascontiguousarray(gradient.swapaxes(1, 2))
    xi = np.nan_to_num(hit.xi)
    around, along, bending = _material(sides, which, xi, gradient, second)
    return Opposite(
        none.astype(np.int32),
        none,
        facet,
        nodes[which],
        np.ascontiguousarray(shape),
        gradient,
        np.ascontiguousarray(second),
        np.where(inside[:, None], np.nan, hit.edge),
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
