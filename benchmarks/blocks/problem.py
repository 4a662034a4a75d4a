"""The two problems and their meshes.

A block 1 x 1 x 0.5 of n x n x n/2 hexahedra, E = 1000, nu = 0.3, small strain, on a rigid plane
("plane") or on an elastic block 2 x 2 x 0.5 of m x m x m/4 hexahedra, m = 3 n / 2, clamped below
("block"). Its top goes down by 0.01 in 5 increments, then along x by 0.02 in 10. Coulomb friction,
mu = 0.3, penalties 1e5 along the normal and the tangent.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

KINDS = ("plane", "block")
YOUNG, POISSON, FRICTION, PENALTY = 1000.0, 0.3, 0.3, 1e5
DOWN, ALONG, PRESSES, DRAGS = 0.01, 0.02, 5, 10


@dataclass(frozen=True)
class Grid:
    """A box of hexahedra.

    Attributes:
        points: Nodes, x fastest, (nodes, 3).
        cells: Nodes of the cells: lower face counter-clockwise, then the upper one, (cells, 8).
        layers: Number of nodes in one layer along z.
    """

    points: np.ndarray
    cells: np.ndarray
    layers: int

    @property
    def bottom(self) -> np.ndarray:
        """Nodes of the lowest layer."""
        return np.arange(self.layers)

    @property
    def top(self) -> np.ndarray:
        """Nodes of the highest layer."""
        return np.arange(len(self.points) - self.layers, len(self.points))


def grid(origin: tuple[float, ...], size: tuple[float, ...], cells: tuple[int, int, int]) -> Grid:
    """A box with its lowest corner in `origin`."""
    axes = [np.linspace(o, o + s, c + 1) for o, s, c in zip(origin, size, cells, strict=True)]
    z, y, x = np.meshgrid(*axes[::-1], indexing="ij")
    number = np.arange(x.size).reshape(x.shape)
    low, high = number[:-1], number[1:]
    ring = [np.s_[:, :-1, :-1], np.s_[:, :-1, 1:], np.s_[:, 1:, 1:], np.s_[:, 1:, :-1]]
    corners = [part[at].ravel() for part in (low, high) for at in ring]
    points = np.column_stack([a.ravel() for a in (x, y, z)])
    return Grid(points, np.column_stack(corners), x[0].size)


def upper(n: int) -> tuple[int, int, int]:
    """Cells of the block."""
    return n, n, n // 2


def lower(n: int) -> tuple[int, int, int]:
    """Cells of the block below: they do not match."""
    m = 3 * n // 2
    return m, m, max(1, m // 4)


def path() -> list[tuple[float, float]]:
    """Displacement of the top along x and z after each increment."""
    down = [(0.0, -DOWN * k / PRESSES) for k in range(1, PRESSES + 1)]
    return down + [(ALONG * k / DRAGS, -DOWN) for k in range(1, DRAGS + 1)]
