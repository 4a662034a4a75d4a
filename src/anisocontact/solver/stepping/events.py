"""Events that end a step: the sub-increment in which one happens is cut until it is met."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from anisocontact.base.arrays import answered
from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import Vec
from anisocontact.base.python_file import called
from anisocontact.base.until import Until
from anisocontact.base.words import hint
from anisocontact.contact import Contact
from anisocontact.solver.stepping.acceptance import Refusal
from anisocontact.solver.system.problem import Problem
from anisocontact.solver.system.reduction import Reduction
from anisocontact.solver.terms.loads import node_shares
from anisocontact.solver.terms.persistent import Arrays
from anisocontact.solver.terms.step import Step

#: Value of a state, the trial at these unknowns or the accepted one; collective.
type _Measure = Callable[[Vec | None], float]
#: Share of what is left to where it has happened that a sub-increment has at least, and leaves at
#: least.
_BESIDE = 0.02
#: Sub-increments below this share of an increment are rounding.
_ROUNDING = 1e-9
#: What is measured where friction cannot hold the loads.
_SLID = np.inf


@dataclass(frozen=True)
class _Beyond:
    """A trial in which the event has happened.

    Attributes:
        end: Share of the increment.
        value: What was measured there.
    """

    end: float
    value: float


class EventWatch:
    """Looks for the event of a step in its trials, and says where sub-increments are to end.

    A value is found by secants, with every second sub-increment half of what is left; what becomes
    of a contact by halves. Sliding has come as well where loads are met that friction holds no
    longer, see `overload`: there is no equilibrium beyond, and the step ends before them.

    Args:
        problem: The problem, where the step begins.
        step: The step.
        smallest: Smallest sub-increment.

    Attributes:
        happened: Whether the accepted state has the event.
        objects: Whether the last trial went beyond it.

    Raises:
        InputError: The problem has no such contact or group.
    """

    def __init__(self, problem: Problem, step: Step, smallest: float) -> None:
        self.happened = self.objects = False
        self._part = self._end = 1.0
        self._until = until = step.until
        self._finest = max(smallest, _ROUNDING)
        if until is None:
            return
        if until.event is not None:
            self._finest = max(self._finest, until.tolerance)
        field = f"step {step.name!r}.until"
        self._measure = _measure(problem, until, field)
        self._contact = None if until.event is None else _contact(problem, until, field)
        self._last = self._trial = self._measure(None)
        self._wanted = 0.0 if until.value is None else until.value
        scale = max(abs(self._wanted), abs(self._wanted - self._last))
        self._near = 0.0 if until.value is None else until.tolerance * scale
        self._side = self._arm()
        self._beyond: _Beyond | None = None
        self._halved = True

    def persistent(self) -> Arrays:
        """What the next sub-increments depend on."""
        if self._until is None:
            return {}
        beyond = (
            (np.nan, np.nan) if self._beyond is None else (self._beyond.end, self._beyond.value)
        )
        return {"event": np.array([self._side, self._near, *beyond, float(self._halved)])}

    def restore(self, kept: Arrays) -> None:
        """Go on from what `persistent` gave."""
        if self._until is not None and "event" in kept:
            self._side, self._near, end, value, halved = kept["event"].tolist()
            self._beyond = None if np.isnan(end) else _Beyond(end, value)
            self._halved = bool(halved)

    @property
    def waits(self) -> bool:
        """Whether there is an event that has not come."""
        return self._until is not None and not self.happened

    @property
    def text(self) -> str:
        """What it is, in words."""
        return "" if self._until is None else self._until.text

    def goal(self, done: float) -> float:
        """Where the next sub-increment is to end; 0 where nothing is known.

        Args:
            done: Share of the increment that is done.
        """
        if self._until is None or self._beyond is None:
            return 0.0
        left, self._halved = self._beyond.end - done, not self._halved
        share = 0.5
        if self._until.event is not None:
            # smaller sub-increments have led to another history, in which it has not happened yet
            share = 1.0 if left < 0.5 * self._finest and self._beyond.value != _SLID else 0.5
        elif not self._halved:
            way = self._beyond.value - self._last
            share = float(np.clip((self._wanted - self._last) / way, _BESIDE, 1.0 - _BESIDE))
        return done + share * left

    def slides(self) -> Contact | None:
        """The contact whose sliding is waited for, if it is."""
        until = self._until
        if until is None or until.event != "sliding" or self.happened or self._side == 0.0:
            return None
        return self._contact

    def overload(self) -> bool:
        """Friction does not hold the loads at the end of the trial: the event comes before.

        Returns:
            Whether a smaller sub-increment is to be tried; none where friction is at its limit by
            now.
        """
        self.objects, self._beyond = self._part > _ROUNDING, _Beyond(self._end, _SLID)
        return self.objects

    def begin(self, part: float, end: float) -> None:
        """A sub-increment is tried.

        Args:
            part: Its size, share of an increment.
            end: Where it ends, share of the increment.
        """
        self._part, self._end, self.objects = part, end, False

    def objection(self, x: Vec) -> Refusal | None:
        """Why a trial in equilibrium is to be cut; None where it may be accepted. Collective.

        Args:
            x: All unknowns.
        """
        self.objects = False
        if self._until is None:
            return None
        self._trial = self._measure(x)
        over = self._side * (self._trial - self._wanted)
        self.objects = over > self._near and self._part > self._finest
        if not self.objects:
            return None
        self._beyond = _Beyond(self._end, self._trial)
        return Refusal(f"goes beyond where {self.text}")

    def accept(self, ends: bool) -> None:
        """The trial has been accepted.

        Args:
            ends: Whether an increment ends with it.
        """
        if self._until is None:
            return
        self._last = self._trial
        self.happened = self._side != 0.0 and (
            self._side * (self._last - self._wanted) >= -self._near or self._at_limit()
        )
        self._side = self._side or self._arm()
        if ends or (self._beyond is not None and self._end >= self._beyond.end):
            self._beyond, self._halved = None, True

    def _at_limit(self) -> bool:
        """Whether friction holds no loads beyond the accepted state, but for the tolerance."""
        if self._until is None or self._beyond is None or self._beyond.value != _SLID:
            return False
        return self._beyond.end - self._end <= self._finest

    def _arm(self) -> float:
        """From which side the event can come: 0 where the value is there already."""
        apart = self._wanted - self._last
        if self._until is not None and self._until.event is not None:
            return max(float(np.sign(apart)), 0.0)
        return float(np.sign(apart)) if abs(apart) > self._near else 0.0


def check_events(problem: Problem, steps: Sequence[Step]) -> None:
    """Go through the events of all steps without solving.

    Raises:
        InputError: The problem has no such contact, or no such group.
    """
    supported = list(problem.holding)
    for step in steps:
        supported += step.prescribed_groups()
        until, field = step.until, f"step {step.name!r}.until"
        if until is None:
            continue
        if until.reaction is None:
            measure = _measure(problem, until, field)
            if until.measure is not None:  # what is asked for may not be there
                measure(None)
        elif until.reaction not in supported:
            known = ", ".join(dict.fromkeys(supported)) or "none"
            text = f"{until.reaction!r} given, what holds the bodies: {known}"
            raise InputError(text, f"{field}.reaction")


def _measure(problem: Problem, until: Until, field: str) -> _Measure:
    """What is looked at: a value, or of what becomes of a contact 1 if it is so and else -1."""
    if until.event is not None:
        contact, so = _contact(problem, until, field), _STATES[until.event]
        return lambda x: 1.0 if so(contact.counts()) else -1.0
    if until.measure is not None:
        return lambda x: _of_problem(problem, until, x, field)
    direction = None
    if until.along is not None:
        direction = np.array(until.along) / np.linalg.norm(until.along)

    def of(vector: np.ndarray) -> float:
        return float(np.linalg.norm(vector) if direction is None else direction @ vector)

    if until.contact is not None:
        contact, comm = _contact(problem, until, field), problem.comm
        return lambda x: of(comm.allreduce(contact.wrench(contact.current, np.zeros(3))[:3]))
    if until.displacement is not None:
        group = until.displacement
        weights = node_shares(problem.model, group, f"{field}.displacement")
        return lambda x: of(_bulk(problem, x).mean(group, weights, x))
    group = str(until.reaction)
    return lambda x: of(problem.reactions(x).get(group, np.zeros(3)))


def _of_problem(problem: Problem, until: Until, x: Vec | None, field: str) -> float:
    """A function of the problem at a trial of all unknowns, or at the accepted state.

    Raises:
        InputError: It failed, or returned something else than a finite number.
    """
    assert until.measure is not None
    if x is not None:
        problem.evaluate_at(x)
    field = f"{field}.measure"
    with problem.asked_at(x):
        found = called(until.measure, problem, x is not None, who=until.name, field=field)
    value = float(answered(found, (), until.name, field))
    if not math.isfinite(value):
        raise InputError(f"{until.name} returned {value}, a finite number needed", field)
    return value


def _bulk(problem: Problem, x: Vec | None) -> Reduction:
    """Who answers for the bulk: of the accepted state a reduction may not know the step yet."""
    if x is not None:
        return problem.reduction
    problem.reduction.recover()
    return problem.whole


def _contact(problem: Problem, until: Until, field: str) -> Contact:
    found = [c for c in problem.contacts if until.contact in (c.name, c.slave)]
    if len(found) == 1:
        return found[0]
    known = [contact.name for contact in problem.contacts]
    names = dict.fromkeys([*known, *(c.slave for c in problem.contacts)])
    near = hint(until.contact or "", names, "allowed")
    raise InputError(f"{until.contact!r} given; {near}", f"{field}.contact")


#: When it is so, by the numbers of points by status.
_STATES: dict[str, Callable[[Mapping[str, int]], bool]] = {
    "closed": lambda points: points["stick"] + points["slip"] > 0,
    "lost": lambda points: points["stick"] + points["slip"] == 0,
    "slipping": lambda points: points["slip"] > 0,
    "sliding": lambda points: points["slip"] > 0 and points["stick"] == 0,
}
