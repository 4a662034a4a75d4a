"""How far a body is from what it may touch, by boxes around both."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from anisocontact.base.array_types import Floats, Locals
from anisocontact.contact import Contact

if TYPE_CHECKING:
    from anisocontact.solver.terms.free_body import FreeBody

#: Corners of a box, lowest and highest, (3,) each.
Box = tuple[Floats, Floats]


def clearance(free: FreeBody, u: Floats) -> float:
    """Distance up to which a body surely meets nothing, length; collective.

    Boxes around meshed surfaces are nearer than these. From surfaces without end it is the least
    gap; none where that is not known.

    Args:
        free: The body.
        u: Displacement of the local nodes, (nodes, 3), length.
    """
    boxes = box_distances(free, u)
    gaps = [least_gap(contact) for contact in free.contacts if not contact.of_two_groups]
    return min([*boxes, *(gap if gap < np.inf else 0.0 for gap in gaps)], default=0.0)


def box_distances(free: FreeBody, u: Floats) -> list[float]:
    """Distances of boxes around a body and what it touches in contacts of two groups; collective.

    Args:
        free: The body.
        u: Displacement of the local nodes, (nodes, 3), length.
    """
    comm = free.contacts[0].space.mesh.comm
    places = free.contacts[0].space.tabulate_dof_coordinates() + u
    own = box(places[free.body.nodes], comm)
    return [
        _distance(own, box(places[_others(contact, side)], comm))
        for contact, side in zip(free.contacts, free.sides, strict=True)
        if contact.of_two_groups
    ]


def least_gap(contact: Contact) -> float:
    """Least gap of a trial, length; infinite where no point has a master to meet; collective."""
    gap = float(np.abs(contact.trial.gap[contact.located()]).min(initial=np.inf))
    gaps: list[float] = contact.space.mesh.comm.allgather(gap)
    return min(gaps)


def box(places: Floats, comm: Any) -> Box:
    """Box around places of all ranks, (n, 3), length; collective."""
    lowest = comm.allgather(places.min(axis=0, initial=np.inf))
    highest = comm.allgather(places.max(axis=0, initial=-np.inf))
    return np.min(lowest, axis=0), np.max(highest, axis=0)


def _distance(one: Box, other: Box) -> float:
    """Distance of two boxes, length."""
    gaps = np.maximum(one[0] - other[1], other[0] - one[1])
    return float(np.linalg.norm(np.maximum(gaps, 0.0)))


def _others(contact: Contact, side: float) -> Locals:
    """Local nodes of what a body touches in a contact of two groups."""
    slave, master = contact.nodes_of_groups
    return master if side > 0.0 else slave
