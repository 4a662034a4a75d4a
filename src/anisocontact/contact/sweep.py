"""Edges of a mesh in the plane as facets in space, for what knows facets alone.

A facet that meets others is swept out of an edge across the plane: straight in a plane, along the
tangent of the circle in a body of revolution. Its nodes are images of those of the edge,

    x_s = x + s t(x) = M_s x + s t_0 ,    t = t_0 + A x ,    M_s = 1 + s A ,

in the plane and in rows on either side of it. In the plane the facet is the edge, with t for its
second tangent. Forces and blocks on the images go back by the transposed maps.
"""

from __future__ import annotations

import numpy as np

from anisocontact.base.array_types import Floats, Locals
from anisocontact.contact.quadrature import Couplings
from anisocontact.mesh import Model

#: Half the angle of a facet of revolution, radian.
ANGLE = 0.5
#: Length across the plane at an axis of revolution over the largest radius: rounding elsewhere,
#: where facets end in a point they would have no tangent.
ON_AXIS = 1e-12
#: Rows of images: in the plane, before it and behind it.
ROWS = np.array([0.0, -1.0, 1.0])
#: Nodes of a facet by the order of its edge: node of the edge and row.
_NODES = {
    1: [(0, 1), (1, 1), (0, 2), (1, 2)],
    2: [(0, 1), (1, 1), (0, 2), (1, 2), (2, 1), (0, 0), (1, 0), (2, 2), (2, 0)],
}
#: Nodes of an edge among those of its facet.
_EDGE = {1: [0, 1], 2: [0, 1, 4]}


class Sweep:
    """Images of the nodes of a mesh in the plane, numbered row by row after those of the mesh.

    The first row is the nodes themselves.

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
        self._count, self._nodes = len(x), np.array(_NODES[model.order])
        self._edge = _EDGE[model.order]
        self._maps = np.eye(3) + shares[:, None, None] * ideal.turn
        self._shifts = shares[:, None] * offset
        self.share = float(0.5 / width)

    @classmethod
    def of(cls, model: Model) -> Sweep | None:
        """That of a mesh in the plane; None of one in space."""
        return cls(model) if model.idealisation.dim == 2 else None

    def facets(self, edges: Locals) -> Locals:
        """Nodes of the facets of edges, (m, 4 or 9), from those of the edges, (m, 2 or 3)."""
        node, row = self._nodes.T
        return np.asarray(edges[:, node] + self._count * row, dtype=np.int32)

    def edges(self, facets: Locals) -> Locals:
        """Nodes of the edges, (m, 2 or 3), from those of the facets that `facets` made of them."""
        return self.named(facets[:, self._edge])

    def tangents(self, nodes: Locals, shares: Floats) -> tuple[Locals, Floats]:
        """Images, (n, 2 k), and factors at which they sum up to mean tangents across the plane.

        Args:
            nodes: Nodes of the mesh, (n, k).
            shares: Of each in the mean, (n, k).
        """
        images = [nodes + row * self._count for row in (1, 2)]
        factors = [sign * self.share * shares for sign in ROWS[1:]]
        return np.concatenate(images, axis=1).astype(np.int32), np.concatenate(factors, axis=1)

    def moved(self, u: Floats) -> Floats:
        """Displacements of the images, (rows nodes, 3), from those of the nodes, (nodes, 3)."""
        return np.concatenate([u @ one.T for one in self._maps])

    def positions(self, x: Floats) -> Floats:
        """Positions of the images, (rows nodes, 3), from those of the nodes, length."""
        return np.asarray(self.moved(x) + np.repeat(self._shifts, self._count, axis=0))

    def named(self, nodes: Locals) -> Locals:
        """Nodes of which these are images; -1 for none."""
        return np.where(nodes < 0, -1, nodes % self._count).astype(np.int32)

    def fold(self, forces: Floats, out: Floats) -> None:
        """Add forces on the images, (rows nodes, 3), to those on the nodes, (nodes, 3)."""
        rows = forces.reshape(len(self._maps), self._count, 3)
        out += np.einsum("sni,sij->nj", rows, self._maps)

    def folded(self, found: Couplings) -> Couplings:
        """Blocks between images as blocks between the nodes."""
        rows, columns, blocks = found
        (p, r), c = rows.shape, columns.shape[1]
        own = blocks.reshape(p, r, 3, c, 3) if blocks.ndim == 3 else blocks.swapaxes(2, 3)
        left, right = (self._maps[np.maximum(n, 0) // self._count] for n in (rows, columns))
        turned = np.einsum("prji,prjck,pckl->pricl", left, own, right, optimize=True)
        return self.named(rows), self.named(columns), turned.reshape(p, 3 * r, 3 * c)
