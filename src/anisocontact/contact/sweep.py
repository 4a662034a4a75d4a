"""Edges of a mesh in the plane as facets in space, for what knows facets alone.

A facet that meets others is swept out of an edge across the plane: straight in a plane, along the
tangent of the circle in a body of revolution. Its nodes are images of those of the edge,

    x_s = x + s t(x) = M_s x + s t_0 ,    t = t_0 + A x ,    M_s = 1 + s A ,

in the plane and in rows on either side of it. In the plane the facet is the edge, with t for its
second tangent.
"""

from __future__ import annotations

import numpy as np

from anisocontact.base.array_types import Floats, Locals
from anisocontact.contact.images import Images
from anisocontact.mesh import Model

#: Half the angle of a facet of revolution, radian.
ANGLE = 0.5
#: Length across the plane at an axis of revolution over the largest radius: rounding elsewhere,
#: where facets end in a point they would have no tangent.
ON_AXIS = 1e-12
#: Rows of images: in the plane, before it and behind it.
ROWS = np.array([0.0, -1.0, 1.0])
#: Nodes of a facet by the number of those of its edge: node of the edge and row.
_NODES = {
    2: [(0, 1), (1, 1), (0, 2), (1, 2)],
    3: [(0, 1), (1, 1), (0, 2), (1, 2), (2, 1), (0, 0), (1, 0), (2, 2), (2, 0)],
}
#: Nodes of an edge among those of its facet, by the number of these.
_EDGE = {4: [0, 1], 9: [0, 1, 4]}


class Sweep(Images):
    """Images of the nodes of a mesh in the plane.

    Where all are there once more, turned, the numbers of each turn go on after those of the last.

    Attributes:
        share: Of the area of a facet, that of the thickness or of the circumference.
        ideal: What the mesh is taken for.
    """

    def __init__(self, model: Model) -> None:
        x = np.asarray(model.space.tabulate_dof_coordinates())
        self.ideal = ideal = model.idealisation
        round_ = ideal.turn.any()
        # in a plane as wide as the mesh: what slides across it stays on the facet
        width = ANGLE / (2.0 * np.pi) if round_ else np.ptp(x, axis=0).max() / ideal.offset[2]
        offset = ideal.offset + round_ * ON_AXIS * np.abs(x).max(initial=0.0) * np.eye(3)[2]
        shares = width * ROWS
        maps = np.eye(3) + shares[:, None, None] * ideal.turn
        super().__init__(len(x), maps, shares[:, None] * offset)
        self.share = float(0.5 / width)

    @classmethod
    def of(cls, model: Model) -> Sweep | None:
        """That of a mesh in the plane; None of one in space."""
        return cls(model) if model.idealisation.dim == 2 else None

    def facets(self, edges: Locals) -> Locals:
        """Nodes of the facets of edges, (m, 4 or 9), from those of the edges, (m, 2 or 3)."""
        node, row = np.array(_NODES[edges.shape[1]]).T
        return np.asarray(edges[:, node] + self.count * row, dtype=np.int32)

    def edges(self, facets: Locals) -> Locals:
        """Nodes of the edges, (m, 2 or 3), from those of the facets that `facets` made of them."""
        return self.in_plane(facets[:, _EDGE[facets.shape[1]]])

    def in_plane(self, nodes: Locals) -> Locals:
        """Nodes in the plane, turned as well, of which these are the rows on either side."""
        row = nodes // self.count % len(ROWS)
        return np.asarray(nodes - self.count * row, dtype=np.int32)

    def tangents(self, nodes: Locals, shares: Floats) -> tuple[Locals, Floats]:
        """Images, (n, 2 k), and factors at which they sum up to mean tangents across the plane.

        Args:
            nodes: Nodes of the mesh, (n, k).
            shares: Of each in the mean, (n, k).
        """
        images = [nodes + row * self.count for row in (1, 2)]
        factors = [sign * self.share * shares for sign in ROWS[1:]]
        return np.concatenate(images, axis=1).astype(np.int32), np.concatenate(factors, axis=1)
