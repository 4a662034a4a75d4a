"""Displacements of which those of the interior take a solution: what is known without it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from anisocontact.base.array_types import Flags, Floats
from anisocontact.base.fenicsx import Vec


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


class PartlyKnown(Protocol):
    """Displacements of which those of the interior take a solution; see `Condensed`."""

    def kept(self, x: Vec) -> Kept:
        """What is known of a trial state in equilibrium without the interior."""
        ...

    def mean(self, group: str, weights: Floats, x: Vec | None = None) -> Floats:
        """Sum of the displacements of all nodes times their weights, (3,) or (3, k), length.

        Args:
            group: Name under which the weights are known.
            weights: Weight of each node, (nodes,) or (nodes, k).
            x: All unknowns of a trial state in equilibrium; the accepted one if not given.
        """
        ...

    def displacement(self, x: Vec) -> Floats:
        """Displacement of all nodes in a trial state in equilibrium, (nodes, 3), length."""
        ...
