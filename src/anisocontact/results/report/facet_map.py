"""Maps of values at nodes over the facets between them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from anisocontact.base.array_types import Flags, Floats, Ints
from anisocontact.results.dataset import DataSet

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.cm import ScalarMappable


def polygons_of(points: DataSet, chosen: Flags) -> Ints:
    """Triangles and quadrilaterals between chosen points, numbered among these.

    Args:
        points: Points with polygons, or without.
        chosen: Which of the points, (n,).

    Returns:
        Corners, (m, 4); those of triangles end with -1.
    """
    cells = points.cells.get("Polys")
    if cells is None:
        return np.zeros((0, 4), dtype=np.int64)
    starts, sizes = cells["offsets"][:-1], np.diff(cells["offsets"])
    corner = np.arange(4)
    there = corner < sizes[:, None]
    named = cells["connectivity"][np.where(there, starts[:, None] + corner, 0)]
    number = np.where(chosen, np.cumsum(chosen) - 1, -1)
    kept = np.all(chosen[named] | ~there, axis=1)
    return np.where(there, number[named], -1)[kept]


class FacetMap:
    """Facets in a plane view, on which values at their nodes are drawn.

    Args:
        places: Places of the nodes in the plane, (n, 2).
        polygons: As of `polygons_of`.
    """

    def __init__(self, places: Floats, polygons: Ints) -> None:
        self.places, self.polygons = places, polygons
        # quadrilaterals as four triangles around their middle, so that no diagonal shows
        triangles, self._squares = polygons[polygons[:, 3] < 0], polygons[polygons[:, 3] >= 0]
        middle = np.broadcast_to(
            len(places) + np.arange(len(self._squares))[:, None], self._squares.shape
        )
        around = np.stack([self._squares, np.roll(self._squares, -1, axis=1), middle], axis=2)
        self._triangles = np.concatenate([triangles[:, :3], around.reshape(-1, 3)])

    def beside(self, nodes: Flags) -> Flags:
        """Some nodes, and those that have a facet in common with one of them, (n,)."""
        corners = np.where(self.polygons < 0, self.polygons[:, :1], self.polygons)
        out = nodes.copy()
        out[corners[nodes[corners].any(axis=1)]] = True
        return out

    def smooth(self, axes: Axes, values: Floats, **style: Any) -> ScalarMappable:
        """Draw values that vary between nodes; facets with a node that has no number are blank."""
        from matplotlib.tri import Triangulation

        places, everywhere = (
            np.concatenate([one, one[self._squares].mean(axis=1)]) for one in (self.places, values)
        )
        shown = np.isfinite(everywhere[self._triangles]).all(axis=1)
        triangles = Triangulation(places[:, 0], places[:, 1], self._triangles[shown])
        return axes.tripcolor(triangles, np.nan_to_num(everywhere), shading="gouraud", **style)

    def by_node(self, axes: Axes, values: Floats, **style: Any) -> ScalarMappable:
        """Draw each value on what is nearest to its node: the parts of the facets around it."""
        from matplotlib.collections import PolyCollection

        corners, owners = [], []
        for count in (3, 4):
            own = self.polygons[(self.polygons[:, 3] >= 0) == (count == 4)][:, :count]
            at = self.places[own]
            after = 0.5 * (at + np.roll(at, -1, axis=1))
            middle = np.repeat(at.mean(axis=1, keepdims=True), count, axis=1)
            parts = np.stack([at, after, middle, np.roll(after, 1, axis=1)], axis=2)
            corners.append(parts.reshape(-1, 4, 2))
            owners.append(own.reshape(-1))
        picked = values[np.concatenate(owners)]
        shown = np.isfinite(picked)
        # without antialiasing, which leaves seams between parts
        drawn = PolyCollection(
            np.concatenate(corners)[shown], edgecolors="none", antialiaseds=False, **style
        )
        drawn.set_array(picked[shown])
        axes.add_collection(drawn)
        return drawn
