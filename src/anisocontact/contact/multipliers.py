"""Augmented Lagrangian: multipliers of the slave points that make penalties exact.

They bring the Signorini conditions `g >= 0, N >= 0, N g = 0` and stick without elastic slip.
A point that carries multipliers answers with the projections of Alart and Curnier (1991),

    N = <lambda_N - eps_N g>,    T = return(lambda_T - eps_T dxi, N) ,

and holds exactly where lambda_N = N, lambda_T = T. `Semismooth` takes the multipliers along with
the displacements in one Newton iteration, `Uzawa` holds them while Newton's method converges.
"""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np

from anisocontact.base.array_types import Flags, Floats
from anisocontact.base.statuses import OPEN, STICK
from anisocontact.contact.contact_trial import ContactTrial
from anisocontact.contact.frames import Frames
from anisocontact.interface import State
from anisocontact.interface.augmentation import Augmentation
from anisocontact.rigid import RigidBody

#: Change of the multipliers over the tractions, both as norms over the area, that is good enough.
SHARE = 1e-5
#: What the penalties are multiplied with in the derivative of multipliers that follow, at most and
#: at least; displacements are rounded, and what that makes of tractions goes with it.
RATIO, LEAST_RATIO = 1e4, 1e3
#: Share of the tractions that is the tolerance of equilibrium, and of positions that is rounded.
EXACT, ROUNDED = 1e-8, 16.0 * float(np.finfo(np.float64).eps)
#: The same at points that are slaves of several contacts: what makes their multipliers unique.
SHARED_RATIO = 3e2
#: Share of its weight below which a point that its master hardly covers is compliant, and how many
#: times as stiff as the penalties it is where nothing is covered. Its force is to vanish with the
#: weight: held exactly by next to none it would pull and press in turn.
FADES, FADED_RATIO = 0.003, 1e4
#: Tractions that are none, as a share of what the tolerance stands for: 1e-9 of the stiffness of
#: the bodies times the facet size.
ROUNDING = 1e-3
#: What the gap of a point that is apart is multiplied with at the start of an increment.
FAR = 1e8
#: Least way of a gap that closes, as a share of the gap.
SMALLEST = 1e-9


