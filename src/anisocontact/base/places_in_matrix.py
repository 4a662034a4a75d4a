"""Where the entries of a sparse matrix of PETSc stand in one that has room for more."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from anisocontact.base.array_types import Floats, Ints
from anisocontact.base.csr_blocks import CsrBlock, blocks_of, keyed_entries
from anisocontact.base.fenicsx import MPI, Mat
from anisocontact.base.petsc_calls import pattern_of


class PlacesInMatrix:
    """Copies the entries of a sparse matrix to where they stand in one that has room for more.

    Places are looked for once for a matrix and its pattern.

    Args:
        source: The matrix with the entries; its columns increase in every row, its pattern stays.

    Attributes:
        found: How often places have been looked for.

    Example:
        >>> from anisocontact.base.fenicsx import PETSc
        >>> out = PETSc.Mat().createAIJ((2, 2), csr=([0, 2, 4], [0, 1, 0, 1], [1.0, 2.0, 3.0, 4.0]))
        >>> source = PETSc.Mat().createAIJ((2, 2), csr=([0, 1, 2], [0, 1], [5.0, 6.0]))
        >>> PlacesInMatrix(source).copy(out)
        True
        >>> out.getValuesCSR()[2]
        array([5., 2., 3., 6.])
    """

    def __init__(self, source: Mat) -> None:
        self._source = source
        #: Left at a matrix under this name to know it again; it goes when the matrix does.
        self._mark, self._name = object(), f"anisocontact.places.{id(self)}"
        self._pattern: tuple[float, int] | None = None
        self._places: list[_Places] | None = None
        self.found = 0

    def copy(self, out: Mat) -> bool:
        """Write the entries of now over those that a matrix has there; collective.

        Args:
            out: The matrix; further rows and columns, behind all others, stay as they are.

        Returns:
            Whether it has all of the places; nothing is written if not.
        """
        return self._merge(out, _Places.copy)

    def add(self, out: Mat) -> bool:
        """Add the entries of now to those that a matrix has there; as `copy`."""
        return self._merge(out, _Places.add)

    def _merge(self, out: Mat, merge: Callable[[_Places, Floats, Floats], None]) -> bool:
        source, there = blocks_of(self._source), blocks_of(out)
        pattern = pattern_of(out)
        if source is None or there is None or pattern is None:
            return False
        if out.getAttr(self._name) is not self._mark or pattern != self._pattern:
            self._mark, self._pattern = object(), pattern
            self.found += 1
            self._places = self._find(source, there, out)
            out.setAttr(self._name, self._mark)
        if self._places is None:
            return False
        for places, own, room in zip(self._places, source, there, strict=True):
            with own.entries() as entries, room.entries() as into:
                merge(places, entries, into)
        return True

    def _find(
        self, source: list[CsrBlock], there: list[CsrBlock], out: Mat
    ) -> list[_Places] | None:
        """Places in all blocks; None where one is missing, on any process."""
        width = out.getSize()[1]
        aligned = self._source.getOwnershipRange()[0] == out.getOwnershipRange()[0]
        found = [_places(*pair, width) for pair in zip(source, there, strict=True) if aligned]
        places = [places for places in found if places is not None]
        comm = out.getComm().tompi4py()
        return places if comm.allreduce(len(places) == len(source), MPI.LAND) else None


@dataclass(frozen=True)
class _Places:
    """Places of entries: most rows of bodies are with contact as they are without.

    Args:
        pieces: Entries of rows that are the same in both: first there, first and end in the source.
        there: Places of the entries of other rows.
        source: Where these are in the source.
    """

    pieces: list[tuple[int, int, int]]
    there: Ints
    source: Ints

    def copy(self, source: Floats, there: Floats) -> None:
        """Write entries to their places."""
        for start, first, end in self.pieces:
            there[start : start + end - first] = source[first:end]
        there[self.there] = source[self.source]

    def add(self, source: Floats, there: Floats) -> None:
        """Add entries at their places."""
        for start, first, end in self.pieces:
            there[start : start + end - first] += source[first:end]
        there[self.there] += source[self.source]


def _places(source: CsrBlock, out: CsrBlock, width: int) -> _Places | None:
    """Places of all entries of a block; None where one is missing."""
    own, columns, room = source.starts, source.columns(), out.columns()
    rows = len(own) - 1
    if len(out.starts) <= rows:
        return None
    starts = out.starts[: rows + 1]
    same = np.diff(own) == np.diff(starts)
    edges = np.flatnonzero(np.diff(same, prepend=False, append=False))
    pieces = []
    for first, end in edges.reshape(-1, 2):
        if not np.array_equal(columns[own[first] : own[end]], room[starts[first] : starts[end]]):
            return None
        pieces.append((int(starts[first]), int(own[first]), int(own[end])))
    others = np.flatnonzero(~same)
    entries, keys = keyed_entries(others, own, columns, width)
    places, known = keyed_entries(others, starts, room, width)
    at = np.searchsorted(known, keys)
    increasing = bool(np.all(np.diff(keys) > 0) and np.all(np.diff(known) > 0))
    if not increasing or not np.array_equal(np.append(known, -1)[at], keys):
        return None
    return _Places(pieces, places[at], entries)
