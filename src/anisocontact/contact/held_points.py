"""Slave points that are held on a facet of the master while equilibrium is sought.

Where two facets meet at an angle the closest point jumps from one to the other, and with it the
normal. A point whose equilibrium is there alternates between facets from one correction to the
next. Held, it is projected on its facet as if that went on beyond its sides: there the gap is wrong
by how far it is outside times the angle, see `Master.strayed`.
"""

from __future__ import annotations

from dataclasses import fields, replace

import numpy as np

from anisocontact.base.array_types import Flags, Floats, Ints, Locals
from anisocontact.contact.continued_facets import feet_on_continued
from anisocontact.contact.facet_mesh import beyond_sides
from anisocontact.contact.sides import Sides, located
from anisocontact.surfaces.facets import FACET_STATUS, FEATURES, FacetProjections

#: How far beyond its sides a facet goes on, in its coordinates, which run from 0 to 1.
BEYOND = 0.1


class HeldPoints:
    """Which slave points are held, and which of them have been let go again.

    A held point that has come to rest beside its facet is let go once: many that have hopped on
    their way come to rest with their closest point, and the state that is found is then the one
    without any help. Those that do not are held as they were.

    Args:
        n: Number of slave points.

    Attributes:
        points: Those that are held, (n,).
    """

    def __init__(self, n: int) -> None:
        self.points: Flags = np.zeros(n, dtype=bool)
        self._let_go = self.points.copy()
        self._before: FacetProjections | None = None

    @property
    def hints(self) -> tuple[FacetProjections, ...]:
        """Projections that are remembered, whose facets may get other numbers."""
        return () if self._before is None else (self._before,)

    def let_go(self, hit: FacetProjections, closest: FacetProjections) -> bool:
        """Let go points that are not above what is closest to them; whether there are any.

        Args:
            hit: Projections in equilibrium.
            closest: Closest points there.
        """
        beside = (closest.facet != hit.facet) | (closest.feature != hit.feature)
        free = self.points & beside & ~self._let_go
        if not free.any():
            return False
        self._let_go |= free
        self.points = self.points & ~free
        self._before = hit
        return True

    def again(self) -> FacetProjections | None:
        """Hold what was let go, after a solution that failed; the projections at that time."""
        before, self._before = self._before, None
        if before is not None:
            self.points = self.points | self._let_go
        return before


def projected_facets(hit: FacetProjections, facets: Locals) -> Ints:
    """A code of the feature of a facet that each point has below it, (n,).

    Args:
        hit: Projections of the points.
        facets: The facets, in the numbers that are wanted, (n,).
    """
    return np.asarray(facets.astype(np.int64) * len(FEATURES) + hit.feature)


def facet_of(codes: Ints) -> Ints:
    """Facets in codes of `projected_facets`."""
    return codes // len(FEATURES)


def on_held_facets(
    sides: Sides, now: Floats, hit: FacetProjections, on: Locals, held: Flags
) -> FacetProjections:
    """Projections of which some are on a given facet, continued beyond its sides.

    Args:
        sides: Both sides; the surface is where it is now.
        now: Positions of the nodes, (nodes, 3), length.
        hit: Closest points of the slave points.
        on: Facet that a held point is on, (n,).
        held: Points that are held, (n,).

    Returns:
        The same for points that are not held, for those beyond the border of the surface, and for
        those that are farther than `BEYOND` from their facet.
    """
    which = np.flatnonzero(held & (on >= 0) & located(hit))
    if not which.size:
        return hit
    x, facets = sides.points.positions(now)[which], on[which]
    start = np.where((hit.facet[which] == facets)[:, None], hit.xi[which], 0.5)
    xi, foot, normal = feet_on_continued(sides.surface, x, facets, start)
    near = beyond_sides(sides.master.topology, xi) <= BEYOND
    which, facets = which[near], facets[near]
    new = {one.name: getattr(hit, one.name).copy() for one in fields(hit)}
    new["facet"][which], new["xi"][which] = facets, xi[near]
    new["position"][which], new["normal"][which] = foot[near], normal[near]
    new["gap"][which] = np.einsum("nd,nd->n", x - foot, normal)[near]
    new["status"][which] = FACET_STATUS.index("on")
    new["feature"][which] = FEATURES.index("interior")
    new["entity"][which], new["edge"][which] = -1, 0.0
    return replace(hit, **new)
