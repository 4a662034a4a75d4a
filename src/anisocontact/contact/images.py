"""Images of nodes: places that follow them by linear maps."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from anisocontact.base.array_types import Floats, Locals
from anisocontact.contact.quadrature import Couplings
from anisocontact.contact.turning import Turning


class Images:
    """Images x_r = M_r x + s_r of the nodes of a mesh, numbered row by row after these.

    The first row is the nodes themselves. Forces and blocks on images go back by the transposed
    maps.

    Args:
        count: Number of nodes of the mesh.
        maps: M_r, (rows, 3, 3).
        shifts: s_r, (rows, 3), length.

    Attributes:
        count: As given.
    """

    def __init__(self, count: int, maps: Floats, shifts: Floats) -> None:
        self.count, self._maps, self._shifts = count, maps, shifts

    @property
    def rows(self) -> int:
        """How many images a node has, itself among them."""
        return len(self._maps)

    def turned(self, turnings: Sequence[Turning]) -> Images:
        """These, then all of them once more for each of some turns."""
        maps, shifts = [self._maps], [self._shifts]
        for one in turnings:
            maps.append(one.matrix @ self._maps)
            shifts.append(one.of(self._shifts))
        return Images(self.count, np.concatenate(maps), np.concatenate(shifts))

    def moved(self, u: Floats) -> Floats:
        """Displacements of the images, (rows nodes, 3), from those of the nodes, (nodes, 3)."""
        return np.concatenate([u @ one.T for one in self._maps])

    def positions(self, x: Floats) -> Floats:
        """Positions of the images, (rows nodes, 3), from those of the nodes, length."""
        return np.asarray(self.moved(x) + np.repeat(self._shifts, self.count, axis=0))

    def named(self, nodes: Locals) -> Locals:
        """Nodes of which these are images; -1 for none."""
        return np.where(nodes < 0, -1, nodes % self.count).astype(np.int32)

    def fold(self, forces: Floats, out: Floats) -> None:
        """Add forces on the images, (rows nodes, 3), to those on the nodes, (nodes, 3)."""
        rows = forces.reshape(len(self._maps), self.count, 3)
        out += np.einsum("sni,sij->nj", rows, self._maps)

    def folded(self, found: Couplings) -> Couplings:
        """Blocks between images as blocks between the nodes."""
        rows, columns, blocks = found
        (p, r), c = rows.shape, columns.shape[1]
        own = blocks.reshape(p, r, 3, c, 3) if blocks.ndim == 3 else blocks.swapaxes(2, 3)
        left, right = (self._maps[np.maximum(n, 0) // self.count] for n in (rows, columns))
        turned = np.einsum("prji,prjck,pckl->pricl", left, own, right, optimize=True)
        return self.named(rows), self.named(columns), turned.reshape(p, 3 * r, 3 * c)
