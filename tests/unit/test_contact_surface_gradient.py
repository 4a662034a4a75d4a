"""Gradients that are continuous across the edges of facets."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest

from anisocontact.contact.facet_mesh import FacetMesh
from anisocontact.contact.surface_gradient import SurfaceGradient
from anisocontact.surfaces.facets import FacetSurface

Floats = npt.NDArray[np.float64]


def _patch(cell: str) -> tuple[npt.NDArray[np.int32], Floats, Floats]:
    """Facets over a square, with bumpy nodes, and displaced ones."""
    line = np.linspace(-1.0, 1.0, 5)
    x, y = (one.ravel() for one in np.meshgrid(line, line, indexing="ij"))
    rng = np.random.default_rng(5)
    nodes = np.stack([x, y, 0.1 * x * x + 0.2 * y], axis=1) + 0.02 * rng.normal(size=(25, 3))
    first = (5 * np.arange(4)[:, None] + np.arange(4)).ravel()
    quads = np.stack([first, first + 5, first + 1, first + 6], axis=1)
    if cell == "tri3":
        quads = quads[:, [0, 1, 2, 2, 1, 3]].reshape(-1, 3)
    return quads.astype(np.int32), nodes, nodes + 0.1 * rng.normal(size=nodes.shape)


def _tangents(mesh: FacetMesh, start: Floats, now: Floats, facet: int, xi: Floats) -> Floats:
    """Tangents at a place of a facet, (2, 3)."""
    which = np.array([facet], dtype=np.int32)
    surface = FacetSurface(start, mesh.nodes, mesh.topology, mesh.flip)
    slope = surface.shapes(which, xi[None])[1][:, : mesh.nodes.shape[1]].swapaxes(1, 2)
    smooth = SurfaceGradient.of(mesh, start)
    bend = np.zeros((1, 2, 2, 3))
    found, _ = smooth.tangents(which, xi[None], slope @ start[mesh.nodes[which]], bend)
    around = smooth.nodes[which]
    return np.asarray(found @ np.where(around[..., None] < 0, 0.0, now[around]))[0]


@pytest.mark.parametrize("cell", ["quad4", "tri3"])
def test_flipped_facets_have_the_same_tangents(cell: str) -> None:
    """The order of the nodes of facets changes nothing but that of the coordinates.

    Requirement: rounding. Source: tangents follow the surface; facets that are flipped have their
    outward normal from coordinates that have changed places.
    """
    facets, start, now = _patch(cell)
    flip = np.arange(len(facets)) % 3 == 1
    mixed = np.where(flip[:, None], facets[:, [0, 2, 1, 3][: facets.shape[1]]], facets)
    plain = FacetMesh(cell, facets, np.zeros(len(facets), dtype=bool))
    other = FacetMesh(cell, np.ascontiguousarray(mixed), flip)
    rng = np.random.default_rng(6)
    for facet in range(len(facets)):
        xi = 0.5 * rng.uniform(size=2)
        wanted = _tangents(plain, start, now, facet, xi)
        found = _tangents(other, start, now, facet, xi)
        np.testing.assert_allclose(found, wanted, atol=1e-12)
