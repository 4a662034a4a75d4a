"""Slave points at which the laws failed, as they can be kept in a file and evaluated alone."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from anisocontact.base.arrays import by_place
from anisocontact.base.errors import InputError
from anisocontact.contact.history import Snapshot
from anisocontact.contact.master import Master
from anisocontact.interface import FAILURE, State
from anisocontact.interface.failed_point import FailedPoint


@dataclass(frozen=True)
class LawFailures:
    """Failures of the laws in a trial, of this rank.

    Attributes:
        contact: Its name.
        master: What the points meet, where it is in the trial.
        start: History from which the trial starts, (n,).
        dt: Time increment of the trial.
    """

    contact: str
    master: Master
    start: State
    dt: float

    def first(self, trial: Snapshot) -> FailedPoint | None:
        """The first point by its place that has no answer in the trial, if one has none."""
        failure = trial.response.failure
        if not failure.any():
            return None
        failed = np.flatnonzero(failure)
        point = int(failed[by_place(trial.points[failed])[0]])
        return self._at_point(point, FAILURE[failure[point]])

    def unanswered(self) -> FailedPoint | None:
        """The first point at which a law in Python fails when it is asked alone."""
        for i in range(len(self.start)):
            point = self._at_point(i, "")
            try:
                point.evaluate()
            except InputError as error:
                return replace(point, failure=str(error))
        return None

    def _at_point(self, point: int, failure: str) -> FailedPoint:
        said = {"contact": self.contact, "point": point, "failure": failure}
        found: FailedPoint = self.master.failed_point(point, self.start, self.dt, **said)
        return found