class Multipliers:
    """Multipliers of the points of one contact.

    They are what a trial starts from: the committed pressure and elastic force, then better ones.
    Nothing of them lasts but the state of the points and `level`.

    Args:
        augmentation: What is asked for.
        size: Facet size, length.
        penalties: Normal penalty and least tangential stiffness, stress/length.
        comm: Communicator of the mesh.

    Attributes:
        level: What the penalties are multiplied with at the beginning of an increment; part of the
            history.
        factor: What they are multiplied with now.
        size: Facet size, length.
        limit: Violation that is none, length.
        tangential: Whether there are multipliers of the tangential part.
        exact: Whether no compliance is meant to stay, but where there is no other way.
        faint: Whether penalties are so soft that forces hardly tell what multipliers violate.
    """

    exact: ClassVar[bool] = True
    faint: ClassVar[bool] = False

    def __init__(
        self, augmentation: Augmentation, size: float, penalties: tuple[float, float], comm: Any
    ) -> None:
        self.tangential = augmentation.tangential
        self.level = self.factor = self._proportion = 1.0
        self.size, self.limit = size, augmentation.tolerance * size
        self._penalties = penalties
        self._comm = comm

    def closes_singly(self, sticks: bool) -> bool:
        """Whether points close one at a time where they open and close in turn.

        Args:
            sticks: Whether points have stuck lately.
        """
        return False

    @property
    def factors(self) -> tuple[float, float]:
        """What normal penalty and stiffness of adhesion are multiplied with now."""
        return self.factor, self.factor * self._proportion if self.tangential else 1.0

    @property
    def penalties(self) -> Floats:
        """Normal penalty and least stiffness of adhesion now, (2,), stress/length."""
        return np.array(self._penalties) * self.factors

    def rigidity(self, shared: Flags, covered: Floats) -> Floats:
        """How many times as stiff as the penalties points are, infinite where they hold exactly.

        Args:
            shared: Points that are slaves of other contacts with multipliers as well, (n,).
            covered: Share of the weight of each point that the master covers, above 0, (n,).

        Returns:
            Along the normal and the surface, (n, 2).
        """
        faded = np.full_like(covered, np.inf)
        left = 1.0 - covered / FADES
        np.divide(FADED_RATIO * covered, left, out=faded, where=left > 0.0)
        each = np.where(shared, np.minimum(SHARED_RATIO, faded), faded)
        return np.repeat(each[:, None], 2, axis=1)

    def held_beyond(self, state: State, beyond: Flags) -> Flags:
        """Points beyond a border that remember where they were if they slide over it, (n,).

        One that also comes down on it slips from there on, as others whose gap closes, see `begin`.
        Where adhesion is physical, all of the way counts. Along the surface penalties alone hold
        them: held exactly where it came from, the first sliver of a point that is covered would
        pull it back with all that its neighbours carry.

        Args:
            state: What trials start from.
            beyond: Points that are beyond it, (n,).
        """
        return beyond & (state["gap"] <= self.limit) if self.tangential else beyond

    def over_border(self, state: State, beyond: Flags) -> State:
        """The state that `begin` takes, with the slip of points that may slide on to the master.

        Args:
            state: What trials start from.
            beyond: As of `held_beyond`.
        """
        start = state.copy()
        if self.tangential:
            start["status"][beyond] = STICK
        else:
            start["gap"][beyond] = 0.0
        return start

    def begin(self, state: State, located: Flags) -> State:
        """What the trials of the next increment start from.

        A point nearer than the tolerance counts as touching: it bears a pressure that closes the
        tolerance, or rounding of its gap would say whether it is held, and friction acts from the
        start. Friction of one that is apart is that of a point which comes to lie on its way, see
        `closeness`; where adhesion is physical it counts as far away, and there is none.
        """
        start = state.copy()
        start["multiplier"] = state["pressure"]
        apart = state["status"] == OPEN
        touching = located & apart & (state["gap"] <= self.limit)
        start["gap"] = np.where(touching | ~apart, np.minimum(state["gap"], 0.0), state["gap"])
        start["multiplier"][touching] = self._penalties[0] * self.factors[0] * self.limit
        apart &= ~touching
        if not self.tangential:
            start["gap"][apart] *= FAR
            return start
        start["status"][touching | (apart & located)] = STICK
        normal, tangential = np.array(self._penalties) * self.factors
        start["stiffer"][apart, 1] = normal / tangential - 1.0
        return start

    def closeness(self, start: State, pressure: Floats, gap: Floats) -> Floats:
        """How near points whose gap closes in the increment were, infinite for others, (n,).

        Where it sticks from the touch on, the force of such a point has the direction of its way,
        T = - N dxi / g_n, as on springs of one stiffness along the normal and the surface: the core
        answers so up to the stiffness of the penalties, see `contact_fraction`. This is how many
        times as stiff N / g_n is. Above 1 penalties act in series with what is left of the
        compliance g_n / N, and a multiplier holds what that is short of the force: so which points
        slip is decided with moderate penalties, as it is at other points.

        Args:
            start: What the trials start from.
            pressure: N, (n,), stress.
            gap: Gap of the trial, (n,), length.
        """
        stands_for = pressure / (self._penalties[0] * self.factors[0])
        way = self.way(start, gap)
        none = np.full(len(way), np.inf)
        return np.asarray(np.divide(stands_for, way, out=none, where=way > 0.0))

    def way(self, start: State, gap: Floats) -> Floats:
        """Ways of the gaps that close, zero for others, (n,), length; as of `closeness`."""
        way = np.maximum(start["gap"] - gap, SMALLEST * start["gap"])
        return np.asarray(np.where(self.tangential & (start["gap"] > 0.0), way, 0.0))

    def coming_to(self, body: RigidBody | None, start: State) -> State:
        """What the trials start from where points come to a rigid body.

        The way to one that is free to turn, as a wheel, is a cycloid, which ends along the normal:
        friction along a straight way would be shear that a wheel which rolls freely does not have.
        Points whose gap closes carry none there yet, as if they had been far away.

        Args:
            body: That carries the master, if one does.
            start: What `begin` gave, changed.
        """
        if body is None or not body.turns_freely or not self.tangential:
            return start
        apart = start["gap"] > 0.0
        start["gap"][apart] *= FAR
        start["status"][apart] = OPEN
        start["stiffer"][apart] = 0.0
        return start

    def let_go(self, start: State, immovable: Flags, slight: Flags) -> None:
        """Leave points to their penalty: no multiplier, nor what one holds of a gap that closes.

        Args:
            start: What the trials start from, changed.
            immovable: Those that supports hold along the normal, (n,).
            slight: Those of which next to nothing is covered: a multiplier that holds one along the
                surface grows with what is not covered, and takes the sliver away, (n,).
        """
        points = immovable | slight
        start["multiplier"][points] = 0.0
        start["stored"][points & (start["gap"] > 0.0)] = 0.0
        if self.tangential:
            start["stored"][slight] = 0.0

    def extrapolated(self, start: State, change: Floats, frames: Frames) -> State:
        """What the trials start from where tractions go on as before.

        Without it displacements that are extrapolated meet bounds of friction of the increment
        before.

        Args:
            start: What `begin` gave.
            change: Change of the traction to be expected, (n, 3), stress.
            frames: Frames at the committed coordinates.
        """
        new = start.copy()
        loaded = start["multiplier"] > 0.0
        more = np.where(loaded, np.einsum("nd,nd->n", change, frames.normal), 0.0)
        new["multiplier"] = np.maximum(start["multiplier"] + more, 0.0)
        if self.tangential:
            stored = np.einsum("nid,nd->ni", frames.tangents, change)
            new["stored"][loaded] += stored[loaded]
        return new

    def suit(self, stiffness: float) -> None:
        """Bring the penalties to the stiffness of the bodies, whatever was given.

        Args:
            stiffness: Traction per displacement of the surfaces, stress/length.
        """
        normal, tangential = self._penalties
        self.level, self._proportion = stiffness / normal, normal / tangential

    @property
    def semismooth(self) -> Any:
        """Multipliers that follow every correction now; None where they are held meanwhile."""
        return None

    def commit(self) -> None:
        """Keep what the increment has shown to be right."""

    def improve(self, step: ContactTrial) -> State | None:
        """Better multipliers from a trial in equilibrium.

        Returns:
            What the next trial starts from; None if these hold.

        Raises:
            NotHeldError: They did not get there.
        """
        raise NotImplementedError

    def settled(self, _: ContactTrial) -> State | None:
        """What the next trial starts from where points came to lie in equilibrium on springs.

        Returns:
            The start, in which these carry friction from where they are; None if nothing changes.
        """
        return None

    def soften(self, _: State) -> State | None:
        """After a solution that failed: take what is easier to solve with.

        Args:
            start: What the trials started from.

        Returns:
            What the next trial starts from; None if there is nothing else to be tried.
        """
        return None

    def values(self, step: ContactTrial) -> tuple[Floats, Floats]:
        """Multipliers, and what they should be: as of `answers`, but for points that cannot move.

        Supports hold these along the normal, or next to nothing of them is covered: they keep their
        penalty. Shared ones are compliant.
        """
        given, found = self.answers(step)
        found *= step.kept[:, [0, 1, 1, 1]]
        found[step.immovable, 0] = given[step.immovable, 0]
        found[step.slight, 1:] = given[step.slight, 1:]
        if step.held is not None:  # nothing comes along supports: no compliance of a way there
            closing = np.isfinite(step.closeness)[:, None]
            along = step.held @ (found - given)[:, 1:, None]
            found[:, 1:] -= np.where(closing, along[..., 0], 0.0)
        return given, found

    def answers(self, step: ContactTrial) -> tuple[Floats, Floats]:
        """Multipliers, and what the trial answers to them: N and T as a vector, (n, 4) each."""
        old, force = np.zeros((2, len(step.start), 3))
        if self.tangential:
            old = np.where(step.remembers, step.before.vector(step.start["stored"]), 0.0)
            turned = step.now.turned_to(step.before, step.now.vector(step.answer.state["stored"]))
            force = np.where(step.remembers, turned, 0.0)
        given = np.hstack([step.start["multiplier"][:, None], old])
        return given, np.hstack([step.answer.pressure[:, None], force])

    def beyond(self, step: ContactTrial) -> Flags:
        """Points that their penalty, or compliance, leaves deeper than the tolerance, (n,)."""
        share = np.where(step.slight, 1.0, 1.0 - step.left[:, 0])
        deep = step.covered * share * step.answer.pressure
        return np.asarray(deep > self.limit * self._penalties[0] * self.factors[0])

    def _violation(self, change: Floats, covered: Floats) -> float:
        """Largest penetration or elastic slip over all ranks that a change stands for, length.

        It is weighted: what a node counts of which next to nothing is covered is that little.
        """
        stiffness = np.array(self._penalties) * self.factors
        each = np.maximum(
            np.abs(change[:, 0]) / stiffness[0],
            np.linalg.norm(change[:, 1:], axis=1) / stiffness[1],
        )
        return float(max(self._comm.allgather(float((covered * each).max(initial=0.0)))))

    def _norms(self, change: Floats, step: ContactTrial) -> tuple[float, float]:
        """Norms over the area of a change of the multipliers and of the tractions.

        Tractions are at least what rounding leaves of them where bodies come to rest without force,
        and what makes roundings of positions, by the penalty, a share of them that is good enough.
        """
        traction, areas = step.answer.traction, step.areas
        least = np.maximum(ROUNDING * self.limit, ROUNDED / SHARE * step.far)
        sizes = [(change**2).sum(axis=1), (traction**2).sum(axis=1), least**2]
        squares = areas @ np.stack(sizes, axis=1)
        changed, carried, rounded = np.sqrt(self._comm.allreduce(squares))
        return float(changed), float(max(carried, self._penalties[0] * self.factors[0] * rounded))


class NotHeldError(RuntimeError):
    """Multipliers that do not converge."""
