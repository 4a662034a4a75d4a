"""One pass over slave points: points, a master and its laws composed, with their history."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from anisocontact.base.errors import InputError
from anisocontact.contact.adjust import adjusted
from anisocontact.contact.body_blocks import BodyBlocks
from anisocontact.contact.history import Slid, Snapshot, dissipated
from anisocontact.contact.initial import check_start
from anisocontact.contact.layer import Layer
from anisocontact.contact.master import Answer, Law, Linear, Master
from anisocontact.contact.multipliers import STICK, Frames, Multipliers, Step
from anisocontact.contact.points import SlavePoints
from anisocontact.contact.schemes import USUAL, make_multipliers
from anisocontact.contact.semismooth import RATIO, Base, Semismooth
from anisocontact.contact.transfer import Couplings
from anisocontact.contact.whereabouts import Seen, Whereabouts
from anisocontact.interface import FAILURE, Response, State
from anisocontact.interface.augmentation import Augmentation
from anisocontact.interface.failed_point import FailedPoint
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.rigid import RigidBody

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int32]
Mask = npt.NDArray[np.bool_]

#: Fields of a point's state that are energies per area, by their name in the balance.
ENERGIES = {
    "adhesion": "energy_adhesion",
    "normal": "energy_normal",
    "friction": "dissipation",
    "viscous": "dissipation_viscous",
}

#: What of a response is kept beside its state.
_KEPT = ("traction", "normal", "directions_adhesion", "directions_friction", "failure")


class Pass:
    """Slave points against a master: forces, tangent and history, which `commit` alone advances.

    Args:
        space: Vector space of the displacement.
        slave: Facet group "body.group".
        points: Where the laws are evaluated.
        master: What the points meet.
        law: Laws, as the user gave them.
        augmentation: How exactly the contact is to hold; by its penalties alone if None.
        adjust: As of `adjusted`.
        area_told: Whether the user has said which area counts.

    Attributes:
        slave: As given.
        space: As given.
        slave_points: Where the laws are evaluated.
        master: What the points meet.
        interface: Laws, as the user gave them.
        state: Committed history, one record for each point.
        ran_off: Slave points that left the end of the master in the accepted increment, (k, 3).
        body_stiffness: Traction per displacement of a single node of the bodies behind it, mean
            over the surface, stress/length; 0 until they are known.

    Raises:
        InputError: As of `check_start` and of `make_multipliers`.
    """

    def __init__(
        self,
        space: Any,
        slave: str,
        points: SlavePoints,
        master: Master,
        law: Any,
        *,
        augmentation: Augmentation | None = None,
        adjust: float | None = None,
        area_told: bool = False,
    ) -> None:
        self.space, self.slave, self.slave_points, self.master = space, slave, points, master
        self.interface = law
        self._laws: Law = law
        self._stiff_laws: Law = law
        self._comm, self._area_told = space.mesh.comm, area_told
        self.body_stiffness = 0.0
        self.ran_off: Floats = np.zeros((0, 3))
        self._multipliers: Multipliers | None = None
        self._ways: Mapping[str, Multipliers] = {}
        self._layer: Layer | None = None
        self._way: list[Slid] = []
        self._linear: Linear | None = None
        self._dt = 1.0
        self._base: Base
        self._slip: Floats
        self.state = self._start = adjusted(master.initial_state(), adjust)
        self._answer: Answer = master.answer(self.state, 1.0)
        self._accepted: Snapshot = self._answer.snapshot
        self._trial: Snapshot | None = None
        check_start(self, points.size)
        if augmentation is not None:
            self._ways = make_multipliers(augmentation, law, points.size, self._comm)
            self._multipliers = self._ways[USUAL]
            self._begin()

    @property
    def groups(self) -> tuple[str, ...]:
        """Facet group of the slave, and of the master if it is one."""
        return (self.slave, *self.master.groups)

    @property
    def body(self) -> RigidBody | None:
        """Rigid body that carries the master, if one does."""
        return self.master.body

    @property
    def facet_of_point(self) -> npt.NDArray[np.int64]:
        """Number of each point's facet in the group, of those of this rank, (n,)."""
        return self.slave_points.facet

    @property
    def facet_size(self) -> float:
        """Length of a slave facet: square root of the mean area."""
        return self.slave_points.size

    @property
    def points(self) -> Floats:
        """Slave points where they are after the accepted increment, (n, 3), length."""
        return self._accepted.points

    @property
    def areas(self) -> Floats:
        """Area of each slave point after the accepted increment, (n,), length^2."""
        return self._accepted.areas

    @property
    def accepted(self) -> Snapshot:
        """The accepted increment."""
        return self._accepted

    @property
    def last(self) -> Response:
        """Response of the accepted increment."""
        return self._accepted.response

    @property
    def current(self) -> Snapshot:
        """The trial, or the accepted increment if there was none since."""
        return self._trial or self._accepted

    def suit_strain(self, finite: bool) -> None:
        """Take the area of now where bodies are at finite strain, unless told when it was made.

        Args:
            finite: Whether one of the bodies at this contact is.
        """
        if not self._area_told:
            self.slave_points.take_area(finite)

    def suit(self, diagonal: Floats) -> None:
        """Learn how stiff the bodies are; multipliers that follow are suited to them.

        Args:
            diagonal: Diagonal of the stiffness of the bodies, of the nodes this rank owns,
                (nodes, 3), force/length.
        """
        self.body_stiffness = self.master.stiffness(diagonal)
        if self._ways:
            for way in self._ways.values():
                way.suit(self.body_stiffness)
            self._begin()

    def update(self, u: Floats, dt: float) -> Response:
        """Response to nodal displacements from the committed history, kept as the trial.

        Args:
            u: Displacement of the local nodes, (nodes, 3), length.
            dt: Time increment.

        Returns:
            The response; the committed history is unchanged.
        """
        master, follower, self._dt = self.master, self._follower, dt
        if master.place(u, self.state, self._start, self.last.state):
            self._linear = None
        if follower is None:
            self._answer = master.settled(master.answer(self._start, dt))
        else:
            self._answer = self._linearised(follower, dt)
        self._trial = self._answer.snapshot
        return self._trial.response

    def failed_point(self, contact: str) -> FailedPoint | None:
        """The first point of this rank at which the laws have failed in the trial, if any has.

        Args:
            contact: Name of the contact.
        """
        failure = self.current.response.failure
        if not failure.any():
            return None
        point = int(np.flatnonzero(failure)[0])
        said = {"contact": contact, "point": point, "failure": FAILURE[failure[point]]}
        found: FailedPoint = self.master.failed_point(point, self._start, self._dt, **said)
        return found

    def unanswered(self, contact: str) -> FailedPoint | None:
        """The first point of this rank at which a law in Python fails when it is asked alone.

        Args:
            contact: Name of the contact.
        """
        for i in range(len(self._start)):
            said = {"contact": contact, "point": i, "failure": ""}
            point: FailedPoint = self.master.failed_point(i, self._start, self._dt, **said)
            try:
                point.evaluate()
            except InputError as error:
                return replace(point, failure=str(error))
        return None

    def _linearised(self, follower: Semismooth | Layer, dt: float) -> Answer:
        """A trial to which the multipliers have followed, with the derivative of a Newton step."""
        master = self.master
        self._follow(follower, dt)
        trial = master.answer(self._start, dt, tangent=False, separate=True)
        step = self._step(trial.snapshot)
        state, self._slip = follower.stiff(step)
        stiff = master.answer(state, dt, derivative=True, separate=True)
        stiffness = stiff.stiffness / follower.ratio
        if not follower.tangential:
            physical = self._laws.slip_stiffness(dt) * trial.snapshot.areas
            stiffness += physical * (trial.snapshot.response.status == STICK)
        answer: Answer = master.settled(trial.by_derivative(stiff, stiffness))
        self._linear = master.linear(answer)
        traction = master.into_frame(trial.snapshot.response.traction)
        self._base = Base(follower.vector(step), traction, self._linear.slipped(self._slip))
        return answer

    def _follow(self, follower: Semismooth | Layer, dt: float) -> None:
        """Let the multipliers follow a step of Newton's method."""
        change = None if self._linear is None else self._linear.change()
        if change is None:
            return
        self._start = follower.advance(
            self._start,
            self._base.after(change, follower.share),
            self._frames(self.master.here(self._start, dt)),
            self._frames(self._start),
        )

    def add_force(self, out: Floats) -> None:
        """Add the forces of the trial to the local nodes, (nodes, 3), force."""
        self._answer.add_force(out)

    def couplings(self) -> list[Couplings]:
        """Where `-d force / d u` of the trial has entries, and the entries.

        Returns:
            Each with nodes of the rows (p, r) and of the columns (p, c), numbered as
            `CoupledTangent` has them, -1 for none, and p blocks, (p, r, c, 3, 3) or (p, 3 r, 3 c).
        """
        return self._answer.couplings()

    def body_blocks(self) -> BodyBlocks:
        """Rows and columns of the rigid body that carries the master in the tangent of the trial.

        Raises:
            ValueError: There is none.
        """
        answer: Any = self._answer
        blocks: BodyBlocks = answer.body_blocks()
        return blocks

    def lever(self) -> float:
        """Forces that would move every point of the trial to the origin, norm over this rank.

        The machine's precision times this is the round-off of the contact forces: positions are
        known to a share of their distance from the origin.
        """
        distance = np.linalg.norm(self.current.points, axis=1)
        if self.body is not None:
            distance += np.linalg.norm(self.body.position)
        return float(np.linalg.norm(self._answer.stiffness * distance))

    def add_lag(self, out: Floats) -> None:
        """Add the forces that a Newton step takes beyond those of the trial.

        They take the violation of multipliers that follow away; (nodes, 3), force.
        """
        if self._linear is not None:
            self._linear.add_force(self._slip, out)

    def lag_wrench(self, about: Floats) -> Floats:
        """Force and moment on the slave that belong to `add_lag` over the points here, (6,).

        Args:
            about: Point of the moment, (3,), length.
        """
        if self._linear is None:
            return np.zeros(6)
        return self.current.wrench(about, self.master.out_of_frame(self._base.lag))

    def commit(self) -> None:
        """Make the trial the history."""
        self.ran_off = self.master.commit(self._accepted, self.state, self._trial)
        if self._trial is not None:
            self._accepted = self._trial
            if self._way:
                self.last.state["dissipation"] = dissipated(self.state, self._way, self.last.state)
            self.state = self.last.state
            if self._multipliers is not None and self._multipliers.tangential:
                # a force that is a multiplier does no work on elastic slip
                self.state["energy_adhesion"] = 0.0
            self._trial = None
        if self._multipliers is not None:
            self._multipliers.commit()
        self._multipliers = self._ways.get(USUAL)
        self._begin()

    def roll_back(self) -> None:
        """Forget the trial."""
        self.master.roll_back(self._trial is not None)
        self._trial = None
        answer: Any = self._answer
        self._answer = replace(answer, snapshot=self._accepted)
        self._multipliers = self._ways.get(USUAL)
        self._begin()

    @property
    def retraceable(self) -> bool:
        """Whether `update` answers at any state from the accepted one, and nothing else changes."""
        return self.master.retraceable and self._multipliers is None

    def pass_through(self) -> None:
        """Remember the trial as a state that bodies which flow have gone through."""
        self._way.append(Slid.of(self.current.response.state))

    def improve(self) -> bool:
        """Take better multipliers from the trial, which is in equilibrium.

        Without multipliers points that are held beside their closest ones are let go: with them the
        way back costs more than the thousandth of a facet that may be wrong.

        Returns:
            Whether anything changed, so that equilibrium has to be found again.

        Raises:
            NotHeldError: They do not converge.
        """
        if self._multipliers is None:
            return self.master.let_go()
        better = self._multipliers.improve(self._step(self.current))
        if better is None:
            return False
        self._start_from(better)
        return True

    def soften(self) -> bool:
        """After a solution that failed: hold points that were let go, or take softer penalties.

        Returns:
            Whether to try again.
        """
        if self.master.hold_again():
            return True
        start = None if self._multipliers is None else self._multipliers.soften(self._start)
        if start is None:
            return False
        self._start_from(start)
        return True

    @property
    def ways(self) -> tuple[str, ...]:
        """Ways to the multipliers in an increment, see `schemes`; none without augmentation."""
        return tuple(self._ways)

    def take_way(self, name: str) -> None:
        """Find the multipliers in another way until the trial is kept or forgotten.

        Args:
            name: One of the names in `schemes`; a contact that does not have it goes on as usual.
        """
        if name in self._ways:
            self._multipliers = self._ways[name]
            self._begin()

    @property
    def follows(self) -> bool:
        """Whether multipliers follow every step of Newton's method."""
        return self._follower is not None

    def held(self) -> bool:
        """Whether multipliers that follow are what the trial answers to them."""
        follower = self._follower
        return follower is None or follower.held(self._step(self.current))

    def take_share(self, share: float) -> None:
        """Take only a share of the next step of multipliers that follow."""
        if self._follower is not None:
            self._follower.share = share

    @property
    def _follower(self) -> Semismooth | Layer | None:
        """What follows every step of Newton's method."""
        own = None if self._multipliers is None else self._multipliers.follower
        return self._layer or own

    def slip_stiffness(self, dt: float) -> float:
        """Largest stiffness of a physical adhesion against slip, stress/length; 0 for others.

        Args:
            dt: Time increment.
        """
        if self._multipliers is not None and self._multipliers.tangential:
            return 0.0
        return float(self.interface.slip_stiffness(dt))

    def lay(self, compliance: float, dt: float) -> None:
        """Put a compliant layer behind adhesion, see `Layer`, until `take_away`; or a stiffer one.

        Args:
            compliance: Of the layer, length/stress.
            dt: Time increment.
        """
        soft, start = self.interface.in_series(compliance, dt)
        stiff, begun = self.interface.in_series(compliance / RATIO, dt)
        first = self._start
        if self._layer is not None:
            first = self._layer.without(first)
            self._layer.stiffer(compliance, (start, begun))
        else:
            normal = None if self._multipliers is None else self._multipliers.follower
            histories = start, begun
            self._layer = Layer(compliance, histories, normal, self.master.at, self._comm)
        self._take(soft, stiff)
        self._start = self._layer.begin(first, self.master.axes(self.last))

    def take_away(self) -> None:
        """Take the layer away."""
        if self._layer is not None:
            self._start = self._layer.without(self._start)
            self._layer = None
            self._take(self.interface, self.interface)

    def _take(self, laws: Law, stiff: Law) -> None:
        """Answer by other laws, and take the derivative of others."""
        self._laws, self._stiff_laws = laws, stiff
        self._stiffen()
        self._linear = None

    def _stiffen(self) -> None:
        """Multiply the penalties of the laws as the multipliers say."""
        laws, stiff = self._laws, self._stiff_laws
        if self._multipliers is not None:
            laws = laws.stiffened(*self._multipliers.factors)
            if self._follower is not None:
                stiff = stiff.stiffened(*self._follower.stiff_factors)
        self.master.take(laws, stiff)

    def _begin(self) -> None:
        """Let trials start from the committed state."""
        self._start = self.state
        self._way, self._linear = [], None
        self.master.begin()
        if self._multipliers is not None:
            self._start_from(self._multipliers.begin(self.state, self.located(self.state)))
        if self._layer is not None:
            self._start = self._layer.begin(self._start, self.master.axes(self.last))

    def _start_from(self, start: State) -> None:
        """Let trials start from other multipliers, perhaps with other penalties."""
        self._start = start
        self._stiffen()
        self._linear = None

    def _step(self, trial: Snapshot) -> Step:
        """A trial with the frames of the master."""
        return Step(
            self._start,
            trial.response,
            trial.areas,
            self._frames(trial.response.state),
            self._frames(self._start),
            self.master.axes(trial.response),
        )

    def _frames(self, state: State) -> Frames:
        return Frames.of(self.master.at(state)[1])

    def elastic_slip(self) -> Floats:
        """Elastic part of the relative displacement `e^i rho_i`, (n, 3), length."""
        tangents = self.master.at(self.state)[1]
        slip = np.einsum("ni,nij->nj", self.state["elastic"], tangents)
        return self.master.out_of_frame(slip)

    def energies(self) -> dict[str, float]:
        """Stored and dissipated energy after the accepted increment, over all ranks.

        Returns:
            "adhesion" (elastic, tangential), "normal" (of the normal law), "friction" and
            "viscous" (dissipated since the start), with overlaps "transfer" (see `Transfer`), force
            times length.
        """
        local = np.array([self.areas @ self.state[name] for name in ENERGIES.values()])
        own = dict(zip(ENERGIES, self._comm.allreduce(local).tolist(), strict=True))
        return own | self.master.energies()

    def located(self, state: State) -> Mask:
        """Whether each point of a state has a surface below it, (n,)."""
        return self.master.located(state)

    def outward(self) -> Floats:
        """Outward normals of the slave at its points in the reference configuration, (n, 3)."""
        return self.slave_points.outward

    def look(self, x: Floats) -> Seen:
        """The master where it is now from points of space, (n, 3), length."""
        return self.master.look(x)

    def whereabouts(self, u: Floats) -> Whereabouts:
        """Where the points of the trial are beside the master, in its frame; collective.

        Args:
            u: Displacement of the local nodes in the trial, (nodes, 3), length.
        """
        return self.master.whereabouts(u, self._accepted, self.state, self.current)

    def probe(
        self, laws: tuple[NormalLaw, Adhesion, Friction], state: State
    ) -> npt.NDArray[np.int8]:
        """Why other laws would fail in the reference configuration, codes of `FAILURE`, (n,)."""
        return self.master.probe(laws, state)

    def footing(self) -> npt.NDArray[np.int64]:
        """As of `Master`."""
        return self.master.footing(len(self.state))

    def hold(self, points: Mask) -> None:
        """As of `Master`."""
        self.master.hold(points)

    def strayed(self) -> Floats:
        """As of `Master`."""
        return self.master.strayed(len(self.state))

    def persistent(self) -> dict[str, npt.NDArray[Any]]:
        """All that the next increments and the output depend on, an entry for each point.

        Multipliers are the pressure and the elastic force in the state; "level" is what their
        penalties are multiplied with.
        """
        now = self._accepted
        fields = {name: getattr(now.response, name) for name in _KEPT}
        level = 1.0 if self._multipliers is None else self._multipliers.level
        own = {
            "state": self.state,
            "points": now.points,
            "areas": now.areas,
            "level": np.full(len(now.areas), level),
        }
        kept = {name: values.copy() for name, values in (own | fields).items()}
        return self.master.persistent(kept)

    def restore(self, kept: Mapping[str, npt.NDArray[Any]], u: Floats) -> None:
        """Go on from what `persistent` gave.

        Args:
            kept: The state.
            u: Displacement of the local nodes in that state, (nodes, 3), length.
        """
        kept = self.master.restore(kept, u)
        self.state = np.array(kept["state"])
        response = Response(
            tangent=np.empty((0, 3, 3)),
            state=self.state,
            **{name: np.array(kept[name]) for name in _KEPT},
        )
        self._accepted = Snapshot(np.array(kept["points"]), np.array(kept["areas"]), response)
        self._trial = None
        if self._multipliers is not None:
            level = float(kept["level"].max(initial=0.0))
            self._multipliers.level = max(self._comm.allgather(level))
        self._begin()
