"""What happens at edges, vertices, ridges and borders.

Requirement: no point is lost there; the sign of the gap is right, by the angle-weighted normal
[Baerentzen Aanaes 2005]; beyond the border a point is off.
"""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from anisocontact.surfaces.facets import FacetSurface

TOPOLOGIES = ("tri3", "tri6", "quad4", "quad8", "quad9")
CUBE = np.array([[i, j, k] for k in (0, 1) for j in (0, 1) for i in (0, 1)], dtype=float)
CUBE_FACES = np.array(
    [[0, 2, 1, 3], [4, 5, 6, 7], [0, 1, 4, 5], [2, 6, 3, 7], [0, 4, 2, 6], [1, 3, 5, 7]]
)


def cube(meshes: SimpleNamespace, topology: str) -> FacetSurface:
    mesh = meshes.Mesh(CUBE, CUBE_FACES, "quad4")
    return (mesh if topology == "quad4" else meshes.halved(mesh)).surface()


def winding(x: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Solid angle of triangles (k, 3, 3) seen from points, over 4 pi: 1 inside, 0 outside
    [van Oosterom Strackee 1983]."""
    total = np.zeros(len(x))
    for a, b, c in corners:
        p, q, r = a - x, b - x, c - x
        lp, lq, lr = (np.linalg.norm(y, axis=1) for y in (p, q, r))
        volume = np.sum(p * np.cross(q, r), axis=1)
        below = lp * lq * lr + np.sum(p * q, 1) * lr + np.sum(q * r, 1) * lp + np.sum(r * p, 1) * lq
        total += 2.0 * np.arctan2(volume, below)
    return total / (4.0 * np.pi)


@pytest.mark.parametrize("topology", ["tri3", "quad4"])
def test_cube_in_closed_form(meshes: SimpleNamespace, topology: str) -> None:
    """Distance, sign, normal and feature about a unit cube, whatever edge cuts its faces in two."""
    surface = cube(meshes, topology)
    assert surface.orientation().volume == pytest.approx(1.0, abs=1e-15)
    x = np.random.default_rng(1).uniform(-0.7, 1.7, (5000, 3))
    p = surface.project(x)
    away = x - np.clip(x, 0.0, 1.0)
    outside = np.linalg.norm(away, axis=1)
    depth = np.minimum(x, 1.0 - x).min(axis=1)
    wanted = np.where(outside > 0.0, outside, -depth)
    assert (p.status == 0).all()
    assert np.abs(p.gap - wanted).max() < 1e-15
    # 0 over a face, 1 over an edge of the cube, 2 at a corner; the cut of a face is no edge
    assert np.array_equal(p.feature, np.maximum(np.count_nonzero(away, axis=1) - 1, 0))
    out = outside > 0.0
    assert np.abs(p.normal[out] - away[out] / outside[out, None]).max() < 1e-13


@pytest.mark.parametrize("topology", ["tri3", "quad4"])
def test_points_exactly_on_edges_and_corners(meshes: SimpleNamespace, topology: str) -> None:
    """On the edges and corners of the cube, and on the cuts of its faces: gap zero, a unit normal,
    that of a face."""
    surface = cube(meshes, topology)
    t = np.linspace(0.0, 1.0, 11)[:, None]
    ends = CUBE[[[a, b] for a in range(8) for b in range(a)]]
    for a, b in ends:
        x = (1 - t) * a + t * b
        if not ((x == 0.0) | (x == 1.0)).any(axis=1).all():
            continue  # through the inside
        p = surface.project(x)
        assert np.abs(p.gap).max() < 1e-15
        assert (p.status == 0).all()
        assert np.abs(np.sort(np.abs(p.normal), axis=1) - [0.0, 0.0, 1.0]).max() < 1e-15


def test_concave_edge(meshes: SimpleNamespace) -> None:
    """A step: from inside the body the nearest point of the inner edge; the normal is the unit
    vector from x to it, the gap negative. Outside, before the edge, a face is always nearest."""
    profile = np.array([[0, 1], [1, 1], [1, 0], [2, 0]], dtype=float)  # y over x, body below
    n = len(profile)
    points = np.concatenate([np.column_stack((profile, np.full(n, z))) for z in (0.0, 1.0)])
    facets = [[i, i + n, i + 1, i + n + 1] for i in range(n - 1)]
    surface = FacetSurface(points, facets, "quad4")
    rng = np.random.default_rng(2)
    inner = np.array([1.0, 0.0])
    below = inner - rng.uniform(0.01, 0.4, (500, 2))
    p = surface.project(np.column_stack((below, np.full(500, 0.5))))
    distance = np.linalg.norm(below - inner, axis=1)
    assert (p.feature == 1).all() and (p.status == 0).all()
    assert np.abs(p.gap + distance).max() < 1e-15
    assert np.abs(p.normal[:, :2] - (inner - below) / distance[:, None]).max() < 1e-13
    above = inner + rng.uniform(0.01, 0.4, (500, 2))
    p = surface.project(np.column_stack((above, np.full(500, 0.5))))
    assert (p.feature == 0).all()
    assert np.abs(p.gap - (above - inner).min(axis=1)).max() < 1e-15
    outer = np.array([1.0, 1.0])
    past = outer + rng.uniform(0.01, 0.4, (500, 2))
    p = surface.project(np.column_stack((past, np.full(500, 0.5))))
    assert (p.feature == 1).all()
    assert np.abs(p.gap - np.linalg.norm(past - outer, axis=1)).max() < 1e-15


@pytest.mark.parametrize("depth", [0.2, 0.6])
def test_sign_by_the_solid_angle(meshes: SimpleNamespace, depth: float) -> None:
    """A crumpled ball of triangles, sharp ridges and valleys: the gap is negative where the solid
    angle says inside, for points over faces, edges and vertices."""
    mesh = meshes.crumpled(5, "tri3", depth, 11)
    rng = np.random.default_rng(3)
    on = mesh.points[rng.integers(len(mesh.points), size=4000)]
    x = on + 0.1 * rng.normal(size=on.shape)
    p = mesh.surface().project(x)
    inside = winding(x, mesh.points[mesh.facets]) > 0.5
    clear = np.abs(p.gap) > 1e-12
    assert clear.mean() > 0.99
    assert min(np.count_nonzero(p.feature == k) for k in range(3)) > 50
    assert np.array_equal(p.gap[clear] < 0.0, inside[clear])


@pytest.mark.parametrize("topology", ["quad4", "tri6", "quad8", "quad9"])
def test_sign_on_curved_facets(meshes: SimpleNamespace, topology: str) -> None:
    """The same with curved facets, against the solid angle of 8 x 8 x 2 triangles a facet; points
    nearer than the error of those triangles are left out."""
    mesh = meshes.crumpled(2, topology, 0.25, 12)
    rng = np.random.default_rng(4)
    on = mesh.points[rng.integers(len(mesh.points), size=600)]
    x = on * rng.uniform(0.8, 1.3, (len(on), 1)) + 0.1 * rng.normal(size=on.shape)
    p = mesh.surface().project(x)
    samples, triangles = mesh.sample(8)
    inside = winding(x, samples[:, triangles].reshape(-1, 3, 3)) > 0.5
    clear = np.abs(p.gap) > 0.02
    assert clear.mean() > 0.6
    assert min(np.count_nonzero(p.feature[clear] == k) for k in range(3)) > 5
    assert np.array_equal(p.gap[clear] < 0.0, inside[clear])


@pytest.mark.parametrize("topology", TOPOLOGIES)
@pytest.mark.parametrize("count", [1, 4, 1000])
def test_flat_surface_has_one_normal(meshes: SimpleNamespace, topology: str, count: int) -> None:
    """On a flat surface of 1, 4 or 1000 random facets no edge or vertex is felt: gap and normal are
    those of the plane to rounding, for points over facets, exactly over edges and over vertices."""
    mesh = meshes.flat(count, topology, 5)
    rng = np.random.default_rng(6)
    ends = mesh.points[mesh.facets[:, :2]]
    spots = np.concatenate((mesh.points, ends.mean(axis=1), rng.uniform(0.0, 1.0, (500, 3))))
    height = rng.uniform(-0.3, 0.3, len(spots))
    x = np.column_stack((spots[:, :2], height))
    p = mesh.surface().project(x)
    assert (p.status == 0).all() and (p.feature == 0).all()
    assert np.abs(p.gap - height).max() < 1e-14
    assert np.abs(p.normal - [0.0, 0.0, 1.0]).max() < 1e-14
    assert np.abs(p.position[:, :2] - spots[:, :2]).max() < 1e-13


@pytest.mark.parametrize("topology", TOPOLOGIES)
def test_beyond_the_border_is_off(meshes: SimpleNamespace, topology: str) -> None:
    """Over the unit square `on`, beside it `off`, a hair inside or outside included (1e-9 of the
    size; points within 1e-10 of a facet's size count as on the border, which is on)."""
    surface = meshes.flat(60, topology, 7).surface()
    rng = np.random.default_rng(8)
    x = rng.uniform(-0.5, 1.5, (3000, 3))
    edge = np.column_stack((rng.uniform(0, 1, 500), np.ones(500), rng.uniform(-0.5, 0.5, 500)))
    for shift, off in ((-1e-9, 0), (0.0, 0), (1e-9, 1)):
        p = surface.project(edge + np.array([0.0, shift, 0.0]))
        assert (p.status == off).all()
    p = surface.project(x)
    inside = ((x[:, :2] >= 0.0) & (x[:, :2] <= 1.0)).all(axis=1)
    assert np.array_equal(p.status == 0, inside)
    assert (p.feature[~inside] > 0).all()


def test_ridge_that_ends_at_the_border(meshes: SimpleNamespace) -> None:
    """A roof: over the ridge `on`, with a normal between those of its sides; beyond the end of the
    ridge `off`."""
    points = [[0, -1, 0], [1, -1, 0], [0, 0, 1], [1, 0, 1], [0, 1, 0], [1, 1, 0]]
    surface = FacetSurface(points, [[0, 1, 2, 3], [2, 3, 4, 5]], "quad4")
    p = surface.project([[0.5, 0.1, 1.5], [1.0, 0.1, 1.5], [1.0, 0.0, 1.2], [1.1, 0.1, 1.5]])
    assert p.status.tolist() == [0, 0, 0, 1]
    assert p.feature.tolist() == [1, 1, 1, 2]
    assert np.abs(p.gap[:3] - [np.hypot(0.1, 0.5), np.hypot(0.1, 0.5), 0.2]).max() < 1e-15
    assert np.abs(p.normal[0] - np.array([0.0, 0.1, 0.5]) / np.hypot(0.1, 0.5)).max() < 1e-15


def test_excluded_facets(meshes: SimpleNamespace) -> None:
    """A strip folded over itself: excluding what is near in the reference state leaves the other
    layer; a point nearest to a side that the excluded part shares is off."""
    n = 41
    s = np.linspace(0.0, 4.0, n)
    strip = np.column_stack([np.repeat(s, 2), np.tile([0.0, 1.0], n), np.zeros(2 * n)])
    facets = [[2 * i, 2 * i + 2, 2 * i + 1, 2 * i + 3] for i in range(n - 1)]
    surface = FacetSurface(strip, facets, "quad4")
    at = np.column_stack((np.linspace(0.05, 1.0, 20), np.full((20, 1), 0.5), np.zeros(20)))
    near = surface.within(at, 1.0)
    assert len(near) == 20
    for i in range(20):
        low, high = s[near[i].min()], s[near[i].max() + 1]
        assert low <= max(at[i, 0] - 1.0, 0.0) and at[i, 0] + 1.0 <= high + 1e-12
        assert high - low < 2.2 + 1e-12
    upper = np.minimum(s, 4.0 - s)
    folded = np.column_stack(
        [np.repeat(upper, 2), strip[:, 1], np.repeat(np.where(s > 2.0, 0.05, 0.0), 2)]
    )
    surface.update(folded)
    free = surface.project(at)
    assert np.abs(free.gap).max() < 1e-15
    p = surface.project(at, exclude=near)
    assert (p.status == 0).all() and (p.facet > 20).all()
    # the upper layer is upside down: the point is above its outside
    assert np.abs(p.gap - 0.05).max() < 1e-14
    surface.update(strip)
    p = surface.project(at, exclude=near)
    assert (p.status == 1).all()


def test_rings_of_neighbours(meshes: SimpleNamespace) -> None:
    """0, 1 and 2 rings about a facet of a 7 x 7 grid: 1, 9 and 25 facets."""
    x, y = np.meshgrid(np.arange(8.0), np.arange(8.0), indexing="ij")
    points = np.column_stack((x.ravel(), y.ravel(), np.zeros(64)))
    surface = FacetSurface(points, meshes.grid(8, 8), "quad4")
    for count, size in ((0, 1), (1, 9), (2, 25), (3, 49)):
        assert len(surface.rings([24], count)[0]) == size
    r = surface.rings([24, 0], 1)
    assert r[0].tolist() == [16, 17, 18, 23, 24, 25, 30, 31, 32]
    assert r[1].tolist() == [0, 1, 7, 8]
