"""Convective velocities and variations of slave points on moving masters.

Requirement: (4), (5), (6) at xi^3 = 0 and their exact form off the surface; source: the paper, and
central differences in time of projections on the moved surface, whose error falls by four when the
time step is halved (only an exact rate has that order).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from anisocontact.base.errors import InputError
from anisocontact.surfaces import Surface, make_surface
from anisocontact.surfaces.kinematics import convective_velocity, relative_variation

SPIN, DRIFT, GROWTH = np.array([0.3, -0.5, 0.9]), np.array([0.2, 0.1, -0.4]), 0.35


def differences(
    at: Callable[[float], Surface], x: Callable[[float], Any], dt: float, speed: Any
) -> tuple[Any, Any, Any]:
    """Central differences of coordinates and gap, and where the foot neither meets an edge nor
    jumps to another part of the surface (faster than three times the speed expected, and one)."""
    ahead, behind = at(dt).project(x(dt)), at(-dt).project(x(-dt))
    d = ahead.xi - behind.xi
    lower, upper, periodic = at(0.0).domain
    for k in range(2):
        if periodic[k]:
            period = upper[k] - lower[k]
            d[:, k] -= period * np.round(d[:, k] / period)
    rate = d / (2 * dt)
    tangents = np.linalg.norm(at(0.0).jet(at(0.0).project(x(0.0)).xi).d1, axis=2)
    goes_on = np.linalg.norm(rate * tangents, axis=1) < 3 * speed + 1
    goes_on &= (ahead.status == 0) & (behind.status == 0)
    return rate * tangents, (ahead.gap - behind.gap) / (2 * dt), goes_on


def slave_points(sample: Any, surfaces: Any, n: int = 200) -> tuple[Any, Any]:
    """Points off the surface, nearer than its least radius of curvature, and their velocities."""
    rng = np.random.default_rng(11)
    surface, xi = sample.make(), sample.coordinates(n, seed=12)
    g = surface.geometry(xi)
    bend = np.abs(np.linalg.eigvals(g.h_mixed)).max(axis=1)
    gap = rng.uniform(-0.5, 0.5, n) / np.maximum(bend, 1 / sample.size)
    x = surface.position(xi) + gap[:, None] * g.normal
    v = rng.normal(size=x.shape)
    near = surfaces.one_sheet(surface, x, 0.03 * sample.size * v, sample.size)
    near &= sample.smooth(surface.project(x).xi, 0.05)
    assert np.count_nonzero(near) > 30
    return x[near], v[near]


def check_order(
    at: Callable[[float], Surface], x: Callable[[float], Any], rate: Any, size: float
) -> None:
    surface = at(0.0)
    tangents = np.linalg.norm(surface.jet(surface.project(x(0.0)).xi).d1, axis=2)
    speed = np.linalg.norm(rate.xi * tangents, axis=1)
    *coarse, coarse_on = differences(at, x, 4e-3, speed)
    *fine, fine_on = differences(at, x, 2e-3, speed)
    on = coarse_on & fine_on
    assert np.mean(on) > 0.9
    for c, f, w in zip(coarse, fine, (rate.xi * tangents, rate.gap), strict=True):
        error = np.linalg.norm((f - w)[on])
        if error > 1e-9 * size * np.sqrt(w.size):
            assert 3.7 < np.linalg.norm((c - w)[on]) / error < 4.3


def test_rigid_motion(sample: Any, surfaces: Any) -> None:
    """The master turns and translates; v_j = omega x rho_j."""
    x0, v = slave_points(sample, surfaces)
    angle = np.linalg.norm(SPIN)

    def at(t: float) -> Surface:
        q = surfaces.rotation(SPIN, angle * t)
        return make_surface(
            sample.shape, **surfaces.moved(sample.parameters, sample.shape, q, t * DRIFT, 1.0)
        )

    surface = sample.make()
    p = surface.project(x0)
    jet = surface.jet(p.xi)
    rate = convective_velocity(
        surface,
        p.xi,
        p.gap,
        v,
        DRIFT + np.cross(SPIN, jet.position),
        v_master_derivatives=np.cross(SPIN, jet.d1),
    )
    check_order(at, lambda t: x0 + t * v, rate, sample.size)


@pytest.mark.parametrize("shape", ["cylinder", "sphere"])
def test_growing_master(surfaces: Any, shape: str) -> None:
    """The radius of the master grows: v = R' n, v_j = R' n_j."""
    sample = next(s for s in surfaces.samples if s.name == shape)
    x0, v = slave_points(sample, surfaces)

    def at(t: float) -> Surface:
        radius = sample.parameters["radius"] + GROWTH * t
        return make_surface(shape, **(sample.parameters | {"radius": radius}))

    surface = sample.make()
    p = surface.project(x0)
    rate = convective_velocity(
        surface,
        p.xi,
        p.gap,
        v,
        GROWTH * surface.geometry(p.xi).normal,
        v_master_derivatives=GROWTH * surface.geometry_derivatives(p.xi).normal,
    )
    check_order(at, lambda t: x0 + t * v, rate, sample.size)


def test_form_of_the_paper(sample: Any) -> None:
    """On the surface the exact form is (4), (5); a^ij (v_s - v) . rho_i and (v_s - v) . n."""
    surface, xi = sample.make(), sample.coordinates(200)
    rng = np.random.default_rng(13)
    v_s, v = rng.normal(size=(2, len(xi), 3))
    g, jet = surface.geometry(xi), surface.jet(xi)
    wanted = np.einsum("nij,nic,nc->nj", g.a_contra, jet.d1, v_s - v)
    length = np.linalg.norm(jet.d1, axis=2)
    for rate in (
        convective_velocity(surface, xi, 0.7, v_s, v, exact=False),
        convective_velocity(surface, xi, 0.0, v_s, v, v_master_derivatives=jet.d1),
    ):
        np.testing.assert_allclose(rate.xi * length, wanted * length, rtol=1e-12, atol=1e-12)
        normal = np.einsum("nc,nc->n", v_s - v, g.normal)
        np.testing.assert_allclose(rate.gap, normal, rtol=1e-12, atol=1e-14)


def test_variation(sample: Any) -> None:
    """delta r_s - delta rho = delta xi^i rho_i + delta xi^3 n, (6)."""
    surface, xi = sample.make(), sample.coordinates(200)
    d_s, d_m = np.random.default_rng(14).normal(size=(2, len(xi), 3))
    d = relative_variation(surface, xi, d_s, d_m)
    built = np.einsum("ni,nic->nc", d.xi, surface.jet(xi).d1)
    built += d.gap[:, None] * surface.geometry(xi).normal
    np.testing.assert_allclose(built, d_s - d_m, atol=1e-12)


def test_shapes_are_checked() -> None:
    """Requirement: one line that says what was given and what is needed."""
    sphere = make_surface("sphere", centre=(0, 0, 0), radius=1.0)
    with pytest.raises(InputError, match=r"v_slave: an array of shape \(2, 3\) given, \(3, 3\)"):
        convective_velocity(sphere, np.zeros((3, 2)), 0.0, np.zeros((2, 3)))
