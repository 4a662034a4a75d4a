"""Whether a body that friction cannot hold comes to rest further on, where shapes or loads hold it.

A block in a bowl that is pushed beyond friction slides up its side until it rests there. Along a
sliding motion by s, loads and normal forces work less than s times what they do at first, by
`c s^2 / 2`: the body is driven the less the further it slides, and `c s` makes up for what friction
lacks. Where a plane or a drum goes on as it is, and loads as well, c is zero. It is asked of
smooth masters: the shape of meshed ones is that of now, with the dent that moves with the body.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from anisocontact.base.array_types import Floats
from anisocontact.contact import Contact

#: Way to either side at which shapes and loads are looked at, over the size of the body.
LOOK = 0.25
#: Way within which a body may come to rest, over its size.
FAR = 10.0


@dataclass(frozen=True)
class SlidingMotion:
    """A body that slides, with what drives it and what it slides on.

    Attributes:
        motion: Translation and turn times the size, (6,).
        centre: Point that the turn is about, (3,), length.
        size: Of the body, length.
        loads: Sums of `f_i (x - centre)_j` over its loads and, last column, of `f_i`, (3, 4).
        contacts: What it slides on or under, which is the same to second order.
        grown: Normal forces over those of the accepted state.
    """

    motion: Floats
    centre: Floats
    size: float
    loads: Floats
    contacts: Sequence[Contact]
    grown: float

    def rests(self, lacking: float) -> bool:
        """Whether what friction lacks is made up for within `FAR` of its size; collective.

        Args:
            lacking: Work of loads and normal forces on the motion beyond that of friction.
        """
        # the dent that a body makes in another one moves with it, and holds nothing back
        if any(contact.meshed for contact in self.contacts):
            return False
        twist = np.zeros((4, 4))
        twist[:3, :3] = np.cross(self.motion[3:] / self.size, np.eye(3)).T
        twist[:3, 3] = self.motion[:3]
        way = self.size / float(np.linalg.norm(self.motion))
        ahead, back = (scipy.linalg.expm(sign * LOOK * way * twist) for sign in (1.0, -1.0))
        work = float((self.loads * (ahead + back - 2.0 * np.eye(4))[:3]).sum())
        work += self.grown * sum(self._pushed(one, ahead, back) for one in self.contacts)
        return -work / (LOOK * way) ** 2 * FAR * way > lacking

    def _pushed(self, contact: Contact, *moved: Floats) -> float:
        """Work of normal forces where slave points are moved to one side and to the other."""
        x, master = contact.points, contact.master
        here, on, gaps = master.look(x), contact.last.pressure > 0.0, np.zeros(len(x))
        on = on & here.on
        for place in moved:
            there = master.look(self.centre + (x - self.centre) @ place[:3, :3].T + place[:3, 3])
            on, gaps = on & there.on, gaps + there.gap - here.gap
        force = contact.areas * contact.last.pressure
        return float(contact.space.mesh.comm.allreduce(force[on] @ gaps[on]))
