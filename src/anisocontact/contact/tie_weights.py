"""Conditions of facets that are tied to others on a mesh that does not match.

At each slave node `D_i u_i = sum of W_ik u_k`, with the mortar weights of the first configuration.
Where the surfaces do not lie on each other, as facets of curved ones, the gap between a node and
the mean of its masters, `g_i = X_i - sum of W_ik X_k / D_i`, goes with the material of the master:

    u_i = sum of W_ik u_k / D_i + grad u . g_i ,

grad u that of the cell of the master below. So linear displacements, and with them all rigid
motions, are kept exactly whatever the gaps are.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
import scipy

from anisocontact.base.errors import InputError
from anisocontact.contact.facet_mesh import FacetMesh
from anisocontact.contact.facing import Near, facing, largest_radius
from anisocontact.contact.mortar_weights import MortarWeights, mortar_weights
from anisocontact.contact.slave_nodes import Patches, nodal_quadrature, patches
from anisocontact.contact.tied_surfaces import WholeGroups
from anisocontact.surfaces import default_threads
from anisocontact.surfaces.facets import FacetSurface

Ints = npt.NDArray[np.int64]
Floats = npt.NDArray[np.float64]
type Sparse = scipy.sparse.csr_array

#: Share of the weight of a node that has to lie on the master for it to be tied: others would be
#: led by what is far from them. What the master covers is tied by the nodes beside.
COVERED = 0.05
#: Gap over the size of the facets that is none: rounding.
CLOSED = 1e-12


@dataclass(frozen=True)
class TieConditions:
    """Conditions `own u - other u = 0`, one for each slave node.

    Attributes:
        nodes: The slave nodes, (s,).
        weight: D of each, 0 of those that do not lie on the master, length^2.
        own: Shares of the slave's nodes, (s, n), length^2.
        other: Shares of the master's, (s, n), length^2.
        beside: Whether two slave nodes have a facet in common, (s, s).
        covered: Whether each can be tied, (s,).
        gap: Distance of each from the master, (s,), length; NaN of those not tied.
    """

    nodes: Ints
    weight: Floats
    own: Sparse
    other: Sparse
    beside: Sparse
    covered: npt.NDArray[np.bool_]
    gap: Floats


@dataclass(frozen=True)
class _Sides:
    """Both sides as `mortar_weights` takes them."""

    slave: FacetMesh
    master: FacetMesh
    surface: FacetSurface
    reach: float
    reference: Floats
    near: Near | None = None
    threads: int = 1


def tie_conditions(
    groups: WholeGroups, slave: str, master: str, tolerance: float, size: float
) -> TieConditions:
    """Conditions of a tie.

    Args:
        groups: Both groups.
        slave: Facet group of the slave.
        master: Facet group of the master.
        tolerance: Facets with nodes farther off than this are not tied, length.
        size: Length of the facets of the master.

    Raises:
        InputError: No facet is as near as that.
    """
    x = groups.x if groups.sweep is None else groups.sweep.positions(groups.x)
    own, other = groups.groups[slave].facets, groups.groups[master]
    surface = FacetSurface(x, other.facets.nodes, other.facets.topology, other.facets.flip)
    threads = default_threads()
    sides = _Sides(own, other.facets, surface, max(tolerance, size), x, threads=threads)
    found = _conditions(groups, sides, other.cells, CLOSED * size)
    far = found.nodes[found.covered & ~(found.gap <= tolerance)]
    kept = ~np.isin(own.nodes % len(groups.x), far).any(axis=1)
    if not (kept.any() and found.covered.any()):
        least = "" if not len(far) else f", the nearest gap is {np.nanmin(found.gap):.4g}"
        text = f"no facet of {slave!r} lies within {tolerance:.4g} of {master!r}{least}"
        raise InputError(text, "tolerance")
    if len(far):
        near = replace(own, nodes=own.nodes[kept], flip=own.flip[kept])
        found = _conditions(groups, replace(sides, slave=near), other.cells, CLOSED * size)
    return found


def _conditions(groups: WholeGroups, sides: _Sides, cells: Ints, closed: float) -> TieConditions:
    around = patches(sides.slave)
    none = np.zeros((len(around.nodes), 0), dtype=np.int32)
    radius = largest_radius(sides.slave, sides.reference)
    pairs = facing(sides, sides.slave, sides.reference, radius)
    weights = mortar_weights(
        sides, around, sides.reference, none, pairs, current_area=True, hand_over=False
    )
    count = len(groups.x)
    nodes, row = np.unique(around.nodes[:, 0].astype(np.int64) % count, return_inverse=True)
    shape = (len(nodes), count)
    weight = np.bincount(row, weights.area, minlength=len(nodes))
    whole = nodal_quadrature(around, sides.reference).weights[:, 0]
    covered = weight > COVERED * np.bincount(row, whole, minlength=len(nodes))
    own, other = _shares(around, weights, row, shape)
    apart = np.zeros((len(nodes), 3))
    apart[covered] = ((own - other) @ groups.x)[covered] / weight[covered, None]
    gap = np.linalg.norm(apart, axis=1)
    open_ = np.flatnonzero(gap > closed)
    carried = _carried(groups, sides.surface, cells, nodes[open_], apart[open_])
    scaled = scipy.sparse.csr_array(
        (weight[open_], (open_, np.arange(len(open_)))), (len(nodes), len(open_))
    )
    facets = np.repeat(np.arange(len(sides.slave.nodes)), sides.slave.nodes.shape[1])
    on = np.searchsorted(nodes, sides.slave.nodes.ravel() % count)
    touching = scipy.sparse.csr_array((np.ones(len(on)), (on, facets)))
    return TieConditions(
        nodes,
        weight,
        own,
        (other + scaled @ carried).tocsr(),
        touching @ touching.T,
        covered,
        np.where(covered, gap, np.nan),
    )


def _shares(
    around: Patches, weights: MortarWeights, row: Ints, shape: tuple[int, int]
) -> tuple[Sparse, Sparse]:
    """Shares of the nodes of slave and master in the conditions; of images those of their nodes."""
    rows, width = around.support.shape[1], weights.masters.shape[1]
    there = weights.masters >= 0
    own = (np.repeat(row, rows), around.nodes[:, :rows].ravel() % shape[1])
    other = (np.repeat(row, width)[there.ravel()], weights.masters[there] % shape[1])
    by_support = (weights.area[:, None] * around.support).ravel()
    return (
        scipy.sparse.csr_array((by_support, own), shape=shape),
        scipy.sparse.csr_array((weights.weight[there], other), shape=shape),
    )


def _carried(
    groups: WholeGroups, surface: FacetSurface, cells: Ints, nodes: Ints, apart: Floats
) -> Sparse:
    """What the material of the master moves vectors that begin at it, `grad u . g`, (p, n)."""
    shape = (len(nodes), len(groups.x))
    if not len(nodes):
        return scipy.sparse.csr_array(shape)
    behind = cells[surface.project(groups.x[nodes]).facet]
    tangents = groups.x[behind].swapaxes(1, 2) @ groups.gradient  # (p, 3, dimension)
    slopes = groups.gradient @ np.linalg.pinv(tangents)
    values = np.einsum("pki,pi->pk", slopes, apart)
    rows = np.repeat(np.arange(len(nodes)), behind.shape[1])
    return scipy.sparse.csr_array((values.ravel(), (rows, behind.ravel())), shape=shape)
