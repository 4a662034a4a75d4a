"""Where slave points that are beyond the border of a master begin to slip.

A point that slides on to the master has slipped since the accepted state as one that comes down on
it has: from the place where it was. That is on its closest facet, which for this goes on beyond
the border, so that the slip has the direction of the way; what friction does on it counts with the
mean of the pressures before and after, see `dissipated`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from anisocontact.base.array_types import Flags, Floats, Locals
from anisocontact.contact.along_normals import OPPOSED
from anisocontact.contact.contact_planes import Opposite, along
from anisocontact.contact.continued_facets import feet_on_continued
from anisocontact.contact.facet_mesh import beyond_sides
from anisocontact.contact.mortar_answer import MortarState
from anisocontact.contact.plane_axes import dual
from anisocontact.contact.sides import Sides
from anisocontact.interface import State
from anisocontact.surfaces.facets import FACET_STATUS, FacetProjections

#: How far beyond the border a facet goes on, in its coordinates, which run from 0 to 1: farther
#: out the shape functions of order 2 make much of how the facet bends.
FARTHEST = 1.0


def beyond(hit: FacetProjections) -> Flags:
    """Whether the closest points of slave points are on the border, with these beyond it, (n,)."""
    return np.asarray(hit.status == FACET_STATUS.index("off"))


@dataclass(frozen=True)
class BeyondBorder:
    """Slave points of the accepted state that are beyond the border of facets.

    Attributes:
        facet: Closest facet of each point, (n,); -1 for those that are not beyond the border.
        xi: Coordinates on it, at most `FARTHEST` beyond its sides, (n, 2).
    """

    facet: Locals
    xi: Floats

    @classmethod
    def of(cls, sides: Sides, now: Floats, hit: FacetProjections) -> BeyondBorder:
        """Points where the nodes are.

        Args:
            sides: Both sides; the surface is where it is now.
            now: Positions of the nodes, (nodes, 3), length.
            hit: Closest points of the slave points.
        """
        there = beyond(hit)
        facet, xi = np.where(there, hit.facet, np.int32(-1)), np.nan_to_num(hit.xi)
        if (which := np.flatnonzero(there)).size:
            x, start = sides.points.positions(now)[which], xi[which]
            far = feet_on_continued(sides.surface, x, facet[which], start)[0]
            outside = beyond_sides(sides.master.topology, far)
            share = np.minimum(FARTHEST / np.maximum(outside, FARTHEST), 1.0)
            # a facet that is folded flat has no place beside it
            xi[which] = start + np.nan_to_num(share[:, None] * (far - start))
        return cls(facet, xi)

    def begin(self, state: State) -> State:
        """The accepted state with the places of points that no facet was below."""
        which = (state["facet"] < 0) & (self.facet >= 0)
        if not which.any():
            return state
        begun = state.copy()
        begun["facet"][which], begun["xi"][which] = self.facet[which], self.xi[which]
        return begun


def accepted_opposite(at: MortarState, hit: FacetProjections, state: State) -> Opposite:
    """What is opposite to slave nodes in an accepted state.

    That is the border, at the place where their tangents are taken, of nodes beyond it, and nothing
    of others that are not in front of a master.

    Args:
        at: The slave nodes where they are.
        hit: Their closest points.
        state: The state, in which nodes beyond the border get coordinates in their plane.
    """
    planes, now = at.planes, at.opposite[0].with_axes(at.planes.now)
    opposed = (now.facet >= 0) & (planes.now.cosine > OPPOSED)
    there = (state["facet"] < 0) & beyond(hit) & opposed
    rows, border = np.flatnonzero(there), replace(now, masters=now.nodes, shares=now.shape)
    away = planes.slave[rows] - border.mean(at.now)[rows]
    away -= along(planes.held[rows], away)
    state["xi"][rows] = np.einsum("nai,ni->na", dual(planes.now.axes[rows]), away)
    now = replace(now, shares=np.where(state["facet"][:, None] < 0, 0.0, now.shares))
    return now.with_rows(there, border).in_order()


def refer_to_accepted(state: State, which: Flags) -> None:
    """Let some slave nodes of a state, (n,), have planes of the accepted increment, others none."""
    state["facet"] = np.where(which, np.arange(len(state)) + len(state), -1)
