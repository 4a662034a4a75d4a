"""Fields for ParaView while a run goes on: when they are due, and the files they go to."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any

from anisocontact.results.collection import Collection
from anisocontact.results.dataset import DataSet
from anisocontact.results.files import Disk
from anisocontact.results.output_options import OutputOptions
from anisocontact.solver import Accepted, Step

#: Sorts of fields, and the suffix of their files.
SUFFIXES: Mapping[str, str] = MappingProxyType(
    {"fields": ".vtu", "contact": ".vtp", "surfaces": ".vtp"}
)


#: Difference of times over themselves that is the round-off of a sum of steps.
_SAME = 1e-9


class FieldFiles:
    """Writes fields where they are due.

    Args:
        folder: Where the files go.
        disk: Where failures go.
        steps: Steps of the run.
        now: What is in the files now, by sort of fields, see `SUFFIXES`.
        options: When they are due.
    """

    def __init__(
        self,
        folder: Path,
        disk: Disk,
        steps: Sequence[Step],
        now: Mapping[str, Callable[[], DataSet | None]],
        options: OutputOptions,
    ) -> None:
        self._disk, self._steps, self._now = disk, steps, dict(now)
        self._options = options
        self._files = {
            name: Collection(folder / f"{name}.pvd", SUFFIXES[name], disk.comm)
            for name in self._now
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
        options, step = self._options, self._steps[accepted.step_index]
        begun, ended = before + _SAME * abs(before), accepted.time + _SAME * abs(accepted.time)
        if any(begun < time <= ended for time in options.times):
            return True
        if options.steps and step.name not in options.steps:
            return False
        if accepted.event:
            return True
        last = accepted.increment == step.increments
        return accepted.done == 1.0 and (last or self._increments % options.every == 0)
