"""Closest point on one facet, against sampling, SciPy and the conditions of a minimum.

Requirement: the closest point is the global one for near and far points and for every topology;
none wrong.
"""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.optimize import minimize

from anisocontact.surfaces.facets import FacetProjections, FacetSurface

TOPOLOGIES = ("tri3", "tri6", "quad4", "quad8", "quad9")


def points_about(rng: np.random.Generator, count: int, far: float) -> np.ndarray:
    """Points around the reference facet: over it, beside it, and up to `far` away."""
    x = rng.normal(size=(count, 3)) * [0.6, 0.6, 0.5 * min(far, 1.0)] + [0.5, 0.5, 0.0]
    return np.where(rng.random((count, 1)) < 0.5, x, x + far * rng.normal(size=(count, 3)))


def sampled_distance(meshes: SimpleNamespace, topology: str, nodes: np.ndarray, x: np.ndarray):
    """Least distance to a grid of 60 x 60 points of the facet: an upper bound."""
    t = np.linspace(0.0, 1.0, 61)
    u, v = (a.ravel() for a in np.meshgrid(t, t, indexing="ij"))
    v = v * (1.0 - u) if meshes.vertices(topology) == 3 else v
    grid = meshes.shapes(topology, np.column_stack((u, v))) @ nodes
    return np.array([np.linalg.norm(grid - p, axis=1).min() for p in x])


def inside(topology: str, xi: np.ndarray) -> bool:
    """Coordinates within the reference facet; the third side of a triangle to rounding."""
    ok = xi.min() >= 0.0 and xi.max() <= 1.0
    return ok and (not topology.startswith("tri") or (xi.sum(axis=1) <= 1.0 + 1e-15).all())


def assert_minimum(surface: FacetSurface, x: np.ndarray, p: FacetProjections) -> None:
    """First-order conditions: the feature says what x - rho is normal to.

    1e-8 of |x - rho| |rho_i| is the accuracy of a projection whose Hessian is nearly singular; the
    typical point is at rounding.
    """
    j = surface.jet(p.facet, p.xi)
    r = x - p.position
    assert np.abs(j.position - p.position).max() < 1e-12 * (1.0 + np.abs(x).max())
    scale = np.linalg.norm(r, axis=1)[:, None] + np.linalg.norm(j.d1, axis=2)
    slope = np.einsum("nc,nic->ni", r, j.d1) / (scale * np.linalg.norm(j.d1, axis=2))
    assert np.abs(slope[p.feature == 0]).max(initial=0.0) < 1e-8
    edge = p.feature == 1
    along = np.einsum("ni,nic->nc", p.edge, j.d1)[edge]
    length = np.linalg.norm(along, axis=1)
    size = np.linalg.norm(r[edge], axis=1) + length
    cosine = np.sum(r[edge] * along, axis=1) / (length * size)
    assert np.abs(cosine).max(initial=0.0) < 1e-8
    vertex = p.feature == 2
    assert np.isin(p.xi[vertex], [0.0, 1.0]).all()


@pytest.mark.parametrize("topology", TOPOLOGIES)
@pytest.mark.parametrize("far", [0.05, 1.0, 50.0])
@pytest.mark.parametrize("bend", [0.02, 0.3, 1.0])
def test_no_sampled_point_is_nearer(
    meshes: SimpleNamespace, topology: str, far: float, bend: float
) -> None:
    """Facets from nearly flat to folded over themselves, flipped or not: of 3721 points of the
    facet none is nearer, and the point found meets the conditions of a minimum."""
    rng = np.random.default_rng(7)
    for seed in range(6):
        mesh = meshes.facet(topology, 100 + seed, bend)
        surface = mesh.surface([seed % 2 == 1])
        x = points_about(rng, 60, far)
        p = surface.project(x)
        assert np.isin(p.status, [0, 1]).all()
        assert inside(topology, p.xi)
        distance = np.linalg.norm(x - p.position, axis=1)
        bound = sampled_distance(meshes, topology, mesh.points, x)
        # a flat minimum is found to 1e-9 of the squared distance
        assert (distance <= bound * (1.0 + 1e-9)).all()
        assert (
            np.abs(np.abs(p.gap)[p.feature > 0] - distance[p.feature > 0]).max()
            < 1e-13 * far + 1e-13
        )
        assert_minimum(surface, x, p)


