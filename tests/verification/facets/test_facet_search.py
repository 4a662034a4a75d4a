"""Closest point over all facets, against the closest point of every single facet.

Requirement: the nearest facet by true distance; no point lost, none wrong, whatever the mesh, the
hint and the deformation.
"""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from anisocontact.surfaces.facets import FacetSurface

TOPOLOGIES = ("tri3", "tri6", "quad4", "quad8", "quad9")
#: Flat minima of curved facets are found to 1e-9 of the squared distance; else rounding.
CURVED, EXACT = 1e-9, 1e-13


def triangle_distance(x: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Distance of points (n, 3) to a triangle (3, 3): over its plane, or to its sides."""
    best = np.full(len(x), np.inf)
    for a, b in ((0, 1), (1, 2), (2, 0)):
        e = t[b] - t[a]
        s = np.clip((x - t[a]) @ e / (e @ e), 0.0, 1.0)
        best = np.minimum(best, np.linalg.norm(x - t[a] - s[:, None] * e, axis=1))
    u, v = t[1] - t[0], t[2] - t[0]
    n = np.cross(u, v)
    p, q = ((x - t[0]) @ np.cross(w, n) / (n @ n) for w in (v, u))
    over = (p >= 0) & (q <= 0) & (p - q <= 1)
    return np.where(over, np.minimum(best, np.abs((x - t[0]) @ n) / np.linalg.norm(n)), best)


def brute_force(mesh, x: np.ndarray) -> np.ndarray:
    """Distance to the nearest facet, one facet after the other."""
    if mesh.topology == "tri3":
        return np.min([triangle_distance(x, mesh.points[f]) for f in mesh.facets], axis=0)
    best = np.full(len(x), np.inf)
    for f in mesh.facets:
        one = FacetSurface(mesh.points[f], [range(len(f))], mesh.topology)
        p = one.project(x, max_distance=best * (1.0 + 1e-12))
        best = np.fmin(best, np.linalg.norm(x - p.position, axis=1))
    return best


def near_and_far(mesh, count: int, seed: int) -> np.ndarray:
    """Points about the mesh: close to it, exactly on nodes and edges, and far away."""
    rng = np.random.default_rng(seed)
    size = np.ptp(mesh.points, axis=0).max()
    base = mesh.points[rng.integers(len(mesh.points), size=count)]
    scale = rng.choice(
        [0.0, 1e-6, 1e-3, 0.03, 0.3, 2.0], size=(count, 1), p=[0.05, 0.05, *[0.2] * 3, 0.3]
    )
    x = base + size * scale * rng.normal(size=(count, 3))
    ends = mesh.points[mesh.facets[rng.integers(len(mesh.facets), size=count // 20)][:, [0, 1]]]
    x[: len(ends)] = ends.mean(axis=1)
    return x


def check(mesh, x: np.ndarray) -> None:
    p = mesh.surface().project(x)
    assert np.isin(p.status, [0, 1]).all()
    distance = np.linalg.norm(x - p.position, axis=1)
    curved = mesh.topology not in {"tri3", "quad4"}
    slack = (CURVED if curved else EXACT) * (distance + np.abs(mesh.points).max())
    assert (np.abs(distance - brute_force(mesh, x)) <= slack).all()
    at = mesh.surface().jet(p.facet, p.xi).position
    assert np.abs(at - p.position).max() < 1e-13 * (1.0 + np.abs(x).max())


def surfaces(meshes: SimpleNamespace, topology: str) -> dict:
    return {
        "ball": meshes.ball(4, topology),
        "crumpled": meshes.crumpled(4, topology, 0.5, 3),
        "ring": meshes.ring(14, 7, topology),
        "flat": meshes.flat(80, topology, 4),
    }


@pytest.mark.parametrize("topology", TOPOLOGIES)
@pytest.mark.parametrize("shape", ["ball", "crumpled", "ring", "flat"])
def test_nearest_of_all_facets(meshes: SimpleNamespace, topology: str, shape: str) -> None:
    """20,000 points over the four meshes and five topologies."""
    check(mesh := surfaces(meshes, topology)[shape], near_and_far(mesh, 1000, 1))


@pytest.mark.slow
@pytest.mark.parametrize("topology", TOPOLOGIES)
@pytest.mark.parametrize("shape", ["ball", "crumpled", "ring", "flat"])
def test_nearest_of_all_facets_many(meshes: SimpleNamespace, topology: str, shape: str) -> None:
    """The same with 200,000 points."""
    check(mesh := surfaces(meshes, topology)[shape], near_and_far(mesh, 10_000, 2))


@pytest.mark.parametrize("topology", ["tri3", "quad4", "quad9"])
def test_refit_after_large_deformation(meshes: SimpleNamespace, topology: str) -> None:
    """A surface twisted, stretched and crumpled beyond recognition gives what one built there
    gives: the same distance to rounding (the same facet is not required where several share it)."""
    rng = np.random.default_rng(9)
    mesh = meshes.ball(6, topology)
    surface = mesh.surface()
    for step in range(5):
        twist = 2.0 * step * mesh.points[:, 2]
        c, s = np.cos(twist), np.sin(twist)
        x, y, z = mesh.points.T
        points = np.column_stack((c * x - s * y, s * x + c * y, (1 + step) * z))
        points = points + 0.1 * step * rng.normal(size=points.shape)
        surface.update(points)
        fresh = mesh.moved(points).surface()
        at = near_and_far(mesh.moved(points), 300, step)
        a, b = surface.project(at), fresh.project(at)
        d, e = (np.linalg.norm(at - p.position, axis=1) for p in (a, b))
        assert np.abs(d - e).max() <= CURVED * np.abs(points).max()
        assert (d <= brute_force(mesh.moved(points), at) * (1.0 + CURVED) + EXACT).all()


@pytest.mark.parametrize("topology", TOPOLOGIES)
def test_hint_changes_nothing_but_the_name(meshes: SimpleNamespace, topology: str) -> None:
    """Wherever the hint points, distance and normal are the same to rounding; where a facet of
    another name is given, it shares the closest point."""
    mesh = meshes.ring(20, 9, topology)
    surface = mesh.surface()
    rng = np.random.default_rng(4)
    x = meshes.unit(rng.normal(size=(2000, 3)) * [1, 1, 0.2]) + 0.2 * rng.normal(size=(2000, 3))
    cold = surface.project(x)
    for hint in (cold, surface.project(rng.permutation(x)), rng.integers(len(surface), size=2000)):
        warm = surface.project(x, hint=hint)
        assert np.abs(warm.gap - cold.gap).max() < 1e-12
        assert np.abs(warm.position - cold.position).max() < 1e-8
        assert np.abs(warm.normal - cold.normal).max() < 1e-8


def test_name_on_a_shared_edge() -> None:
    """Below the edge of a valley the facet is named whose normal is nearer to x - rho, whatever the
    hint; above the edge of a plane, where both are as near, the one that is asked for."""
    points = np.array([[-1, 0, 1], [0, 0, 0], [1, 0, 1], [-1, 1, 1], [0, 1, 0], [1, 1, 1]], float)
    facets = np.array([[0, 1, 3, 4], [1, 2, 4, 5]])
    x = np.array([[0.05, 0.5, -0.2], [-0.05, 0.5, -0.2]])
    valley = FacetSurface(points, facets, "quad4")
    plane = FacetSurface(points * [1, 1, 0], facets, "quad4")
    for hint in (np.array([0, 0], np.int32), np.array([1, 1], np.int32)):
        assert valley.project(x, hint, named=1 - hint).facet.tolist() == [1, 0]
        assert np.array_equal(plane.project(x * [0, 1, 1], hint, named=1 - hint).facet, 1 - hint)


@pytest.mark.parametrize("turn", [0.0, 0.4])
@pytest.mark.parametrize("topology", ["tri3", "quad4", "quad9"])
def test_hint_on_the_wrong_layer(meshes: SimpleNamespace, topology: str, turn: float) -> None:
    """Points about two tori, at most a twentieth of a facet apart, turned about their axis too so
    that boxes overlap otherwise: with the hint on a facet of the other torus, or on a neighbour,
    the distance is that of a search without a hint to rounding."""
    ring = meshes.ring(20, 9, topology)
    c, s = np.cos(turn), np.sin(turn)
    points = ring.points @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    count, height = len(ring.facets), 0.01
    layers = np.concatenate([points, points + np.array([0.0, 0.0, height])])
    facets = np.concatenate([ring.facets, ring.facets + len(points)])
    surface = FacetSurface(layers, facets, topology)
    rng = np.random.default_rng(11)
    x = layers[rng.integers(len(layers), size=3000)] + height * rng.normal(size=(3000, 3))
    cold = surface.project(x)
    other = (cold.facet + count) % (2 * count)
    beside = (cold.facet + rng.integers(1, 3, size=3000)) % (2 * count)
    for hint in (cold, other, beside):
        warm = surface.project(x, hint=hint)
        d, e = (np.linalg.norm(x - p.position, axis=1) for p in (cold, warm))
        assert np.abs(d - e).max() <= EXACT


@pytest.mark.parametrize("topology", ["tri3", "quad4", "quad9"])
def test_walk_around_a_ring(meshes: SimpleNamespace, topology: str) -> None:
    """A point carried around a torus, both ways at once, each projection the hint of the next:
    always that of a cold search, and after the last turn where it began."""
    surface = meshes.ring(24, 11, topology).surface()
    hint = None
    first = None
    for k in range(121):
        t = 2.0 * np.pi * k / 120
        spine = np.array([np.cos(t), np.sin(t), 0.0])
        x = spine + 0.33 * (np.cos(5 * t) * spine + np.sin(5 * t) * np.array([0.0, 0.0, 1.0]))
        p = surface.project(x, hint=hint)
        cold = surface.project(x)
        assert abs(p.gap[0] - cold.gap[0]) < 1e-13 and p.status[0] == 0
        first = first or p
        hint = p
    assert abs(p.gap[0] - first.gap[0]) < 1e-13
    assert np.abs(p.position - first.position).max() < 1e-12


@pytest.mark.parametrize("topology", TOPOLOGIES)
def test_rigid_motion_and_units(meshes: SimpleNamespace, topology: str) -> None:
    """Rotated and moved, or in other units: the same facet and coordinates, gap and normal to 1e-12
    of the size. Points on the medial axis have two closest points and are left out: there the
    distance alone is compared."""
    mesh = meshes.crumpled(4, topology, 0.15, 5)
    rng = np.random.default_rng(6)
    x = meshes.unit(rng.normal(size=(1000, 3))) * rng.uniform(0.8, 1.3, (1000, 1))
    p = mesh.surface().project(x)
    for seed, unit in ((1, 1.0), (2, 1e-3), (3, 1e6)):
        q = meshes.rotation(seed)
        move = unit * np.array([0.3, -0.2, 0.5])
        r = mesh.moved(unit * mesh.points @ q.T + move).surface().project(unit * x @ q.T + move)
        d, e = (
            np.linalg.norm(y, axis=1) for y in (x - p.position, unit * x @ q.T + move - r.position)
        )
        assert np.abs(e / unit - d).max() < 1e-12
        same = np.linalg.norm((r.position - move) @ q / unit - p.position, axis=1) < 1e-3
        assert same.mean() > 0.99
        assert np.array_equal(r.facet[same], p.facet[same])
        assert np.array_equal(r.feature[same], p.feature[same])
        # on curved facets far from the surface the Hessian takes two digits
        assert np.abs((r.xi - p.xi)[same]).max() < 1e-10
        assert np.abs((r.gap / unit - p.gap)[same]).max() < 1e-12
        assert np.median(np.abs((r.xi - p.xi)[same])) < 1e-15
        assert np.abs((r.normal @ q - p.normal)[same]).max() < 1e-10


@pytest.mark.parametrize("topology", ["tri3", "quad4"])
def test_largest_distance(meshes: SimpleNamespace, topology: str) -> None:
    """Points farther than the largest distance are `beyond`, nearer ones as without it."""
    surface = meshes.ball(5, topology).surface()
    x = np.random.default_rng(8).normal(size=(3000, 3))
    free = surface.project(x)
    limit = np.random.default_rng(9).uniform(0.05, 1.0, 3000)
    for largest in (0.3, limit):
        p = surface.project(x, max_distance=largest)
        far = np.abs(free.gap) >= largest
        assert np.array_equal(p.status == 2, far)
        assert (p.facet[far] == -1).all() and np.isnan(p.gap[far]).all()
        assert np.array_equal(p.gap[~far], free.gap[~far])
        assert np.array_equal(p.facet[~far], free.facet[~far])


def test_mixed_triangles_and_quadrilaterals(meshes: SimpleNamespace) -> None:
    """A ball half of quadrilaterals and half of triangles: the nearer of the two halves, and no
    border between them."""
    mesh = meshes.ball(6, "quad4")
    cut = mesh.points[mesh.facets].mean(axis=1)[:, 2] > 0.1
    halves = meshes.halved(meshes.Mesh(mesh.points, mesh.facets[cut], "quad4"))
    mixed = FacetSurface(mesh.points, [mesh.facets[~cut], halves.facets], ["quad4", "tri3"])
    assert mixed.orientation().outward
    x = 1.3 * meshes.unit(np.random.default_rng(3).normal(size=(2000, 3)))
    p = mixed.project(x)
    assert (p.status == 0).all()
    low = brute_force(meshes.Mesh(mesh.points, mesh.facets[~cut], "quad4"), x)
    assert np.abs(p.gap - np.minimum(low, brute_force(halves, x))).max() < EXACT


def test_values_that_are_not_finite(meshes: SimpleNamespace) -> None:
    """A point, or a node after an update, that is not finite: failed, until the next update."""
    mesh = meshes.ball(3, "tri3")
    surface = mesh.surface()
    assert surface.project([[np.nan, 0, 0], [0, np.inf, 0], [2, 0, 0]]).status.tolist() == [3, 3, 0]
    broken = mesh.points.copy()
    broken[5, 1] = np.nan
    surface.update(broken)
    assert surface.project([[2, 0, 0]]).status.tolist() == [3]
    surface.update(mesh.points)
    assert surface.project([[2, 0, 0]]).status.tolist() == [0]


def test_threads_give_the_same(meshes: SimpleNamespace) -> None:
    """Bit by bit."""
    surface = meshes.crumpled(5, "quad4", 0.3, 1).surface()
    x = np.random.default_rng(1).normal(size=(3000, 3))
    one, two = (surface.project(x, threads=k) for k in (1, 2))
    for name in ("facet", "xi", "gap", "normal", "status", "feature"):
        assert np.array_equal(getattr(one, name), getattr(two, name))


def test_what_goes_on_in_front_is_met_farther() -> None:
    """Facets that oppose another one, which hang together and reach beyond the distance.

    Requirement: within the distance all that oppose; up to the farther one what goes on from these
    by nodes in front of the facet, and nothing else: no wall that stands alone there, none behind,
    and none where all are seen from aside. Source: `Limits`. Facets and distances are exact.
    """
    # a stair of four facets that rises from where the other one is, and one that stands alone
    row = [
        [[h, 0, h], [h, 1, h], [h + 0.5, 0, h + 0.5], [h + 0.5, 1, h + 0.5]]
        for h in (0.0, 0.5, 1.0, 1.5)
    ]
    alone = [[0, 0, 1.3], [0, 1, 1.3], [1, 0, 1.3], [1, 1, 1.3]]
    points = np.array([x for facet in [*row, alone] for x in facet], dtype=float)
    nodes, numbers = np.unique(points, axis=0, return_inverse=True)
    facets = numbers.reshape(-1, 4).astype(np.int32)
    surface = FacetSurface(nodes, facets, "quad4")
    middle, radius = np.array([[0.3, 0.5, 0.0]]), np.array([2.0])
    up, down = np.array([[0.0, 0.0, 1.0]]), np.tile([0.0, 0.0, -1.0], (len(facets), 1))
    none = np.zeros(0, np.int64), np.zeros(0, np.int32)
    balls = nodes[facets].mean(axis=1), np.full(len(facets), 2.0)

    def found(farther: float, normal: np.ndarray = up, theirs: np.ndarray = down) -> list[int]:
        args = middle, radius, normal, *balls, np.sign(normal[0, 2]) * theirs
        pairs = surface.core.facing(*args, 0.9, farther, *none, 1)
        return pairs[1].tolist()

    assert found(0.9) == [0, 1]
    assert found(1.5) == [0, 1, 2]
    assert found(3.0) == [0, 1, 2, 3]
    assert found(3.0, -up) == [0, 1]
    assert found(3.0, up, np.tile([0.96, 0.0, -0.28], (len(facets), 1))) == [0, 1]
