"""Meshes of the hard cases: drawn with gmsh, and planes of nodes that are fine at a contact."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest


@contextmanager
def drawn(path: Path, order: int = 1, dim: int = 2) -> Iterator[Any]:
    """gmsh, in which something is drawn that is meshed and written at the end.

    Args:
        path: The file to be written.
        order: Of the cells.
        dim: Their dimension.
    """
    gmsh = pytest.importorskip("gmsh")
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        yield gmsh
        gmsh.model.mesh.generate(dim)
        gmsh.model.mesh.setOrder(order)
        gmsh.write(str(path))
    finally:
        gmsh.finalize()


def fine_at(gmsh: Any, places: Sequence[tuple[int, int, float, float, float]]) -> None:
    """Let cells be fine within 1.5 around a point of each surface, and grow from there on.

    Args:
        gmsh: As of `drawn`.
        places: Surface, point, size of the cells there and far away, and where that is.
    """
    field, sizes = gmsh.model.mesh.field, []
    for surface, point, size, coarse, far in places:
        away, grown, one = field.add("Distance"), field.add("Threshold"), field.add("Restrict")
        field.setNumbers(away, "PointsList", [point])
        field.setNumber(grown, "InField", away)
        for key, values in (("Size", (size, coarse)), ("Dist", (1.5, far))):
            for end_of, value in zip(("Min", "Max"), values, strict=True):
                field.setNumber(grown, key + end_of, value)
        field.setNumber(one, "InField", grown)
        field.setNumbers(one, "SurfacesList", [surface])
        sizes.append(one)
    least = field.add("Min")
    field.setNumbers(least, "FieldsList", sizes)
    field.setAsBackgroundMesh(least)
    for key in ("FromPoints", "ExtendFromBoundary"):
        gmsh.option.setNumber(f"Mesh.MeshSize{key}", 0)


def graded(facets: int, even: int, size: float, growth: float = 1.35) -> npt.NDArray[np.float64]:
    """Places of nodes from 0 to 1, even ones and then ever farther apart.

    Args:
        facets: Facets along a unit of length where they are even.
        even: How many are even.
        size: Length that the places are shares of.
        growth: Size of a facet over that of the one before, where they grow.
    """
    fine = np.arange(even + 1) / facets
    grown = np.cumsum(growth ** np.arange(1, 40)) / facets
    coarse = grown[: np.searchsorted(grown, size - fine[-1]) + 1]
    places = np.concatenate([fine, fine[-1] + coarse * (size - fine[-1]) / coarse[-1]])
    return np.asarray(places / size)
