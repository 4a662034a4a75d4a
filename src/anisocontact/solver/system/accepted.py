"""The accepted state of a problem, and the work from outside since the start."""

from __future__ import annotations

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.fenicsx import Vec
from anisocontact.solver.system.ends_work import EndsWork
from anisocontact.solver.system.layout import Layout
from anisocontact.solver.terms.persistent import Arrays


class AcceptedState:
    """Unknowns, forces and work of the last accepted state, and the way from there to the next.

    Attributes:
        x: The unknowns, length.
        outside: All forces but those of contact on the unknowns this rank owns, force.
        reaction: Of these, what the supports carry, force.
        contact: Forces of contact, force.
        work: Work of all that acts from outside since the start, force times length.
    """

    def __init__(self, layout: Layout) -> None:
        self._layout = layout
        self.x: Vec = layout.new_vector()
        self.outside: Floats = np.zeros(layout.owned)
        self.reaction: Floats = np.zeros(layout.owned)
        self.contact: Floats = np.zeros(layout.owned)
        self.work = 0.0
        self.begin_way()

    @property
    def displacement(self) -> Floats:
        """Displacements this rank owns, length."""
        return np.array(self.x.array_r[: self._layout.owned])

    def begin_way(self) -> None:
        """Start from the accepted state."""
        self._place, self._force = self.displacement, self.outside
        self.way_work = EndsWork(0.0, 0.0)

    def go_on(self, x: Vec, outside: Floats) -> None:
        """Add the work from the last state on the way to this one.

        Trapezoidal rule: the mean of the forces at both ends times the way between them.

        Args:
            x: Unknowns of this state, length.
            outside: All forces but those of contact, force.
        """
        place = np.array(x.array_r[: self._layout.owned])
        local = EndsWork.between(self._force, outside, place - self._place)
        sums = self._layout.comm.allreduce(np.array([local.mean, local.missed]))
        self.way_work += EndsWork(*sums.tolist())
        self._place, self._force = place, outside

    def take(self, outside: Floats, load: Floats) -> None:
        """Take over the forces of a state: all but those of contact, and of these the loads."""
        self.outside, self.reaction = outside, outside - load

    def persistent(self) -> tuple[Arrays, Arrays]:
        """Values at the nodes this rank owns, and what all ranks have in common."""
        displacement, rigid = self._layout.split(self.x)
        nodal: Arrays = {
            "displacement": displacement,
            "outside": self.outside.reshape(-1, 3).copy(),
            "reaction": self.reaction.reshape(-1, 3).copy(),
            "contact": self.contact.reshape(-1, 3).copy(),
        }
        return nodal, {"external_work": np.array([self.work]), "rigid": rigid}

    def restore(self, nodal: Arrays, common: Arrays) -> None:
        """Go on from what `persistent` gave."""
        self.x = self._layout.joined(nodal["displacement"], common["rigid"])
        self.outside = nodal["outside"].reshape(-1).copy()
        self.reaction = nodal["reaction"].reshape(-1).copy()
        self.contact = nodal["contact"].reshape(-1).copy()
        self.work = float(common["external_work"][0])
        self.begin_way()
