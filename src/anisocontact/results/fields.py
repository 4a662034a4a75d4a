"""Fields for ParaView while a run goes on: when they are due, and the files they go to."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any

from anisocontact.results.collection import Collection
from anisocontact.results.dataset import DataSet
from anisocontact.results.files import Disk
from anisocontact.solver import Accepted, Step

#: Sorts of fields, and the suffix of their files.
SUFFIXES: Mapping[str, str] = MappingProxyType(
    {"fields": ".vtu", "contact": ".vtp", "surfaces": ".vtp"}
)


class FieldFiles:
    """Writes fields where they are due.

    Args:
        folder: Where the files go.
        disk: Where failures go.
        comm: Communicator of the run.
        steps: Steps of the run.
        now: What is in the files now, by sort of fields, see `SUFFIXES`.
        every: Fields are written every so many increments, and at the end of each step.
        only: Names of the steps of which they are written; all if not given.
        times: Times from which on the next increment is written as well.
    """

    def __init__(
        self,
        folder: Path,
        disk: Disk,
        comm: Any,
        steps: Sequence[Step],
        now: Mapping[str, Callable[[], DataSet | None]],
        *,
        every: int,
        only: Sequence[str],
        times: Sequence[float],
    ) -> None:
        self._disk, self._steps, self._now = disk, steps, dict(now)
        self._every, self._only, self._times = every, list(only), list(times)
        self._files = {
            name: Collection(folder / f"{name}.pvd", SUFFIXES[name], comm) for name in self._now
        }
        self._increments = 0
        self._written = 0.0

    def state(self) -> dict[str, Any]:
        """What `resume` needs, as JSON can have it."""
        files = {name: one.state() for name, one in self._files.items()}
        return {"increments": self._increments, "written": self._written} | files

    def resume(self, state: Mapping[str, Any]) -> None:
        """Take up the files where they were."""
        self._increments, self._written = state["increments"], state["written"]
        for name, files in self._files.items():
            files.resume(state[name])
            self._disk.write(files.tidy)

    def write(self, at: float) -> None:
        """Write all fields as they are at a time."""
        for name, files in self._files.items():
            files.add(self._disk, at, self._now[name]())
        self._written = at

    def accept(self, accepted: Accepted, before: float) -> None:
        """Write the fields of an accepted increment, which began at `before`, if they are due."""
        if accepted.done == 1.0:
            self._increments += 1
        if self._is_due(accepted, before):
            self.write(accepted.time)

    def close(self, at: float) -> None:
        """Write the fields of the end, unless they are there."""
        if self._written != at:
            self.write(at)

    def _is_due(self, accepted: Accepted, before: float) -> bool:
        if any(before < time <= accepted.time for time in self._times):
            return True
        step = self._steps[accepted.step_index]
        if accepted.event:
            return not self._only or step.name in self._only
        if accepted.done < 1.0 or (self._only and step.name not in self._only):
            return False
        return accepted.increment == step.increments or self._increments % self._every == 0
