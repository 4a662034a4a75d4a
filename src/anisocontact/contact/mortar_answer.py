"""What laws answer at the slave nodes of a mortar contact, as forces on nodes of both bodies."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from anisocontact import _core
from anisocontact.base.array_types import Flags, Floats, Locals
from anisocontact.base.statuses import OPEN, SLIP, STICK
from anisocontact.contact.contact_planes import ContactPlanes, Opposite, along
from anisocontact.contact.facet_answer import response_of
from anisocontact.contact.history import Snapshot
from anisocontact.contact.master_surface import MasterSurface
from anisocontact.contact.mortar_weights import MortarWeights
from anisocontact.contact.quadrature import Couplings, FacetQuadrature
from anisocontact.surfaces import default_threads


@dataclass(frozen=True)
class MortarState:
    """Slave nodes, their weights and their planes where the nodes of both bodies are.

    Attributes:
        gathered: The master as this process has it.
        quadrature: The slave nodes as points, with the nodes around each.
        weights: Mortar weights.
        planes: Contact planes.
        opposite: Material opposite to the nodes, now and at the accepted increment.
        now: Positions of the nodes, (nodes, 3), length.
        reference: The same in the reference configuration.
    """

    gathered: MasterSurface
    quadrature: FacetQuadrature
    weights: MortarWeights
    planes: ContactPlanes
    opposite: tuple[Opposite, Opposite]
    now: Floats
    reference: Floats

    @cached_property
    def columns(self) -> Locals:
        """Nodes that the traction of each slave node depends on, (n, c), -1 for none."""
        return np.concatenate([self.quadrature.nodes, self.weights.masters], axis=1)

    @cached_property
    def rows(self) -> Locals:
        """Nodes that its force acts on, (n, r), -1 for none."""
        own = self.quadrature.nodes[:, : self.quadrature.rows]
        return np.concatenate([own, self.weights.masters], axis=1)

    @cached_property
    def row_weights(self) -> Floats:
        """Force on the nodes of the rows over the traction, (n, r), length^2."""
        own = self.quadrature.basis[:, 0, : self.quadrature.rows]
        area = self.weights.area[:, None]
        return np.concatenate([area * own, -self.weights.weight], axis=1)

    @property
    def _moving(self) -> list[tuple[int, Locals | None, Floats]]:
        """How slave point, tangents and planes are made of nodes: first of twelve, nodes, values.

        The slave point and its tangents, the mean of the master and the tangents there, these of
        the accepted increment, the place where the tangents are taken now and those of its facet.
        """
        quadrature, (now, then) = self.quadrature, self.opposite
        own = [quadrature.basis, quadrature.gradient[:, 0].swapaxes(1, 2)]
        parts: list[tuple[int, Locals | None, Floats]] = [(0, None, np.concatenate(own, axis=1))]
        for first, one in ((3, now), (6, then)):
            parts += [(first, one.masters, one.shares[:, None])]
            parts += [(first + 1, one.around, one.along)]
        return [*parts, (9, now.nodes, now.shape[:, None]), (10, now.nodes, now.gradient)]

    def tangent(
        self, by_nodes: Floats, which: Locals, traction: Floats
    ) -> tuple[Floats, Locals, Locals, Floats]:
        """Derivative of tractions, and of the forces that they are.

        Args:
            by_nodes: Of the tractions by the nodes of `ContactPlanes.nodes`, (p, 3, 27).
            which: Slave nodes that have these tractions, (p,).
            traction: The tractions, (p, 3).

        Returns:
            That of the tractions by the nodes of the columns, (p, 3, c, 3), and couplings.
        """
        planes, now = self.planes, self.opposite[0]
        by, lift = _core.plane_slopes(
            slave=planes.slave,
            tangents=planes.tangents,
            normal=planes.normal,
            held=planes.held,
            now=self.now,
            reference=self.reference,
            then=planes.then.tangents,
            carried=planes.then.by_master,
            area=self.weights.area,
            masters=now.masters,
            shares=now.shares,
            facet=now.facet,
            nodes=now.nodes,
            shape=now.shape,
            gradient=now.gradient,
            second=now.second,
            edge=now.edge,
            around=now.around,
            along=now.along,
            bending=now.bending,
            which=which,
            by_nodes=by_nodes,
            threads=default_threads(),
        )
        slopes, rows, columns, blocks = self.weights.core.tangent(
            which, by, lift, traction, self._moving, default_threads()
        )
        return slopes[..., :3], rows, columns, blocks


@dataclass(frozen=True)
class MortarAnswer:
    """What laws answer at slave nodes, see `Answer`.

    Attributes:
        at: The nodes where they are.
        snapshot: The nodes as points.
        stiffness: Size of the derivative of the force of each, (n,), force/length.
        which: Slave nodes in contact, (p,).
        by_nodes: Derivative of their tractions, by the nodes of the planes, (p, 3, 27).
        answered: That of what laws answer, with what supports carry of it.
        by_slip: That by slip, as of `Response.tangent_slip`, (p, 3, 3); along held directions that
            of what laws would answer where nodes slide, and none where they stick.
    """

    at: MortarState
    snapshot: Snapshot
    stiffness: Floats
    which: Locals
    by_nodes: Floats
    answered: Floats
    by_slip: Floats

    @classmethod
    def of(
        cls, at: MortarState, found: Mapping[str, Any], failed: Flags, tangent: bool
    ) -> MortarAnswer:
        """What the core has found at slave nodes.

        Args:
            at: The nodes where they are.
            found: By the names of the core.
            failed: Nodes whose projection failed, (n,).
            tangent: Whether the derivative is asked for.
        """
        # supports carry what there is along directions that they hold
        held = at.planes.held
        traction = found["traction"] - along(held, found["traction"])
        response = response_of({**found, "traction": traction}, failed)
        which = np.flatnonzero(response.status != OPEN).astype(np.int32)
        snapshot = Snapshot(at.planes.slave, at.weights.area, response)
        by_nodes, by_slip = np.zeros((len(which), 3, 27)), np.zeros((len(which), 3, 3))
        if tangent:
            by_nodes, by_slip = found["slopes"][which], found["by_slip"][which]
            sticking = response.status[which] == STICK
            by_slip[sticking] -= by_slip[sticking] @ held[which[sticking]]
        stiffness = found["stiffness"] * at.weights.area
        free = by_nodes - held[which] @ by_nodes if held[which].any() else by_nodes
        return cls(at, snapshot, stiffness, which, free, by_nodes, by_slip)

    @cached_property
    def _tangent(self) -> tuple[Floats, Locals, Locals, Floats]:
        traction = self.snapshot.response.traction[self.which]
        return self.at.tangent(self.by_nodes, self.which, traction)

    @property
    def by_columns(self) -> Floats:
        """Derivative of the tractions by the nodes of the columns, (p, 3, c, 3)."""
        return self._tangent[0]

    def add_force(self, out: Floats) -> None:
        """As of `Answer`."""
        self.add_traction(self.which, self.snapshot.response.traction[self.which], out)

    def add_traction(self, which: Locals, traction: Floats, out: Floats) -> None:
        """Add the forces of tractions on the slave, (p, 3), of some slave nodes, (p,)."""
        rows, weights = self.at.rows[which], self.at.row_weights[which]
        forces = self.at.gathered.zeros(out)
        _core.add_at_nodes(rows, weights, traction, forces)
        self.at.gathered.hand_back(forces, out)

    def couplings(self) -> list[Couplings]:
        """As of `Answer`: a block for each pair of nodes."""
        return [self.at.gathered.couplings(self._tangent[1:])]

    def by_derivative(self, other: MortarAnswer, stiffness: Floats) -> MortarAnswer:
        """As of `Answer`."""
        return replace(other, at=self.at, snapshot=self.snapshot, stiffness=stiffness)


class MortarLinear:
    """Linear change of the tractions about an answer, see `Linear`.

    Args:
        moved: Gives the displacements of the nodes now, (nodes, 3), length.
        planes: Gives the contact planes now.
        answer: The answer, given there.
    """

    def __init__(
        self,
        moved: Callable[[], Floats],
        planes: Callable[[], ContactPlanes],
        answer: MortarAnswer,
    ) -> None:
        self._moved, self._planes = moved, planes
        self._answer, self._then = answer, moved()

    def change(self) -> Floats | None:
        """As of `Linear`."""
        now, answer = self._moved(), self._answer
        if np.array_equal(now, self._then):
            return None
        columns = answer.at.columns[answer.which]
        # the tangent is so stiff that the rounding of positions would be felt in the difference
        way = (now - self._then)[np.maximum(columns, 0)]
        way[columns < 0] = 0.0
        change = np.einsum("picj,pcj->pi", answer.by_columns, way)
        return self._everywhere(change + self._supported())

    def slipped(self, slip: Floats) -> Floats:
        """As of `Linear`."""
        return self._everywhere(self._of(slip))

    def add_force(self, slip: Floats, out: Floats) -> None:
        """As of `Linear`."""
        which, carried = self._answer.which, self._of(slip)[..., None]
        held = self._answer.at.planes.held[which]
        self._answer.add_traction(which, (carried - held @ carried)[..., 0], out)

    def _of(self, slip: Floats) -> Floats:
        return np.asarray(np.einsum("pij,pj->pi", self._answer.by_slip, slip[self._answer.which]))

    def _supported(self) -> Floats:
        """Change of what supports carry of the tractions answered where nodes slide, (p, 3).

        Where they stick supports carry what they do: nothing slips there, and what is of second
        order in the way would be felt in a tangent that stiff.
        """
        answer, held = self._answer, self._answer.at.planes.held
        out = np.zeros((len(answer.which), 3))
        sliding = answer.snapshot.response.status[answer.which] == SLIP
        rows = np.flatnonzero(sliding & held[answer.which].any(axis=(1, 2)))
        if rows.size:
            nodes = answer.which[rows]
            way = (self._planes().nodes() - answer.at.planes.nodes()).reshape(-1, 27)[nodes]
            out[rows] = (held[nodes] @ answer.answered[rows] @ way[..., None])[..., 0]
        return out

    def _everywhere(self, found: Floats) -> Floats:
        out = np.zeros((len(self._answer.at.quadrature.nodes), 3))
        out[self._answer.which] = found
        return out
