"""The bulk of a problem as it is solved for: all unknowns, or condensed on those of contact."""

from __future__ import annotations

from typing import Protocol

from anisocontact.base.array_types import Floats
from anisocontact.base.fenicsx import Vec
from anisocontact.solver.system.ends_work import EndsWork
from anisocontact.solver.system.rotations import BodyRotation, Rotations
from anisocontact.solver.terms.persistent import Arrays


class Reduction(Protocol):
    """Bulk of which all unknowns are kept up to date, or only some; see `Whole` and `Condensed`.

    Attributes:
        whole: Whether all are.
    """

    whole: bool

    def commit(self, x: Vec) -> EndsWork:
        """Take over an accepted state and return the work from outside since the last one."""
        ...

    def nodal(self, x: Vec) -> Floats:
        """Displacement of the local nodes, true where bodies can be touched, (nodes, 3), length."""
        ...

    def displacement(self, x: Vec) -> Floats:
        """Displacement of the local nodes in a trial state in equilibrium, (nodes, 3), length."""
        ...

    def pending(self) -> Arrays:
        """What `recover` needs beside the accepted state, at the nodes; none if it is up to date.

        "in_reach" are the nodes at which the accepted state is true, (nodes,); "load" and
        "contact_force" the forces of that state, (nodes, 3).
        """
        ...

    def recover(self) -> None:
        """Bring the state of all unknowns up to date with `Whole.complete`."""
        ...

    def reactions(self, x: Vec | None = None) -> dict[str, Floats]:
        """Force of the supports of each facet group on the bodies, (3,), force.

        Args:
            x: All unknowns of the trial in equilibrium; the accepted state if not given.
        """
        ...

    def elastic(self) -> float:
        """Elastic energy of the accepted state."""
        ...

    def mean(self, group: str, weights: Floats, x: Vec | None = None) -> Floats:
        """Sum of the displacements of all nodes times their weights, (3,), length.

        Args:
            group: Name under which the weights are known.
            weights: Weight of each node, (nodes,).
            x: All unknowns of a trial in equilibrium; the accepted state if not given.
        """
        ...

    def turned(self, rotations: Rotations, x: Vec, last: bool) -> dict[str, BodyRotation]:
        """How far bodies have turned in a trial state in equilibrium, by name.

        Args:
            rotations: Who tells from displacements.
            x: All unknowns of the state.
            last: Whether this is the end of a step.
        """
        ...
