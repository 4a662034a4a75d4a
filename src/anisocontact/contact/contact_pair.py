"""A contact pair: slave points, a master and its laws composed, with their history."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from anisocontact.base.array_types import Flags, Floats
from anisocontact.base.arrays import points as points_of
from anisocontact.base.arrays import read_only_view
from anisocontact.base.errors import InputError
from anisocontact.contact.adjust import adjusted
from anisocontact.contact.body_blocks import BodyBlocks
from anisocontact.contact.continuation_trials import ContinuationTrials
from anisocontact.contact.energies import ContactEnergies
from anisocontact.contact.history import Snapshot
from anisocontact.contact.initial import check_start
from anisocontact.contact.integration_points import IntegrationPoints
from anisocontact.contact.law_failures import LawFailures
from anisocontact.contact.master import Answer, Master, Resting
from anisocontact.contact.options import ContactOptions
from anisocontact.contact.rounded_forces import levers
from anisocontact.contact.side_of_master import SideOfMaster
from anisocontact.interface import ContactLaw, Interface, Response, State
from anisocontact.interface.failed_point import FailedPoint
from anisocontact.mesh.node_unknowns import NodeUnknowns

#: Gap that is none, over the size of a slave facet.
TOUCHING = 1e-6
#: What of a response is kept beside its state.
_KEPT = ("traction", "normal", "directions_adhesion", "directions_friction", "failure")


@dataclass(frozen=True)
class PairParts:
    """What a contact is composed of.

    Attributes:
        points: Where the laws are evaluated.
        master: What the points meet.
        law: Laws, as the user gave them.
    """

    points: IntegrationPoints
    master: Master
    law: ContactLaw | Interface


class ContactPair:
    """Slave points against a master: forces, tangent and history, which `commit` alone advances.

    A `Contact` is one, made from the names of groups.

    Args:
        unknowns: Where the displacement of nodes is among the unknowns.
        slave: Facet group "body.group".
        name: Name in output.
        parts: Slave points, master and laws.
        options: How the user wants it to hold.

    Attributes:
        slave: As given.
        name: As given.
        unknowns: As given.
        space: Vector space of the displacement of nodes.
        slave_points: Where the laws are evaluated.
        master: What the points meet.
        trials: What trials start from and which laws answer, with their multipliers.
        accepted: The points in the accepted increment.
        answer: What the laws answered last: forces of the trial and their derivative.
        ran_off: Slave points that left the end of the master in the accepted increment, (k, 3).
        without_slip: Those that came on to it in that increment as if from nowhere, (n,), see
            `ContinuationTrials.without_slip`.
        body_stiffness: Traction per displacement of a single node of the bodies behind it, mean
            over the surface, stress/length; 0 until they are known.
        master_yields: How many times as far as the slave the master gives way, see `Master.yields`.

    Raises:
        InputError: As of `check_start` and of `make_multipliers`.
    """

    def __init__(
        self,
        unknowns: NodeUnknowns,
        slave: str,
        name: str,
        parts: PairParts,
        options: ContactOptions,
    ) -> None:
        self.slave_points, self.master = points, master = parts.points, parts.master
        self.unknowns, self.space = unknowns, unknowns.nodes
        self.slave, self.name = slave, name
        nodes = self.space.dofmap.index_map
        self._count = nodes.size_local + nodes.num_ghosts
        self._comm, self._area_given = unknowns.comm, options.current_area is not None
        self._dt = 1.0
        self.body_stiffness = self.master_yields = 0.0
        self.ran_off: Floats = np.zeros((0, 3))
        self._committed = adjusted(master.initial_state(), options.adjust)
        self.without_slip: Flags = np.zeros(len(self._committed), dtype=bool)
        self.answer: Answer = master.answer(self._committed, 1.0)
        self.accepted: Snapshot = self.answer.snapshot
        self._trial: Snapshot | None = None
        self._gained: Floats = np.zeros_like(self.last.traction)
        self.trials = ContinuationTrials(points, master, parts.law, self._committed, self._comm)
        self._energies = ContactEnergies(self.trials, len(self._committed), self._comm)
        check_start(self, points.size)
        self._fixed: Floats | None = None
        if (augmentation := options.augmentation) is not None:
            self.trials.multipliers.augment(augmentation, points.size)
        self._begin()

    @property
    def interface(self) -> Any:
        """Laws, as the user gave them."""
        return self.trials.interface

    @property
    def groups(self) -> tuple[str, ...]:
        """Facet group of the slave, and of the master if it is one."""
        return (self.slave, *self.master.groups)

    @property
    def points(self) -> Floats:
        """Slave points after the accepted increment, (n, 3), length; read only."""
        return read_only_view(self.accepted.points)

    @property
    def areas(self) -> Floats:
        """Area of each slave point after the accepted increment, (n,), length^2; read only."""
        return read_only_view(self.accepted.areas)

    @property
    def state(self) -> State:
        """Committed history, one record for each point; read only."""
        return read_only_view(self._committed)

    @property
    def last(self) -> Response:
        """Response of the accepted increment."""
        return self.accepted.response

    @property
    def current(self) -> Snapshot:
        """The trial, or the accepted increment if there was none since."""
        return self._trial or self.accepted

    def suit_strain(self, finite: bool) -> None:
        """Take the area of now where bodies are at finite strain, unless told when it was made.

        Args:
            finite: Whether one of the bodies at this contact is.
        """
        if not self._area_given:
            self.slave_points.take_area(finite)

    def suit(self, diagonal: Floats) -> None:
        """Learn how stiff the bodies are; multipliers that follow are suited to them.

        Args:
            diagonal: Diagonal of the stiffness of the bodies, of the nodes this rank owns,
                (nodes, 3), force/length.

        Raises:
            InputError: They are not stiff at all, or less than that.
        """
        self.body_stiffness = self.master.stiffness(diagonal)
        if not 0.0 <= self.body_stiffness < np.inf:
            raise InputError(
                f"a stiffness of {self.body_stiffness:.3g} at contact {self.name!r}, a residual "
                "that grows with u needed",
                "F",
            )
        self.master_yields = self.master.yields(diagonal)
        self.trials.multipliers.suit(self.body_stiffness)
        self._begin()

    def given_stiffnesses(self) -> dict[str, float]:
        """Those that hold, which multipliers do not choose, by name, stress/length."""
        interface = self.interface
        found = {} if self.trials.augmented else {"normal.penalty": interface.penalties()[0]}
        if self.trials.does_work:
            found["adhesion.stiffness"] = interface.tangential.stiffest()
        return found

    def take_supports(self, fixed: Floats, resting: Sequence[Resting]) -> None:
        """Learn which displacements are prescribed from now on.

        Args:
            fixed: Projections on directions along which local nodes are prescribed, (nodes, 3, 3):
                points that cannot move keep their penalty.
            resting: Nodes that are held where they are along directions.
        """
        self.master.take_resting(resting, self._committed)
        self.master.take_fixed(fixed)
        self._fixed = fixed
        self._begin()

    def meeting(self) -> Flags:
        """Points that meet their master in the accepted increment, pressed or not, (n,)."""
        last = self.last
        return self.master.located(last.state) & (last.gap <= TOUCHING * self.slave_points.size)

    def undetermined(self) -> int:
        """Slave points whose pressure nothing says, over all ranks, accepted increment; collective.

        They touch, and supports hold them and what they meet along the normal.
        """
        own = self.trials.immovable & self.meeting() & self.trials.augmented
        return int(self._comm.allreduce(int(np.count_nonzero(own))))

    def update(self, u: Floats, dt: float) -> Response:
        """Response to nodal displacements from the committed history, kept as the trial.

        Args:
            u: Displacement of the local nodes, (nodes, 3), length.
            dt: Time increment > 0.

        Returns:
            The response; the committed history is unchanged.

        Raises:
            InputError: The time increment is not positive, the displacements are not those of the
                local nodes, or a law in Python failed.
        """
        if not 0.0 < dt < np.inf:
            raise InputError(f"{dt!r} given, must be > 0", "dt")
        u = points_of(u, 3, "u", rows=self._count)
        last = self.last.state if self.last.state.flags.writeable else self._committed
        if self.master.place(u, self._committed, self.trials.start, last):
            self.trials.forget()
        self._dt = dt
        try:
            self.answer = self.trials.answer(dt)
        except InputError as error:
            error.failed = self._failures().unanswered()
            raise
        self._trial = self.answer.snapshot
        return self._trial.response

    def failed_point(self) -> FailedPoint | None:
        """The first point of this rank, by its place, at which the laws failed in the trial."""
        return self._failures().first(self.current)

    def _failures(self) -> LawFailures:
        return LawFailures(self.name, self.master, self.trials.start, self._dt)

    def body_blocks(self) -> BodyBlocks:
        """Rows and columns of the rigid body that carries the master in the tangent of the trial.

        Raises:
            ValueError: There is none.
        """
        answer: Any = self.answer
        blocks: BodyBlocks = answer.body_blocks()
        return blocks

    def lever(self) -> float:
        """Forces that would move every point of the trial to the origin, norm over this rank.

        The machine's precision times this is the round-off of the contact forces: positions are
        known to a share of their distance from the origin, and those of a surface to a share of
        what it is made of, such as its radius. Points that have met their master count where the
        trial leaves them open as well: that share says which of them do.
        """
        distance = np.linalg.norm(self.current.points, axis=1) + self.master.extent
        if self.master.body is not None:
            distance += np.linalg.norm(self.master.body.position)
        current = self.current
        stiff = self.trials.penalty * current.areas * self.meeting()
        slopes = np.maximum(self.answer.stiffness, stiff)
        forces = np.linalg.norm(current.forces, axis=1)
        return float(np.linalg.norm(levers(slopes, distance, forces, self._stiffness)))

    def _stiffness(self) -> Floats:
        """How stiff points are by laws and bodies, (n,), force/length.

        As stiff as may be where the law is one in Python, which is not asked in each evaluation.
        """
        interface, penalty = self.interface, self.trials.penalty
        if interface.tangential.in_python:
            return np.full(len(self.current.areas), np.inf)
        slip = interface.slip_stiffness(self._dt)
        largest = max(penalty, interface.penalties()[0], slip, self.body_stiffness)
        return np.asarray(largest * self.current.areas)

    def commit(self) -> None:
        """Make the trial the history."""
        self.without_slip = self.trials.without_slip()
        self.ran_off = self.master.commit(self.accepted, self._committed, self._trial)
        if self._trial is not None:
            self._gained = self._trial.response.traction - self.last.traction
            self._energies.commit(self.accepted, self._committed, self._trial)
            self._committed = self._trial.response.state
            if not self.trials.does_work:
                self._committed["energy_adhesion"] = 0.0
            self.accepted = replace(self._trial, response=self._trial.response.frozen())
            self._trial = None
        self.trials.multipliers.end(accepted=True)
        self._begin()

    def roll_back(self) -> None:
        """Forget the trial."""
        self.master.roll_back(self._trial is not None)
        self._trial = None
        answer: Any = self.answer
        self.answer = replace(answer, snapshot=self.accepted)
        self.trials.multipliers.end(accepted=False)
        self._begin()

    def _begin(self) -> None:
        self._energies.begin()
        if self._fixed is not None:
            held = self.slave_points.held(self._fixed, self.last.normal)
            self.trials.immovable = held & self.master.immovable(self.last.normal)
        self.trials.begin(self._committed, self.accepted)

    @property
    def retraceable(self) -> bool:
        """Whether `update` answers at any state from the accepted one, and nothing else changes."""
        return self.master.retraceable and not self.trials.augmented

    def predict(self, ratio: float) -> None:
        """Let multipliers of the next trials start extrapolated, by a ratio of the last change.

        Where nothing is extrapolated, no node has moved in the first trial, but masters have.
        """
        self.trials.predict(ratio * self._gained)
        if ratio == 0.0:
            self.trials.expect_motion()

    def pass_through(self) -> None:
        """Remember the trial as a state that bodies which springs let go have come through."""
        self._energies.pass_through(self.current.response.state)

    def taken_up(self) -> float:
        """As of `ContactEnergies`, from the accepted state to the trial, of this rank."""
        return self._energies.taken_up(self.accepted, self._committed, self.current)

    def energies(self) -> dict[str, float]:
        """As of `ContactEnergies.totals`, after the accepted increment, over all ranks."""
        return self._energies.totals(self._committed, self.areas)

    def elastic_slip(self) -> Floats:
        """Elastic part of the relative displacement `e^i rho_i`, (n, 3), length."""
        tangents = self.master.at(self._committed)[1]
        slip = np.einsum("ni,nij->nj", self._committed["elastic"], tangents)
        return self.master.out_of_frame(slip)

    def side_of_master(self, u: Floats) -> SideOfMaster:
        """Where the points of the trial are beside the master, in its frame; collective.

        Args:
            u: Displacement of the local nodes in the trial, (nodes, 3), length.
        """
        return self.master.side_of_master(u, self.accepted, self._committed, self.current)

    def persistent(self) -> dict[str, npt.NDArray[Any]]:
        """All that the next increments and the output depend on, an entry for each point.

        Multipliers are the pressure and the elastic force in the state; "level" is what their
        penalties are multiplied with.
        """
        now = self.accepted
        fields = {name: getattr(now.response, name) for name in _KEPT}
        own = {
            "state": self._committed,
            "points": now.points,
            "areas": now.areas,
            "gained": self._gained,
            "dissipated": self._energies.dissipated,
            "level": np.full(len(now.areas), self.trials.multipliers.level),
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
        self._committed = np.array(kept["state"])
        response = Response(
            tangent=np.empty((0, 3, 3)),
            state=self._committed,
            **{name: np.array(kept[name]) for name in _KEPT},
        )
        self.accepted = Snapshot(np.array(kept["points"]), np.array(kept["areas"]), response)
        self._gained, self._trial = np.array(kept["gained"]), None
        self._energies.dissipated = np.array(kept["dissipated"])
        level = float(kept["level"].max(initial=0.0))
        self.trials.multipliers.level = max(self._comm.allgather(level))
        self._begin()
