"""Where couplings of nodes go in a matrix of the contact unknowns."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy

from anisocontact import _core
from anisocontact.base.array_types import Flags, Floats, Ints, Locals
from anisocontact.contact.quadrature import Couplings

#: Slave nodes, master nodes and their shares, as of `Contacts.opposite`.
OppositeNodes = tuple[Locals | Ints, Locals | Ints, Floats]


class AssemblyMap:
    """Where couplings of nodes go in a matrix of the contact unknowns.

    They are found once for couplings of the same nodes, which most iterations have.

    Args:
        number: Row and column of each unknown of the nodes, -1 for those without, (n,).
    """

    def __init__(self, number: Ints) -> None:
        # one more node stands for "no node"
        self._number = np.append(number, [-1] * 3).reshape(-1, 3)
        self._keys: Ints = np.full(1, -1)

    def total(self, couplings: Sequence[Couplings], size: int) -> scipy.sparse.csr_array:
        """The sum of all couplings, (size, size)."""
        nodes = len(self._number)
        keys, blocks = [np.zeros(0, np.int64)], [np.zeros((0, 9))]
        for rows, columns, values in couplings:
            row, column = (side.astype(np.int64) % nodes for side in (rows, columns))
            keys.append((row[:, :, None] * nodes + column[:, None, :]).ravel())
            blocks.append(_pairs(values, rows.shape[1], columns.shape[1]))
        key = np.concatenate(keys)
        if not np.array_equal(key, self._keys):
            self._locate(key, size)
        if not len(key):
            return scipy.sparse.csr_array((size, size))
        sums = self._sum @ np.concatenate(blocks)
        number, columns, begin = self._entry
        return scipy.sparse.csr_array((sums.ravel()[number], columns, begin), shape=(size, size))

    def shares(
        self, opposite: Sequence[OppositeNodes], size: int
    ) -> tuple[scipy.sparse.csr_array, Flags]:
        """How unknowns of slave nodes follow those of what is opposite to them.

        Args:
            opposite: What slave nodes are held against.
            size: Number of unknowns of the matrix.

        Returns:
            Shares in single precision, (size, size), without rows of unknowns that follow slave
            nodes; and which unknowns are those of slave nodes.
        """
        slaves = np.zeros(size + 1, dtype=np.bool_)
        for slave, _, _ in opposite:
            slaves[self._number[slave]] = True
        slaves = slaves[:size]
        if not opposite:
            return self.following(opposite, size), slaves
        found = self.following(opposite, size).tocoo()
        again = np.isin(found.row, found.row[slaves[found.col]])
        parts = (found.data[~again], (found.row[~again], found.col[~again]))
        return scipy.sparse.csr_array(parts, shape=(size, size)), slaves

    def following(self, opposite: Sequence[OppositeNodes], size: int) -> scipy.sparse.csr_array:
        """Shares of unknowns in those of nodes that follow them, single precision, (size, size)."""
        if not opposite:
            return scipy.sparse.csr_array((size, size), dtype=np.float32)
        rows, columns = np.zeros(0, np.int64), np.zeros(0, np.int64)
        values = np.zeros(0, np.float32)
        for slave, masters, shares in opposite:
            row, column, share = np.broadcast_arrays(
                self._number[slave][:, None],
                self._number[masters],
                shares[..., None].astype(np.float32),
            )
            there = (row >= 0) & (column >= 0) & (share != 0.0)
            rows, columns = np.append(rows, row[there]), np.append(columns, column[there])
            values = np.append(values, share[there])
        # numbers as in `total`: SciPy would convert one of the two for every product
        places = tuple(one.astype(np.int32) for one in (rows, columns))
        return scipy.sparse.csr_array((values, places), shape=(size, size))

    def _locate(self, key: Ints, size: int) -> None:
        """Sort pairs of nodes, each of them a number."""
        self._keys = key
        order = np.argsort(key, kind="stable")
        first = np.flatnonzero(np.diff(key[order], prepend=-1))
        starts = np.append(first, len(key))
        self._sum = scipy.sparse.csr_array(
            (np.ones(len(key)), order, starts), shape=(len(first), len(key))
        )
        row, column = np.divmod(key[order][first], len(self._number))
        self._entry = _core.block_entries(row, column, self._number, size)


def _pairs(values: Floats, r: int, c: int) -> Floats:
    """Blocks of `Couplings` of r by c nodes as those of their pairs, (p r c, 9)."""
    if values.ndim == 3:
        values = values.reshape(-1, r, 3, c, 3).swapaxes(2, 3)
    return values.reshape(-1, 9)
