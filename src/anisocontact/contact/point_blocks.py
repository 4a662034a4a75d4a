"""Forces and blocks of slave points that each have their own, on the nodes of both bodies."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from anisocontact.contact.transfer import Couplings, Transfer

Mask = npt.NDArray[np.bool_]
Floats = npt.NDArray[np.float64]


def add_rows(answer: Mapping[str, Any], forces: Floats, out: Floats) -> None:
    """Add forces on the nodes of the rows of each point.

    Args:
        answer: What the laws answered, with the "nodes" of each point, -1 for none.
        forces: The forces, (n, 3 r).
        out: Forces of the nodes, (nodes, 3).
    """
    rows = answer["nodes"][:, : forces.shape[1] // 3]
    held = rows >= 0
    np.add.at(out, rows[held], forces.reshape(*rows.shape, 3)[held])


def point_blocks(
    answer: Mapping[str, Any], touching: Mask, handed: Mask, own: int, transfer: Transfer | None
) -> Sequence[Couplings]:
    """Where `-d force / d u` of the points has entries, and the entries.

    Args:
        answer: What the laws answered, with "nodes" and "tangent" of each point.
        touching: Points in contact, (n,).
        handed: Points whose force on the master the transfer hands over, (n,).
        own: Number of nodes of a slave facet.
        transfer: Who hands forces over; None if they act at the feet of the points.

    Returns:
        Rows, columns and blocks as of `FacetContact.couplings`, with the nodes of the surface.
    """
    nodes, tangent = answer["nodes"], answer["tangent"]
    rows = nodes[:, : tangent.shape[1] // 3]
    if transfer is None:
        return [(rows[touching], nodes[touching], tangent[touching])]
    handed, kept = touching & handed, touching & ~handed
    count, unknowns = len(tangent), tangent.shape[2]
    force = -tangent[:, : 3 * own].reshape(count, own, 3, unknowns).sum(axis=1)
    return [
        (rows[kept], nodes[kept], tangent[kept]),
        (rows[handed, :own], nodes[handed], tangent[handed, : 3 * own]),
        *transfer.couplings(nodes, force, handed),
    ]
