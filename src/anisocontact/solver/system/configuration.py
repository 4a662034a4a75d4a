"""Where the bodies are."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from anisocontact.base.fenicsx import MPI, Vec, fem
from anisocontact.bulk import Material
from anisocontact.mesh import Model
from anisocontact.solver.system.balance import Place
from anisocontact.solver.system.cells import DeformedCells
from anisocontact.solver.system.parts import Parts

Floats = npt.NDArray[np.float64]


class Configuration:
    """The bodies of a problem, brought from one state of all unknowns to the next.

    Args:
        parts: Parts of the problem.
        model: Mesh of the bodies.
        materials: Material of each body.

    Attributes:
        u: Displacement, a DOLFINx function.
    """

    def __init__(self, parts: Parts, model: Model, materials: Mapping[str, Material]) -> None:
        self._parts = parts
        self.u: Any = fem.Function(model.space, name="displacement")
        self._owned = parts.bulk.stiffness.createVecRight()
        finite = [name for name, material in materials.items() if not material.linear]
        self._cells = DeformedCells(model, finite)
        self._at: Floats | None = None

    @property
    def nodal(self) -> Floats:
        """Displacement of the local nodes, (nodes, 3), length."""
        return np.asarray(self.u.x.array.reshape(-1, 3))

    def take(self, x: Vec) -> Place:
        """Bring all bodies to a state.

        Args:
            x: All unknowns, length.

        Returns:
            The state; the next one overwrites it.
        """
        self._at = np.array(x.array_r)
        nodal, rigid = self._parts.layout.split(x)
        self._owned.array[:] = nodal.reshape(-1)
        self.u.x.array[: self._parts.layout.owned] = self._owned.array_r
        self.u.x.scatter_forward()
        self._parts.rigid.place(rigid)
        return Place(x, self._owned, self.nodal, rigid)

    def is_at(self, x: Vec) -> bool:
        """Whether the bodies are at a state, and nothing else has changed since; collective."""
        here = self._at is not None and np.array_equal(self._at, x.array_r)
        # a process whose own unknowns have not moved goes along
        return bool(self._parts.layout.comm.allreduce(here, MPI.LAND))

    def commit(self) -> None:
        """Accept the state: histories of materials advance."""
        self._parts.bulk.commit(self._owned)

    def forget(self) -> None:
        """Something else has changed: the same state has to be evaluated anew."""
        self._at = None

    def elastic(self, x: Vec) -> float:
        """Elastic energy of a state, force times length."""
        self._owned.array[:] = x.array_r[: self._parts.layout.owned]
        return self._parts.bulk.energy(self._owned)

    def inverted(self) -> Floats:
        """Middles of the cells of this rank that are turned inside out, (n, 3), length.

        Cells at small strain do not count: their equations know no det F.
        """
        return self._cells.inverted(self.nodal)
