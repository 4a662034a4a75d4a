"""Smooth surface over a mesh of linear facets."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
import scipy

from anisocontact import _core
from anisocontact.base.arrays import points
from anisocontact.base.errors import InputError
from anisocontact.base.typed import typed
from anisocontact.surfaces.facet_blocks import FacetBlocks, finite
from anisocontact.surfaces.facets import FacetSurface

#: Patches over linear facets, and the number of their nodes.
PATCHES = {"tri3": ("tri6", 6), "quad4": ("quad8", 8)}


@typed
class SmoothSurface(FacetSurface):
    """A surface of quadratic patches through the points of linear facets.

    Every edge becomes a parabola normal to averaged normals at its two points, so that a mesh that
    approximates a curved surface has normals that hardly jump. Facets keep their numbers and their
    points; the middles of the edges are computed from these, also at every `update`. Edges at
    which the given facets meet at more than the crease angle stay sharp and straight, for good.

    Args:
        coordinates: Points, (m, 3) [length].
        connectivity: Points of each facet, (k, 3) or (k, 4), or a list of such blocks.
        topology: "tri3" or "quad4", one for each block.
        flip: Facets whose normal is to be turned round, (number of facets,).
        crease_angle: Angle of the normals of neighbours above which their edge is sharp [radians].

    Raises:
        InputError: What `FacetSurface` does not take, or another topology.

    Example:
        >>> roof = [[0, 0, 0], [1, 0, 0.1], [0, 1, 0], [1, 1, 0.1], [2, 0, 0], [2, 1, 0]]
        >>> smooth = SmoothSurface(roof, [[0, 1, 2, 3], [1, 4, 3, 5]], "quad4")
        >>> smooth.geometry([0, 1], [[1.0, 0.5], [0.0, 0.5]]).normal[:, 2].round(12).tolist()
        [1.0, 1.0]
    """

    def __init__(
        self,
        coordinates: npt.ArrayLike,
        connectivity: npt.ArrayLike | Sequence[npt.ArrayLike],
        topology: str | Sequence[str],
        flip: npt.ArrayLike | None = None,
        crease_angle: float = np.pi / 6.0,
    ) -> None:
        mesh = FacetBlocks.of(connectivity, topology, flip)
        for name in mesh.topologies:
            if name not in PATCHES:
                raise InputError(f"given {name!r}, allowed: {', '.join(PATCHES)}", field="topology")
        if not 0.0 <= crease_angle <= np.pi:
            raise InputError(f"given {crease_angle}, 0 to pi allowed", field="crease_angle")
        x = finite(points(coordinates, 3, "coordinates"))
        try:
            self._smoothing = _core.Smoothing(
                x, mesh.topologies, mesh.counts, mesh.nodes, mesh.flip, crease_angle
            )
        except ValueError as error:
            raise InputError(str(error), field="connectivity") from None
        nodes = np.asarray(self._smoothing.nodes(x.shape[0]), dtype=np.int32)
        patches = [PATCHES[name] for name in mesh.topologies]
        ends = np.cumsum([k * n for k, (_, n) in zip(mesh.counts, patches, strict=True)])
        blocks = np.split(nodes, ends[:-1])
        super().__init__(
            np.concatenate((x, self._smoothing.middles(x))),
            [b.reshape(-1, n) for b, (_, n) in zip(blocks, patches, strict=True)],
            [name for name, _ in patches],
            mesh.flip,
        )
        self._points = x.shape[0]

    def update(self, coordinates: npt.ArrayLike) -> None:
        """Moves the points, and the middles of the edges with them.

        Args:
            coordinates: New positions of the same points, (m, 3) [length].
        """
        x = points(coordinates, 3, "coordinates", rows=self._points)
        self.core.update(np.concatenate((x, self._smoothing.middles(x))))

    def middle_derivatives(self, coordinates: npt.ArrayLike) -> scipy.sparse.bsr_array:
        """How the middles of the edges follow the points, exact.

        Args:
            coordinates: Positions of the points, (m, 3) [length].

        Returns:
            Block-sparse matrix (3 middles, 3 points); middle i is node m + i of the patches.
        """
        x = points(coordinates, 3, "coordinates", rows=self._points)
        first, column, blocks = self._smoothing.derivatives(x)
        shape = (3 * (first.size - 1), 3 * self._points)
        return scipy.sparse.bsr_array((blocks, column, first), shape=shape)
