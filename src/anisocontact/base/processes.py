"""Processes that a launcher such as mpirun has started together: one message, one end, no hang."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable
from io import StringIO
from typing import Any, cast

from anisocontact.base.errors import InputError

#: What launchers tell each of several processes: MPICH and Slurm, PMIx, Open MPI.
_TOLD = ("PMI_RANK", "PMI_FD", "PMIX_RANK", "OMPI_COMM_WORLD_RANK")
#: How long a process that has failed waits for the others, s: they may be stuck in an exchange.
PATIENCE = 5.0
#: How often it looks, s.
_LOOK = 0.01


class Together:
    """Processes of a run, and how they end together.

    Args:
        comm: Communicator; the call is collective.

    Attributes:
        rank: Number of this process.
        size: How many there are.
        apart: Whether some did not come when this one waited: no call that all have to make may
            follow.
    """

    def __init__(self, comm: Any) -> None:
        self.rank = int(comm.rank)
        self.size = int(comm.size)
        # one of its own: the others may be in the middle of something else
        self._comm = comm.Dup() if comm.size > 1 else comm
        self.apart = False
        self._said: StringIO | None = None

    def met(self, code: int = 1, patience: float = PATIENCE) -> list[int] | None:
        """Wait until all processes have come here.

        Args:
            code: What this one tells the others.
            patience: How long it waits, s.

        Returns:
            What all have told, by rank; None if some have not come, now or before.
        """
        if self.size == 1:
            return [code]
        if self.apart:
            return None
        request, found = _exchange(self._comm, code)
        end = time.monotonic() + patience
        while not request.Test():
            if time.monotonic() > end:
                self.apart = True
                return None
            time.sleep(_LOOK)
        codes: list[int] = found.tolist()
        return codes

    def quiet(self) -> None:
        """Let the first process speak for all: what others print is kept until `finish`."""
        if self.rank > 0:
            self._said = StringIO()
            sys.stdout = open(os.devnull, "w")  # noqa: SIM115 (for good)
            sys.stderr = self._said

    def finish(self, code: int) -> int:
        """End together; where others are stuck, they are ended.

        The first process that failed is the one that is heard.

        Args:
            code: Exit code of this process, 0 if it is done.

        Returns:
            Exit code for all of them.
        """
        if self.size == 1:
            return code
        codes = self.met(code, PATIENCE if code else float("inf"))
        if codes is None:
            self._speak()
            os.dup2(os.open(os.devnull, os.O_WRONLY), 2)  # one line says why, MPI need not add one
            self._comm.Abort(code)
            return code
        failed = [rank for rank, one in enumerate(codes) if one]
        if not failed:
            return 0
        if self.rank == failed[0]:
            self._speak()
        return codes[failed[0]]

    def _speak(self) -> None:
        if self._said is not None and sys.__stderr__ is not None:
            sys.__stderr__.write(self._said.getvalue())
            sys.__stderr__.flush()


def on_all[T](comm: Any, ask: Callable[[], T]) -> T:
    """What is asked on every rank; a mistake of one is raised on all, which would wait for it.

    Args:
        comm: Communicator; the call is collective.
        ask: What may raise an `InputError` on some ranks.

    Raises:
        InputError: That of the first rank that has one.
    """
    if comm.size == 1:
        return ask()
    answer: T | None = None
    said: tuple[str, str] | None = None
    try:
        answer = ask()
    except InputError as mistake:
        said = str(mistake), mistake.field
    first = next((one for one in comm.allgather(said) if one is not None), None)
    if first is not None:
        raise InputError(*first)
    return cast(T, answer)


def launched() -> bool:
    """Whether a launcher has started this process; others may be beside it."""
    return any(name in os.environ for name in _TOLD)


def started_together() -> Together | None:
    """The processes a launcher has started beside this one.

    Nothing of MPI is loaded for a process that is alone.

    Returns:
        The processes; None without a launcher, or without MPI.
    """
    if not launched():
        return None
    try:
        from anisocontact.base.fenicsx import MPI
    except ImportError:  # the command says what it lacks
        return None
    return Together(MPI.COMM_WORLD)


def _exchange(comm: Any, code: int) -> tuple[Any, Any]:
    """A request that is done when all codes are there, and the codes."""
    import numpy as np

    mine, found = np.array([code]), np.zeros(comm.size, dtype=np.int64)
    return comm.Iallgather(mine, found), found
