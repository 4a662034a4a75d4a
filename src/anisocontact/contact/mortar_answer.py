"""What laws answer at the slave nodes of a mortar contact, as forces on nodes of both bodies."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from anisocontact import _core
from anisocontact.contact.contact_planes import ContactPlanes, Opposite, by_slave_tangents
from anisocontact.contact.history import Snapshot
from anisocontact.contact.mortar_weights import MortarWeights
from anisocontact.contact.quadrature import Couplings, FacetQuadrature
from anisocontact.surfaces import default_threads

Ints = npt.NDArray[np.int32]
Floats = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]


@dataclass(frozen=True)
class MortarState:
    """Slave nodes, their weights and their planes where the nodes of both bodies are.

    Attributes:
        quadrature: The slave nodes as points, with the nodes around each.
        weights: Mortar weights.
        planes: Contact planes.
        opposite: Material opposite to the nodes, now and at the accepted increment.
        now: Positions of the nodes, (nodes, 3), length.
        reference: The same in the reference configuration.
    """

    quadrature: FacetQuadrature
    weights: MortarWeights
    planes: ContactPlanes
    opposite: tuple[Opposite, Opposite]
    now: Floats
    reference: Floats

    @cached_property
    def columns(self) -> Ints:
        """Nodes that the traction of each slave node depends on, (n, c), -1 for none."""
        return np.concatenate([self.quadrature.nodes, self.weights.masters], axis=1)

    @cached_property
    def rows(self) -> Ints:
        """Nodes that its force acts on, (n, r), -1 for none."""
        own = self.quadrature.nodes[:, : self.quadrature.rows]
        return np.concatenate([own, self.weights.masters], axis=1)

    @cached_property
    def row_weights(self) -> Floats:
        """Force on the nodes of the rows over the traction, (n, r), length^2."""
        own = self.quadrature.basis[:, 0, : self.quadrature.rows]
        area = self.weights.area[:, None]
        return np.concatenate([area * own, -self.weights.weight], axis=1)

    @cached_property
    def moving(self) -> Floats:
        """How slave point, tangents and planes are made of the nodes of the columns, (n, 10, c).

        The slave point and its tangents, the mean of the master and the tangents there, these of
        the accepted increment, and the place where the tangents are taken now.
        """
        n, k = self.quadrature.nodes.shape
        out = np.zeros((n, 10, self.columns.shape[1]))
        out[:, 0, :k] = self.quadrature.basis[:, 0]
        out[:, 1:3, :k] = self.quadrature.gradient[:, 0].swapaxes(1, 2)
        for first, one in zip((3, 6), self.opposite, strict=True):
            self._put(one.masters, one.shares[:, None], out[:, first : first + 1, k:])
            self._put(one.nodes, one.gradient, out[:, first + 1 : first + 3, k:])
        now = self.opposite[0]
        self._put(now.nodes, now.shape[:, None], out[:, 9:, k:])
        return out

    @cached_property
    def _place_slopes(self) -> tuple[Floats, Floats, Floats]:
        """How the tangents follow the place where they are taken, and it the slave point.

            d d_a = (d_ab - d_c (D^c . D_ab)) d xi^b ,

        less what the reference turns, in which directions are taken; d xi as of `Opposite.moves`.

        Returns:
            The bracket of the first line, (n, 2, 2, 3), w times the tangents, (n, 2, 3), and w
            times x - y, (n, 2, 2, 3).
        """
        one, now = self.opposite[0], self.planes.now.tangents
        bend = one.bend(self.now)
        turn = one.bend(self.reference) @ one.dual_tangents(self.reference).swapaxes(1, 2)[:, None]
        apart = self.planes.slave - one.place(self.now)
        w = one.moves(self.now, apart)
        return bend - turn @ now[:, None], w @ now, w[..., None] * apart[:, None, None]

    def _put(self, nodes: Ints, values: Floats, out: Floats) -> None:
        """Add values (n, v, j) of nodes (n, j) to the columns (n, v, masters) of those nodes."""
        same = (nodes[:, :, None] == self.weights.masters[:, None]) & (nodes[:, :, None] >= 0)
        out += values @ same

    @cached_property
    def _ways(self) -> Floats:
        """How the mean of the master follows the weights, over their sum, (n, k, 3), 1/length.

        What it moves along the plane is less what the point of the reference moves there, at which
        directions are taken: on a master that keeps its shape both are the same.
        """
        planes, opposite, masters = self.planes, self.opposite[0], self.weights.masters
        named = np.maximum(masters, 0)
        way = self.now[named] - opposite.mean(self.now)[:, None]
        material = self.reference[named] - opposite.mean(self.reference)[:, None]
        way -= (material @ opposite.dual_tangents(self.reference).swapaxes(1, 2)) @ planes.now.axes
        area = self.weights.area[:, None, None]
        there = (masters >= 0)[:, :, None] & (area > 0.0)
        return np.asarray(np.divide(way, area, out=np.zeros_like(way), where=there))

    def by_columns(self, by_nodes: Floats, which: Ints) -> Floats:
        """Derivative of tractions by the nodes of the columns.

        Args:
            by_nodes: By the nodes of `ContactPlanes.nodes`, (p, 3, 27).
            which: Slave nodes that have these tractions, (p,).

        Returns:
            The derivative, (p, 3, 3 c).
        """
        planes = self.planes
        by = by_nodes.reshape(-1, 3, 3, 3, 3).copy()  # (p, i, part, node of it, j)
        by[:, :, :, 0] = by.sum(axis=3)
        by_now, by_normal = planes.now.take(which).pulled_back(by[:, :, 1, 1:])
        by[:, :, 1, 1:] = by_now
        by[:, :, 0, 1:] += by_slave_tangents(planes.tangents[which], planes.held[which], by_normal)
        for part in (1, 2):  # both means follow the slave point along what is held
            held = by[:, :, part, 0] @ planes.held[which]
            by[:, :, part, 0] -= held
            by[:, :, 0, 0] += held
        p = len(which)
        turn, along, lean = (one[which] for one in self._place_slopes)
        by_place = np.einsum("piaj,pabj->pib", by[:, :, 1, 1:], turn)
        by[:, :, 1, 1:] += np.einsum("pib,pbaj->piaj", by_place, lean)
        by_foot = by_place @ along
        by[:, :, 0, 0] += by_foot
        flat = np.concatenate([by.reshape(p, 3, 9, 3), -by_foot[:, :, None]], axis=2)
        flat = np.ascontiguousarray(flat.swapaxes(2, 3).reshape(p, 9, 10))
        lift = by[:, :, 1, 0] @ self._ways[which].swapaxes(1, 2)
        return _core.mortar_slopes(
            which, flat, self.moving, lift, self.weights.d_weight, default_threads()
        )


@dataclass(frozen=True)
class MortarAnswer:
    """What laws answer at slave nodes, see `Answer`.

    Attributes:
        at: The nodes where they are.
        snapshot: The nodes as points.
        stiffness: Size of the derivative of the force of each, (n,), force/length.
        which: Slave nodes in contact, (p,).
        by_nodes: Derivative of their tractions, by the nodes of the planes, (p, 3, 27).
    """

    at: MortarState
    snapshot: Snapshot
    stiffness: Floats
    which: Ints
    by_nodes: Floats

    @cached_property
    def by_columns(self) -> Floats:
        """The same by the nodes of the columns, (p, 3, 3 c)."""
        return self.at.by_columns(self.by_nodes, self.which)

    def add_force(self, out: Floats) -> None:
        """As of `Answer`."""
        self.add_traction(self.which, self.snapshot.response.traction[self.which], out)

    def add_traction(self, which: Ints, traction: Floats, out: Floats) -> None:
        """Add the forces of tractions on the slave, (p, 3), of some slave nodes, (p,)."""
        rows, weights = self.at.rows[which], self.at.row_weights[which]
        there = rows >= 0
        np.add.at(out, rows[there], (weights[:, :, None] * traction[:, None])[there])

    def couplings(self) -> list[Couplings]:
        """As of `Answer`: a block for each slave node in contact."""
        at, which, weights = self.at, self.which, self.at.weights
        blocks = _core.mortar_couplings(
            which,
            self.by_columns,
            self.snapshot.response.traction[which],
            np.ascontiguousarray(at.quadrature.basis[:, 0, : at.quadrature.rows]),
            weights.area,
            weights.weight,
            weights.d_area,
            weights.d_weight,
            default_threads(),
        )
        return [(at.rows[which], at.columns[which], blocks)]

    def by_derivative(self, other: MortarAnswer, stiffness: Floats) -> MortarAnswer:
        """As of `Answer`."""
        return replace(self, which=other.which, by_nodes=other.by_nodes, stiffness=stiffness)


class MortarLinear:
    """Linear change of the tractions about an answer, see `Linear`.

    Args:
        moved: Gives the displacements of the nodes now, (nodes, 3), length.
        answer: The answer, given there.
    """

    def __init__(self, moved: Callable[[], Floats], answer: MortarAnswer) -> None:
        self._moved, self._answer, self._then = moved, answer, moved()

    def change(self) -> Floats | None:
        """As of `Linear`."""
        now, answer = self._moved(), self._answer
        if np.array_equal(now, self._then):
            return None
        columns = answer.at.columns[answer.which]
        # the tangent is so stiff that the rounding of positions would be felt in the difference
        way = (now - self._then)[np.maximum(columns, 0)]
        way[columns < 0] = 0.0
        found = answer.by_columns @ way.reshape(len(way), 3 * columns.shape[1], 1)
        return self._everywhere(found[..., 0])

    def slipped(self, slip: Floats) -> Floats:
        """As of `Linear`."""
        return self._everywhere(self._of(slip))

    def add_force(self, slip: Floats, out: Floats) -> None:
        """As of `Linear`."""
        self._answer.add_traction(self._answer.which, self._of(slip), out)

    def _of(self, slip: Floats) -> Floats:
        by_point = self._answer.by_nodes[:, :, :9].reshape(-1, 3, 3, 3).sum(axis=2)
        return np.asarray(np.einsum("pij,pj->pi", by_point, slip[self._answer.which]))

    def _everywhere(self, found: Floats) -> Floats:
        out = np.zeros((len(self._answer.at.quadrature.nodes), 3))
        out[self._answer.which] = found
        return out
