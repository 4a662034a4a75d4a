"""What the laws of an interface answer at slave points that meet facets."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any, Protocol

import numpy as np

from anisocontact.base.array_types import Flags, Floats, Locals
from anisocontact.base.processes import on_all
from anisocontact.contact.history import Snapshot
from anisocontact.contact.master_surface import MasterSurface
from anisocontact.contact.quadrature import Couplings
from anisocontact.contact.sides import Sides, located
from anisocontact.interface import Response, State
from anisocontact.interface.contact_law import CoreCall, FacetBatch, FacetLaw
from anisocontact.surfaces.facets import FACET_STATUS, FacetProjections

#: Code of the kernel for a point without a facet below it.
OFF = 3
#: No directions along which supports hold points and master.
NOTHING = np.zeros((0, 3, 3))
#: Gap up to which a point may be in contact, as a share of the size of the facets: rounding.
NEAR = 1e-6


class Forces(Protocol):
    """Forces on the nodes of the surface and their derivative."""

    def add_force(self, out: Floats) -> None:
        """Add them, (nodes, 3)."""

    def couplings(self, touching: Flags) -> list[Couplings]:
        """Where `-d force / d u` has entries, and the entries, of points in contact, (n,)."""


@dataclass(frozen=True)
class ByFacets:
    """Points of one pair of facets share a block.

    Attributes:
        force: On the nodes, (nodes, 3).
        blocks: Nodes of rows and columns, and the blocks.
    """

    force: Floats
    blocks: list[Couplings]

    def add_force(self, out: Floats) -> None:
        """As of `Forces`."""
        out += self.force

    def couplings(self, touching: Flags) -> list[Couplings]:
        """As of `Forces`."""
        return self.blocks


@dataclass(frozen=True)
class ByPoints:
    """Every point has a force and a block of its own.

    Attributes:
        nodes: That the force depends on, (n, c), -1 for none; the first r are those of the rows.
        residual: Less the force on the nodes of the rows, (n, 3 r).
        tangent: Its derivative, (n, 3 r, 3 c).
        by_slip: What each component of a slip makes of the residual, (n, 3, 3 r), force/length.
        own: Number of nodes of a slave facet, which come first.
    """

    nodes: Locals
    residual: Floats
    tangent: Floats
    by_slip: Floats
    own: int

    @property
    def rows(self) -> Locals:
        """Nodes of the rows, (n, r)."""
        return self.nodes[:, : self.residual.shape[1] // 3]

    def add_force(self, out: Floats) -> None:
        """As of `Forces`."""
        self.add_rows(-self.residual, out)

    def add_rows(self, forces: Floats, out: Floats) -> None:
        """Add forces, (n, 3 r)."""
        rows = self.rows
        there = rows >= 0
        np.add.at(out, rows[there], forces.reshape(*rows.shape, 3)[there])

    def couplings(self, touching: Flags) -> list[Couplings]:
        """As of `Forces`."""
        return [(self.rows[touching], self.nodes[touching], self.tangent[touching])]

    @cached_property
    def by_nodes(self) -> Floats:
        """Derivative of the force of each point by its nodes, (n, 3, 3 c)."""
        return self.on_slave(self.tangent)

    def on_slave(self, residual: Floats) -> Floats:
        """Forces of the points, (n, 3, ...), whose residuals are these, (n, 3 r, ...)."""
        # rows of the slave's nodes are shares of the force of the point
        shares = residual[:, : 3 * self.own]
        return np.asarray(-shares.reshape(len(shares), self.own, 3, *shares.shape[2:]).sum(axis=1))


@dataclass(frozen=True)
class FacetAnswer[F: Forces]:
    """What laws answer at slave points that meet facets, see `Answer`.

    Attributes:
        gathered: The master as this rank has it.
        snapshot: The points as they are then.
        stiffness: Size of the derivative of the force of each point, (n,), force/length.
        forces: Forces on the nodes.
    """

    gathered: MasterSurface
    snapshot: Snapshot
    stiffness: Floats
    forces: F

    def add_force(self, out: Floats) -> None:
        """As of `Answer`."""
        total = self.gathered.zeros(out)
        self.forces.add_force(total)
        self.gathered.hand_back(total, out)

    def couplings(self) -> list[Couplings]:
        """As of `Answer`; points of one slave facet on one facet of the master share a block.

        Returns:
            Each with nodes of the rows (p, r) and of the columns (p, c), numbered as
            `CoupledTangent` has them, -1 for none, and p blocks, (p, r, c, 3, 3) or (p, 3 r, 3 c).
        """
        found = self.forces.couplings(self.snapshot.response.status != 0)
        return [self.gathered.couplings(one) for one in found]

    def by_derivative(
        self: FacetAnswer[ByPoints], other: FacetAnswer[ByPoints], stiffness: Floats
    ) -> Any:
        """As of `Answer`."""
        stiff = other.forces
        forces = replace(
            self.forces, nodes=stiff.nodes, tangent=stiff.tangent, by_slip=stiff.by_slip
        )
        return replace(self, forces=forces, stiffness=stiffness)


@dataclass(frozen=True)
class FacetEvaluation:
    """Slave points against facets where both are, for the laws.

    Attributes:
        sides: Both sides.
        hit: Where the points are on the master.
        now: Positions of the nodes, (nodes, 3), length.
        by_points: Whether every point is to have a block, or those of one pair of facets share one.
    """

    sides: Sides
    hit: FacetProjections
    now: Floats
    by_points: bool

    def answer(self, law: FacetLaw, state: State, dt: float, tangent: bool) -> FacetAnswer[Any]:
        """What a law answers from a state.

        Args:
            law: The law.
            state: History of the points.
            dt: Time increment.
            tangent: Whether derivatives are wanted.
        """
        slave, hit = self.sides.points, self.hit
        batch = self.batch(state, tangent)
        of: CoreCall = "update" if self.by_points else "assemble"
        found = found_on_all(self.sides.comm, law, state, dt, batch, of)
        lost = hit.status == FACET_STATUS.index("failed")
        response = response_of(found, lost)
        snapshot = Snapshot(slave.positions(self.now), found["area"], response)
        own, gathered = slave.quadrature.nodes.shape[1], self.sides.gathered
        forces: Forces
        if self.by_points:
            forces = ByPoints(
                nodes=found["nodes"],
                residual=found["residual"],
                tangent=found["tangent"],
                by_slip=found["by_slip"],
                own=own,
            )
        else:
            forces = ByFacets(found["force"], found["blocks"])
        return FacetAnswer(gathered, snapshot, found["stiffness"], forces)

    def batch(self, state: State, tangent: bool = True) -> FacetBatch:
        """Points and facets as the core takes them; arguments as of `answer`."""
        slave, master, hit = self.sides.points, self.sides.master, self.hit
        touches = hit.gap - state["offset"] <= NEAR * slave.size  # as far as rounding goes
        return {
            "slave_nodes": slave.nodes,
            "slave_shape": slave.shape,
            "slave_gradient": slave.gradient,
            "weight": slave.weight,
            "current_area": slave.current_area,
            "now": self.now,
            "reference": self.sides.reference,
            "connectivity": master.nodes,
            "topology": self.sides.kinds,
            "flip": master.flip,
            "facet": np.maximum(hit.facet, 0),
            "xi": np.nan_to_num(hit.xi),
            "feature": np.where(located(hit), hit.feature, np.int8(OFF)),
            "edge": hit.edge,
            "held": NOTHING,
            "near": touches | (state["multiplier"] > 0.0),
            "tangent": tangent,
            "threads": self.sides.threads,
        }


def response_of(found: Mapping[str, Any], lost: Flags) -> Response:
    """What the core has found for a batch as a response.

    Args:
        found: As of `FacetLaw.evaluate`.
        lost: Points whose projection has failed, (n,).
    """
    return Response(
        traction=found["traction"],
        tangent=np.empty((0, 3, 3)),
        state=found["state"],
        normal=found["normal"],
        directions_adhesion=found["adhesion_axes"],
        directions_friction=found["friction_axes"],
        failure=np.where(lost, np.int8(1), found["failure"]),
    )


def found_on_all(
    comm: Any, law: FacetLaw, state: State, dt: float, batch: FacetBatch, of: CoreCall
) -> dict[str, Any]:
    """What a law answers for a batch; a mistake in a Python law is raised on every rank.

    Args:
        comm: Communicator of the mesh.
        law: The law.
        state: History of the points.
        dt: Time increment.
        batch: Points and facets.
        of: As of `FacetLaw.evaluate`.
    """
    evaluate = partial(law.evaluate, state, of, dt, batch)
    return on_all(comm, evaluate) if law.in_python else evaluate()
