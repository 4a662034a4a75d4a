"""When checkpoints are written: by time, and at the end of a run what has none yet."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from copy import deepcopy
from dataclasses import dataclass
from pathlib import Path
from time import monotonic
from typing import Any

from anisocontact.mesh import Model
from anisocontact.results.checkpoint import keep_checkpoint
from anisocontact.results.files import Disk, WriteError
from anisocontact.solver.terms.persistent import Persistent

#: Least time between two checkpoints over what the last one took to write: they cost 5 % at most.
LEAST_WAIT = 20.0


@dataclass(frozen=True)
class HeldState:
    """An accepted increment without a checkpoint.

    Attributes:
        number: A number that no other one has.
        kept: State of this rank.
        facts: What else is to be kept, as JSON can have it.
    """

    number: int
    kept: Persistent
    facts: Mapping[str, Any]


class Checkpoints:
    """Writes checkpoints of accepted increments; all ranks make the same calls.

    The last increment is held in memory until it has one, so that a run that ends in order loses
    nothing.

    Args:
        folder: Results folder.
        model: The mesh.
        every: Seconds between two checkpoints; 0 for one after each increment.
    """

    def __init__(self, folder: Path, model: Model, every: float) -> None:
        self._folder, self._model, self._every = folder, model, every
        self._comm = model.mesh.comm
        self._next = monotonic()
        self._held: HeldState | None = None

    def take(self, disk: Disk, number: int, kept: Persistent, facts: Mapping[str, Any]) -> None:
        """Take an accepted increment, and write its checkpoint if one is due.

        Args:
            disk: Where failures go.
            number: A number that no other one has.
            kept: State of this rank.
            facts: What else is to be kept, as JSON can have it; not changed any more.

        Raises:
            WriteError: It cannot be written; the one before is still there.
        """
        due = self._comm.bcast(monotonic() >= self._next)  # clocks differ
        # what is written later must not go on with the run
        self._held = HeldState(number, kept if due else deepcopy(kept), facts)
        if due:
            self.write(disk)

    def write(self, disk: Disk) -> None:
        """Write a checkpoint of the last increment, unless it has one.

        Raises:
            WriteError: It cannot be written; the one before is still there.
        """
        held = self._held
        if held is None:
            return
        began = monotonic()
        keep_checkpoint(self._folder, disk, held.number, self._model, held.kept, dict(held.facts))
        self._held = None
        now = monotonic()
        self._next = now + (self._every and max(self._every, LEAST_WAIT * (now - began)))

    def rescue(self) -> None:
        """The same after something has failed, as far as it can be done."""
        numbers = self._comm.allgather(None if self._held is None else self._held.number)
        if any(number != numbers[0] for number in numbers):
            return  # some were interrupted where others had written it
        with suppress(WriteError):
            self.write(Disk(self._comm))
