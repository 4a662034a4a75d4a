"""Gradients on a surface of facets that are continuous across edges, `SurfaceGradient`."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pytest

from anisocontact.contact.facet_mesh import FacetMesh
from anisocontact.contact.surface_gradient import VERTICES, SurfaceGradient
from anisocontact.surfaces.facets import FacetSurface

Floats = npt.NDArray[np.float64]

TOPOLOGIES = ["tri3", "quad4", "tri6", "quad9"]
#: Places of the nodes of a square of two by two, for one quadrilateral or two triangles.
NODES = {
    "quad4": [[(0, 0), (2, 0), (0, 2), (2, 2)]],
    "quad9": [[(0, 0), (2, 0), (0, 2), (2, 2), (1, 0), (0, 1), (2, 1), (1, 2), (1, 1)]],
    "tri3": [[(0, 0), (2, 0), (0, 2)], [(2, 2), (0, 2), (2, 0)]],
    "tri6": [
        [(0, 0), (2, 0), (0, 2), (1, 1), (0, 1), (1, 0)],
        [(2, 2), (0, 2), (2, 0), (1, 1), (2, 1), (1, 2)],
    ],
}


def patch(topology: str, n: int = 3) -> tuple[FacetMesh, Floats]:
    """Facets on the unit square, nodes in its plane moved aside, and their places, (nodes, 3)."""
    shape = NODES[topology]
    squares = [(i, j) for j in range(n) for i in range(n)]
    grid = [[(2 * i + a, 2 * j + b) for a, b in one] for i, j in squares for one in shape]
    known, nodes = np.unique(np.array(grid).reshape(-1, 2), axis=0, return_inverse=True)
    x = np.zeros((len(known), 3))
    x[:, :2] = known / (2.0 * n)
    x[:, 0] += 0.05 * np.sin(2.0 * x[:, 1] + 1.0)
    x[:, 1] += 0.04 * np.cos(3.0 * x[:, 0])
    if topology.endswith(("6", "9")):
        x = _straight(x, np.array(grid), nodes.reshape(len(grid), -1), topology)
    connectivity = nodes.reshape(len(grid), -1).astype(np.int32)
    return FacetMesh(topology, connectivity, np.zeros(len(grid), dtype=bool)), x


def _bilinear(s: Floats, t: Floats) -> list[Floats]:
    """Functions of the vertices of a quadrilateral."""
    return [(1 - s) * (1 - t), s * (1 - t), (1 - s) * t, s * t]


def _straight(x: Floats, grid: Floats, nodes: Floats, topology: str) -> Floats:
    """Facets of order 2 whose sides are straight between their vertices."""
    out, corners = x.copy(), 3 if topology == "tri6" else 4
    for places, own in zip(grid, nodes, strict=True):
        local = (places - places[:corners].min(axis=0)) / 2.0
        if corners == 3 and not np.array_equal(places[0], places.min(axis=0)):
            local = 1.0 - local
        s, t = local[:, :1], local[:, 1:]
        shares = [1 - s - t, s, t] if corners == 3 else _bilinear(s, t)
        share = np.concatenate(shares, axis=1)
        out[own] = share @ x[own[:corners]]
    return out


def deformed(x: Floats) -> Floats:
    """A place where neighbouring facets stretch and turn by unequal amounts."""
    turn = 0.8 * x[:, :1] * x[:, 1:2] + 0.3 * x[:, :1]
    out = np.concatenate([np.cos(turn) * x[:, :1], np.sin(turn) + x[:, 1:2], turn**2], axis=1)
    return np.asarray(out)


def tangents(
    mesh: FacetMesh, reference: Floats, facet: Floats, xi: Floats
) -> tuple[SurfaceGradient, Floats, Floats]:
    """The gradients, what the tangents are made of, and the derivatives of that."""
    surface = FacetSurface(reference, mesh.nodes, mesh.topology, mesh.flip)
    k = mesh.nodes.shape[1]
    _, first, second = (one[:, :k] for one in surface.shapes(facet, xi))
    second = np.moveaxis(second[:, :, [[0, 1], [1, 2]]], 1, 3)
    x = reference[mesh.nodes[facet]]
    own, bend = first.swapaxes(1, 2) @ x, np.einsum("nabk,nki->nabi", second, x)
    gradient = SurfaceGradient.of(mesh, reference)
    return gradient, *gradient.tangents(facet, xi, own, bend)


def made_of(gradient: SurfaceGradient, facet: Floats, along: Floats, x: Floats) -> Floats:
    """Tangents of nodes at x, (n, 2, 3)."""
    return np.asarray(np.einsum("naj,nji->nai", along, x[np.maximum(gradient.nodes[facet], 0)]))


def inside(mesh: FacetMesh) -> tuple[Floats, Floats]:
    """A place in every facet."""
    m = len(mesh.nodes)
    rng = np.random.default_rng(3)
    return np.arange(m, dtype=np.int32), rng.uniform(0.05, 0.45, (m, 2))


def on_edges(mesh: FacetMesh) -> list[tuple[int, Floats, int, Floats]]:
    """Places on edges that two facets share: both facets, and the coordinates on each."""
    corners = 3 if mesh.topology.startswith("tri") else 4
    edges = [(0, 1), (1, 2), (2, 0)] if corners == 3 else [(0, 1), (1, 3), (3, 2), (2, 0)]
    seen: dict[tuple[int, int], tuple[int, Floats]] = {}
    found = []
    for f, nodes in enumerate(mesh.nodes):
        for a, b in edges:
            key = (int(min(nodes[a], nodes[b])), int(max(nodes[a], nodes[b])))
            a, b = (a, b) if nodes[a] == key[0] else (b, a)  # noqa: PLW2901
            xi = 0.7 * VERTICES[corners][a] + 0.3 * VERTICES[corners][b]
            if key in seen:
                found.append((*seen[key], f, xi))
            seen[key] = f, xi
    return found


@pytest.mark.parametrize("topology", TOPOLOGIES)
def test_linear_fields(topology: str) -> None:
    """A flat surface that is stretched and turned evenly, any facets: tangents follow, 1e-12.

    Source: shape functions reproduce linear fields, so that all gradients around a vertex agree.
    """
    mesh, x = patch(topology)
    facet, xi = inside(mesh)
    gradient, along, _ = tangents(mesh, x, facet, xi)
    stretch = np.array([[1.2, 0.3, 0.0], [-0.4, 0.9, 0.0], [0.2, 0.1, 1.0]])
    before, after = (made_of(gradient, facet, along, one) for one in (x, x @ stretch.T))
    np.testing.assert_allclose(after, before @ stretch.T, atol=1e-12)
    own = FacetSurface(x, mesh.nodes, topology, mesh.flip).jet(facet, xi).d1
    np.testing.assert_allclose(before, own, atol=1e-12)


@pytest.mark.parametrize("topology", TOPOLOGIES)
def test_continuous_across_edges(topology: str) -> None:
    """Facets that turn by unequal amounts agree on their edges about what moves there, 1e-12.

    Source: the requirement itself. The facets' own gradients differ by more than 1e-3 there.
    """
    mesh, x = patch(topology)
    now, jumps = deformed(x), []
    surfaces = [FacetSurface(one, mesh.nodes, topology, mesh.flip) for one in (x, now)]
    for f, first, g, second in on_edges(mesh):
        facet, xi = np.array([f, g], dtype=np.int32), np.array([first, second])
        gradient, along, _ = tangents(mesh, x, facet, xi)
        before, after = (made_of(gradient, facet, along, one) for one in (x, now))
        both = np.linalg.pinv(before) @ after
        np.testing.assert_allclose(both[0], both[1], atol=1e-12)
        own = [one.jet(facet, xi).d1 for one in surfaces]
        apart = np.linalg.pinv(own[0]) @ own[1]
        jumps.append(np.abs(apart[0] - apart[1]).max())
    assert max(jumps) > 1e-3


@pytest.mark.parametrize("topology", TOPOLOGIES)
def test_curved_surface_that_turns(topology: str) -> None:
    """A curved surface that turns as a whole takes its tangents with it, 1e-12."""
    mesh, flat = patch(topology)
    x = deformed(flat)
    facet, xi = inside(mesh)
    gradient, along, _ = tangents(mesh, x, facet, xi)
    turn, _ = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))
    before, after = (made_of(gradient, facet, along, one) for one in (x, x @ turn.T + 2.0))
    np.testing.assert_allclose(after, before @ turn.T, atol=1e-12)


@pytest.mark.parametrize("topology", TOPOLOGIES)
def test_derivatives_by_the_coordinates(topology: str) -> None:
    """Derivatives of what tangents are made of: second order against central differences."""
    mesh, flat = patch(topology)
    x = deformed(flat)
    facet, xi = inside(mesh)
    exact = tangents(mesh, x, facet, xi)[2]
    errors = []
    for h in (1e-2, 5e-3):
        found = np.zeros_like(exact)
        for b in range(2):
            step = h * np.eye(2)[b]
            ends = [tangents(mesh, x, facet, xi + s * step)[1] for s in (1.0, -1.0)]
            found[:, :, b] = (ends[0] - ends[1]) / (2.0 * h)
        errors.append(np.abs(found - exact).max())
    assert errors[1] < 1e-12 or np.log2(errors[0] / errors[1]) > 1.9


def test_sharp_edges_are_not_averaged() -> None:
    """Two faces at a right angle: each keeps the gradients of its own facets."""
    mesh, x = patch("quad4", 2)
    folded = x.copy()
    middle = np.abs(x[:, 0] - x[mesh.nodes[0, 1], 0]) < 0.1
    right = x[:, 0] > x[middle, 0].max()
    folded[right, 2] = x[right, 0] - x[middle, 0].mean()
    folded[right, 0] = x[middle, 0].mean()
    folded[middle, 0] = x[middle, 0].mean()
    gradient = SurfaceGradient.of(mesh, folded)
    flat = np.flatnonzero((folded[mesh.nodes][:, :, 2] == 0.0).all(axis=1))
    assert len(flat) == 2
    np.testing.assert_allclose(np.abs(gradient.normals[flat]) @ [0.0, 0.0, 1.0], 1.0, rtol=1e-12)
    named = gradient.nodes[flat]
    assert (folded[named[named >= 0], 2] == 0.0).all()
