"""Conditions of facets that are tied to others on a mesh that does not match.

At each slave node `D_i u_i = sum of W_ik u_k`, with the mortar weights of the first configuration.
Where the surfaces do not lie on each other, as facets of curved ones, the gap between a node and
the mean of its masters, `g_i = X_i - sum of W_ik X_k / D_i`, goes with the material of the master:

    u_i = sum of W_ik u_k / D_i + grad u . g_i ,

grad u that of the cell of the master below. So linear displacements, and with them all rigid
motions, are kept exactly whatever the gaps are.

Between the cut faces of a sector the master is met turned about the axis, by Q. All of the above is
then said of what it is turned to, with `Q u_k` in the place of `u_k`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial

import numpy as np
import scipy

from anisocontact.base.array_types import Flags, Floats, Ints, Sparse
from anisocontact.base.errors import InputError
from anisocontact.contact.facet_mesh import FacetMesh
from anisocontact.contact.facet_pairs import facing_pairs, largest_radius
from anisocontact.contact.mortar_weights import MortarWeights, mortar_weights
from anisocontact.contact.near_facets import NearFacets
from anisocontact.contact.slave_nodes import Patches, nodal_quadrature, patches
from anisocontact.contact.tied_surfaces import WholeGroups
from anisocontact.contact.turning import Turning
from anisocontact.surfaces import default_threads
from anisocontact.surfaces.facets import FacetSurface

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
        turning: How the master is turned to the slave; None where it stays.
    """

    nodes: Ints
    weight: Floats
    own: Sparse
    other: Sparse
    beside: Sparse
    covered: Flags
    gap: Floats
    turning: Turning | None = None


@dataclass(frozen=True)
class _Sides:
    """Both sides as `mortar_weights` takes them."""

    slave: FacetMesh
    master: FacetMesh
    surface: FacetSurface
    reach: float
    reference: Floats
    near: NearFacets | None = None
    threads: int = 1


def tie_conditions(
    groups: WholeGroups,
    slave: str,
    master: str,
    tolerance: float,
    size: float,
    turning: Turning | None = None,
) -> TieConditions:
    """Conditions of a tie.

    Args:
        groups: Both groups.
        slave: Facet group of the slave.
        master: Facet group of the master.
        tolerance: Facets with nodes farther off than this are not tied, length.
        size: Length of the facets of the master.
        turning: How the master is turned to the slave, if it is.

    Raises:
        InputError: No facet is as near as that.
    """
    x, there = groups.x, groups.x if turning is None else turning.of(groups.x)
    if groups.sweep is not None:
        x, there = groups.sweep.positions(x), groups.sweep.positions(there)
    own, other = groups.groups[slave].facets, groups.groups[master]
    met = other.facets
    if turning is not None:  # nodes of the master once more, where they are turned to
        met = replace(met, nodes=met.nodes + np.int32(len(x)))
        x = np.concatenate([x, there])
    surface = FacetSurface(x, met.nodes, met.topology, met.flip)
    threads = default_threads()
    sides = _Sides(own, met, surface, max(tolerance, size), x, threads=threads)
    find = partial(_conditions, groups, cells=other.cells, closed=CLOSED * size, turning=turning)
    found = find(sides)
    far = found.nodes[found.covered & ~(found.gap <= tolerance)]
    kept = ~np.isin(own.nodes % len(groups.x), far).any(axis=1)
    if not (kept.any() and found.covered.any()):
        least = "" if not len(far) else f", the nearest gap is {np.nanmin(found.gap):.4g}"
        turned = "" if turning is None else f" {turning.text}"
        text = f"no facet of {slave!r} lies within {tolerance:.4g} of {master!r}{turned}{least}"
        raise InputError(text, "tolerance")
    if len(far):
        near = replace(own, nodes=own.nodes[kept], flip=own.flip[kept])
        found = find(replace(sides, slave=near))
    return found


def _conditions(
    groups: WholeGroups, sides: _Sides, cells: Ints, closed: float, turning: Turning | None
) -> TieConditions:
    around = patches(sides.slave)
    none = np.zeros((len(around.nodes), 0), dtype=np.int32)
    radius = largest_radius(sides.slave, sides.reference)
    pairs = facing_pairs(sides, sides.slave, sides.reference, radius)
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
    there = groups.x if turning is None else turning.of(groups.x)
    apart = np.zeros((len(nodes), 3))
    apart[covered] = (own @ groups.x - other @ there)[covered] / weight[covered, None]
    gap = np.linalg.norm(apart, axis=1)
    open_ = np.flatnonzero(gap > closed)
    behind = cells[sides.surface.project(groups.x[nodes[open_]]).facet]
    carried = _carried(groups, there, behind, apart[open_])
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
        turning,
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


def _carried(groups: WholeGroups, x: Floats, behind: Ints, apart: Floats) -> Sparse:
    """What the cells behind move vectors that begin at them, `grad u . g`, (p, n)."""
    shape = (len(behind), len(x))
    if not len(behind):
        return scipy.sparse.csr_array(shape)
    tangents = x[behind].swapaxes(1, 2) @ groups.gradient  # (p, 3, dimension)
    slopes = groups.gradient @ np.linalg.pinv(tangents)
    values = np.einsum("pki,pi->pk", slopes, apart)
    rows = np.repeat(np.arange(len(behind)), behind.shape[1])
    return scipy.sparse.csr_array((values.ravel(), (rows, behind.ravel())), shape=shape)
