"""Edges of a mesh in the plane as facets in space, for what knows facets alone.

A facet that meets others is swept out of an edge across the plane: straight in a plane, along the
tangent of the circle in a body of revolution. Its nodes are images of those of the edge,

    x_s = x + s t(x) = M_s x + s t_0 ,    t = t_0 + A x ,    M_s = 1 + s A ,

in rows on either side of the plane, and in it where there are three. In the plane the facet is the
edge, with t for its second tangent. Forces and blocks on the images go back by the transposed maps.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from anisocontact.contact.quadrature import Couplings
from anisocontact.mesh import Model

Ints = npt.NDArray[np.int32]
Floats = npt.NDArray[np.float64]

#: Half the angle of a facet of revolution, radian.
ANGLE = 0.5
#: Nodes of a facet by the order of its edge: node of the edge and row.
_NODES = {
    1: [(0, 0), (1, 0), (0, 1), (1, 1)],
    2: [(0, 0), (1, 0), (0, 2), (1, 2), (2, 0), (0, 1), (1, 1), (2, 2), (2, 1)],
}


class Sweep:
    """Images of the nodes of a mesh in the plane, numbered row by row after those of the mesh.

    The first row has the numbers of the nodes themselves.

    Args:
        model: The mesh.

    Attributes:
        share: Of the area of a facet, that of the thickness or of the circumference.
    """

    def __init__(self, model: Model) -> None:
        ideal, x = model.idealisation, np.asarray(model.space.tabulate_dof_coordinates())
        round_ = ideal.turn.any()
        # in a plane as wide as the mesh: what slides across it stays on the facet
        width = ANGLE / (2.0 * np.pi) if round_ else np.ptp(x, axis=0).max() / ideal.offset[2]
        shares = width * np.linspace(-1.0, 1.0, model.order + 1)
        self._count, self._nodes = len(x), np.array(_NODES[model.order])
        self._maps = np.eye(3) + shares[:, None, None] * ideal.turn
        self._shifts = shares[:, None] * ideal.offset
        self.share = float(0.5 / width)

    @classmethod
    def of(cls, model: Model) -> Sweep | None:
        """That of a mesh in the plane; None of one in space."""
        return cls(model) if model.idealisation.dim == 2 else None

    def facets(self, edges: Ints) -> Ints:
        """Nodes of the facets of edges, (m, 4 or 9), from those of the edges, (m, 2 or 3)."""
        node, row = self._nodes.T
        return np.asarray(edges[:, node] + self._count * row, dtype=np.int32)

    def moved(self, u: Floats) -> Floats:
        """Displacements of the images, (rows nodes, 3), from those of the nodes, (nodes, 3)."""
        return np.concatenate([u @ one.T for one in self._maps])

    def positions(self, x: Floats) -> Floats:
        """Positions of the images, (rows nodes, 3), from those of the nodes, length."""
        return np.asarray(self.moved(x) + np.repeat(self._shifts, self._count, axis=0))

    def named(self, nodes: Ints) -> Ints:
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
