"""Slave nodes that turn with a sector past the cut face at which their master ends."""

from __future__ import annotations

import numpy as np

from anisocontact.base.array_types import Flags
from anisocontact.contact import Contact
from anisocontact.solver.system.problem import Problem

#: Share of its weight that a slave node has to lose; what is left carries as much more.
LOST = 0.01
#: Share from which on the master covers a node.
WHOLE = 0.99
#: What is said of it.
PAST = (
    "slave nodes at the cut faces of a sector have turned past the end of the master by up to "
    "{:.0%} of what they stand for, which nothing carries here: pressures there are wrong, and "
    "where the surface is curved forces with them; give both bodies a sector with the same turn "
    "and the run one process, or take the whole instead of a sector"
)


class CutFaceWatch:
    """Says how much of slave nodes on cut faces has lost its meshed master since the start.

    Nodes count that the master covered then, of contacts that end there. Both faces are strained
    alike, so that what one of them loses is measured on the other.

    Args:
        problem: The problem at the start of the run.
    """

    def __init__(self, problem: Problem) -> None:
        ties, nodes = problem.constraints.ties, problem.model.space.dofmap.index_map
        on_cuts = np.zeros(0, dtype=np.int64) if ties is None else ties.sectors.on_cuts()
        self._watched: list[tuple[Contact, Flags]] = []
        for one in problem.contacts if problem.comm.allreduce(len(on_cuts)) else ():
            if one.meshed and one.slave_points.at_nodes and not one.goes_on:
                # images of nodes have the numbers after them, see `Images`
                own = one.slave_points.nodes[:, 0] % (nodes.size_local + nodes.num_ghosts)
                self._watched.append((one, np.isin(own, on_cuts) & (one.covered() > WHOLE)))

    def lost(self) -> dict[str, float]:
        """Largest share of its weight that a node has lost, by contact that closes; collective."""
        found = {}
        for contact, on_cut in self._watched:
            kept = contact.covered()[on_cut]
            share = contact.extreme(1.0 - kept / (contact.extreme(kept) or 1.0))
            # anywhere: nodes at the cut may have opened
            closed = contact.extreme(contact.last.pressure) > 0.0
            if closed and share > LOST:
                found[contact.name] = share
        return found
