"""Rows of nodes that follow a rigid body, handed to the body before they get into a matrix.

A node of a body that follows as a whole has no stiffness of its own: what contacts have in its row
goes to the rows of the rigid body, and the row keeps nothing but its constraint.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from anisocontact.base.array_types import Floats, Ints, Locals
from anisocontact.contact.quadrature import Couplings
from anisocontact.contact.reachable import NodePairs


@dataclass(frozen=True)
class HandedRows:
    """Nodes whose rows go to one rigid body.

    Attributes:
        place: Of every node that couplings can name its place in `gathering`, -1 of others.
        gathering: From the force on a node to force and moment of the body, transposed, (n, 3, 6).
        body: What couplings call the two nodes of the body.
    """

    place: Ints
    gathering: Floats
    body: Locals

    def couplings(self, given: Sequence[Couplings]) -> list[Couplings]:
        """The same blocks without rows of these nodes."""
        out: list[Couplings] = []
        for rows, columns, values in given:
            place = self._places(rows)
            there = np.flatnonzero((place >= 0).any(axis=1))
            if not len(there):
                out.append((rows, columns, values))
                continue
            out.append((_without(rows, place), columns, values))
            own = np.where((place >= 0)[there, :, None, None], self.gathering[place[there]], 0.0)
            shape = (len(there), 3 * rows.shape[1], 6)
            handed = own.reshape(shape).swapaxes(1, 2) @ _by_rows(values[there])
            out.append((self._body_rows(len(there)), columns[there], handed))
        return out

    def pairs(self, given: Sequence[NodePairs]) -> list[NodePairs]:
        """The same pairs of nodes without rows of these nodes."""
        out: list[NodePairs] = []
        reached = [np.zeros(0, dtype=np.int32)]
        for rows, columns in given:
            place = self._places(rows)
            out.append((_without(rows, place), columns))
            reached.append(columns[(place >= 0).any(axis=1)].ravel())
        nodes = np.unique(np.concatenate(reached)).astype(np.int32)[:, None]
        return [*out, (self._body_rows(len(nodes)), nodes)]

    def _places(self, rows: Locals) -> Ints:
        return np.where(rows >= 0, self.place[rows], -1)

    def _body_rows(self, count: int) -> Locals:
        return np.tile(self.body, (count, 1))


def _without(rows: Locals, place: Ints) -> Locals:
    return np.where(place >= 0, -1, rows).astype(np.int32)


def _by_rows(values: Floats) -> Floats:
    """Blocks as whole rows, (p, 3 r, 3 c)."""
    if values.ndim == 3:
        return values
    count, r, c = values.shape[:3]
    return values.reshape(count, r, c, 3, 3).swapaxes(2, 3).reshape(count, 3 * r, 3 * c)