@pytest.mark.parametrize("topology", TOPOLOGIES)
def test_scipy_finds_the_same(meshes: SimpleNamespace, topology: str) -> None:
    """SLSQP from nine starts. It stops at changes of 1e-15 of the squared distance of order 1:
    distances agree to 1e-7, the root of that."""
    rng = np.random.default_rng(3)
    triangle = meshes.vertices(topology) == 3
    constraint = [{"type": "ineq", "fun": lambda s: 1.0 - s.sum()}] if triangle else []
    starts = [np.array([a, b]) for a in (0.1, 0.4, 0.8) for b in (0.1, 0.4, 0.8)]
    for seed in range(8):
        mesh = meshes.facet(topology, 200 + seed, 0.6)
        for x in points_about(rng, 2, 1.5):

            def f(s: np.ndarray, x: np.ndarray = x, nodes: np.ndarray = mesh.points) -> float:
                return float(np.sum((meshes.shapes(topology, s[None])[0] @ nodes - x) ** 2))

            results = [
                minimize(
                    f,
                    s,
                    bounds=[(0, 1)] * 2,
                    constraints=constraint,
                    method="SLSQP",
                    options={"ftol": 1e-15},
                )
                for s in starts
                if not triangle or s.sum() <= 1.0
            ]
            p = mesh.surface().project(x)
            distance = np.linalg.norm(x - p.position[0])
            assert abs(distance - np.sqrt(min(r.fun for r in results))) < 1e-7


@pytest.mark.parametrize("topology", TOPOLOGIES)
@pytest.mark.parametrize("flip", [False, True])
def test_points_built_over_a_facet_come_back(
    meshes: SimpleNamespace, topology: str, flip: bool
) -> None:
    """x = rho + g n for g below the radii of curvature: xi and g to 1e-12, rounding times the
    condition (a - g h)^-1 a of at most ten here."""
    rng = np.random.default_rng(11)
    for seed in range(10):
        surface = meshes.facet(topology, 300 + seed, 0.15).surface([flip])
        u, v = rng.uniform(0.02, 0.95, (2, 40))
        v = v * (0.98 - u) if meshes.vertices(topology) == 3 else v
        xi = np.column_stack((u, np.abs(v)))
        gap = rng.uniform(-0.1, 0.1, 40)
        x = surface.jet(np.zeros(40), xi).position
        x = x + gap[:, None] * surface.geometry(np.zeros(40), xi).normal
        p = surface.project(x)
        assert (p.feature == 0).all() and (p.status == 0).all()
        assert np.abs(p.xi - xi).max() < 1e-12
        assert np.abs(p.gap - gap).max() < 1e-12


@pytest.mark.parametrize("topology", TOPOLOGIES)
def test_points_on_edges_and_vertices(meshes: SimpleNamespace, topology: str) -> None:
    """A point on an edge or vertex, and one straight above it, is normal to the facet: interior
    with the coordinates of the edge to rounding; one pushed outward gives the edge or vertex."""
    surface = meshes.facet(topology, 8, 0.1).surface()
    corners = np.array([[0, 0], [1, 0], [0, 1], [1, 1]])[: meshes.vertices(topology)]
    sides = [(1, 2), (0, 2), (0, 1)] if len(corners) == 3 else [(0, 1), (0, 2), (1, 3), (2, 3)]
    for k, (a, b) in enumerate(sides):
        for t in (0.0, 0.25, 0.5, 1.0):
            xi = (1.0 - t) * corners[[a]] + t * corners[[b]]
            j, g = surface.jet([0], xi), surface.geometry([0], xi)
            for gap in (0.0, 0.01, -0.02):
                p = surface.project(j.position + gap * g.normal)
                assert p.feature[0] == 0 and p.status[0] == 0
                assert np.abs(p.xi - xi).max() < 1e-13
                assert abs(p.gap[0] - gap) < 1e-14
            if t not in {0.25, 0.5}:
                continue
            along = (corners[b] - corners[a]) @ j.d1[0]
            outward = np.cross(along, g.normal[0])
            outward *= np.sign(
                outward @ (j.position[0] - surface.jet([0], [[0.3, 0.3]]).position[0])
            )
            p = surface.project(j.position + 0.01 * outward + 0.02 * g.normal)
            assert p.feature[0] == 1 and p.entity[0] == k and p.status[0] == 1
            assert np.abs(p.xi - xi).max() < 1e-13
            assert np.array_equal(np.abs(p.edge[0]), np.abs(corners[b] - corners[a]))
    for k, corner in enumerate(corners):
        j = surface.jet([0], [corner])
        away = j.position - surface.jet([0], [[0.3, 0.3]]).position
        p = surface.project(j.position + 2.0 * away)
        assert p.feature[0] == 2 and p.entity[0] == k and np.array_equal(p.xi[0], corner)


