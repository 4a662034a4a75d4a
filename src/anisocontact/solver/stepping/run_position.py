"""How far a run has come: its step, increment and sub-increment, and what it goes on from there."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field, fields
from typing import Self

import numpy as np

from anisocontact.base.fenicsx import Vec
from anisocontact.base.limits import Limits
from anisocontact.solver.stepping.attempts import Outcome
from anisocontact.solver.stepping.events import EventWatch
from anisocontact.solver.stepping.increment_control import IncrementControl
from anisocontact.solver.terms.persistent import Arrays, under
from anisocontact.solver.terms.step import Step

#: What names of numbers in a checkpoint begin with.
PLACE = "place."


@dataclass
class RunPosition:
    """How far a run has come.

    Attributes:
        step: Number of the step, from 0.
        time: Time at which it began.
        control: Increments and sub-increments of it.
        begun: Whether the problem has the loads of the step.
        before: State before the last accepted sub-increment of this step; None at its beginning.
        spent: Newton iterations since the last accepted sub-increment.
        lost: What came of a sub-increment of this increment in which equilibrium was lost for good.
        stopped: Fractions at which steps that an event ended did, by number.
        events: Looks for the event of the step; None before it has begun.
    """

    step: int
    time: float
    control: IncrementControl
    begun: bool = False
    before: Vec | None = None
    spent: int = 0
    lost: Outcome | None = None
    stopped: dict[int, float] = field(default_factory=dict)
    events: EventWatch | None = None

    @classmethod
    def beginning(cls, step: int, time: float, limits: Limits) -> Self:
        """The beginning of a step.

        Args:
            step: Its number.
            time: Time at which it begins.
            limits: Bounds of its increments.
        """
        return cls(step, time, IncrementControl(limits, limits.largest))

    @classmethod
    def restored(cls, common: Arrays, limits: Limits) -> Self:
        """The position that `persistent` has written, without `before`.

        Args:
            common: What all ranks have in common.
            limits: Bounds of the increments.
        """
        numbers = {name: value.item() for name, value in under(PLACE, common).items()}
        own = {one.name for one in fields(IncrementControl)} & numbers.keys()
        control = IncrementControl(limits, **{name: numbers[name] for name in own})
        stopped = {int(i): float(factor) for i, factor in common["stopped"]}
        return cls(
            numbers["step"], numbers["time"], control, bool(numbers["begun"]), stopped=stopped
        )

    @property
    def ended_at(self) -> float | None:
        """Fraction of the step at which an event has ended it; None where none has."""
        return self.stopped.get(self.step)

    def after(self, step: Step) -> Self:
        """The beginning of the next step, once this one is done or an event has ended it."""
        end = self.ended_at
        time = self.time + (1.0 if end is None else end) * step.duration
        found = self.beginning(self.step + 1, time, self.control.limits)
        found.stopped = self.stopped
        return found

    def persistent(self) -> Arrays:
        """Where the run goes on, as arrays by name; `before` belongs to the nodes."""
        numbers = asdict(self.control)
        del numbers["limits"]
        numbers |= {"step": self.step, "time": self.time, "begun": self.begun}
        found = {f"{PLACE}{name}": np.array(value) for name, value in numbers.items()}
        found["stopped"] = np.array([*self.stopped.items()]).reshape(-1, 2)
        return found | ({} if self.events is None else self.events.persistent())

    @property
    def steps_begun(self) -> int:
        """Number of steps whose loads the problem has had."""
        return self.step + self.begun

    def reached(self, step: Step) -> float:
        """Fraction of the step of the accepted state."""
        return fraction(step, self.control.increment, self.control.done)

    def time_at(self, step: Step, increment: int, done: float) -> float:
        """Time at a share of an increment of the step."""
        return self.time + increments_done(increment, done) * (step.duration / step.increments)


def increments_done(increment: int, done: float) -> float:
    """Increments from the beginning of the step to a share of one of them.

    Args:
        increment: Its number, from 1.
        done: The share, 0 to 1.
    """
    return increment if done == 1.0 else increment - 1 + done


def fraction(step: Step, increment: int, done: float) -> float:
    """Fraction of a step at a share of one of its increments, see `increments_done`."""
    return increments_done(increment, done) / step.increments
