"""Who answers for the bulk of a problem while only some unknowns are kept up to date."""

from __future__ import annotations

from typing import Protocol

import numpy as np
import numpy.typing as npt

from anisocontact._fenicsx import Vec
from anisocontact.solver.persistent import Arrays

Floats = npt.NDArray[np.float64]


class Reduction(Protocol):
    """Bulk of which only some unknowns are kept up to date; see `Condensed`."""

    def commit(self, x: Vec) -> float:
        """Take over an accepted state and return the work from outside since the last one."""
        ...

    def pending(self) -> Arrays:
        """What `recover` needs beside the accepted state, at the nodes; none if it is up to date.

        "in_reach" are the nodes at which the accepted state is true, (nodes,); "load" and
        "contact_force" the forces of that state, (nodes, 3).
        """
        ...

    def recover(self) -> None:
        """Bring the state of all unknowns up to date with `Problem.complete`."""
        ...

    def reactions(self) -> dict[str, Floats]:
        """Force of the supports of each facet group on the bodies, (3,), force."""
        ...

    def elastic(self) -> float:
        """Elastic energy of the accepted state."""
        ...

    def mean(self, group: str, weights: Floats) -> Floats:
        """Sum of the displacements of all nodes times their weights, (3,), length."""
        ...
