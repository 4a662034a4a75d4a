"""Which nodes can be touched: those of the slaves, and of master facets that points may get to."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from anisocontact.base.array_types import Flags, Floats, Ints, Locals
from anisocontact.base.load_curve import history_of
from anisocontact.contact import Contact
from anisocontact.contact.remote_nodes import all_marked, marked_nodes, node_count
from anisocontact.mesh import Model
from anisocontact.solver.system.problem import Problem
from anisocontact.solver.terms.persistent import Arrays
from anisocontact.solver.terms.step import AXES, Step

#: Motion allowed beyond that of the supports, over the size of a slave facet.
_SLACK = 0.1
#: Longest side of a triangle over the root of its area; a facet around another one is no further.
_SIDE = 2.0


class Reach:
    """Nodes in reach of contacts from one state on, until bodies have moved too far.

    A master facet stays out as long as no slave point can have it as its closest: it is further
    than the facet that is closest now by more than twice the motion that is allowed for.

    Args:
        model: Mesh.
        contacts: Contacts.
        steps: Loads: supports tell how far bodies will move past each other.
        others: Nodes that are always in reach: those that something elastic holds.
    """

    def __init__(
        self,
        model: Model,
        contacts: Sequence[Contact],
        steps: Sequence[Step],
        others: Locals,
    ) -> None:
        self._contacts, self._others = contacts, others
        self._space, self._comm = model.space, model.mesh.comm
        self._ranges = {body: _prescribed_range(steps, body) for body in model.body_names()}
        self._start: Floats = np.zeros((node_count(model.space), 3))
        self._factor = 1.0
        self.nodes: Flags = np.zeros(len(self._start), dtype=np.bool_)

    def select(self, u: Floats, alone: Sequence[Ints] = ()) -> None:
        """Take the nodes in reach of a state; collective.

        Args:
            u: Displacement of the local nodes, (nodes, 3), length.
            alone: Nodes of each body that contact alone can hold, on which springs may act until it
                does; all of them are taken where the body is so far away that none is in reach.
        """
        self._start = u.copy()
        named = [self._others]
        for contact in self._contacts:
            named += self._of(contact, u) if contact.of_two_groups else [contact.couplable()]
        self.nodes = marked_nodes(self._space, np.concatenate([one.ravel() for one in named]))
        for nodes in alone:
            self.nodes[nodes] |= not self.nodes[nodes].any()

    def has(self, named: Locals) -> bool:
        """Whether all nodes that any process names are in reach; see `all_marked`."""
        return all_marked(self._space, self.nodes, named)

    def persistent(self) -> Arrays:
        """Where the last selection was made, and what came of it."""
        return {
            "start": self._start,
            "in_reach": self.nodes,
            "widened": np.array(self._factor),
        }

    def restore(self, kept: Arrays) -> None:
        """Go on from what `persistent` gave."""
        self._start, self.nodes = kept["start"], kept["in_reach"]
        self._factor = float(kept["widened"])

    @property
    def start(self) -> Floats:
        """Displacement of the nodes at the last selection, (nodes, 3), length."""
        return self._start

    def widen(self) -> None:
        """Allow for twice the motion from the next selection on."""
        self._factor *= 2.0

    def valid(self, u: Floats) -> bool:
        """Whether no body has moved by more than what was allowed for."""
        for contact in self._contacts:
            if not contact.of_two_groups:
                continue
            master: Any = contact.master
            sides = (master.local_names(contact.slave_points.nodes), master.facets)
            if sum(self._moved(side, u) for side in sides) > self._motion(contact):
                return False
        return True

    def _moved(self, facets: Locals, u: Floats) -> float:
        """Longest way of a node of the facets that are in reach."""
        nodes = np.unique(facets[self.nodes[facets].all(axis=1)])
        step = np.linalg.norm(u[nodes] - self._start[nodes], axis=1)
        return float(step.max(initial=0.0))

    def _motion(self, contact: Contact) -> float:
        """Motion of slave and master that is allowed for, length."""
        bodies = [self._ranges[name.partition(".")[0]] for name in contact.groups]
        planned = sum(float(np.linalg.norm(extent)) for extent in bodies)
        return float(self._factor * (planned + _SLACK * contact.slave_points.size))

    def _of(self, contact: Contact, u: Floats) -> list[Locals]:
        """Nodes in reach of a contact, named as in `Couplings`."""
        motion = self._motion(contact)
        master: Any = contact.master
        spread = contact.slave_points.spread
        if self._factor > 1.0:
            # of a master coarser than the slave a facet may be met that has no slave node below it
            spread += np.sqrt(2.0) * contact.master_size
        around = contact.slave_points.at_nodes
        far = master.reach + 3.0 * motion + spread + around * _SIDE * contact.master_size
        points, (surface, facets) = contact.points, master.seen_within(u, far)
        nearest = np.linalg.norm(surface.project(points).position - points, axis=1)
        able = np.flatnonzero(nearest <= master.reach + motion)
        found = [master.named_slaves[able], master.below(contact.state)]
        below = nearest[able] + 2.0 * motion
        for some, largest in _alike(below + spread, self._comm):
            near = surface.within(points[able[some]], largest)
            found.append(facets[near.facets])
        for some, largest in _alike(below, self._comm) if around else []:
            near = surface.within(points[able[some]], largest)
            # facets around those below a slave node turn its contact plane, also across a corner
            found.append(facets[np.isin(facets, facets[near.facets]).any(axis=1)])
        return found


def _alike(limit: Floats, comm: Any) -> list[tuple[Ints, float]]:
    """Which of some positive lengths differ by less than a quarter; the largest on all ranks."""
    level = np.floor(np.log(limit) / np.log(1.25))
    own = {one: float(limit[level == one].max()) for one in np.unique(level).tolist()}
    found = comm.allgather(own)
    return [
        (np.flatnonzero(level == one), max(there.get(one, 0.0) for there in found)) for one in own
    ]


def touched_nodes(problem: Problem, steps: Sequence[Step]) -> Flags:
    """Whether the steps of a problem can bring a node into contact, (nodes,)."""
    reach = Reach(problem.model, problem.contacts, steps, problem.attached.nodes)
    reach.select(problem.u.x.array.reshape(-1, 3))
    return reach.nodes


def _prescribed_range(steps: Sequence[Step], body: str) -> Floats:
    """Largest displacement that any support of a body is given, along each axis, length."""
    extent = np.zeros(3)
    for step in steps:
        for group, values in step.displacement.items():
            if group.partition(".")[0] == body:
                for axis, value in values.items():
                    if value is not None:
                        i, history = AXES.index(axis), history_of(value)
                        extent[i] = max(extent[i], history.largest(step.duration, extent[i]))
    return extent
