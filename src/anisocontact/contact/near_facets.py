"""What is near to facets of a surface that meets itself, and what of it they do not look at."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from anisocontact.base.array_types import Flags, Ints, Locals
from anisocontact.surfaces.facets import FacetSets


@dataclass(frozen=True)
class NearFacets:
    """Facets near to each facet in the reference configuration, and its neighbours.

    Attributes:
        unmet: Those that it does not overlap: neighbours, but at the tip of a closed crack, and
            the other side of a thin wall.
        unseen: Those that its points do not look at: as well those that it does not face.
        faced: Those that it faces within 84 degrees.
    """

    unmet: FacetSets
    unseen: FacetSets
    faced: FacetSets

    def by(self, change: Callable[[FacetSets], FacetSets]) -> NearFacets:
        """All changed alike."""
        return NearFacets(*(change(sets) for sets in vars(self).values()))

    def unseen_from(self, offsets: Ints, facets: Locals, counts: Flags) -> FacetSets:
        """What nodes do not look at: what their facets do not.

        Where a facet stands across an edge, all that is in front of the others is beside it: of
        that it leaves out what it cannot meet alone.

        Args:
            offsets: Where the facets around each node begin, (n + 1,).
            facets: The facets, one list after the other, (pairs,).
            counts: Whether each is part of the averaged normal of the node, (pairs,).
        """
        count = len(offsets) - 1
        owner = np.repeat(np.arange(count), np.diff(offsets))
        width = np.int64(max(sets.facets.max(initial=0) for sets in vars(self).values()) + 1)

        def pairs(sets: FacetSets, which: Flags) -> Ints:
            taken = sets.take(facets[which].astype(np.int64))
            return np.repeat(owner[which], np.diff(taken.offsets)) * width + taken.facets

        across = np.setdiff1d(pairs(self.unseen, ~counts), pairs(self.faced, counts))
        found = [pairs(self.unseen, counts), pairs(self.unmet, ~counts), across]
        points, taken = np.divmod(np.concatenate(found), width)
        return FacetSets.of_pairs(points, taken.astype(np.int32), count)
