"""Stiff penalties by way of multipliers: how a solver comes to the answer of a penalty method.

Penalties k answer `N = <-k g>`, `T = return(T_n - k dxi, N)`. Where k is far beyond the stiffness
of the bodies, whether a point touches or sticks hangs on displacements that are next to none, and
corrections throw points from one status to another. With penalties r of the stiffness of the bodies
and multipliers that keep the compliance 1/k, which r lacks,

    P = projections of (lambda_N - r g, lambda_T - r dxi),
    lambda_N = (1 - r/k) P_N,    lambda_T = (1 - r/k) P_T + r/k T_n ,

P is the answer of k: what is a point's status is decided as in augmented contacts
[Alart Curnier 1991], and what is found is an equilibrium of the law as it was given.
"""

from __future__ import annotations

from typing import ClassVar, override

import numpy as np

from anisocontact.base.array_types import Flags, Floats
from anisocontact.contact.contact_trial import ContactTrial
from anisocontact.contact.frames import Frames
from anisocontact.contact.semismooth import Semismooth
from anisocontact.interface import State


class Compliant(Semismooth):
    """Multipliers whose compliance is that of the penalties which were given."""

    exact: ClassVar[bool] = False

    @override
    def closes_singly(self, sticks: bool) -> bool:
        return False

    @override
    def suit(self, stiffness: float) -> None:
        normal, tangential = np.minimum(stiffness / np.array(self._penalties), 1.0)
        self.level, self._proportion = float(normal), float(tangential / normal)

    @override
    def rigidity(self, shared: Flags, covered: Floats) -> Floats:
        return np.asarray(covered[:, None] / np.array(self.factors))

    @override
    def begin(self, state: State, located: Flags) -> State:
        self._carried = state["stored"].copy()
        start = super().begin(state, located)
        start["multiplier"] *= 1.0 - self.factor
        return start

    @override
    def values(self, step: ContactTrial) -> tuple[Floats, Floats]:
        given, found = super().values(step)
        found[:, 1:] += self._remembered(step.before)
        return given, found

    @override
    def stiff(self, step: ContactTrial) -> tuple[State, Floats]:
        state, slip = super().stiff(step)
        force = step.before.turned_to(step.now, self._remembered(step.before))
        held = step.remembers & (step.answer.pressure > 0.0)[:, None]
        elastic = step.flexed(force) / self.penalties[1]
        return state, slip - np.where(held, elastic, 0.0)

    @override
    def advance(
        self, start: State, traction: Floats, now: Frames, before: Frames, left: Floats
    ) -> State:
        new = super().advance(start, traction, now, before, left)
        more = self.share * self._remembered(before)
        new["stored"] += np.einsum("nid,nd->ni", before.tangents, more)
        return new

    @override
    def beyond(self, step: ContactTrial) -> Flags:
        """No point has anything else than its penalty."""
        return np.zeros(len(step.start), dtype=bool)

    def _remembered(self, before: Frames) -> Floats:
        """What multipliers are of the force of the accepted state, (n, 3), stress."""
        return self.factors[1] * before.vector(self._carried)
