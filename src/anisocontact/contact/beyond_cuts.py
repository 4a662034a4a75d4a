"""What goes on beyond the cut faces of a sector: nodes and facets once more, turned.

A sector stands for a whole. Where slave and master are both cut, slave nodes on the two cut faces
are one node of the whole, with the facets of both sides around it, and the master goes all around.
What is turned there moves with the nodes it is an image of; forces on it go back to these by the
transposed turn, see `Images`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from anisocontact.base.array_types import Floats, Ints, Locals
from anisocontact.contact.facet_mesh import FacetMesh
from anisocontact.contact.images import Images
from anisocontact.contact.turning import Turning


@dataclass(frozen=True)
class Seam:
    """Nodes of two cut faces that are one node of the whole.

    Attributes:
        turning: How the first are turned to the second.
        leading: Nodes of the mesh, (n,).
        following: That which each is turned to, (n,).
    """

    turning: Turning
    leading: Ints
    following: Ints

    def ends(self, turning: Turning) -> tuple[Ints, Ints]:
        """Nodes of the cut face that a turn brings to the other one, and of that, (n,)."""
        if turning.same_as(self.turning):
            return self.leading, self.following
        return self.following, self.leading


@dataclass(frozen=True)
class Led:
    """Nodes that follow others, after all nodes of the mesh.

    Attributes:
        leading: The nodes that they follow, (n,).
    """

    leading: Ints

    def everywhere[T: np.generic](self, nodal: npt.NDArray[T]) -> npt.NDArray[T]:
        """Values of the nodes, then of those that these follow."""
        return np.concatenate([nodal, nodal[self.leading]])


class BeyondCuts:
    """Images of a mesh turned to all other sectors, with the nodes of cut faces once.

    Args:
        images: Images of the nodes in the sector.
        seams: Cut faces of the bodies, all with one turn, to either side.

    Attributes:
        images: Those, then the same turned to one sector after the other.
    """

    def __init__(self, images: Images, seams: Sequence[Seam]) -> None:
        there = seams[0].turning
        self._seams, self._turns = list(seams), there.repeats
        self._turnings = [there.times(k) for k in range(self._turns)]
        self.images = images.turned(self._turnings[1:])
        self._count, self._first = images.count, images.rows * images.count
        # nodes of one cut face, and those that the turn brings them to
        ends = [one.ends(there) for one in seams]
        self._ends = tuple(np.concatenate(both) for both in zip(*ends, strict=True))

    def _numbers(self, k: int) -> Locals:
        """Number of what each node of the mesh is turned to by k turns, (nodes,)."""
        low, high = self._ends
        found = k * self._first + np.arange(self._count)
        if k == 1:
            found[low] = high
        found[high] = (k + 1) % self._turns * self._first + low
        return found.astype(np.int32)

    def whole(self, mesh: FacetMesh) -> FacetMesh:
        """Facets, then all of them in one sector after the other."""
        turned = [self._turned(mesh, k) for k in range(1, self._turns)]
        nodes = np.concatenate([mesh.nodes, *turned])
        return replace(mesh, nodes=nodes, flip=np.tile(mesh.flip, self._turns))

    def beside(self, mesh: FacetMesh) -> tuple[FacetMesh, Ints]:
        """Facets, then those of them that lie turned beside leading nodes.

        Returns:
            These, and the number of the facet that each is.
        """
        leading = self.followed(mesh)[0]
        nodes, which = [mesh.nodes], [np.arange(len(mesh.nodes))]
        for k in sorted({1, self._turns - 1}):
            turned = self._turned(mesh, k)
            here = (turned < self._first) & np.isin(turned % self._count, leading)
            met = np.flatnonzero(here.any(axis=1))
            nodes.append(turned[met])
            which.append(met)
        of = np.concatenate(which)
        return replace(mesh, nodes=np.concatenate(nodes), flip=mesh.flip[of]), of

    def all_around(self, places: Floats, vectors: Floats) -> tuple[Floats, Floats]:
        """Places, (n, 3), and vectors there, (n, 3), in all sectors."""
        turned = [(one.of(places), vectors @ one.matrix.T) for one in self._turnings]
        here, along = zip(*turned, strict=True)
        return np.concatenate(here), np.concatenate(along)

    def followed(self, mesh: FacetMesh) -> tuple[Ints, Ints]:
        """Nodes of the mesh on facets that lead, and those on them that follow each, (n,)."""
        nodes = np.unique(self.images.named(mesh.nodes))
        leading, following = (
            np.concatenate([getattr(seam, name) for seam in self._seams])
            for name in ("leading", "following")
        )
        both = np.isin(leading, nodes) & np.isin(following, nodes)
        return leading[both], following[both]

    def _turned(self, mesh: FacetMesh, k: int) -> Locals:
        row, node = np.divmod(mesh.nodes, self._count)
        return np.asarray(self._numbers(k)[node] + self._count * row, dtype=np.int32)
