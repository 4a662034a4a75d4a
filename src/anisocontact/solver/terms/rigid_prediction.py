"""Where forces carry a body on springs, taken for rigid."""

from __future__ import annotations

from typing import Any

import numpy as np

from anisocontact.base.array_types import Floats, Ints
from anisocontact.solver.terms.free_modes import ConnectedBody

#: Share of the largest resistance of closed points below which a motion meets none; share of the
#: largest stiffness below which springs have none.
UNRESISTED, NO_STIFFNESS = 1e-6, 1e-10


class RigidPrediction:
    """Free motions of a body on springs of unit stiffness, from where its nodes are now.

    Args:
        body: The body.
        motions: Its motions that nothing but contact and these springs holds, (j, 6).
        nodes: Nodes of this rank with springs.
        places: Where they are in the mesh, (n, 3), length.
        moved: Their displacement, (n, 3), length.
        comm: Communicator of the mesh.
    """

    def __init__(
        self,
        body: ConnectedBody,
        motions: Floats,
        nodes: Ints,
        places: Floats,
        moved: Floats,
        comm: Any,
    ) -> None:
        self._comm, self._motions, self._size = comm, motions, body.size
        self._count = max(comm.allreduce(len(nodes)), 1)
        self._centre = body.centre + comm.allreduce(moved.sum(axis=0)) / self._count
        self._fields = self.at(places + moved)
        gram = np.einsum("nai,naj->ij", self._fields, self._fields)
        self._gram: Floats = comm.allreduce(gram)

    def at(self, places: Floats) -> Floats:
        """The motions at places of now, (n, 3, j)."""
        arms = (places - self._centre) / self._size
        turns = np.cross(self._motions[:, 3:], arms[:, None])
        return np.asarray((self._motions[:, :3] + turns).transpose(0, 2, 1))

    def along(self, force: Floats) -> Floats:
        """Generalised forces of forces on the nodes with springs, (n, 3); (j,)."""
        own = np.einsum("nai,na->i", self._fields, force)
        return np.asarray(self._comm.allreduce(own))

    def motion(self, push: Floats, resisted: Floats | None = None) -> Floats:
        """Where generalised forces carry it, (j,).

        Args:
            push: The forces, (j,).
            resisted: Sum of the squares of the motions that contact resists, (j, j): what meets
                nothing of it is left. Nothing is resisted if left out.
        """
        ways = np.eye(len(push))
        if resisted is not None:
            sizes, axes = np.linalg.eigh(resisted)
            ways = axes[:, sizes <= UNRESISTED * sizes[-1]]
        stiffness = ways.T @ self._gram @ ways
        inverse = np.linalg.pinv(stiffness, rcond=NO_STIFFNESS, hermitian=True)
        return np.asarray(ways @ (inverse @ (ways.T @ push)))

    def way(self, motion: Floats) -> float:
        """Root mean square of the ways of the nodes with springs in a motion, length."""
        return float(np.sqrt(motion @ self._gram @ motion / self._count))
