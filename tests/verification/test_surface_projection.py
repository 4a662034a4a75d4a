"""Closest points of every registered surface against brute force, and their derivatives."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from scipy.spatial import cKDTree

from anisocontact.surfaces import PROJECTION_STATUS, Surface, make_surface

Floats = npt.NDArray[np.float64]
INTERIOR, EDGE, CORNER, SINGULAR, AMBIGUOUS, FAILED = range(len(PROJECTION_STATUS))


def random_points(sample: Any, n: int, seed: int) -> Floats:
    """Points near the surface, in a box about it, far away, and near its axis and centre."""
    rng = np.random.default_rng(seed)
    near, box, far, axis = np.array_split(np.arange(n), 4)
    x = np.empty((n, 3))
    lower, upper = np.clip(np.transpose(sample.whole), -4 * sample.size - 4, 4 * sample.size + 4)
    direction = rng.normal(size=(n, 3))
    direction /= np.linalg.norm(direction, axis=1)[:, None]
    off = sample.size * 10.0 ** rng.uniform(-9, 0.5, (n, 1)) * direction
    x[near] = sample.position(rng.uniform(lower, upper, (near.size, 2))) + off[near]
    x[box] = sample.centre + sample.size * rng.uniform(-2, 2, (box.size, 3))
    x[far] = sample.centre + sample.size * 10 ** rng.uniform(0.5, 3, (far.size, 1)) * direction[far]
    axes = rng.choice([0.0, 1.0], (axis.size, 1)) * rng.uniform(-2, 2, (axis.size, 1))
    x[axis] = sample.centre + sample.size * axes * sample.axis + 1e-3 * off[axis]
    return x


def grid(sample: Any, n: int = 250) -> tuple[Floats, Floats]:
    """Coordinates (n^2, 2) over the whole surface and their spacing; long ranges are graded."""
    lines, steps = [], []
    for lower, upper in sample.whole:
        line = np.linspace(lower, upper, n)
        if upper - lower > 1e3 * sample.size:
            ends = np.arcsinh([lower / sample.size, upper / sample.size])
            line = sample.size * np.sinh(np.linspace(*ends, n))
        lines.append(line)
        steps.append(np.gradient(line))
    mesh = np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, 2)
    return mesh, np.stack(np.meshgrid(*steps, indexing="ij"), axis=-1).reshape(-1, 2)


def compass(sample: Any, x: Floats, xi: Floats, step: Floats, rounds: int) -> Floats:
    """Distances after a search along the coordinates that needs nothing but positions.

    Coordinates and steps go on from what is given, and are left where the search ends.
    """
    lower, upper = np.transpose(sample.whole)
    best = np.linalg.norm(x - sample.position(xi), axis=1)
    for _ in range(rounds):
        for k in range(2):
            better = np.zeros(len(x), bool)
            for sign in (1.0, -1.0):
                trial = xi.copy()
                trial[:, k] += sign * step[:, k]
                if not sample.closed[k]:
                    trial[:, k] = np.clip(trial[:, k], lower[k], upper[k])
                distance = np.linalg.norm(x - sample.position(trial), axis=1)
                gain = distance < best
                xi[gain], best[gain] = trial[gain], distance[gain]
                better |= gain
            step[:, k] *= np.where(better, 1.5, 0.5)
    return best


def brute_force(sample: Any, x: Floats, starts: int = 5) -> Floats:
    """Distance to the surface: of the nearest of a dense grid the best one, improved to the end."""
    mesh, spacing = grid(sample)
    _, near = cKDTree(sample.position(mesh)).query(x, starts)
    xi, step = mesh[near], spacing[near]
    first = [compass(sample, x, xi[:, k], step[:, k], 12) for k in range(starts)]
    best = np.arange(len(x)), np.argmin(first, axis=0)
    return compass(sample, x, xi[best], step[best], 60)


def check_against_brute_force(sample: Any, n: int, seed: int) -> None:
    x = random_points(sample, n, seed)
    p = sample.make().project(x, derivatives=False)
    assert not np.any(p.status == FAILED)
    found = np.linalg.norm(x - sample.position(p.xi), axis=1)
    # What the coordinates of x resolve; at a pole the foot is moved by 1e-8 of the size.
    reach = np.abs(x).max(axis=1) + sample.size
    limit = 1e-13 * reach + np.where(p.status == SINGULAR, 2e-8 * reach, 0.0)
    assert np.all(found <= brute_force(sample, x) + limit)


def test_brute_force(sample: Any) -> None:
    """Requirement: none of 2,000 random points (near, far, at the axis) is nearer to another point
    of the surface than to its closest point; source: dense sampling and a derivative-free search on
    a NumPy parametrisation. The search only ever finds distances that are there, so the closest
    point may not be farther by more than rounding."""
    check_against_brute_force(sample, 2_000, seed=3)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(10))
def test_brute_force_many(sample: Any, seed: int) -> None:
    """The same for 100,000 points of every surface."""
    check_against_brute_force(sample, 10_000, seed=100 + seed)


def test_foot_is_normal(sample: Any) -> None:
    """Requirement: x = rho + xi^3 n at interior points; source: (1), (2). What is left is rounding
    of coordinates of the size of x, and on the very edge of a patch an angle of 1e-10, below which
    a point counts as interior. Near the pole of a NURBS patch rounding grows with the reciprocal of
    the distance to it."""
    x = random_points(sample, 4_000, seed=4)
    surface = sample.make()
    p = surface.project(x)
    inner = (p.status == INTERIOR) & sample.smooth(p.xi, 1e-3)
    assert np.count_nonzero(inner) > 300
    g, rho = surface.geometry(p.xi[inner]), surface.position(p.xi[inner])
    error = np.abs(x[inner] - rho - p.gap[inner, None] * g.normal).max(axis=1)
    at_end = np.isin(p.xi[inner], surface.domain[:2]).any(axis=1)
    limit = 1e-12 * (np.abs(x[inner]).max(axis=1) + sample.size)
    assert np.all(error <= limit + np.where(at_end, 1e-10 * np.abs(p.gap[inner]), 0.0))
    np.testing.assert_array_equal(p.dgap_dx[inner], g.normal)


def taylor_errors(surface: Surface, x: Floats, p: Any, direction: Floats, step: float) -> Any:
    """Errors of central differences of xi, as lengths, and of the gap, both divided by the step."""
    ahead = surface.project(x + step * direction)
    behind = surface.project(x - step * direction)
    assert np.all((ahead.status == p.status) & (behind.status == p.status))
    lower, upper, periodic = surface.domain
    d = ahead.xi - behind.xi
    for k in range(2):
        if periodic[k]:
            period = upper[k] - lower[k]
            d[:, k] -= period * np.round(d[:, k] / period)
    xi = d / (2 * step) - np.einsum("nij,nj->ni", p.dxi_dx, direction)
    gap = (ahead.gap - behind.gap) / (2 * step) - np.einsum("nj,nj->n", p.dgap_dx, direction)
    tangents = surface.jet(p.xi).d1
    return np.einsum("ni,nij->nj", xi, tangents), gap


def test_derivatives_by_order(sample: Any, surfaces: Any) -> None:
    """Requirement: d xi^i/dx and d xi^3/dx are exact off the surface; source: central differences
    of projections, whose error falls by four when the step is halved. Points lie closer to the
    surface than the least radius of curvature, where the closest point is smooth."""
    surface, xi = sample.make(), sample.coordinates(400, seed=5)
    rng = np.random.default_rng(6)
    g = surface.geometry(xi)
    bend = np.abs(np.linalg.eigvals(g.h_mixed)).max(axis=1)
    gap = rng.uniform(-0.6, 0.6, len(xi)) / np.maximum(bend, 1 / sample.size)
    x = surface.position(xi) + gap[:, None] * g.normal
    p = surface.project(x)
    direction = rng.normal(size=x.shape)
    step = 2e-3 * sample.size
    near = surfaces.one_sheet(surface, x, step * direction, sample.size) & sample.smooth(xi, 0.03)
    assert np.count_nonzero(near & (np.abs(p.gap - gap) < 1e-9 * sample.size)) > 100
    x, p, direction = x[near], surface.project(x[near]), direction[near]
    coarse = taylor_errors(surface, x, p, direction, step)
    fine = taylor_errors(surface, x, p, direction, step / 2)
    for c, f in zip(coarse, fine, strict=True):
        if np.linalg.norm(f) > 1e-9 * np.sqrt(len(x)):
            assert 3.7 < np.linalg.norm(c) / np.linalg.norm(f) < 4.3


@pytest.mark.parametrize("scale", [1e-6, 1e6])
def test_units_and_motion(sample: Any, surfaces: Any, scale: float) -> None:
    """Requirement: turned, shifted and in other units, the same distances and statuses; source:
    t + s Q rho. Points on the axis are left out: there rounding decides what is ambiguous."""
    q = surfaces.rotation((3, -1, 2), 1.9)
    t = scale * np.array([-0.4, 2.0, 1.5])
    there = make_surface(
        sample.shape, **surfaces.moved(sample.parameters, sample.shape, q, t, scale)
    )
    x = random_points(sample, 2_000, seed=7)[:1_000]
    p, r = sample.make().project(x), there.project(t + scale * x @ q.T)
    clear = (p.status == INTERIOR) | (p.status == EDGE) | (p.status == CORNER)
    np.testing.assert_array_equal(p.status[clear], r.status[clear])
    np.testing.assert_allclose(
        r.gap[clear] / scale, p.gap[clear], rtol=1e-12, atol=2e-14 * 10 * sample.size
    )


def test_points_that_have_no_closest_point(sample: Any) -> None:
    """Requirement: a status, not numbers that look right; source: the description of the codes."""
    x = np.array([[np.nan, 0, 0], [0, np.inf, 0]])
    p = sample.make().project(x)
    assert np.all(p.status == FAILED)
    assert np.isnan(p.xi).all() and np.isnan(p.gap).all()


def test_guess_and_threads_change_nothing(sample: Any) -> None:
    """Requirement: the result is a function of x alone; source: the description of `guess`. Where
    distances are equal to rounding the order of the search decides what counts as ambiguous."""
    surface, x = sample.make(), random_points(sample, 1_000, seed=8)
    p = surface.project(x, threads=1)
    for q in (
        surface.project(x, guess=p.xi, threads=2),
        surface.project(x, guess=sample.coordinates(len(x)), threads=2),
    ):
        unique = (p.status != AMBIGUOUS) & (q.status != AMBIGUOUS)
        np.testing.assert_array_equal(p.status[unique], q.status[unique])
        np.testing.assert_allclose(q.gap, p.gap, rtol=1e-12, atol=1e-13 * sample.size)
