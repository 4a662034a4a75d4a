"""Closest points per second and core on a wavy sheet, by topology, distance and hint.

    python benchmarks/search.py [cells of a side]

Cold: no hint. Warm: with the projection of the same point before it moved by a third of a facet.
Processor time of one thread.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable

import numpy as np
from facet_grid import grid

from anisocontact.surfaces import TOPOLOGIES, FacetProjections, FacetSurface

POINTS = 200_000


def height(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """The sheet, three waves of two hundredths of its side."""
    return 0.02 * np.sin(20.0 * x) * np.cos(15.0 * y)


def sheet(cells: int, topology: str) -> tuple[np.ndarray, np.ndarray]:
    """Points and facets."""
    x, y, facets = grid(cells, topology)
    return np.column_stack((x, y, height(x, y))), facets


def seconds(work: Callable[[], FacetProjections]) -> tuple[float, FacetProjections]:
    """Processor time of a projection, the better of two."""
    times = []
    for _ in range(2):
        start = time.process_time()
        result = work()
        times.append(time.process_time() - start)
    return min(times), result


def main(cells: int = 141) -> None:
    """Print the table."""
    rng = np.random.default_rng(1)
    side = int(np.sqrt(POINTS))
    y, x = (a.ravel() for a in np.meshgrid(*[(np.arange(side) + 0.5) / side] * 2, indexing="ij"))
    print("| facets | number | distance, sizes | cold, thousand/s | warm, thousand/s | refit, ms |")
    print("|---|---|---|---|---|---|")
    for topology in TOPOLOGIES:
        points, facets = sheet(cells, topology)
        surface = FacetSurface(points, facets, topology)
        start = time.process_time()
        surface.update(points)
        refit = 1e3 * (time.process_time() - start)
        size = 1.0 / cells
        for far in (0.1, 1.0, 10.0):
            z = height(x, y) + far * size * rng.normal(size=x.size)
            before = np.column_stack((x, y, z))
            now = before + size * np.array([0.3, 0.1, 0.01])
            hint = surface.project(before, threads=1)
            cold, a = seconds(lambda s=surface, p=now: s.project(p, threads=1))
            warm, b = seconds(lambda s=surface, p=now, h=hint: s.project(p, hint=h, threads=1))
            assert np.abs(a.gap - b.gap).max() < 1e-12
            rates = " | ".join(f"{1e-3 * x.size / t:.0f}" for t in (cold, warm))
            print(f"| {topology} | {len(surface)} | {far} | {rates} | {refit:.1f} |")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
