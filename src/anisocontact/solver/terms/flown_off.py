"""How far a free body can come and still meet something."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.solver.terms.clearance import accepted_gap, box, box_distances
from anisocontact.solver.terms.free_body import FreeBody

#: Sizes of a body that it may come beyond what it could reach when it began to move.
BEYOND = 2.0


def flown_off(
    bodies: Iterable[FreeBody], begun: Floats, u: Floats
) -> tuple[FreeBody, float] | None:
    """A body, regularised or on springs, that nothing can stop any more, and how far; collective.

    None of its points has anything of a master below it that it may come back to, and it has come
    farther than to where it could meet one, see `farthest_way`.

    Args:
        bodies: Bodies that only contact can hold.
        begun: Displacement of the local nodes when they began to move, (nodes, 3), length.
        u: That of now, (nodes, 3), length.
    """
    for free in bodies:
        nodes = free.body.nodes
        way = np.linalg.norm(u[nodes] - begun[nodes], axis=1).max(initial=0.0)
        below = _may_come_back(free, BEYOND * _diameter(free))
        every = free.contacts[0].space.mesh.comm.allgather((float(way), below))
        farthest = max(one for one, _ in every)
        if any(here for _, here in every):
            continue
        if farthest > farthest_way(free, begun):
            return free, farthest
    return None


def _may_come_back(free: FreeBody, far: float) -> bool:
    """Whether there is something of a master below a point of this rank that may be met again.

    Not where that has come farther away by `far` and the loads on the body point away from it: a
    surface without end is below a body wherever it is. Collective.
    """
    gaps = [accepted_gap(contact) for contact in free.contacts]
    for contact, side, before in zip(free.contacts, free.sides, gaps, strict=True):
        here, now = contact.located(), contact.trial
        if not here.any():
            continue
        nearer = now.gap[here] <= before + far
        if (nearer | (side * (now.normal[here] @ free.force) <= 0.0)).any():
            return True
    return False


def farthest_way(free: FreeBody, begun: Floats) -> float:
    """Way beyond which a body that has nothing of a master below it meets none, length; collective.

    That is twice its size and how far it is from the most distant of what it can touch.

    Args:
        free: The body.
        begun: Displacement of the local nodes when it began to move, (nodes, 3), length.
    """
    # a surface is below it wherever it is
    ways = box_distances(free.nodes, free.contacts, free.sides, begun)
    return BEYOND * _diameter(free) + max(ways, default=0.0)


def _diameter(free: FreeBody) -> float:
    """Diagonal of the box around a body as it is meshed, length; collective."""
    space = free.contacts[0].space
    low, high = box(space.tabulate_dof_coordinates()[free.body.nodes], space.mesh.comm)
    return float(np.linalg.norm(high - low))
