"""What trials of a pass start from, and how multipliers and layers follow the displacements."""

from __future__ import annotations

from contextlib import AbstractContextManager
from dataclasses import replace
from typing import Any

import numpy as np

from anisocontact.base.array_types import Flags, Floats
from anisocontact.contact.contact_trial import ContactTrial
from anisocontact.contact.frames import Frames
from anisocontact.contact.history import Snapshot
from anisocontact.contact.integration_points import IntegrationPoints
from anisocontact.contact.layer import Layer
from anisocontact.contact.linearised import Linearised
from anisocontact.contact.master import Answer, Master
from anisocontact.contact.multiplier_schemes import MultiplierSchemes
from anisocontact.contact.multipliers import Multipliers
from anisocontact.contact.point_changes import PointChanges
from anisocontact.contact.semismooth import Semismooth
from anisocontact.contact.shared_nodes import SharedNodes
from anisocontact.contact.slivers import Slivers
from anisocontact.contact.supported_share import SupportedPoints, at_rest
from anisocontact.contact.trial_laws import TrialLaws
from anisocontact.interface import State

#: What a trial starts from, and what the next Newton step is linear about.
type Mark = tuple[State, Linearised | None]

#: Least share of its weight that a point counts with.
LEAST = 1e-6


class Trials:
    """Laws at slave points from a state on: as the user gave them, augmented, or with a layer.

    Args:
        points: The points.
        master: What they meet.
        law: Laws, as the user gave them.
        state: Committed state.
        comm: Communicator of the mesh.

    Attributes:
        master: As given.
        interface: Laws, as the user gave them.
        start: State from which trials start.
        immovable: Points that supports hold along the normal, left to their penalty, (n,).
        multipliers: Those of the laws, and the schemes that find them.
        shared: Nodes that other contacts with multipliers have too.
    """

    def __init__(
        self, points: IntegrationPoints, master: Master, law: Any, state: State, comm: Any
    ) -> None:
        self._points = points
        self.master, self.interface, self.start, self._comm = master, law, state, comm
        self._laws = TrialLaws(law, master, comm)
        self.multipliers = MultiplierSchemes(law, comm)
        self.immovable = np.zeros(len(state), dtype=bool)
        self._slivers = Slivers(points, comm)
        self._supports = SupportedPoints(len(state))
        self.shared = SharedNodes(())
        self._linear: Linearised | None = None
        self._changes = PointChanges(comm)
        self._state: State
        self._accepted: Snapshot
        self._now: Snapshot

    @property
    def augmented(self) -> bool:
        """Whether there are multipliers."""
        return self._own is not None

    @property
    def penalty(self) -> float:
        """Normal penalty that trials are answered with now, stress/length."""
        given = self.interface.penalties()[0]
        return float(given if self._own is None else given * self._own.factors[0])

    @property
    def does_work(self) -> bool:
        """Whether tangential forces do work on elastic slip: those that are multipliers do none."""
        return self._own is None or not self._own.tangential

    def begin(self, state: State, accepted: Snapshot) -> None:
        """Let trials start from the committed state, of which the points are given as well."""
        self._linear = None
        self._changes.begin()
        self._state, self._now, self._accepted = state, accepted, accepted
        begun, counts = self.master.begin(state), self.multipliers.first and self._layer is None
        self.start = begun if counts else state
        self._beyond = self.master.beyond(state) & counts
        self.shared.begin()
        self._supports = SupportedPoints(len(state))
        self._slivers.begin(accepted.areas)
        if self._own is not None:
            self._beyond = self._own.held_beyond(self.start, self._beyond)
            there = self.master.located(self.start) & ~self._beyond
            start = self._own.begin(self._own.over_border(self.start, self._beyond), there)
            self._start_from(self._own.coming_to(self.master.body, start))
        if self._layer is not None:
            self.start = self._layer.begin(self.start, self.master.axes(accepted.response))

    def predict(self, change: Floats) -> None:
        """Let trials start anew, with multipliers as if tractions changed like this.

        Args:
            change: Change that is to be expected, (n, 3), stress.
        """
        if self._own is None:
            return
        self.begin(self._state, self._accepted)
        change, frames = self.master.into_frame(change), self._frames(self.start)
        self._start_from(self._own.extrapolated(self.start, change, frames))

    def hold_alone(self, needed: bool) -> None:
        """Take it that contact alone holds a body here from the next increment on, or that not."""
        self._changes.needed = needed

    def expect_motion(self) -> None:
        """Take it that the next trial is where the master has moved and no node has yet."""
        self._changes.expect_motion()

    def forget(self) -> None:
        """Forget about which trial a Newton step was linear."""
        self._linear = None

    def answer(self, dt: float) -> Answer:
        """The trial where the master is, with the derivative of a Newton step."""
        if (semismooth := self._semismooth) is not None:
            answer = self._linearised(semismooth, dt)
        else:
            answer = self.master.answer(self.start, dt)
        self._now = answer.snapshot
        return answer

    def improve(self) -> bool:
        """Take better multipliers from the trial, which is in equilibrium.

        Without multipliers points that are held beside their closest ones are let go: with them the
        way back costs more than the thousandth of a facet that may be wrong.

        Returns:
            Whether anything changed, so that equilibrium has to be found again.

        Raises:
            NotHeldError: They do not converge.
        """
        if self._own is None:
            return self.master.let_go()
        step = self._step(self._now)
        better = self._own.improve(step)
        if better is None:
            better = self._slivers.held_as_well(self._own, step, self.start)
        if better is None:
            return False
        self._start_from(better)
        return True

    def settle(self) -> None:
        """Let points that came to lie in the trial, which is in equilibrium, carry friction."""
        if self._own is None or self._layer is not None:
            return
        if (settled := self._own.settled(self._step(self._now))) is not None:
            self._start_from(settled)

    def soften(self) -> bool:
        """After a solution that failed: hold points that were let go, or take softer penalties.

        Returns:
            Whether to try again.
        """
        if self.master.hold_again():
            return True
        start = None if self._own is None else self._own.soften(self.start)
        if start is None:
            return False
        self._start_from(start)
        return True

    def _linearised(self, semismooth: Semismooth | Layer, dt: float) -> Answer:
        """A trial to which the multipliers have followed, with the derivative of a Newton step."""
        master = self.master
        self._correct(semismooth, dt)
        changes, own, about = self._changes, self._without_layer, self._linear
        trial = master.answer(self.start, dt, tangent=False, separate=True)
        start = changes.with_master(self.start, trial.snapshot, self._accepted, own)
        if start is not None:
            self.start = start
            trial = master.answer(start, dt, tangent=False, separate=True)
        fixed = self.immovable | self._slivers.left
        start = changes.restrained(self.start, trial.snapshot, about, fixed, own)
        if start is not None:
            self.start = start
            trial = master.answer(start, dt, tangent=False, separate=True)
        self._slivers.look(trial.snapshot.areas)
        step = replace(self._step(trial.snapshot), settled=changes.settled(trial.snapshot, about))
        physical = 0.0 if semismooth.tangential else self._laws.slip_stiffness(dt)
        if self._layer is not None or self.interface.tangential.in_python:
            changes.reversals.forget()
        answer, self._linear = Linearised.of(
            semismooth,
            step,
            master,
            trial,
            dt,
            physical,
            changes.active(step.answer),
            changes.reversals,
        )
        return answer

    @property
    def faint(self) -> bool:
        """Whether multipliers have penalties as of `Multipliers.faint`."""
        return self._own is not None and self._own.faint

    def close_singly(self, sticks: bool) -> bool:
        """Let corrections close one point at a time; whether that is something else, collective.

        Args:
            sticks: Whether points have stuck lately.
        """
        return self._changes.close_singly(self._without_layer, sticks)

    def _correct(self, semismooth: Semismooth | Layer, dt: float) -> None:
        """Let the multipliers follow a step of Newton's method."""
        about = self._linear
        if about is None or (change := about.linear.change()) is None:
            return
        now = self._frames(self.master.here(self.start, dt))
        before = self._frames(self.start)
        traction = about.base.after(change, semismooth.share, now.normal)
        if semismooth.tangential and self.multipliers.exact:
            last = before.turned_to(now, before.vector(self._state["stored"]))
            traction = self._along_supports(traction, last, now.normal)
        self.start = semismooth.advance(self.start, traction, now, before, about.base.kept)
        self._let_go_of_immovable()

    def _along_supports(self, traction: Floats, last: Floats, normal: Floats) -> Floats:
        """Multipliers after a step with what they are along supports, (n, 3), stress.

        Args:
            traction: After the step, (n, 3), stress.
            last: Tangential traction of the last accepted increment, (n, 3), stress.
            normal: Of the surface, (n, 3).
        """
        held = self.master.held
        still: Flags | bool = False
        if held is None and (held := self.master.resting(normal)) is not None:
            still = at_rest(held)
        if held is None or self._linear is None:
            return traction
        return self._supports.bounded(
            traction,
            held,
            last=last,
            carried=self._linear.base.traction,
            normal=normal,
            status=self._now.response.status,
            still=still,
        )

    def _let_go_of_immovable(self) -> None:
        if self._own is not None and self.multipliers.exact:
            self._own.let_go(self.start, self.immovable, self._slivers.left)

    def add_multiplier_residual(self, out: Floats) -> None:
        """Add the condensed residual of the multipliers: what a step takes beyond the trial.

        These forces take the violation of multipliers that follow away; (nodes, 3), force.
        """
        if self._linear is not None:
            self._linear.linear.add_force(self._linear.slip, out)

    def multiplier_wrench(self, about: Floats) -> Floats:
        """Force and moment on the slave of `add_multiplier_residual` over the points here, (6,).

        Args:
            about: Point of the moment, (3,), length.
        """
        if self._linear is None:
            return np.zeros(6)
        return self._now.wrench(about, self.master.out_of_frame(self._linear.base.residual))

    def take_way(self, name: str) -> None:
        """Find the multipliers in another way until the trial is kept or forgotten.

        Args:
            name: One of those of `multiplier_schemes`; a contact that lacks it goes on as usual.
        """
        if name in self.multipliers.names:
            self.multipliers.take(name)
            self.begin(self._state, self._accepted)

    @property
    def simultaneous(self) -> bool:
        """Whether multipliers follow every step of Newton's method."""
        return self._semismooth is not None

    def consistent(self) -> bool:
        """Whether multipliers that follow are what the trial answers to them."""
        semismooth = self._semismooth
        return semismooth is None or semismooth.consistent(self._step(self._now))

    @property
    def retraceable(self) -> bool:
        """Whether `go_back` is possible: a layer keeps more."""
        return self._layer is None

    def mark(self) -> Mark:
        """Where the multipliers are, and about which trial the next step is linear."""
        return self.start, self._linear

    def go_back(self, mark: Mark) -> None:
        """Take it that the trials since a mark have not been."""
        self.start, self._linear = mark
        self._changes.reversals.forget()

    def apart(self) -> AbstractContextManager[None]:
        """Around trials that are no corrections, see `SlipReversals`."""
        return self._changes.reversals.apart()

    def damp_correction(self, share: float) -> None:
        """Take only a share of the next step of multipliers that follow."""
        if self._semismooth is not None:
            self._semismooth.share = share

    @property
    def _own(self) -> Multipliers | None:
        """Multipliers, if there are any."""
        return self.multipliers.taken

    @property
    def _without_layer(self) -> Multipliers | None:
        """Multipliers, if there are any and no layer."""
        return None if self._layer is not None else self._own

    @property
    def _semismooth(self) -> Semismooth | Layer | None:
        """What follows every step of Newton's method."""
        return self._laws.follows(self._own)

    @property
    def _layer(self) -> Layer | None:
        """The layer behind adhesion, if there is one."""
        return self._laws.layer

    def slip_stiffness(self, dt: float) -> float:
        """Largest stiffness of a physical adhesion against slip, stress/length; 0 for others.

        Args:
            dt: Time increment.
        """
        if self._own is not None and self._own.tangential:
            return 0.0
        return float(self.interface.slip_stiffness(dt))

    def _stiffen(self) -> None:
        """Answer by the laws of now, with penalties as the multipliers say."""
        self._laws.stiffen(self._own)
        self._linear = None

    def _start_from(self, start: State) -> None:
        """Let trials start from other multipliers, perhaps with other penalties."""
        self.master.anchor(start)
        self.start = start
        self._let_go_of_immovable()
        self._stiffen()

    def _step(self, trial: Snapshot) -> ContactTrial:
        """A trial with the frames of the master."""
        own, answer, far = self._own, trial.response, np.full(len(self.start), np.inf)
        covered = self._points.covered(trial.areas).clip(LEAST, 1.0)
        shared = self.shared.at(self._points.nodes[:, 0])
        slight = self._slivers.left & self.multipliers.exact
        closeness = far if own is None else own.closeness(self.start, answer.pressure, answer.gap)
        firm = (self._slivers.firm | slight) & self.multipliers.exact
        rigidity = np.full((len(covered), 2), np.inf)
        if own is not None:
            rigidity = own.rigidity(shared, np.where(firm, 1.0, covered))
            come = self._beyond & own.exact  # by penalties alone, see `Multipliers.held_beyond`
            rigidity[come, 1] = covered[come]
        return ContactTrial(
            start=self.start,
            answer=answer,
            areas=trial.areas,
            now=self._frames(answer.state),
            before=self._frames(self.start),
            axes=self.master.axes(answer),
            softness=self.interface.tangential.softness(),
            immovable=self.immovable & self.multipliers.exact | slight,
            slight=slight,
            covered=covered,
            rigidity=rigidity,
            far=np.linalg.norm(trial.points, axis=1),
            held=self.master.held if self.multipliers.exact else None,
            closeness=closeness,
        )

    def _frames(self, state: State) -> Frames:
        return Frames.of(self.master.at(state)[1])
