"""The current configuration of the bodies, at a state of all unknowns."""

from __future__ import annotations

from typing import Any

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.fenicsx import MPI, Vec, fem
from anisocontact.bulk import small_strain
from anisocontact.solver.system.assembly import TrialState
from anisocontact.solver.system.cells import DeformedCells
from anisocontact.solver.system.parts import ProblemParts


class Configuration:
    """The bodies of a problem, brought from one state of all unknowns to the next.

    Attributes:
        u: Displacement, a DOLFINx function.
    """

    def __init__(self, parts: ProblemParts) -> None:
        self._parts = parts
        self.u: Any = fem.Function(parts.model.space, name="displacement")
        finite = [name for name, material in parts.materials.items() if not small_strain(material)]
        self._cells = DeformedCells(parts.model, finite)
        self._at: Floats | None = None

    @property
    def nodal(self) -> Floats:
        """Displacement of the local nodes, (nodes, 3), length; read only."""
        values: Floats = self.u.x.array.reshape(-1, 3)
        values.flags.writeable = False
        return values

    def take(self, x: Vec) -> TrialState:
        """Bring all bodies to a state.

        Args:
            x: All unknowns, length.

        Returns:
            The state; the next one overwrites it.
        """
        self._at = np.array(x.array_r)
        nodal, rigid = self._parts.layout.split(x)
        self.u.x.array[: self._parts.layout.owned] = nodal.reshape(-1)
        self.u.x.scatter_forward()
        self._parts.rigid.place(rigid)
        return TrialState(x, self.nodal, rigid)

    def is_at(self, x: Vec) -> bool:
        """Whether the bodies are at a state, and nothing else has changed since; collective."""
        here = self._at is not None and np.array_equal(self._at, x.array_r)
        # a process whose own unknowns have not moved goes along
        return bool(self._parts.layout.comm.allreduce(here, MPI.LAND))

    def forget(self) -> None:
        """Something else has changed: the same state has to be evaluated anew."""
        self._at = None

    def inverted(self) -> Floats:
        """Middles of the cells of this rank that are inverted, (n, 3), length.

        Cells at small strain do not count: their equations know no det F.
        """
        return self._cells.inverted(self.nodal)

    def folded(self) -> dict[str, Floats]:
        """Middles of those folded at a corner, by body, as `inverted`."""
        return self._cells.folded(self.nodal)
