"""Multipliers together with the displacements: semismooth Newton method of Alart and Curnier.

A primal-dual active set: every correction takes points as open, sticking or slipping as they are.
Unknowns are the displacement u and the traction lambda of every point, equations

    K(u) - integral of P(u, lambda) = 0,    lambda - P(u, lambda) = 0,

P the projections of `multipliers`. The second is eliminated point by point: with the penalties
times a large `ratio` r the derivative of the law, taken where it answers the same P, is that of P
with lambda eliminated from `lambda + dlambda - P - dP = -dlambda / (r - 1)`. A step leaves the
share k / (r eps) of a violation, k the stiffness of the bodies behind the point, and its square.
What the derivative is multiplied with enters no state that is evaluated.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from anisocontact.base.array_types import Flags, Floats
from anisocontact.base.statuses import OPEN, STICK
from anisocontact.contact.contact_trial import ContactTrial, left_by
from anisocontact.contact.frames import Frames
from anisocontact.contact.multipliers import (
    EXACT,
    LEAST_RATIO,
    RATIO,
    ROUNDED,
    SHARE,
    Multipliers,
)
from anisocontact.interface import State

#: Least share of an increment in contact that is divided by.
LEAST_PART = 1e-9
#: Way of a gap that closes, over the gap, from which on a trial says nothing of where it ends; so
#: does a way that is as many times shorter.
OVERSHOOT = 4.0


@dataclass(frozen=True)
class _Closing:
    """Points of a trial that close a gap in the increment, flags of all points, (n,).

    Attributes:
        closing: All of them.
        weak: Those whose trial says where the gap ends.
        astray: The others, as of `Semismooth._astray`.
        part: Part of the increment in which a point is in contact, for any.
    """

    closing: Flags
    weak: Flags
    astray: Flags
    part: Floats


class Semismooth(Multipliers):
    """Multipliers that follow every Newton step, made like all `Multipliers`.

    Attributes:
        share: Share that is taken of the next step.
        ratio: What the penalties are multiplied with in the derivative.
    """

    share: float = 1.0
    ratio: ClassVar[float] = RATIO

    @property
    def semismooth(self) -> Semismooth:
        """Itself."""
        return self

    def closes_singly(self, sticks: bool) -> bool:
        """Where nothing sticks: a point that closes changes nothing then but how bodies bend."""
        return not sticks

    @property
    def stiff_factors(self) -> tuple[float, float]:
        """`factors` in the derivative."""
        normal, tangential = self.factors
        return self.ratio * normal, self.ratio * tangential if self.tangential else 1.0

    def begin_from(self, step: ContactTrial) -> State:
        """What the trials start from after equilibrium with penalties: what it answers."""
        _, found = self.answers(step)
        self.share = 1.0
        new = step.start.copy()
        new["multiplier"] = found[:, 0] * step.kept[:, 0]
        new["multiplier"][step.immovable] = step.start["multiplier"][step.immovable]
        if self.tangential:
            self._hold(new, step.left[:, 1:] * found[:, 1:], step.before, step.left)
        return new

    def _hold(self, start: State, force: Floats, before: Frames, left: Floats) -> None:
        """Let points carry friction, those that close a gap but what its compliance leaves.

        A point that is compliant along the normal bears more than its multiplier, and goes on by
        what the penalty answers with the rest.

        Args:
            start: State of the trials, with the multipliers of the pressure, changed.
            force: At the committed coordinates, (n, 3), stress.
            before: Frames there.
            left: What compliance leaves where no gap closes, as of `ContactTrial.left`.
        """
        held = np.maximum(start["multiplier"], 0.0)
        pressure = np.divide(held, left[:, 0], out=held.copy(), where=left[:, 0] > 0.0)
        deep = (pressure - held) / (self.factors[0] * self._penalties[0])
        share = left_by(self.closeness(start, pressure, -deep))
        start["stored"] = np.einsum("nid,nd->ni", before.tangents, share[:, None] * force)

    def settled(self, step: ContactTrial) -> State | None:
        """As of `Multipliers.settled`: springs let a body glide on that nothing rubs against."""
        new = self.begin_from(step)
        closed = self.tangential & (new["gap"] > 0.0) & (step.answer.status != OPEN)
        for name in ("xi", "origin", "facet"):
            new[name][closed] = step.answer.state[name][closed]
        for name in ("gap", "elastic", "stored"):
            new[name][closed] = 0.0
        new["stiffer"][closed] = 0.0
        new["status"][closed] = STICK
        return new

    def begin(self, state: State, located: Flags) -> State:
        """What the trials of the next increment start from, see `Multipliers.begin`."""
        self.share = 1.0
        self.factor = self.level
        return super().begin(state, located)

    def improve(self, step: ContactTrial) -> State | None:
        """They are as good as equilibrium is: see `consistent`."""
        return None

    def consistent(self, step: ContactTrial) -> bool:
        """Whether the multipliers are what the trial answers to them."""
        given, found = self.values(step)
        changed, carried = self._norms(found - given, step)
        return (
            self._violation(found - given, step.covered) <= self.limit
            and changed <= SHARE * carried
        )

    def stiff(self, step: ContactTrial) -> tuple[State, Floats]:
        """Where to take the derivative, and the violation that a step is to take away.

        Returns:
            State from which the law with `ratio` times the penalties answers as the trial does;
            gap and slip that would make the trial exact, which move no point, (n, 3), length.
        """
        answers, ratio, gaps = self.answers(step), self._ratios(step), self._closing(step)
        state = self._shifted(step, answers, ratio, gaps)
        return state, self._missing_way(step, answers, ratio, gaps)

    def _shifted(
        self, step: ContactTrial, answers: tuple[Floats, Floats], ratio: Floats, gaps: _Closing
    ) -> State:
        """State from which the law with `ratio` times the penalties answers as the trial does.

        Args:
            step: The trial.
            answers: Multipliers and what is answered to them, as of `Multipliers.answers`.
            ratio: As of `_ratios`.
            gaps: Points whose gap closes.
        """
        given, found = answers
        times = ratio.copy()
        times[gaps.weak, 1] = step.closeness[gaps.weak].clip(1.0, ratio[gaps.weak, 1])
        times[gaps.astray, 1] /= gaps.part[gaps.astray]
        shifted = given + (1.0 - times[:, [0, 1, 1, 1]]) * (found - given)
        # an open point stays open, however little its gap may be closed
        apart = step.answer.pressure == 0.0
        shifted[apart, 0] = np.minimum(shifted[apart, 0], 0.0)
        shifted[apart, 1:] = 0.0
        state = step.start.copy()
        state["multiplier"] = shifted[:, 0]
        state["stiffer"] = (1.0 + step.start["stiffer"]) * ratio / self.ratio - 1.0
        if self.tangential:
            state["stored"] = np.einsum("nid,nd->ni", step.before.tangents, shifted[:, 1:])
            state["gap"][gaps.astray] = 0.0
        return state

    def _missing_way(
        self, step: ContactTrial, answers: tuple[Floats, Floats], ratio: Floats, gaps: _Closing
    ) -> Floats:
        """Gap and slip that would make the trial exact, (n, 3), length; arguments of `_shifted`."""
        given, found = answers
        left = np.where(np.isfinite(step.rigidity), 1.0, 1.0 - 1.0 / ratio)
        left[gaps.weak, 1] = 1.0
        left[gaps.astray, 1] = 1.0 / gaps.part[gaps.astray]
        deep = left[:, 0] * (given[:, 0] - step.kept[:, 0] * found[:, 0])
        deep /= self.factors[0] * self._penalties[0]
        deep[step.immovable] = 0.0
        way = deep[:, None] * step.now.normal
        if self.tangential:
            trial = step.answer.state
            kept = step.before.turned_to(step.now, step.before.moved(step.start["elastic"]))
            more = step.now.moved(trial["elastic"]) - kept
            stiffness = self.factors[1] * self._penalties[1] * (1.0 + step.start["stiffer"][:, 1:])
            held = step.flexed(step.before.turned_to(step.now, given[:, 1:] - found[:, 1:]))
            held /= stiffness
            # slip that stays is felt to its square: what stands for force is told by force
            by_force = gaps.closing | np.isfinite(step.rigidity[:, 1])
            more = left[:, 1:] * np.where(by_force[:, None], held, more)
            compliant = 1.0 - step.kept[:, 1:]
            compliant[gaps.astray, 0] = 1.0 / ratio[gaps.astray, 1]
            more += compliant * step.flexed(step.now.vector(trial["stored"])) / stiffness
            # the way of a gap, which friction is divided by, does not grow with what is no motion
            weak = gaps.weak
            of_gap = self.way(step.start, step.answer.gap)[weak] * gaps.part[weak]
            more[weak] -= (deep[weak] / of_gap)[:, None] * held[weak]
            way += np.where(step.remembers, more, 0.0)
        way[step.answer.pressure == 0.0] = 0.0
        return way

    def _closing(self, step: ContactTrial) -> _Closing:
        """The points of a trial whose gap closes."""
        closing, astray = np.isfinite(step.closeness), self._astray(step)
        part = step.closeness.clip(LEAST_PART, 1.0)
        return _Closing(closing, closing & ~astray, astray, part)

    def _ratios(self, step: ContactTrial) -> Floats:
        """What penalties are multiplied with at the points, normal and tangential, (n, 2).

        The force of a node changes as much where little of its weight is covered; where supports
        hold a point along the normal, or next to nothing is covered, its penalty is what it is. At
        points that are compliant it is that of their compliance, see `ContactTrial.kept`.
        """
        exact = np.isinf(step.rigidity)
        most = np.where(exact, self._resolved(step), step.rigidity)
        ratio = most / step.covered[:, None]
        ratio[step.immovable, 0] = 1.0
        if not self.tangential:
            ratio[:, 1] = self.ratio
        else:
            closing = np.isfinite(step.closeness)
            ratio[closing, 1] = ratio[closing, 0]
            astray = self._astray(step)
            ratio[astray, 1] = np.minimum(self._at_no_gap(step), ratio[:, 0])[astray]
            ratio[step.slight, 1] = 1.0
        return ratio

    def _at_no_gap(self, step: ContactTrial) -> Floats:
        """How many times as stiff N / g_n is as penalties where the gap has closed, (n,)."""
        return self.closeness(step.start, step.answer.pressure, np.zeros(len(step.start)))

    def _astray(self, step: ContactTrial) -> Flags:
        """Points whose trial says nothing of where a gap that closes ends, (n,).

        Corrections take the stiffness N / g_n as what it is at no gap and as constant: a trial deep
        in the master has a way many times the gap; one that a multiplier presses though it is as
        far away as before, or farther, has none, and a slip would be divided by it.
        """
        near = self._at_no_gap(step)
        deep = near > np.maximum(1.0, OVERSHOOT * step.closeness)
        return np.asarray(np.isfinite(near) & (deep | (step.closeness > OVERSHOOT * near)))

    def _resolved(self, step: ContactTrial) -> float:
        """What penalties are multiplied with so that corrections of displacements are felt.

        A correction is rounded as the displacement is that it is added to, by up to a share of the
        places. Of bodies that have moved far under small pressures that would be felt.
        """
        sizes = [step.start["pressure"].max(initial=0.0), step.far.max(initial=0.0)]
        pressure, far = np.max(self._comm.allgather(sizes), axis=0)
        rounded = ROUNDED * self.factors[0] * self._penalties[0] * far
        most = self.ratio if pressure * far == 0.0 else LEAST_RATIO * EXACT * pressure / rounded
        return float(np.clip(most, LEAST_RATIO, self.ratio))

    def advance(
        self, start: State, traction: Floats, now: Frames, before: Frames, left: Floats
    ) -> State:
        """State with other multipliers.

        Args:
            start: State of the trials.
            traction: lambda as a vector, (n, 3), stress.
            now: Frames where the points are.
            before: Frames at the committed coordinates.
            left: What compliance leaves where no gap closes, (n, 2).
        """
        new = start.copy()
        normal = np.einsum("nd,nd->n", traction, now.normal)
        new["multiplier"] = normal
        if self.tangential:
            tangential = now.turned_to(before, traction - normal[:, None] * now.normal)
            self._hold(new, tangential, before, left)
        return new

    def vector(self, step: ContactTrial) -> Floats:
        """The multipliers of a trial as vectors where it is, (n, 3), stress."""
        given, found = self.answers(step)
        closing = np.isfinite(step.closeness)
        held = np.where(closing[:, None], found[:, 1:], given[:, 1:])
        turned = step.before.turned_to(step.now, held)
        return np.asarray(given[:, :1] * step.now.normal + turned)


class Softer(Semismooth):
    """The same with smaller penalties in the projections: fewer points change their status at once.

    A softer penalty moves the boundary between the cases of P less from one step to the next, at
    the price of more steps where no status changes; the answer is the same.
    """

    #: Shares of the penalties that suit the bodies: normal, tangential.
    SHARES: ClassVar[tuple[float, float]] = (0.3, 0.1)

    def closes_singly(self, sticks: bool) -> bool:
        """Never: other penalties are another way out."""
        return False

    def suit(self, stiffness: float) -> None:
        """Bring the penalties to a share of the stiffness of the bodies, see `Multipliers.suit`."""
        super().suit(stiffness)
        normal, tangential = self.SHARES
        self.level *= normal
        self._proportion *= tangential / normal


class Slender(Softer):
    """The same with penalties of bodies that bend, which give way by thousands of facets' strain.

    Turns leave gaps to their square after a correction. Times a penalty of the material they would
    open points that press a beam by next to nothing, so that it springs back and closes them.
    Where points still change their status, corrections leave what these penalties let them; where
    none has, as little as others do: bodies that do not bend would take a half each time.
    """

    SHARES: ClassVar[tuple[float, float]] = (3e-4, 3e-4)
    faint: ClassVar[bool] = True
    ratio: ClassVar[float] = RATIO / SHARES[0]

    def _resolved(self, step: ContactTrial) -> float:
        """As of `Semismooth`."""
        most = super()._resolved(step)
        return most if step.settled and self.share == 1.0 else min(most, RATIO)


class Singly(Semismooth):
    """The same; where corrections gain nothing they close one point at a time, whatever sticks."""

    def closes_singly(self, sticks: bool) -> bool:
        """Always."""
        return True
