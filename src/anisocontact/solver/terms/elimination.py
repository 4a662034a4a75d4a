"""Conditions on the displacement of single nodes, solved for some of its components."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from anisocontact.base.array_types import Flags, Floats

#: Share of a direction that counts as none of it along an axis.
NO_SHARE = 1e-9


@dataclass(frozen=True)
class Elimination:
    """Conditions `e_r . u = g_r` of m nodes, R each, as `u_s = c . u + gain . g`.

    Attributes:
        slave: Components that follow from the others, (m, 3).
        follow: The c of these, zero in the slaves themselves, (m, 3, 3).
        gain: Their dependence on the values, (m, 3, R).
        rows: The conditions after the elimination, (m, R, 3).
        open: Conditions that prescribed components meet or contradict, (m, R).
        values: How the values of `rows` follow from the g, (m, R, R).
        share: Force on the node -> force of each condition along its direction, (m, R, 3).
    """

    slave: Flags
    follow: Floats
    gain: Floats
    rows: Floats
    open: Flags
    values: Floats
    share: Floats

    def left(self, prescribed: Floats, given: Floats) -> Floats:
        """How far the open conditions are from met by what is prescribed, (m, R), length.

        Args:
            prescribed: Prescribed components, zero where there is none, (m, 3), length.
            given: The g, (m, R), length.
        """
        off = (self.rows @ prescribed[..., None])[..., 0] - (self.values @ given[..., None])[..., 0]
        return np.asarray(np.where(self.open, off, 0.0))


def eliminated(directions: Floats, held: Flags) -> Elimination:
    """Solve the conditions of every node: Gauss-Jordan elimination with the largest pivot.

    Args:
        directions: The e, zero where a node has fewer conditions, (m, R, 3).
        held: Components that supports prescribe: they do not follow, (m, 3).

    Returns:
        What follows from what.

    Example:
        >>> plane = eliminated(np.array([[[0.6, 0.8, 0.0]]]), np.zeros((1, 3), dtype=bool))
        >>> plane.slave[0].tolist(), (plane.follow[0, 1].round(3) + 0.0).tolist()
        ([False, True, False], [-0.75, 0.0, 0.0])
    """
    count, most = directions.shape[:2]
    rows, values = directions.copy(), np.tile(np.eye(most), (count, 1, 1))
    row_of = np.full((count, 3), -1)
    is_open, allowed = np.ones((count, most), dtype=bool), ~held
    for _ in range(3 if most else 0):
        sizes = (np.abs(rows) * is_open[:, :, None] * allowed[:, None]).reshape(count, -1)
        which = sizes.argmax(axis=1)
        n = np.flatnonzero(sizes[np.arange(count), which] >= NO_SHARE)
        row, column = np.divmod(which[n], 3)
        pivot = rows[n, row, column]
        for table in (rows, values):
            table[n, row] /= pivot[:, None]
        factors = rows[n, :, column]
        factors[np.arange(len(n)), row] = 0.0
        for table in (rows, values):
            table[n] -= factors[:, :, None] * table[n, row][:, None]
        row_of[n, column] = row
        is_open[n, row], allowed[n, column] = False, False
    slave = row_of >= 0
    at = np.arange(count)[:, None], np.maximum(row_of, 0)
    follow = np.where(slave[:, :, None] & ~slave[:, None], -rows[at] if most else 0.0, 0.0)
    gain = np.where(slave[:, :, None], values[at], 0.0) if most else np.zeros((count, 3, 0))
    used = np.where(is_open[:, :, None], 0.0, directions)
    there = np.concatenate([used, np.eye(3) * held[:, :, None]], axis=1)
    share = np.linalg.pinv(there.swapaxes(1, 2))[:, :most]
    return Elimination(slave, follow, gain, rows, is_open, values, share)
