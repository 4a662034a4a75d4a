"""Where the unknowns of a problem are: those of the mesh, then those of rigid bodies."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from anisocontact.base.array_types import Floats
from anisocontact.base.fenicsx import MPI, PETSc, Vec
from anisocontact.mesh.node_unknowns import NodeUnknowns


class Layout:
    """Unknowns of the mesh on every rank, those of rigid bodies behind them on the last one.

    Args:
        unknowns: Where the displacement of nodes is among those of the mesh.
        rigid: Number of unknowns of rigid bodies.

    Attributes:
        unknowns: As given.
        comm: Communicator of the mesh.
        owned: Number of unknowns of the mesh this rank owns.
        rigid: Number of unknowns of rigid bodies.
        last_rank: Whether this rank has them.
    """

    def __init__(self, unknowns: NodeUnknowns, rigid: int) -> None:
        self.unknowns, self.comm = unknowns, unknowns.comm
        self.owned = unknowns.owned
        self.rigid = rigid
        self.last_rank = bool(self.comm.rank == self.comm.size - 1)
        self._memory = unknowns.ghosted()  # owns what is behind its PETSc vector
        self._ghosted = self._memory.petsc_vec

    def new_vector(self) -> Vec:
        """Vector of the unknowns, zero."""
        vector = PETSc.Vec().create(self.comm)
        vector.setSizes((self.owned + self.rigid * self.last_rank, None), bsize=self.unknowns.block)
        vector.setType(PETSc.Vec.Type.STANDARD)
        return vector

    def split(self, x: Vec) -> tuple[Floats, Floats]:
        """Values at the nodes this rank owns, (nodes, 3), and of the rigid bodies on every rank."""
        values = np.array(x.array_r)
        rigid = values[self.owned :]
        if self.rigid:
            rigid = np.asarray(self.comm.bcast(rigid, root=self.comm.size - 1))
        return values[: self.owned].reshape(-1, 3), rigid

    def joined(self, nodal: Floats, rigid: Floats) -> Vec:
        """Vector of the parts that `split` gives."""
        x = self.new_vector()
        x.array[: self.owned] = nodal.reshape(-1)
        if self.last_rank:
            x.array[self.owned :] = rigid
        return x

    def assembled(self, nodal: Floats) -> Floats:
        """Forces on the local nodes, (nodes, 3), with what other ranks add to them.

        Returns:
            Of the unknowns this rank owns.
        """
        with self._ghosted.localForm() as form:
            form.array[:] = self.unknowns.local(nodal)
        self._ghosted.ghostUpdate(PETSc.InsertMode.ADD_VALUES, PETSc.ScatterMode.REVERSE)
        return np.array(self._ghosted.array_r)

    def norms(self, *owned: Floats) -> list[float]:
        """Norms over all ranks of what each owns; collective, once for all of them."""
        local = np.array([values @ values for values in owned])
        self.comm.Allreduce(MPI.IN_PLACE, local)
        return [float(square) for square in np.sqrt(local)]

    def total(self, values: npt.ArrayLike) -> Any:
        """Sum over all ranks, entry by entry; collective."""
        own = np.asarray(values)
        out = np.empty_like(own)
        self.comm.Allreduce(own, out)
        return out
