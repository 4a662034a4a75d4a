"""A compliant layer behind a stiff adhesion, with multipliers that take it away again.

With a layer of the compliance c in series a point answers `T = law(dxi + c T)`. Shifted by what the
layer gives way under a force lambda,

    T = law(dxi + c (T - lambda)) = P(dxi, lambda),    lambda - P = 0 ,

the law stands there as it is. Where adhesion is stiff a point sticks within a tiny slip only, and
corrections throw it from one side of the yield ellipse to the other; here lambda remembers the
side, and c, of the compliance of the bodies, says when the point leaves it. As in `semismooth`
lambda is eliminated point by point: the derivative is that of the law where it answers the same T,
with 1e-4 of the layer: beyond that rounding is all that is gained.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.statuses import OPEN
from anisocontact.contact.contact_trial import ContactTrial
from anisocontact.contact.frames import Frames
from anisocontact.contact.multipliers import RATIO
from anisocontact.contact.semismooth import Semismooth
from anisocontact.interface import Response, State
from anisocontact.interface.series import SeriesHistory

#: Change of the multipliers over the tractions that is good enough to go on with a stiffer layer,
#: or with none.
ENOUGH = 1e-5
#: Corrections of the coordinates that slip counts from.
_CORRECTIONS = 3
#: Cosine between two tangent planes that stand on edge on each other.
_EDGEWISE = 1e-9


class Layer:
    """The layer of one contact, and its multipliers, in the frame that the contact calculates in.

    Args:
        compliance: c, length/stress.
        histories: What the law in series starts from, and the law of the derivative.
        normal: Multipliers of the pressure that follow as well, if there are any.
        master: Its places at the coordinates of a state, (n, 3), and its tangents there,
            (n, 2, 3), length.
        comm: Communicator of the mesh.

    Attributes:
        share: Share that is taken of the next step.
        ratio: What normal penalties are multiplied with in the derivative.
        tangential: Whether the stiffness of adhesion is a penalty: it is not.
    """

    tangential: ClassVar[bool] = False

    def __init__(
        self,
        compliance: float,
        histories: tuple[SeriesHistory, SeriesHistory],
        normal: Semismooth | None,
        master: Callable[[State], tuple[Floats, Floats]],
        comm: Any,
    ) -> None:
        self._compliance, self._histories = compliance, histories
        self._normal, self._master, self._comm = normal, master, comm
        self._force: Floats = np.zeros((0, 3))
        self._way = _LayerCompliance(np.zeros((0, 2, 3)), np.zeros((0, 3, 3)))
        self._spin: Floats = np.zeros(0)
        self.share = 1.0
        self.ratio = 1.0 if normal is None else normal.ratio

    @property
    def stiff_factors(self) -> tuple[float, float]:
        """What normal penalty and stiffness of adhesion are multiplied with in the derivative."""
        return (1.0, 1.0) if self._normal is None else self._normal.stiff_factors

    def begin(self, start: State, axes: Floats) -> State:
        """State from which the law in series starts.

        Args:
            start: State from which the law itself starts.
            axes: Axes of adhesion there, (n, 2, 3).
        """
        self._own, self.share = start, 1.0
        begun = start.copy()
        frames = Frames.of(self._master(start)[1])
        if not len(self._force):
            self._force, self._spin = np.zeros((len(start), 3)), np.zeros(len(start))
            self._way = _LayerCompliance(axes, np.zeros((len(start), 3, 3)))
        self._shift(begun, self._histories[0], self._way.under(self._force), frames)
        return begun

    def stiffer(self, compliance: float, histories: tuple[SeriesHistory, SeriesHistory]) -> None:
        """Go on with a stiffer layer and the multipliers found so far."""
        way = replace(self._way, compliance=self._way.compliance * compliance / self._compliance)
        self._compliance, self._histories = compliance, histories
        self._way = way

    def without(self, start: State) -> State:
        """The state from which the law itself starts, with the multipliers of the pressure."""
        own = start.copy()
        for name in ("xi", "origin", "stored"):
            own[name] = self._own[name]
        return own

    def consistent(self, step: ContactTrial) -> bool:
        """Whether the multipliers are what the trial answers to them."""
        change = self._found(step) - self._force
        found = step.answer.traction
        local = np.array([step.areas @ (each**2).sum(axis=1) for each in (change, found)])
        changed, carried = self._comm.allreduce(local)
        settled = changed <= ENOUGH**2 * carried
        return bool(settled) and (self._normal is None or self._normal.consistent(step))

    def stiff(self, step: ContactTrial) -> tuple[State, Floats]:
        """Where to take the derivative, and the slip that a step is to take away.

        Returns:
            State from which the law itself answers as the trial does; gap and slip that would make
            the trial exact, (n, 3), length.
        """
        state, slip = step.start.copy(), np.zeros((len(step.start), 3))
        if self._normal is not None:
            self._normal.share = self.share
            state, slip = self._normal.stiff(step)
        self._way = _LayerCompliance.of(step, self._compliance)
        self._spin = step.answer.state["spin"]
        found, rest = self._found(step), 1.0 / RATIO
        way = self._way.under(self._force - (1.0 - rest) * found)
        self._shift(state, self._histories[1], way, step.now)
        more = (1.0 - rest) * self._way.under(self._force - found)
        return state, slip + more

    def advance(
        self, start: State, traction: Floats, now: Frames, before: Frames, left: Floats
    ) -> State:
        """State with other multipliers, see `Semismooth.advance`."""
        new = start.copy()
        if self._normal is not None:
            new = self._normal.advance(start, traction, now, before, left)
        normal = np.einsum("nd,nd->n", traction, now.normal)[:, None] * now.normal
        self._force = traction - normal
        self._shift(new, self._histories[0], self._way.under(self._force), now)
        return new

    def vector(self, step: ContactTrial) -> Floats:
        """The multipliers of a trial as vectors where it is, (n, 3), stress."""
        pressure = step.answer.pressure[:, None] * step.now.normal
        normal = pressure if self._normal is None else self._normal.vector(step)
        return np.asarray(normal + self._force)

    def _found(self, step: ContactTrial) -> Floats:
        """Tangential tractions of a trial, (n, 3), stress."""
        force = step.now.vector(step.answer.state["traction"])
        return np.where((step.answer.status != OPEN)[:, None], force, 0.0)

    def _shift(self, state: State, history: SeriesHistory, way: Floats, now: Frames) -> None:
        """Let the slip of a state count from places farther on.

        Args:
            state: The state, changed.
            history: What it starts from.
            way: How much farther, (n, 3), length. It is elastic slip times the ratio of the
                stiffnesses, so that its square is felt, and that a slave which turns spans it on
                an arc.
            now: Frames where the points are.
        """
        state["xi"] = self._own["xi"]
        before, tangents = self._master(state)
        force = self._start(history, Frames.of(tangents), now)
        there, way = before, now.chord(way, self._spin)
        for _ in range(_CORRECTIONS):
            along = np.einsum("nid,nd->ni", now.tangents, way - (there - before))[..., None]
            state["xi"] += _coordinates(now.tangents, tangents, along)
            there, tangents = self._master(state)
        turned = now.turned_to(Frames.of(tangents), force)
        state["stored"] = np.einsum("nid,nd->ni", tangents, turned)
        state["origin"] = self._own["origin"] + state["xi"] - self._own["xi"]

    def _start(self, history: SeriesHistory, before: Frames, now: Frames) -> Floats:
        """Force that a law in series starts from, turned to where the points are, (n, 3)."""
        own, axes = self._own, self._way.axes
        force = before.turned_to(now, before.vector(own["stored"]))
        slip = before.turned_to(now, before.moved(own["elastic"]))
        keep = (own["status"] != OPEN) & axes.any(axis=(1, 2))
        axes = axes[keep]
        along = np.einsum("nad,nd->na", axes, slip[keep])[..., None]
        kept = history.keeps @ _components(axes, force[keep]) - history.recovers @ along
        force[keep] = np.einsum("nad,na->nd", axes, kept[..., 0])
        return force


@dataclass(frozen=True)
class _LayerCompliance:
    """How far the layer gives way at each point of a trial.

    Attributes:
        axes: Axes of adhesion, (n, 2, 3); zero where there is no contact.
        compliance: Way for a unit of force, over the part of the increment spent in contact,
            (n, 3, 3), length/stress; nothing where there is no contact.
    """

    axes: Floats
    compliance: Floats

    @classmethod
    def of(cls, step: ContactTrial, compliance: float) -> _LayerCompliance:
        touching = step.answer.status != OPEN
        axes = step.axes[touching]
        # the layer is one of the axes: e_a . way = c t_a for the force t_a e_a
        dual = np.linalg.solve(axes @ axes.swapaxes(1, 2), axes)
        whole = np.zeros((len(touching), 3, 3))
        along = compliance * dual.swapaxes(1, 2) @ dual
        whole[touching] = along / _fraction(step.start, step.answer)[touching, None, None]
        return cls(step.axes, whole)

    def under(self, force: Floats) -> Floats:
        """Under a force at each point, (n, 3)."""
        return np.asarray(np.einsum("nij,nj->ni", self.compliance, force))


def _coordinates(now: Floats, tangents: Floats, along: Floats) -> Floats:
    """Steps in the coordinates of the master that lead as far along tangents of now, (n, 2).

    A point that has come to no place of the master has a frame of its own, which may stand on edge
    on the place it started from: it stays there.
    """
    both = np.einsum("nid,njd->nij", now, tangents)
    lengths = np.linalg.norm(now, axis=2) * np.linalg.norm(tangents, axis=2)
    edgewise = np.abs(np.linalg.det(both)) <= _EDGEWISE * lengths.prod(axis=1)
    both[edgewise] = np.eye(2)
    return np.where(edgewise[:, None], 0.0, np.linalg.solve(both, along)[..., 0])


def _components(axes: Floats, vectors: Floats) -> Floats:
    """Components t of vectors `t_a e_a`, (n, 2, 1)."""
    along = np.einsum("nad,nd->na", axes, vectors)[..., None]
    return np.asarray(np.linalg.solve(axes @ axes.swapaxes(1, 2), along))


def _fraction(start: State, trial: Response) -> Floats:
    """Part of the increment that each point spends in contact, (n,)."""
    closes = (start["status"] == OPEN) & (start["gap"] > 0.0) & (trial.gap < 0.0)
    way = np.where(closes, trial.gap - start["gap"], 1.0)
    return np.where(closes, trial.gap / way, 1.0)
