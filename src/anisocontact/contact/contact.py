"""Slave facets against the master of an interface: forces, tangent and history."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import Mat, PETSc
from anisocontact.contact.adjust import adjusted
from anisocontact.contact.body_blocks import BodyBlocks, body_blocks
from anisocontact.contact.initial import check_start
from anisocontact.contact.layer import Layer
from anisocontact.contact.multipliers import Frames
from anisocontact.contact.penalty import facet_size
from anisocontact.contact.quadrature import Surfaced, chosen_degree, facet_quadrature
from anisocontact.contact.record import ContactRecord, Snapshot
from anisocontact.contact.semismooth import Base, Semismooth
from anisocontact.contact.transfer import Couplings
from anisocontact.contact.whereabouts import Seen, Whereabouts, turned
from anisocontact.interface import Interface, Response, SlaveSurface, State
from anisocontact.interface.augmentation import Augmentation
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import Model
from anisocontact.rigid import MovingInterface, RigidBody
from anisocontact.surfaces import PROJECTION_STATUS

Ints = npt.NDArray[np.int32]
Floats = npt.NDArray[np.float64]

_INTERIOR = PROJECTION_STATUS.index("interior")

#: A surface with its laws.
type Laws = Interface
#: What answers for them.
type Master = Laws | MovingInterface


class Contact(ContactRecord):
    """Contact of a facet group with the master surface of an interface.

    The residual gets `-integral of t . delta u` over the slave area, the tangent
    `-integral of delta u . (dt/dx) . du` and, where the area is that of now, its change; `t` is the
    traction on the slave at `x = X + u`. The history advances with `commit` only.

    Args:
        model: Mesh with the facet group.
        slave: Facet group "body.group".
        interface: Surface and laws, also laws written in Python.
        degree: Degree of the quadrature on the facets, >= 1; if not given twice the order of the
            displacement, with an augmentation the order.
        current_area: Whether tractions act on the area of now or of the reference; where it is not
            given on that of now, but for a problem whose bodies at this contact are linear.
        augmentation: How exactly the contact is to hold; by its penalties alone if not given.
        adjust: Gaps up to this one are closed and overlaps taken out before the first step, see
            `adjusted`, length; nothing if not given.
        name: Name in output; the slave if not given.
        body: Rigid body that carries the surface and its directions; the surface rests if not
            given.

    Attributes:
        state: Committed history, one record for each point.
        facet_size: Length of a slave facet: square root of the mean area.
        last: Response of the accepted increment.

    Raises:
        InputError: No such facet group, one without facets or with facets inside the body, a degree
            below 1, laws without a surface, or a contact that cannot be meant, see `check_start`.

    Example:
        >>> from anisocontact.mesh import BoxSpec, build_box
        >>> from anisocontact.surfaces import make_surface
        >>> model = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1))})
        >>> interface = Interface(
        ...     make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1)),
        ...     NormalLaw(penalty=100.0),
        ...     Adhesion(stiffness=(100.0, 100.0)),
        ...     Friction(coefficients=(0.3, 0.3)),
        ... )
        >>> contact = Contact(model, "block.bottom", interface)
        >>> response = contact.update(np.tile([0.0, 0.0, -0.01], (8, 1)), 1.0)
        >>> response.pressure.round(12).tolist()  # at the four points of the facet
        [1.0, 1.0, 1.0, 1.0]
    """

    def __init__(
        self,
        model: Model,
        slave: str,
        interface: Interface,
        *,
        degree: int | None = None,
        current_area: bool | None = None,
        augmentation: Augmentation | None = None,
        adjust: float | None = None,
        name: str = "",
        body: RigidBody | None = None,
    ) -> None:
        facets = _checked(model, slave, interface)
        degree = chosen_degree(degree, model.order, augmentation is not None)
        self.interface: Laws = interface
        self._laws = self._stiff_laws = interface
        self.body = body
        self._master: Master = interface if body is None else MovingInterface(interface, body)
        self._stiff = self._master
        self.groups = (slave,)
        self._area_told = current_area is not None
        self.current_area = current_area is None or current_area
        self.quadrature = facet_quadrature(model.space, facets, degree)
        self._moved: Surfaced | None = None
        self._base: Base | None = None
        self._dt = 1.0
        points = self.quadrature.reference
        self._facets, self.facet_size = facets, facet_size(model, slave)
        self._sees_slave = interface.takes_slave()
        self._slave = self._surface(self.quadrature.tangents)
        state = adjusted(interface.initial_state(points), adjust)
        start = self._respond(state, points, 1.0)
        facets_here, per_facet = self.quadrature.weights.shape
        super().__init__(
            model.space,
            slave,
            name or slave,
            state,
            Snapshot(points, self.quadrature.areas, start),
            np.repeat(np.arange(facets_here), per_facet),
        )
        check_start(self, self.facet_size)
        self._augment(augmentation, self.facet_size, interface)

    def suit_strain(self, finite: bool) -> None:
        """As of `ContactRecord`."""
        if not self._area_told:
            self.current_area = finite

    def update(self, u: Floats, dt: float) -> Response:
        """Response to nodal displacements from the committed history, kept as the trial.

        Args:
            u: Displacement of the local nodes, (nodes, 3), length.
            dt: Time increment.

        Returns:
            The response; the committed history is unchanged.
        """
        self._dt = dt
        way = self.quadrature.at_points(u)
        x = self.quadrature.reference + way
        moved = self.quadrature.moved(u) if self.current_area or self._sees_slave else None
        if moved is not None:
            self._slave = self._surface(moved.tangents)
        self._moved = moved if self.current_area else None
        areas = self.quadrature.areas if self._moved is None else self._moved.areas
        semismooth = self._semismooth
        if semismooth is not None:
            self._follow(semismooth, way, x, dt)
        response = self._respond(self._start, x, dt)
        self._trial = Snapshot(x, areas, response)
        if semismooth is not None:
            self._trial = self._linearised(semismooth, self._trial, way, dt)
        return self._trial.response

    def persistent(self) -> dict[str, npt.NDArray[Any]]:
        """As of `ContactRecord`, with the positions in the reference configuration."""
        return super().persistent() | {"reference": self.quadrature.reference.copy()}

    def elastic_slip(self) -> Floats:
        """Elastic part of the relative displacement `e^i rho_i`, (n, 3), length."""
        slip: Floats = np.einsum("ni,nij->nj", self.state["elastic"], self._tangents(self.state))
        return slip if self.body is None else self.body.to_space(slip)

    def add_force(self, out: Floats) -> None:
        """Add the forces of the trial on the slave to the local nodes, (nodes, 3), force."""
        self.quadrature.to_nodes(self.trial.traction, out, self.current.areas)

    @property
    def passes(self) -> tuple[Contact, ...]:
        """The passes over slave points this contact is made of: itself."""
        return (self,)

    def feet(self) -> Ints:
        """Local nodes of the master below the points: it has none."""
        return np.zeros(0, dtype=np.int32)

    @property
    def slave_nodes(self) -> Ints:
        """Local nodes of the slave facets."""
        return np.unique(self.quadrature.nodes).astype(np.int32)

    def couplable(self) -> Ints:
        """Local nodes that the contact acts on."""
        return self.slave_nodes

    def add_tangent(self, matrix: Mat) -> None:
        """Add `-d force / d u` of the trial to the matrix of the system."""
        ((nodes, _, blocks),) = self.couplings()
        matrix.setValuesBlockedLocalRCV(nodes, nodes, blocks, PETSc.InsertMode.ADD_VALUES)

    def couplings(self) -> list[Couplings]:
        """Where `-d force / d u` of the trial has entries in rows of nodes, and the entries.

        Returns:
            Local nodes of the rows (m, k) and of the columns (m, k) of each facet, and its block,
            (m, 3 k, 3 k).
        """
        blocks = self.quadrature.facet_matrices(-self.trial.tangent, self.current.areas)
        if self._moved is not None:
            blocks -= self._moved.area_matrices(self.trial.traction)
        if self._sees_slave:
            blocks -= self.quadrature.tangent_matrices(self.trial.tangent_slave, self.current.areas)
        return [(self.quadrature.nodes, self.quadrature.nodes, blocks)]

    def body_blocks(self) -> BodyBlocks:
        """Rows and columns of the rigid body in the tangent of the trial.

        Raises:
            ValueError: The surface is that of no body.
        """
        if self.body is None:
            raise ValueError("the surface is that of no rigid body")
        return body_blocks(self.quadrature, self._moved, self.body, self.current, self._slave)

    def located(self, state: State) -> npt.NDArray[np.bool_]:
        """Whether each point of a state has a surface below it, (n,): all have."""
        return np.ones(len(state), dtype=bool)

    def outward(self) -> Floats:
        """Outward normals of the slave at its points in the reference configuration, (n, 3)."""
        return self.quadrature.outward(self.space, self._facets)

    def whereabouts(self, u: Floats) -> Whereabouts:
        """Where the points of the trial are beside the surface, in its frame.

        Args:
            u: Displacement of the local nodes in the trial, (nodes, 3), length.
        """
        trial, tangents = self.current, self.quadrature.tangents.reshape(-1, 2, 3)
        moved = self.quadrature.moved(u).tangents.reshape(-1, 2, 3)
        outward = turned(self.outward(), tangents, moved)
        before, now, normal = self.points, trial.points, trial.response.normal
        if self.body is not None:
            before, now = self.body.to_body(before, accepted=True), self.body.to_body(now)
            turn = self.body.trial.rotation
            outward, normal = outward @ turn, normal @ turn
        everywhere = np.ones(len(now), dtype=bool)
        return Whereabouts(
            before=before,
            now=now,
            outward=outward,
            closed=trial.response.status != 0,
            located=everywhere,
            had=everywhere,
            normal=normal,
            areas=trial.areas,
            size=self.facet_size,
            reach=np.inf,
            look=self._look,
            comm=self._comm,
        )

    def look(self, x: Floats) -> Seen:
        """The surface where it is now from points of space, (n, 3), length."""
        return self._look(x if self.body is None else self.body.to_body(x))

    def _look(self, x: Floats, _: object = None) -> Seen:
        hit = self.interface.surface.project(x)
        return Seen(hit.status == _INTERIOR, hit.gap, hit.dgap_dx)

    def probe(
        self, laws: tuple[NormalLaw, Adhesion, Friction], state: State
    ) -> npt.NDArray[np.int8]:
        """Why other laws would fail in the reference configuration, codes of `FAILURE`, (n,)."""
        interface = Interface(self.interface.surface, *laws)
        tangents = self.quadrature.tangents
        slave = self._surface(tangents) if interface.takes_slave() else None
        points = self.quadrature.reference
        return interface.update(state, points, tangent=False, slave=slave).failure

    def lever(self) -> float:
        """Forces that would move every point of the trial to the origin, norm over this rank.

        The machine's precision times this is the round-off of the contact forces: positions are
        known to a share of their distance from the origin.
        """
        now = self.current
        stiffness = np.linalg.norm(now.response.tangent, axis=(1, 2)) * now.areas
        stiffness = self._unstiffened(stiffness, now, self._dt)
        distance = np.linalg.norm(now.points, axis=1)
        if self.body is not None:
            distance += np.linalg.norm(self.body.position)
        return float(np.linalg.norm(stiffness * distance))

    def add_lag(self, out: Floats) -> None:
        """As of `ContactRecord`."""
        if self._base is not None:
            self.quadrature.to_nodes(self.lag(), out, self.current.areas)

    def lag(self) -> Floats:
        """Tractions that a Newton step takes beyond those of the trial, (n, 3), stress."""
        if self._base is None:
            return np.zeros_like(self.trial.traction)
        return self._in_space(self._base.lag)

    def lag_wrench(self, about: Floats) -> Floats:
        """Force and moment of `lag` about a point on the slave over the points here, (6,)."""
        now = self.current
        lag = replace(now.response, traction=self.lag())
        return replace(now, response=lag).wrench(about)

    def _follow(self, semismooth: Semismooth | Layer, way: Floats, x: Floats, dt: float) -> None:
        """Let the multipliers follow a step of Newton's method that displaces points by way to x.

        The tangent is so stiff that the rounding of positions would be felt in their difference.
        """
        there = self._displaced(way)
        if self._base is None or np.array_equal(there, self._base_way):
            return
        change = np.einsum("nij,nj->ni", self._base_tangent, there - self._base_way)
        if self._slave is not None:
            more = self._slave.tangents @ self._turn() - self._base_slave
            change += np.einsum("nkij,nkj->ni", self._base_tangent_slave, more)
        state = self._respond(self._start, x, dt).state
        self._start = semismooth.advance(
            self._start,
            self._base.after(change, semismooth.share),
            Frames.of(self._tangents(state)),
            Frames.of(self._tangents(self._start)),
        )

    def _linearised(
        self, semismooth: Semismooth | Layer, trial: Snapshot, way: Floats, dt: float
    ) -> Snapshot:
        """The trial with the derivative of a Newton step that takes the multipliers along."""
        step = self._step(trial)
        state, slip = semismooth.stiff(step)
        stiff = self._respond(state, trial.points, dt, self._stiff)
        turn = self._turn()
        self._base_way = self._displaced(way)
        self._base_tangent = turn.T @ stiff.tangent @ turn
        if self._slave is not None:
            self._base_slave = self._slave.tangents @ turn
            self._base_tangent_slave = turn.T @ stiff.tangent_slave @ turn
        lag = np.einsum("nij,nj->ni", self._base_tangent, slip)
        traction = trial.response.traction @ turn
        self._base = Base(semismooth.vector(step), traction, lag)
        response = replace(trial.response, tangent=stiff.tangent, tangent_slave=stiff.tangent_slave)
        return replace(trial, response=response)

    def _displaced(self, way: Floats) -> Floats:
        """Displacements of points as seen from the surface, (n, 3), length."""
        if self.body is None:
            return way
        pose, arms = self.body.trial, self.quadrature.reference - self.body.reference
        return np.asarray(
            arms @ (pose.rotation - np.eye(3)) + (way - pose.translation) @ pose.rotation
        )

    def _turn(self) -> Floats:
        """Rotation of the surface since it was drawn, (3, 3)."""
        return np.eye(3) if self.body is None else self.body.trial.rotation

    def _in_space(self, vectors: Floats) -> Floats:
        return vectors if self.body is None else self.body.to_space(vectors)

    def _forget_base(self) -> None:
        self._base = None

    def _stiffness(self, diagonal: Floats) -> float:
        nodes = self.slave_nodes[self.slave_nodes < len(diagonal)]
        local = np.array([diagonal[nodes].mean(axis=1).sum(), self.quadrature.areas.sum()])
        stiffness, area = self._comm.allreduce(local)
        return float(stiffness / area)

    def _stiffen(self, normal: float, tangential: float) -> None:
        """Multiply the penalties of the law."""
        self._master = self._on_body(self._laws, normal, tangential)
        if self._semismooth is not None:
            self._stiff = self._on_body(self._stiff_laws, *self._semismooth.stiff_factors)

    def _on_body(self, laws: Laws, normal: float, tangential: float) -> Master:
        stiff = laws if self._multipliers is None else laws.stiffened(normal, tangential)
        return stiff if self.body is None else MovingInterface(stiff, self.body)

    def _tangents(self, state: State) -> Floats:
        """Tangents of the master as given at the coordinates of a state, (n, 2, 3), length."""
        return self.interface.surface.jet(state["xi"]).d1

    def _place(self, state: State) -> tuple[Floats, Floats]:
        jet = self.interface.surface.jet(state["xi"])
        return jet.position, jet.d1

    def _axes(self, answer: Response) -> Floats:
        own = answer.directions_adhesion
        return own if self.body is None else own @ self.body.trial.rotation

    def _surface(self, tangents: Floats) -> SlaveSurface | None:
        """The slave with its tangents, (m, q, 2, 3), where the laws see it."""
        if not self._sees_slave:
            return None
        quadrature = self.quadrature
        return SlaveSurface(
            quadrature.reference,
            quadrature.tangents.reshape(-1, 2, 3),
            tangents.reshape(-1, 2, 3),
        )

    def _respond(
        self, state: State, x: Floats, dt: float, master: Master | None = None
    ) -> Response:
        return (master or self._master).update(state, x, dt, slave=self._slave)


def _checked(model: Model, slave: str, interface: object) -> Ints:
    """Facets of the slave on this rank; refuses arguments that are no slave or no interface."""
    facets = model.boundary(slave, "slave")
    if not hasattr(interface, "surface"):
        text = f"{type(interface).__name__} given, Interface needed"
        raise InputError(text, "interface")
    return facets
