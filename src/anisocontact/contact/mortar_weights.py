"""Mortar weights of slave nodes: dual functions integrated over the overlaps with the master."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Protocol

import numpy as np

from anisocontact import _core
from anisocontact.base.array_types import Floats, Ints, Locals
from anisocontact.base.fenicsx import basix
from anisocontact.contact.facet_mesh import FacetMesh
from anisocontact.contact.facet_pairs import FacetPairs, FacingSides
from anisocontact.contact.line_weights import line_weights
from anisocontact.contact.slave_nodes import Patches

#: Degree of the product of two shape functions of the position, by topology, on triangles and
#: parallelograms, and of the rule on other quadrilaterals, where they are no polynomials.
DEGREES = {"tri3": (2, 2), "quad4": (4, 6), "tri6": (4, 4), "quad9": (8, 8)}
#: Share of a whole facet that the weight of each of its nodes is, by topology.
WHOLE = {
    "tri3": [1 / 3] * 3,
    "quad4": [1 / 4] * 4,
    "tri6": [2 / 15] * 3 + [1 / 5] * 3,
    "quad9": [1 / 36] * 4 + [1 / 9] * 4 + [4 / 9],
}


class Differentiated(Protocol):
    """What forces of slave nodes follow from weights and from sums over nodes."""

    def tangent(
        self,
        which: Locals,
        by: Floats,
        lift: Floats,
        traction: Floats,
        moving: Sequence[tuple[int, Locals | None, Floats]],
        threads: int,
        /,
    ) -> tuple[Floats, Locals, Locals, Floats]:
        """Derivatives of tractions, and of the forces that they are.

        Args:
            which: Slave nodes that have tractions, (p,).
            by: Derivatives of the tractions by twelve sums over nodes, (p, 12, 9).
            lift: And by the weights, (p, k, 3).
            traction: The tractions, (p, 3).
            moving: First sums, nodes of the master or those of the patch, and values.
            threads: Threads of the kernel.

        Returns:
            Of the tractions, (p, 3, columns, 3 or more); rows, columns and blocks of that of
            the forces.
        """


@dataclass(frozen=True)
class MortarWeights:
    """Weights of slave nodes on the nodes of the master that their dual functions reach.

    Attributes:
        masters: Nodes, (n, k), ascending, -1 behind the last.
        area: D_i, integral of the dual function over what is covered, (n,), length^2.
        weight: W_ik, integral of it with the shape functions of the master, (n, k), length^2.
        core: What has found them, and differentiates them.
    """

    masters: Locals
    area: Floats
    weight: Floats
    core: Differentiated

    @property
    def shares(self) -> Floats:
        """W_ik / D_i, (n, k); zero where nothing is covered."""
        area = self.area[:, None]
        return np.divide(self.weight, area, out=np.zeros_like(self.weight), where=area > 0.0)


def mortar_weights(
    sides: FacingSides,
    around: Patches,
    now: Floats,
    more: Locals,
    pairs: FacetPairs,
    *,
    current_area: bool,
    hand_over: bool,
) -> MortarWeights:
    """Weights where the nodes are.

    Args:
        sides: Slave and master.
        around: The facets around each slave node.
        now: Positions of the nodes, (nodes, 3), length.
        more: Nodes of the master to have as well, (n, j), -1 for none.
        pairs: Facets around the slave nodes and those that they may overlap.
        current_area: Whether areas are those of now or of the reference configuration.
        hand_over: Whether nodes of which hardly anything of a facet is covered give their weights
            on it to the others, as contact needs: dual functions extrapolate there from a strip.
    """
    if sides.slave.sweep is not None:
        found = line_weights(
            sides, around, now, more, pairs, current_area=current_area, hand_over=hand_over
        )
        return MortarWeights(found.masters, found.area, found.weight, found)
    whole = WHOLE[around.mesh.topology] if hand_over else []
    return _in_space(sides, around, now, more, pairs, whole, current_area)


def _in_space(
    sides: FacingSides,
    around: Patches,
    now: Floats,
    more: Locals,
    pairs: FacetPairs,
    whole: Sequence[float],
    current_area: bool,
) -> MortarWeights:
    """As of `mortar_weights`, of facets in space, by the core.

    Where nodes hand their weights over `whole` is the share of a facet that each has, else empty.
    """
    slave, master = around.mesh, sides.master
    offsets, opposite = _by_slave(pairs, len(slave.nodes), len(master.nodes))
    there = more >= 0
    straight, skew = _rules(slave, master)
    core = _core.MortarWeights(
        slave_topology=slave.topology,
        slave=slave.nodes,
        master_topology=master.topology,
        master=master.nodes,
        now=now,
        reference=sides.reference,
        pair_offsets=offsets,
        pair_facets=opposite,
        patch=around.nodes,
        around_offsets=around.offsets,
        around_facets=around.facets,
        around_local=around.local,
        support=around.support,
        more_offsets=np.append(0, np.cumsum(there.sum(axis=1))).astype(np.int64),
        more_nodes=np.ascontiguousarray(more[there]),
        straight_points=straight[0],
        straight_weights=straight[1],
        skew_points=skew[0],
        skew_weights=skew[1],
        whole=np.array(whole),
        current_area=current_area,
        memory=around.memory,
        threads=sides.threads,
    )
    return MortarWeights(core.masters, core.area, core.weight, core)


def _by_slave(pairs: FacetPairs, slaves: int, masters: int) -> tuple[Ints, Locals]:
    """Where the facets opposite to each of the slave begin, and these, ascending."""
    order = np.argsort(pairs.slave * masters + pairs.master, kind="stable")
    offsets = np.searchsorted(pairs.slave[order], np.arange(slaves + 1))
    return offsets.astype(np.int64), pairs.master[order].astype(np.int32)


def _rules(slave: FacetMesh, master: FacetMesh) -> list[tuple[Floats, Floats]]:
    """Points and weights on a triangle for products of the functions of both, see `DEGREES`."""
    degrees = zip(DEGREES[slave.topology], DEGREES[master.topology], strict=True)
    return [_rule(max(both)) for both in degrees]


@cache
def _rule(degree: int) -> tuple[Floats, Floats]:
    points, weights = basix.make_quadrature(basix.CellType.triangle, degree)
    return np.ascontiguousarray(points), np.ascontiguousarray(weights)
