"""Who answers for the bulk of a problem while only some unknowns are kept up to date."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt

from anisocontact.base.fenicsx import Vec
from anisocontact.solver.terms.persistent import Arrays

Floats = npt.NDArray[np.float64]
Flags = npt.NDArray[np.bool_]


@dataclass(frozen=True)
class Kept:
    """What is known of a state without the interior.

    Attributes:
        nodes: Nodes whose displacement is, (nodes,).
        u: Displacements, true at these, (nodes, 3), length.
        along_loads: Mean displacement along all loads, length.
    """

    nodes: Flags
    u: Floats
    along_loads: float


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

    def mean(self, group: str, weights: Floats, x: Vec | None = None) -> Floats:
        """Sum of the displacements of all nodes times their weights, (3,) or (3, k), length.

        Args:
            group: Name under which the weights are known.
            weights: Weight of each node, (nodes,) or (nodes, k).
            x: All unknowns of a trial state in equilibrium; the accepted one if not given.
        """
        ...

    def kept(self, x: Vec) -> Kept:
        """What is known of a trial state in equilibrium without the interior."""
        ...

    def displacement(self, x: Vec) -> Floats:
        """Displacement of all nodes in a trial state in equilibrium, (nodes, 3), length."""
        ...
