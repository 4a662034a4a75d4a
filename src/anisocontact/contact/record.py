"""What every contact keeps: the accepted increment, the trial of the next, their numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from anisocontact.contact.layer import Layer
from anisocontact.contact.multipliers import AugmentedLaw, Frames, Multipliers, Step
from anisocontact.contact.schemes import USUAL, make_multipliers
from anisocontact.contact.semismooth import RATIO, Semismooth
from anisocontact.interface import STATUS, Response, State
from anisocontact.interface.augmentation import Augmentation
from anisocontact.rigid import RigidBody

Floats = npt.NDArray[np.float64]

#: Fields of a point's state that are energies per area, by their name in the balance.
_ENERGIES = {
    "adhesion": "energy_adhesion",
    "normal": "energy_normal",
    "friction": "dissipation",
    "viscous": "dissipation_viscous",
}

#: What of a response is kept beside its state.
_KEPT = ("traction", "normal", "directions_adhesion", "directions_friction", "failure")


@dataclass(frozen=True)
class Snapshot:
    """Slave points at one state.

    Attributes:
        points: Where they are, (n, 3), length.
        areas: Area of each, (n,), length^2.
        response: What the interface answers.
    """

    points: Floats
    areas: Floats
    response: Response

    def wrench(self, about: Floats) -> Floats:
        """Force and moment about a point on the slave over the points of this rank, (6,)."""
        forces = self.areas[:, None] * self.response.traction
        moments = np.cross(self.points - about, forces)
        return np.concatenate([forces.sum(axis=0), moments.sum(axis=0)])


@dataclass(frozen=True)
class Slid:
    """What slip has come to at slave points since the start.

    Attributes:
        way: Length of the sliding path, (n,), length.
        work: What friction has dissipated, (n,), energy/area.
        touching: Where there is contact, (n,).
    """

    way: Floats
    work: Floats
    touching: npt.NDArray[np.bool_]

    @classmethod
    def of(cls, state: State) -> Slid:
        """That of a state."""
        touching = state["status"] != STATUS.index("open")
        return cls(state["slip_accumulated"].copy(), state["dissipation"].copy(), touching)


class ContactRecord:
    """History of the slave points of one contact: it advances with `commit` only.

    Args:
        space: Vector space of the displacement.
        slave: Facet group "body.group".
        name: Name in output.
        state: State of the points before the first increment.
        start: The points then.
        facet_of_point: Number of each point's facet in the group, of those of this rank, (n,).

    Attributes:
        physical_adhesion: Whether the stiffness of adhesion is physical, so that elastic slip is
            none of its faults.
        state: Committed history, one record for each point.
        facet_of_point: As given.
        space: Vector space of the displacement.
        ran_off: Slave points that left the end of the master in the accepted increment, (k, 3).
        body_stiffness: Traction per displacement of a single node of the bodies behind it, mean
            over the surface, stress/length; 0 until they are known.
    """

    #: Facet group of the slave, and of the master if it is one.
    groups: tuple[str, ...]
    #: Rigid body that carries the master, if one does.
    body: RigidBody | None = None
    #: Laws as the user gave them, those of trials, and those that derivatives are taken of.
    interface: Any
    _laws: Any
    _stiff_laws: Any

    def __init__(
        self,
        space: Any,
        slave: str,
        name: str,
        state: State,
        start: Snapshot,
        facet_of_point: npt.NDArray[np.int64],
    ) -> None:
        self.slave = slave
        self.name = name
        self.state = state
        self.physical_adhesion = True
        self.space = space
        self.facet_of_point = facet_of_point
        self._comm = space.mesh.comm
        self.ran_off: Floats = np.zeros((0, 3))
        self._accepted = start
        self._trial: Snapshot | None = None
        self._start = state
        self._multipliers: Multipliers | None = None
        self._way: list[Slid] = []
        self._ways: Mapping[str, Multipliers] = {}
        self._layer: Layer | None = None
        self.body_stiffness = 0.0

    @property
    def meshed(self) -> bool:
        """Whether the master is facets of a mesh."""
        return len(self.groups) == 2

    @property
    def of_two_groups(self) -> bool:
        """Whether facets of one group meet those of another one."""
        return len(set(self.groups)) == 2

    @property
    def points(self) -> Floats:
        """Slave points where they are after the accepted increment, (n, 3), length."""
        return self._accepted.points

    @property
    def areas(self) -> Floats:
        """Area of each slave point after the accepted increment, (n,), length^2."""
        return self._accepted.areas

    @property
    def last(self) -> Response:
        """Response of the accepted increment."""
        return self._accepted.response

    @property
    def current(self) -> Snapshot:
        """The trial, or the accepted increment if there was none since."""
        return self._trial or self._accepted

    @property
    def trial(self) -> Response:
        """Response of the last `update`, or of the accepted increment if there was none since."""
        return self.current.response

    def failed_points(self) -> Floats:
        """Positions of the trial at which the law has no answer, (failed, 3), length."""
        if self._trial is None:
            return np.zeros((0, 3))
        return self._trial.points[self._trial.response.failed]

    def footing(self) -> npt.NDArray[np.int64]:
        """The facet of the master, or feature of one, below each point in the trial, a code (n,).

        Facets are numbered in the whole group; a smooth master is one.
        """
        return np.zeros(len(self.trial.status), dtype=np.int64)

    def hold(self, points: npt.NDArray[np.bool_]) -> None:
        """Hold points on the facet that they are on until the trial is kept or forgotten.

        Args:
            points: Which, (n,).
        """

    def strayed(self) -> Floats:
        """How wrong the gaps of held points are: against those of the closest points, (n,), length.

        It is zero where a point is above the facet on which it is held.
        """
        return np.zeros(len(self.trial.status))

    def commit(self) -> None:
        """Make the trial the history."""
        if self._trial is not None:
            self._accepted = self._trial
            if self._way:
                self.last.state["dissipation"] = self._dissipated()
            self.state = self.last.state
            if self._multipliers is not None and self._multipliers.tangential:
                # a force that is a multiplier does no work on elastic slip
                self.state["energy_adhesion"] = 0.0
            self._trial = None
        if self._multipliers is not None:
            self._multipliers.commit()
        self._multipliers = self._ways.get(USUAL)
        self._begin()

    @property
    def retraceable(self) -> bool:
        """Whether `update` answers at any state from the accepted one, and nothing else changes."""
        return self._multipliers is None

    def pass_through(self) -> None:
        """Remember the trial as a state that bodies which flow have gone through."""
        self._way.append(Slid.of(self.trial.state))

    def _dissipated(self) -> Floats:
        """What friction has dissipated since the start, with the way there taken piece by piece.

        The law takes the slip from the accepted state at once, `D = -T . s` with the force of the
        end. Along a way on which the force has changed the sum of the means is right to second
        order; while a point has not slipped its force at yield is taken for that of the next state.
        """
        before, total = Slid.of(self.state), self.state["dissipation"].copy()
        slid, force = np.zeros_like(total), np.zeros_like(total)
        for now in (*self._way, Slid.of(self.last.state)):
            way, work = now.way - before.way, now.work - before.work
            at_yield = np.divide(work, way, out=force.copy(), where=way > 0.0)
            first = np.where(slid > 0.0, force, at_yield)
            total += np.where(now.touching, 0.5 * (first + at_yield) * (way - slid), 0.0)
            slid, force = way, at_yield
        return np.asarray(total)

    def roll_back(self) -> None:
        """Forget the trial."""
        self._trial = None
        self._multipliers = self._ways.get(USUAL)
        self._begin()

    def improve(self) -> bool:
        """Take better multipliers from the trial, which is in equilibrium.

        Returns:
            Whether they changed, so that equilibrium has to be found again; False for a contact
            without augmentation.

        Raises:
            NotHeldError: They do not converge.
        """
        if self._multipliers is None:
            return False
        better = self._multipliers.improve(self._step(self.current))
        if better is None:
            return False
        self._start_from(better)
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

    def soften(self) -> bool:
        """Take softer penalties after a solution that failed.

        Returns:
            Whether to try again; False for a contact without augmentation.
        """
        if self._multipliers is None:
            return False
        start = self._multipliers.soften(self._start)
        if start is None:
            return False
        self._start_from(start)
        return True

    @property
    def follows(self) -> bool:
        """Whether multipliers follow every step of Newton's method."""
        return self._semismooth is not None

    def held(self) -> bool:
        """Whether multipliers that follow are what the trial answers to them."""
        semismooth = self._semismooth
        return semismooth is None or semismooth.held(self._step(self.current))

    def suit_strain(self, finite: bool) -> None:
        """Take the area of now where bodies are at finite strain, unless told when it was made.

        Args:
            finite: Whether one of the bodies at this contact is.
        """
        raise NotImplementedError

    def suit(self, diagonal: Floats) -> None:
        """Learn how stiff the bodies are; multipliers that follow are suited to them.

        Args:
            diagonal: Diagonal of the stiffness of the bodies, of the nodes this rank owns,
                (nodes, 3), force/length.
        """
        self.body_stiffness = self._stiffness(diagonal)
        if self._ways:
            for way in self._ways.values():
                way.suit(self.body_stiffness)
            self._begin()

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
            self._layer = Layer(compliance, histories, normal, self._place, self._comm)
        self._take(soft, stiff)
        self._start = self._layer.begin(first, self._axes(self.last))

    def take_away(self) -> None:
        """Take the layer away."""
        if self._layer is not None:
            self._start = self._layer.without(self._start)
            self._layer = None
            self._take(self.interface, self.interface)

    def _take(self, laws: AugmentedLaw, stiff: AugmentedLaw) -> None:
        """Answer by other laws, and take the derivative of others."""
        self._laws, self._stiff_laws = laws, stiff
        self._stiffen(*((1.0, 1.0) if self._multipliers is None else self._multipliers.factors))
        self._forget_base()

    def _stiffness(self, diagonal: Floats) -> float:
        """Traction per displacement of a single node, mean over the surface, stress/length."""
        raise NotImplementedError

    def take_share(self, share: float) -> None:
        """Take only a share of the next step of multipliers that follow."""
        if self._semismooth is not None:
            self._semismooth.share = share

    def add_lag(self, out: Floats) -> None:
        """Add the forces that a Newton step takes beyond those of the trial.

        They take the violation of multipliers that follow away; (nodes, 3), force.
        """

    @property
    def _semismooth(self) -> Semismooth | Layer | None:
        """What follows every step of Newton's method."""
        own = None if self._multipliers is None else self._multipliers.follower
        return self._layer or own

    def _unstiffened(self, stiffness: Floats, trial: Snapshot, dt: float) -> Floats:
        """Stiffness of the points of a trial, from that of the derivative, (n,), force/length."""
        semismooth = self._semismooth
        if semismooth is None:
            return stiffness
        physical = 0.0 if semismooth.tangential else self._laws.slip_stiffness(dt)
        sticks = trial.response.status == STATUS.index("stick")
        return np.asarray(stiffness / semismooth.ratio + physical * trial.areas * sticks)

    def _step(self, trial: Snapshot) -> Step:
        """A trial with the frames of the master."""
        return Step(
            self._start,
            trial.response,
            trial.areas,
            Frames.of(self._tangents(trial.response.state)),
            Frames.of(self._tangents(self._start)),
            self._axes(trial.response),
        )

    def _augment(self, augmentation: Augmentation | None, size: float, law: AugmentedLaw) -> None:
        if augmentation is None:
            return
        self._ways = make_multipliers(augmentation, law, size, self._comm)
        self._multipliers = self._ways[USUAL]
        self._begin()

    def _begin(self) -> None:
        """Let trials start from the committed state."""
        self._start = self.state
        self._way = []
        if self._multipliers is not None:
            self._start_from(self._multipliers.begin(self.state, self.located(self.state)))
        if self._layer is not None:
            self._start = self._layer.begin(self._start, self._axes(self.last))
        self._forget_base()

    def _start_from(self, start: State) -> None:
        """Let trials start from other multipliers, perhaps with other penalties."""
        assert self._multipliers is not None
        self._start = start
        self._stiffen(*self._multipliers.factors)
        self._forget_base()

    def located(self, state: State) -> npt.NDArray[np.bool_]:
        """Whether each point of a state has a surface below it, (n,)."""
        raise NotImplementedError

    def _stiffen(self, normal: float, tangential: float) -> None:
        """Multiply the normal penalty and the stiffness of adhesion of the law."""
        raise NotImplementedError

    def _tangents(self, state: State) -> Floats:
        """Tangents of the master of now at the coordinates of a state, (n, 2, 3), length."""
        raise NotImplementedError

    def _place(self, state: State) -> tuple[Floats, Floats]:
        """Where the master is at the coordinates of a state, (n, 3), and `_tangents`, length."""
        raise NotImplementedError

    def _axes(self, answer: Response) -> Floats:
        """Axes of adhesion as `_tangents` has the master, (n, 2, 3)."""
        return answer.directions_adhesion

    def _forget_base(self) -> None:
        """Forget about which trial a Newton step was linear."""

    @property
    def parts(self) -> tuple[ContactRecord, ...]:
        """The passes over slave points that have a history of their own: itself."""
        return (self,)

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
        return {name: values.copy() for name, values in (own | fields).items()}

    def restore(self, kept: Mapping[str, npt.NDArray[Any]], u: Floats) -> None:
        """Go on from what `persistent` gave.

        Args:
            kept: The state.
            u: Displacement of the local nodes in that state, (nodes, 3), length.
        """
        self.state = np.array(kept["state"])
        response = Response(
            tangent=np.empty((0, 3, 3)),
            state=self.state,
            **{name: np.array(kept[name]) for name in _KEPT},
        )
        self._accepted = Snapshot(np.array(kept["points"]), np.array(kept["areas"]), response)
        self._trial = None
        if self._multipliers is not None:
            self._multipliers.level = self.extreme(kept["level"])
        self._begin()

    def rejoin(self) -> None:
        """Take over what its parts have restored."""

    def counts(self) -> dict[str, int]:
        """Number of open, sticking and slipping points of the trial, over all ranks."""
        local = np.bincount(self.trial.status, minlength=len(STATUS))
        total = self._comm.allreduce(local)
        return {name: int(n) for name, n in zip(STATUS, total, strict=True)}

    def resultant(self, about: npt.ArrayLike = (0.0, 0.0, 0.0)) -> tuple[Floats, Floats]:
        """Force and moment on the slave after the accepted increment.

        Args:
            about: Point of the moment, (3,), length.

        Returns:
            Force (3,) and moment (3,), force and force times length.
        """
        total = self._comm.allreduce(self._accepted.wrench(np.asarray(about)))
        return total[:3], total[3:]

    def energies(self) -> dict[str, float]:
        """Stored and dissipated energy after the accepted increment.

        Returns:
            "adhesion" (elastic, tangential), "normal" (of the normal law), "friction" and
            "viscous" (dissipated since the start), force times length.
        """
        local = np.array([self.areas @ self.state[name] for name in _ENERGIES.values()])
        return dict(zip(_ENERGIES, self._comm.allreduce(local).tolist(), strict=True))

    def extreme(self, values: Floats) -> float:
        """Largest of one number at each point, over all ranks; 0 without points."""
        return float(max(self._comm.allgather(float(np.max(values, initial=0.0)))))
