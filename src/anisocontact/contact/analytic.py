"""A surface given by formulas as a master; it rests or moves with a rigid body."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Self, override

import numpy as np
import numpy.typing as npt

from anisocontact.base.array_types import Codes, Flags, Floats, Locals
from anisocontact.base.processes import on_all
from anisocontact.contact.body_blocks import BodyBlocks, body_blocks
from anisocontact.contact.history import Snapshot
from anisocontact.contact.integration_points import IntegrationPoints
from anisocontact.contact.master import Master, Resting
from anisocontact.contact.quadrature import Couplings, Surfaced
from anisocontact.contact.side_of_master import Seen, SideOfMaster
from anisocontact.contact.supported_share import add_direction
from anisocontact.interface import Interface, SlaveSurface, State
from anisocontact.interface.failed_point import OnSurface
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.rigid import MovingInterface, RigidBody
from anisocontact.rigid.body import Pose
from anisocontact.surfaces import PROJECTION_STATUS

_INTERIOR = PROJECTION_STATUS.index("interior")
#: Component of a direction along a normal, or beside other directions, that is none.
ROUNDED = 1e-6


@dataclass(frozen=True)
class AnalyticAnswer:
    """What an interface answers at slave points, see `Answer`.

    Attributes:
        slave: The points.
        there: Their facets in the configuration of the answer.
        turned: The slave's surface, where the laws see it.
        body: Rigid body that carries the surface, if one does.
        snapshot: The points as they are then.
        own_stiffness: What `stiffness` is where the derivative is that of other laws.
    """

    slave: IntegrationPoints
    there: Surfaced
    turned: SlaveSurface | None
    body: RigidBody | None
    snapshot: Snapshot
    own_stiffness: Floats | None = None

    @property
    def stiffness(self) -> Floats:
        """As of `Answer`."""
        if self.own_stiffness is not None:
            return self.own_stiffness
        sizes = np.linalg.norm(self.snapshot.response.tangent, axis=(1, 2))
        return np.asarray(sizes * self.snapshot.areas)

    def add_force(self, out: Floats) -> None:
        """As of `Answer`."""
        self.slave.quadrature.to_nodes(self.snapshot.response.traction, out, self.snapshot.areas)

    def couplings(self) -> list[Couplings]:
        """As of `Answer`: a block for each facet, (m, 3 r, 3 k)."""
        quadrature, now = self.slave.quadrature, self.snapshot.response
        areas = self.snapshot.areas
        blocks = quadrature.facet_matrices(-now.tangent, areas)
        if self.slave.current_area:
            blocks -= self.there.area_matrices(now.traction)
        if self.turned is not None:
            blocks -= quadrature.tangent_matrices(now.tangent_slave, areas)
        rows = quadrature.nodes[:, : quadrature.rows]
        columns = self.slave.coupled(quadrature.nodes)
        return [(rows, columns, blocks)]

    def by_derivative(self, other: AnalyticAnswer, stiffness: Floats) -> Self:
        """As of `Answer`."""
        stiff = other.snapshot.response
        response = replace(
            self.snapshot.response,
            tangent=stiff.tangent,
            tangent_slave=stiff.tangent_slave,
            tangent_slip=stiff.tangent_slip,
        )
        return replace(
            self, snapshot=replace(self.snapshot, response=response), own_stiffness=stiffness
        )

    def body_blocks(self) -> BodyBlocks:
        """Rows and columns of the rigid body in the tangent.

        Raises:
            ValueError: The surface is that of no body.
        """
        if self.body is None:
            raise ValueError("the surface is that of no rigid body")
        moved = self.there if self.slave.current_area else None
        found = body_blocks(self.slave.quadrature, moved, self.body, self.snapshot, self.turned)
        return replace(found, nodes=self.slave.coupled(found.nodes))


class AnalyticMaster(Master):
    """A surface with laws, for the slave points of one pass, see `Master`.

    Args:
        interface: Surface and laws.
        body: Rigid body that carries the surface and its directions; it rests if None.
        slave: The points.
        comm: Communicator of the mesh.

    Raises:
        InputError: A point has no closest point on the surface, or directions do not go together.
    """

    def __init__(
        self, interface: Interface, body: RigidBody | None, slave: IntegrationPoints, comm: Any
    ) -> None:
        self.interface, self.body, self._slave, self._comm = interface, body, slave, comm
        self._sees_slave = interface.takes_slave()
        self.extent = interface.surface.extent
        self._way = np.zeros_like(slave.quadrature.reference)
        self._there = slave.quadrature.at_rest
        self._resting: list[tuple[Flags, Floats]] = []
        self.take(interface, interface)

    @override
    def initial_state(self) -> State:
        return self.interface.initial_state(self._slave.quadrature.reference)

    @override
    def take(self, laws: Interface, derivative: Interface) -> None:
        on, self._given = self._on_body, laws
        self._laws, self._derivative = on(laws), on(derivative)

    def _on_body(self, laws: Any) -> Any:
        return laws if self.body is None else MovingInterface(laws, self.body)

    @override
    def take_resting(self, resting: Sequence[Resting], state: State) -> None:
        at = ((self._slave.all_of(there), direction) for there, direction in resting)
        self._resting = [(points, direction) for points, direction in at if points.any()]

    @override
    def resting(self, normal: Floats) -> Floats | None:
        if not self._resting:
            return None
        out = np.zeros((len(normal), 3, 3))
        for points, direction in self._resting:
            if self.body is None or self.body.rests_along(direction):
                along = self.into_frame(direction)
                which = np.flatnonzero(points & (np.abs(normal @ along) < ROUNDED))
                add_direction(out, which, along, ROUNDED)
        return out

    @override
    def place(self, u: Floats, *histories: State) -> bool:
        self._way = self._slave.quadrature.at_points(u)
        if self._slave.current_area or self._sees_slave:
            self._there = self._slave.quadrature.moved(self._slave.everywhere(u))
        return False

    @override
    def answer(
        self,
        state: State,
        dt: float,
        *,
        tangent: bool = True,
        derivative: bool = False,
        separate: bool = False,
    ) -> AnalyticAnswer:
        slave, turned = self._slave, self._turned(self._there)
        x = slave.quadrature.reference + self._way
        laws = self._derivative if derivative else self._laws
        update = partial(laws.update, state, x, dt, slave=turned)
        in_python = self.interface.tangential.in_python
        response = on_all(self._comm, update) if in_python else update()
        snapshot = Snapshot(x, slave.areas(self._there), response)
        return AnalyticAnswer(slave, self._there, turned, self.body, snapshot)

    @override
    def failed_point(self, i: int, state: State, dt: float, **of_point: Any) -> OnSurface:
        body, turned = self.body, self._turned(self._there)
        x = self._slave.quadrature.reference + self._way
        slave = None
        if turned is not None:
            rows = (turned.reference, turned.reference_tangents, self.into_frame(turned.tangents))
            slave = SlaveSurface(*(row[i : i + 1] for row in rows))
        return OnSurface(
            **of_point,
            position=(x if body is None else body.to_body(x))[i],
            dt=dt,
            state=state[i : i + 1].copy(),
            law=self._given,
            slave=slave,
        )

    @override
    def linear(self, answer: AnalyticAnswer) -> AnalyticLinear:
        return AnalyticLinear(self, answer)

    @override
    def here(self, state: State, dt: float) -> State:
        return self.answer(state, dt).snapshot.response.state

    @override
    def at(self, state: State) -> tuple[Floats, Floats]:
        jet = self.interface.surface.jet(state["xi"])
        return jet.position, jet.d1

    @override
    def into_frame(self, vectors: Floats) -> Floats:
        return vectors if self.body is None else np.asarray(vectors @ self.body.trial.rotation)

    @override
    def out_of_frame(self, vectors: Floats) -> Floats:
        return vectors if self.body is None else self.body.to_space(vectors)

    def displaced(self) -> tuple[Floats, Pose | None]:
        """Displacements of the points, (n, 3), length, and the pose of the body."""
        return self._way, None if self.body is None else self.body.trial

    def moved_since(self, way: Floats, pose: Pose | None) -> Floats:
        """Ways of the points as seen from the surface since they were displaced, (n, 3), length.

        Where the body has rested they are those of the nodes, without the rounding of its motion.

        Args:
            way: Displacements then, (n, 3), length.
            pose: Pose of the body then.
        """
        if self.body is None or pose is None:
            return self._way - way
        now = self.body.trial
        arms = self._slave.quadrature.reference - self.body.reference + way - pose.translation
        moved = self._way - way - (now.translation - pose.translation)
        return np.asarray(arms @ (now.rotation - pose.rotation) + moved @ now.rotation)

    def slave_tangents(self) -> Floats | None:
        """Tangents of the slave in the frame of the surface, (n, 2, 3); None where none is seen."""
        turned = self._turned(self._there)
        return None if turned is None else self.into_frame(turned.tangents)

    @override
    def facing(self, normal: Floats) -> Floats:
        outward = self._slave.outward_of(self._there)
        return np.asarray(-np.einsum("ni,ni->n", normal, outward))

    @override
    def stiffness(self, diagonal: Floats) -> float:
        nodes = self.couplable()
        nodes = nodes[nodes < len(diagonal)]
        local = np.array([diagonal[nodes].mean(axis=1).sum(), self._slave.quadrature.areas.sum()])
        stiffness, area = self._comm.allreduce(local)
        return float(stiffness / area)

    @override
    def couplable(self) -> Locals:
        return np.unique(self._slave.quadrature.nodes).astype(np.int32)

    @override
    def look(self, x: Floats) -> Seen:
        return self._look(x if self.body is None else self.body.to_body(x))

    def _look(self, x: Floats, _: object = None) -> Seen:
        hit = self.interface.surface.project(x)
        return Seen(hit.status == _INTERIOR, hit.gap, hit.dgap_dx)

    @override
    def side_of_master(
        self, u: Floats, before: Snapshot, state: State, now: Snapshot
    ) -> SideOfMaster:
        moved = self._slave.quadrature.moved(self._slave.everywhere(u))
        outward = self._slave.outward_of(moved)
        places, last = now.points, before.points
        if self.body is not None:
            last, places = self.body.to_body(last, accepted=True), self.body.to_body(places)
        everywhere = np.ones(len(places), dtype=bool)
        return SideOfMaster(
            before=last,
            now=places,
            outward=self.into_frame(outward),
            touched=before.response.status != 0,
            closed=now.response.status != 0,
            located=everywhere,
            had=everywhere,
            normal=self.into_frame(now.response.normal),
            areas=now.areas,
            size=self._slave.size,
            reach=np.inf,
            look=self._look,
            comm=self._comm,
            idle=np.zeros(len(now.points), dtype=bool),
        )

    @override
    def probe(self, laws: tuple[NormalLaw, Adhesion, Friction], state: State) -> Codes:
        interface = Interface(self.interface.surface, *laws)
        at_rest = self._slave.quadrature.at_rest
        slave = self._turned(at_rest) if interface.takes_slave() else None
        x = self._slave.quadrature.reference
        return interface.update(state, x, tangent=False, slave=slave).failure

    @override
    def persistent(self, kept: dict[str, npt.NDArray[Any]]) -> dict[str, npt.NDArray[Any]]:
        return kept | {"reference": self._slave.quadrature.reference.copy()}

    def _turned(self, there: Surfaced) -> SlaveSurface | None:
        """The slave in some configuration, where the laws see it."""
        if not self._sees_slave:
            return None
        quadrature = self._slave.quadrature
        return SlaveSurface(
            quadrature.reference,
            quadrature.tangents.reshape(-1, 2, 3),
            there.tangents.reshape(-1, 2, 3),
        )


class AnalyticLinear:
    """Linear change of the tractions about an answer, see `Linear`.

    The tangent is so stiff that the rounding of positions would be felt in their difference:
    displacements are taken.
    """

    def __init__(self, master: AnalyticMaster, answer: AnalyticAnswer) -> None:
        self._master, self._areas, self._to_nodes = (
            master,
            answer.snapshot.areas,
            answer.slave.quadrature.to_nodes,
        )
        response = answer.snapshot.response
        turn = np.eye(3) if master.body is None else master.body.trial.rotation
        self._then, self._slave = master.displaced(), master.slave_tangents()
        self._tangent = turn.T @ response.tangent @ turn
        self._by_slave = turn.T @ response.tangent_slave @ turn
        self._by_slip = turn.T @ response.tangent_slip @ turn

    def change(self) -> Floats | None:
        """As of `Linear`."""
        way, slave = self._master.moved_since(*self._then), self._master.slave_tangents()
        if not way.any():
            return None
        change = np.einsum("nij,nj->ni", self._tangent, way)
        if slave is not None and self._slave is not None:
            change += np.einsum("nkij,nkj->ni", self._by_slave, slave - self._slave)
        return np.asarray(change)

    def slipped(self, slip: Floats) -> Floats:
        """As of `Linear`."""
        return np.asarray(np.einsum("nij,nj->ni", self._by_slip, slip))

    def add_force(self, slip: Floats, out: Floats) -> None:
        """As of `Linear`."""
        self._to_nodes(self._master.out_of_frame(self.slipped(slip)), out, self._areas)
