"""How far a body is from what it may touch, by boxes around both."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from anisocontact.base.array_types import Floats, Ints, Locals
from anisocontact.contact import Contact
from anisocontact.interface import Response

#: Corners of a box, lowest and highest, (3,) each.
Box = tuple[Floats, Floats]


def clearance(nodes: Ints, contacts: Sequence[Contact], sides: Sequence[float], u: Floats) -> float:
    """Distance up to which a body surely meets nothing, length; collective.

    Boxes around meshed surfaces are nearer than these. From surfaces without end it is the least
    gap; none where that is not known.

    Args:
        nodes: Local nodes of the body, or those that may touch, (k,).
        contacts: Its contacts.
        sides: Of each of them, see `FreeBody.sides`.
        u: Displacement of the local nodes, (nodes, 3), length.
    """
    boxes = box_distances(nodes, contacts, sides, u)
    gaps = [least_gap(contact) for contact in contacts if not contact.of_two_groups]
    return min([*boxes, *(gap if gap < np.inf else 0.0 for gap in gaps)], default=0.0)


def box_distances(
    nodes: Ints, contacts: Sequence[Contact], sides: Sequence[float], u: Floats
) -> list[float]:
    """Distances of boxes around a body and what it touches in contacts of two groups; collective.

    Arguments as of `clearance`.
    """
    space = contacts[0].space
    places = space.tabulate_dof_coordinates() + u
    own = box(places[nodes], space.mesh.comm)
    return [
        _distance(own, box(places[_others(contact, side)], space.mesh.comm))
        for contact, side in zip(contacts, sides, strict=True)
        if contact.of_two_groups
    ]


def least_gap(contact: Contact) -> float:
    """Least gap of a trial, length; infinite where no point has a master to meet; collective."""
    return _least(contact, np.abs(contact.trial.gap), contact.trial)


def accepted_gap(contact: Contact) -> float:
    """The same of the accepted increment, negative where points penetrate; collective."""
    there = contact.accepted.response
    return _least(contact, there.gap, there)


def _least(contact: Contact, gaps: Floats, response: Response) -> float:
    own = float(gaps[contact.master.located(response.state)].min(initial=np.inf))
    every: list[float] = contact.space.mesh.comm.allgather(own)
    return min(every)


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
