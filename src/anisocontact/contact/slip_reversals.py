"""Points that slide to and fro from one correction to the next, which the next one has stick.

Where a point slides, a correction is linear about friction against its last slip, and the force
along it is as good as constant. What ought to stick, or to slide by next to nothing, is driven
across the place where it sticks by friction alone, and driven back by the next correction: slip
alternates between two directions as long as one likes. So a point whose friction has turned by
more than a right angle, and back, counts as sticking in the active set of the next correction,
which brings it back to where it sticks. From there its trial force says whether it slides, and
where to. States are answered as ever: the set of points that stick is a choice of each correction,
as in a primal-dual active set [Hueeber Stadler Wohlmuth 2008].
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np

from anisocontact.base.array_types import Flags, Floats
from anisocontact.base.statuses import SLIP, STICK
from anisocontact.contact.contact_trial import ContactTrial
from anisocontact.interface import Response, State

#: Corrections from one start in which a point sticks so: where it slides to and fro after them,
#: sticking is no way out.
MOST = 2
#: What presses points so that friction holds any force, over their pressure.
PRESSED = 1e12
#: Times that a remembered force is sought from which trials have none: the last one leaves what
#: relaxes in an increment, to this power.
TRIES = 10


@dataclass(frozen=True)
class _Sliding:
    """What slid in a trial.

    Attributes:
        points: Points that slid, and were not made to stick, (n,).
        force: Tangential tractions, (n, 3), stress.
        back: Points whose friction had turned by more than a right angle, (n,).
    """

    points: Flags
    force: Floats
    back: Flags


class SlipReversals:
    """Finds points that slide to and fro, and lets them stick in a correction.

    Args:
        comm: Communicator over whose ranks the points are spread.
    """

    def __init__(self, comm: Any) -> None:
        self._comm = comm
        self._times: Any = 0
        self._last: _Sliding | None = None

    def begin(self) -> None:
        """Take it that corrections start anew."""
        self._times = 0
        self.forget()

    @contextmanager
    def apart(self) -> Iterator[None]:
        """Around trials that are no corrections: what is known of these is none of theirs."""
        known = self._times, self._last
        self.begin()
        try:
            yield
        finally:
            self._times, self._last = known

    def forget(self) -> None:
        """Take it that there was no trial before the next one."""
        self._last = None

    def sticking(
        self,
        step: ContactTrial,
        state: State,
        slip: Floats,
        answer: Callable[[State], Response],
    ) -> tuple[State, Floats]:
        """Where to take the derivative so that points that slide to and fro stick; collective.

        Args:
            step: The trial.
            state: Where the derivative is taken from, see `Semismooth.stiff`.
            slip: What a step takes away, (n, 3), length.
            answer: What the laws of the derivative answer from a state where the points are.

        Returns:
            The state, from which these points stick, and what a step takes away, their slip too.
        """
        alternate = self._alternate(step)
        if not self._comm.allreduce(int(alternate.any())):
            return state, slip
        self._times = self._times + alternate
        held = self._without_force(step, alternate, state, answer)
        stuck = alternate & (answer(held).status == STICK)
        held[~stuck] = state[~stuck]
        back = step.now.moved(step.answer.state["slip"])
        return held, slip + np.where(stuck[:, None], back, 0.0)

    def _alternate(self, step: ContactTrial) -> Flags:
        """Points that slide to and fro, (n,); takes note of this trial."""
        answer, last = step.answer, self._last
        pressing = np.einsum("nd,nd->n", answer.traction, answer.normal)[:, None] * answer.normal
        force, sliding = answer.traction - pressing, answer.status == SLIP
        back = alternate = np.zeros(len(sliding), dtype=bool)
        if last is not None:
            # friction of a gap that closes is that of a straight way, with no place to come back to
            known = step.remembers[:, 0] & np.isinf(step.closeness)
            back = known & sliding & last.points
            back &= np.einsum("nd,nd->n", force, last.force) < 0.0
            alternate = back & last.back & (self._times < MOST)
        self._last = _Sliding(sliding & ~alternate, force, back & ~alternate)
        return alternate

    def _without_force(
        self,
        step: ContactTrial,
        points: Flags,
        state: State,
        answer: Callable[[State], Response],
    ) -> State:
        """A state from which the trial has no force at these points, but for what relaxes."""
        held = state.copy()
        for _ in range(TRIES):
            pressed = held.copy()
            pressed["multiplier"][points] += PRESSED * step.answer.pressure[points]
            trial = step.now.vector(answer(pressed).state["stored"])
            trial = step.now.turned_to(step.before, trial)
            less = np.einsum("nid,nd->ni", step.before.tangents, trial)
            held["stored"][points] -= less[points]
            if not self._comm.allreduce(int((answer(held).status[points] != STICK).any())):
                break
        return held
