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
from anisocontact.surfaces.facets import FACET_STATUS, FacetProjections, FacetSurface

#: How far beyond the border a facet goes on, in its coordinates, which run from 0 to 1: farther
#: out the shape functions of order 2 make much of how the facet bends.
FARTHEST = 1.0
#: Least cosine between the normals at the border and where a facet goes on to, and the least area
#: there over that at the border: beyond, a place is no continuation of the surface.
STRAIGHT, LEAST = 0.5, 0.1
#: Share of a node in a place on the border that is none.
ROUNDING = 1e-12


def beyond(hit: FacetProjections) -> Flags:
    """Whether the closest points of slave points are on the border, with these beyond it, (n,)."""
    return np.asarray(hit.status == FACET_STATUS.index("off"))


@dataclass(frozen=True)
class BeyondBorder:
    """Slave points of the accepted state that are beyond the border of facets.

    Attributes:
        facet: Closest facet of each point, (n,); -1 for those that are not beyond the border.
        xi: Coordinates on it, at most `FARTHEST` beyond its sides, (n, 2).
        gap: How far above it they are, (n,), length; 0 below it.
    """

    facet: Locals
    xi: Floats
    gap: Floats

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
        gap = np.zeros(len(facet))
        if (which := np.flatnonzero(there)).size:
            x, start = sides.points.positions(now)[which], xi[which]
            topology, away = sides.master.topology, np.abs(hit.gap[which])
            found = places_beyond(sides.surface, topology, x, facet[which], start, away)
            xi[which], gap[which] = found
        return cls(facet, xi, gap)

    def begin(self, state: State) -> State:
        """The accepted state with the places of points that no facet was below."""
        which = (state["facet"] < 0) & (self.facet >= 0)
        if not which.any():
            return state
        begun = state.copy()
        for name in ("facet", "xi", "gap"):
            begun[name][which] = getattr(self, name)[which]
        begun["origin"][which] = self.xi[which]
        return begun


def places_beyond(
    surface: FacetSurface, topology: str, x: Floats, facet: Locals, start: Floats, away: Floats
) -> tuple[Floats, Floats]:
    """Where points are on facets that go on beyond their border, and how far above these.

    Args:
        surface: The facets, where they are now.
        topology: Of these.
        x: The points, (n, 3), length.
        facet: Closest facet of each, (n,).
        start: Closest places on their border, (n, 2).
        away: Distances from there, (n,), length.

    Returns:
        Coordinates, (n, 2), at most `FARTHEST` beyond the sides, and on the border where a facet
        does not go on to the foot; gaps (n,), length, 0 below.
    """
    far, foot, normal = feet_on_continued(surface, x, facet, start)
    outside = beyond_sides(topology, far)
    share = np.minimum(FARTHEST / np.maximum(outside, FARTHEST), 1.0)
    far = start + share[:, None] * (far - start)
    # a facet that bends has a foot on its other side as well, which is farther than the border
    there = goes_on(surface, facet, start, far) & (np.linalg.norm(x - foot, axis=1) <= away)
    above = np.where(there, np.einsum("nd,nd->n", x - foot, normal), 0.0)
    return np.where(there[:, None], far, start), np.clip(above, 0.0, None)


def goes_on(surface: FacetSurface, facet: Locals, start: Floats, far: Floats) -> Flags:
    """Whether facets go on from their border to places without turning round or folding, (n,)."""
    jets = [surface.jet(facet, xi) for xi in (start, far)]
    border, there = (np.cross(jet.d1[:, 0], jet.d1[:, 1]) for jet in jets)
    size = np.linalg.norm(border, axis=1)
    along = np.einsum("nd,nd->n", border, there)
    straight = along > STRAIGHT * size * np.linalg.norm(there, axis=1)
    # not a number where a facet that is folded flat has no place beside it
    return np.asarray(straight & (np.linalg.norm(there, axis=1) > LEAST * size))


def accepted_opposite(at: MortarState, hit: FacetProjections, state: State) -> Opposite:
    """What is opposite to slave nodes in an accepted state.

    That is the border, at the place where their tangents are taken, of nodes beyond it, and nothing
    of others that are not in front of a master.

    Args:
        at: The slave nodes where they are.
        hit: Their closest points.
        state: The state, in which nodes beyond the border get coordinates in their plane, and how
            far above it they are.
    """
    planes, now = at.planes, at.opposite[0].with_axes(at.planes.now)
    opposed = (now.facet >= 0) & (planes.now.cosine > OPPOSED)
    there = (state["facet"] < 0) & beyond(hit) & opposed
    # which nodes have a share is no matter of rounding: another number of processes has the same
    shares = np.where(np.abs(now.shape) > ROUNDING, now.shape, 0.0)
    rows, border = np.flatnonzero(there), replace(now, masters=now.nodes, shares=shares)
    away = planes.slave[rows] - border.mean(at.now)[rows]
    away -= along(planes.held[rows], away)
    above = np.einsum("ni,ni->n", away, planes.normal[rows])
    state["gap"][rows] = np.maximum(above, 0.0)
    state["xi"][rows] = np.einsum("nai,ni->na", dual(planes.now.axes[rows]), away)
    state["origin"][rows] = state["xi"][rows]
    now = replace(now, shares=np.where(state["facet"][:, None] < 0, 0.0, now.shares))
    return now.with_rows(there, border).in_order()


def refer_to_accepted(state: State, which: Flags) -> None:
    """Let some slave nodes of a state, (n,), have planes of the accepted increment, others none."""
    state["facet"] = np.where(which, np.arange(len(state)) + len(state), -1)
