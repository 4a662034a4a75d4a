"""Facets on a square grid, for what is timed on a sheet."""

from __future__ import annotations

import numpy as np

#: Nodes of the facets of a cell on a grid of (degree + 1) x (degree + 1) points.
NODES = {
    "tri3": [[(0, 0), (1, 0), (0, 1)], [(1, 1), (0, 1), (1, 0)]],
    "tri6": [
        [(0, 0), (2, 0), (0, 2), (1, 1), (0, 1), (1, 0)],
        [(2, 2), (0, 2), (2, 0), (1, 1), (2, 1), (1, 2)],
    ],
    "quad4": [[(0, 0), (1, 0), (0, 1), (1, 1)]],
    "quad8": [[(0, 0), (2, 0), (0, 2), (2, 2), (1, 0), (0, 1), (2, 1), (1, 2)]],
    "quad9": [[(0, 0), (2, 0), (0, 2), (2, 2), (1, 0), (0, 1), (2, 1), (1, 2), (1, 1)]],
}


def grid(cells: int, topology: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Coordinates x and y of the points of a unit square, and its facets."""
    degree = 1 if topology in {"tri3", "quad4"} else 2
    m = degree * cells + 1
    y, x = (a.ravel() for a in np.meshgrid(*[np.linspace(0.0, 1.0, m)] * 2, indexing="ij"))
    j, i = (degree * a.ravel() for a in np.meshgrid(*[np.arange(cells)] * 2, indexing="ij"))
    facets = [np.column_stack([(j + b) * m + i + a for a, b in nodes]) for nodes in NODES[topology]]
    return x, y, np.concatenate(facets)
