"""Long tables of which every process has a block of rows: who has a row, and how to get at it."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from anisocontact.base.array_types import Flags, Ints

type Rows = npt.NDArray[Any]


class Route:
    """Rows that go to other processes, and answers that come back.

    Args:
        comm: Communicator; every call is collective.
        to: Process to which each row goes, (rows,).
    """

    def __init__(self, comm: Any, to: Ints) -> None:
        self._comm = comm
        if comm.size > 1:
            self._order = np.argsort(to, kind="stable")
            self._sent = np.bincount(to, minlength=comm.size)
            self._got = np.empty_like(self._sent)
            comm.Alltoall(self._sent, self._got)

    def there(self, rows: Rows) -> Rows:
        """Rows that come to this process, those of the first process first."""
        if self._comm.size == 1:
            return rows
        return self._exchanged(rows[self._order], self._sent, self._got)

    def back(self, answers: Rows) -> Rows:
        """Answers to the rows that this process has sent, in the order of these.

        Args:
            answers: To the rows that came to this process, (rows there, ...).
        """
        if self._comm.size == 1:
            return answers
        out = np.empty((len(self._order), *answers.shape[1:]), answers.dtype)
        out[self._order] = self._exchanged(answers, self._got, self._sent)
        return out

    def _exchanged(self, rows: Rows, sent: Ints, got: Ints) -> Rows:
        width = int(np.prod(rows.shape[1:]))
        out = np.empty((int(got.sum()), *rows.shape[1:]), rows.dtype)
        given = np.ascontiguousarray(rows)
        self._comm.Alltoallv([given, sent * width], [out, got * width])
        return out


class Split:
    """Rows numbered from the first to the last process.

    Args:
        comm: Communicator; the call is collective, and so are those of `fetch` and `marked`.
        count: Rows of this process.

    Attributes:
        first: Number of the first row of this process.
        total: Rows of all processes.
    """

    def __init__(self, comm: Any, count: int) -> None:
        self._comm = comm
        self._count = count
        self._starts = np.cumsum([0, *comm.allgather(count)])
        self.first = int(self._starts[comm.rank])
        self.total = int(self._starts[-1])

    @cached_property
    def numbers(self) -> Ints:
        """Numbers of the rows of this process."""
        return np.arange(self.first, self.first + self._count)

    def owner(self, numbers: Ints) -> Ints:
        """Process that has each of these rows."""
        return np.searchsorted(self._starts, numbers, side="right") - 1

    def fetch(self, values: Rows, numbers: Ints) -> Rows:
        """Rows of all processes.

        Args:
            values: Rows of this process, (rows, ...).
            numbers: Rows that this process wants, of any shape.

        Returns:
            The rows, in the shape of `numbers`.
        """
        if self._comm.size == 1:
            return np.asarray(values[numbers])
        asked, place = np.unique(numbers, return_inverse=True)
        route = Route(self._comm, self.owner(asked))
        found = route.back(values[route.there(asked) - self.first])
        return np.asarray(found[place.reshape(numbers.shape)])

    def marked(self, numbers: Ints) -> Flags:
        """Which rows of this process any process has named, (rows,)."""
        mask = np.zeros(self._count, dtype=np.bool_)
        asked = np.unique(numbers) if self._comm.size > 1 else numbers
        mask[Route(self._comm, self.owner(asked)).there(asked) - self.first] = True
        return mask


def arranged(comm: Any, total: int, numbers: Ints, *tables: Rows) -> list[Rows]:
    """Rows in order, an even share of them on every process.

    Args:
        comm: Communicator; the call is collective.
        total: Rows of all processes.
        numbers: Number of each row that this process has, each of 0 to total - 1 on one of them.
        tables: Tables with these rows.

    Returns:
        The tables, from row `rank * total // size` on.
    """
    starts = np.arange(comm.size + 1) * total // comm.size
    route = Route(comm, np.searchsorted(starts, numbers, side="right") - 1)
    order = np.argsort(route.there(numbers), kind="stable")
    return [route.there(table)[order] for table in tables]


def share_of(comm: Any, total: int) -> tuple[int, int]:
    """First row of this process and the one after its last, of so many in all."""
    return comm.rank * total // comm.size, (comm.rank + 1) * total // comm.size