@pytest.mark.parametrize("topology", TOPOLOGIES)
def test_start_does_not_matter(meshes: SimpleNamespace, topology: str) -> None:
    """From coordinates of other projections the same point is found, to the accuracy of a flat
    minimum (1e-9 of the squared distance)."""
    rng = np.random.default_rng(5)
    for seed in range(6):
        surface = meshes.facet(topology, 400 + seed, 0.8).surface()
        x = points_about(rng, 100, 1.0)
        cold = surface.project(x)
        other = surface.project(rng.permutation(x))
        warm = surface.project(x, hint=other)
        d, e = (np.linalg.norm(x - p.position, axis=1) for p in (cold, warm))
        assert np.abs(d - e).max() < 1e-9


def test_facet_without_area_fails(meshes: SimpleNamespace) -> None:
    """It has no normal: the status says so, nothing is made up."""
    x = np.random.default_rng(2).normal(size=(50, 3))
    for topology in TOPOLOGIES:
        k = len(meshes.nodes[topology])
        nodes = np.zeros((k, 3))
        nodes[:, 0] = meshes.nodes[topology].sum(axis=1)
        p = FacetSurface(nodes, [range(k)], topology).project(x)
        assert (p.status == 3).all() and (p.facet == -1).all() and np.isnan(p.gap).all()


def test_centre_of_a_cap(meshes: SimpleNamespace) -> None:
    """At the centre of a sphere every point of a facet is nearly as near: one of them is found, at
    the least distance there is."""
    for topology in ("tri6", "quad8", "quad9"):
        mesh = meshes.ball(1, topology)
        for f in range(0, len(mesh.facets), 3):
            nodes = mesh.points[mesh.facets[f]]
            one = meshes.Mesh(nodes, np.arange(len(nodes))[None], topology)
            for x in (np.zeros(3), np.full(3, 1e-9), np.array([0.0, 1e-4, 0.0])):
                p = one.surface().project(x)
                assert p.status[0] != 3
                bound = sampled_distance(meshes, topology, nodes, x[None])
                assert np.linalg.norm(x - p.position[0]) <= bound[0] * (1.0 + 1e-9)


@pytest.mark.parametrize("slope", [-0.1, -0.04, 0.0, 0.04, 0.1])
def test_pole(slope: float) -> None:
    """A facet of revolution whose side on the axis is a point, as near from all over that side.

    Requirement: a point on the axis, above or below, finds a place at least as near as 2001 of the
    generator, to 1e-9 of the distance and rounding of a facet of 0.1: where the pole was nearer
    than 1e-7 of a facet its parts were told apart by rounding, and the search failed.
    """
    radius, width = np.array([0.0, 0.13, 0.065]), 0.5 / (2.0 * np.pi)
    generator = np.column_stack((radius, slope * radius + radius**2 / 1.76))
    across = width * (2.0 * np.pi * radius + 1e-12)
    rows = ((0, -1), (1, -1), (0, 1), (1, 1), (2, -1), (0, 0), (1, 0), (2, 1), (2, 0))
    nodes = [(*generator[e], side * across[e]) for e, side in rows]
    t = np.linspace(0.0, 0.13, 2001)
    line = np.column_stack((t, slope * t + t**2 / 1.76))
    surface = FacetSurface(np.array(nodes), [range(9)], "quad9")
    gaps = 10.0 ** -np.arange(3.0, 13.0)
    for y in np.concatenate([gaps, -gaps]):
        p = surface.project(np.array([[-2e-17, y, 0.0]]))
        assert p.status[0] in (0, 1)
        away = np.linalg.norm(p.position[0] - [0.0, y, 0.0])
        assert away <= np.linalg.norm(line - [0.0, y], axis=1).min() * (1.0 + 1e-9) + 1e-15
