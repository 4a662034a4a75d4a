"""Analytic masters for ParaView: patches of surfaces where rigid bodies have brought them."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from anisocontact.anisotropy import DirectionField
from anisocontact.base.array_types import Floats, Locals
from anisocontact.contact import Contact
from anisocontact.results.dataset import DataSet, polygons
from anisocontact.results.quantities import PATCH, arrays

#: Points of a patch along each coordinate.
POINTS = 33
#: What an endless surface reaches beyond the slave points, over their extent.
MARGIN = 0.5


class MasterPatches:
    """Patches of the analytic masters of a problem.

    A coordinate that ends or closes is shown whole, an endless one around the feet of the slave
    points at the start.

    Args:
        contacts: All contacts; those with a meshed master have no patch.
        comm: Communicator of the mesh.
        chosen: Quantities to write; all if not given.
    """

    def __init__(
        self, contacts: Iterable[Contact], comm: Any, chosen: Collection[str] = ()
    ) -> None:
        self._chosen = chosen
        self._first = comm.rank == 0
        self._patches = [
            (number, contact, _patch(contact, comm))
            for number, contact in enumerate(contacts)
            if not contact.meshed
        ]

    def mesh(self) -> DataSet | None:
        """The patches of the accepted state; None without one, and but on the first rank."""
        if not (self._first and self._patches):
            return None
        corners = np.arange(POINTS * POINTS).reshape(POINTS, POINTS)
        ring = (corners[:-1, :-1], corners[1:, :-1], corners[1:, 1:], corners[:-1, 1:])
        faces = np.stack(ring, axis=-1).reshape(-1, 4)
        moved = [_moved(number, contact, *drawn) for number, contact, drawn in self._patches]
        starts = POINTS * POINTS * np.arange(len(moved))
        return DataSet(
            "PolyData",
            np.concatenate([patch.points for patch in moved]),
            polygons(np.concatenate([faces + start for start in starts])),
            arrays(PATCH, moved, self._chosen),
        )


@dataclass(frozen=True)
class MasterPatch:
    """A patch of an analytic master where it is now.

    Attributes:
        numbers: Number of the contact, (n,).
        points: Positions, (n, 3), length.
        directions: First axes of friction, zero where there are none, (n, 3).
    """

    numbers: Locals
    points: Floats
    directions: Floats


def _moved(number: int, contact: Contact, points: Floats, directions: Floats) -> MasterPatch:
    """A patch where the rigid body is that carries it."""
    if contact.body is not None:
        points = contact.body.out_of_body(points)
        directions = contact.body.to_space(directions)
    return MasterPatch(np.full(len(points), number, dtype=np.int32), points, directions)


def _patch(contact: Any, comm: Any) -> tuple[Floats, Floats]:
    """Points of the patch and first axes of friction there, where the surface was drawn."""
    surface = contact.interface.surface
    xi = surface.project(contact.quadrature.reference, derivatives=False).xi
    low = np.min(comm.allgather(xi.min(axis=0, initial=np.inf)), axis=0)
    high = np.max(comm.allgather(xi.max(axis=0, initial=-np.inf)), axis=0)
    margin = MARGIN * (high - low)
    start, end, _ = surface.domain
    low = np.where(np.isfinite(start), start, np.maximum(low - margin, start))
    high = np.where(np.isfinite(end), end, np.minimum(high + margin, end))
    first, second = np.meshgrid(*np.linspace(low, high, POINTS).T, indexing="ij")
    at = np.column_stack([first.reshape(-1), second.reshape(-1)])
    directions = np.zeros((len(at), 3))
    field = _friction_directions(contact)
    if field is not None:
        axes, regular = field.axes(surface, at)
        directions[regular] = axes[regular, 0]
    return surface.position(at), directions


def _friction_directions(contact: Any) -> DirectionField | None:
    found: DirectionField | None = contact.interface.tangential.friction_directions
    return found
