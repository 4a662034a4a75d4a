"""Differential geometry of every registered surface.

Requirement: the identities of surface theory at random points to 1e-12 relative, whatever the
parameters; source: Gauss, Weingarten, Codazzi, and the closed forms of the curvatures. 1e-12 is a
few thousand roundings: the numbers compared are of the order of the scale they are divided by.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from anisocontact.base import registry

LIMIT = 1e-12


def size(a: Any, axes: int = 1) -> Any:
    """Largest entry over the last `axes` axes."""
    return np.abs(a).reshape(*a.shape[: a.ndim - axes], -1).max(axis=-1)


def per_tangents(a: Any, d1: Any) -> Any:
    """Components with two lower indices, divided by the lengths of the tangents: dimension only."""
    length = np.linalg.norm(d1, axis=2)
    return a / (length[:, :, None] * length[:, None, :])


def test_every_registered_surface_has_a_sample(surfaces: Any) -> None:
    """Requirement: a surface cannot be added without being verified; source: the registry."""
    assert {s.shape for s in surfaces.samples} == {e.name for e in registry.surfaces()}


def test_position_is_the_documented_parametrisation(sample: Any) -> None:
    """Requirement: rho as documented; source: docs/theory/surfaces.md, written anew in NumPy."""
    xi = sample.coordinates(1000)
    difference = sample.make().position(xi) - sample.position(xi)
    assert np.abs(difference).max() < LIMIT * sample.size


def test_metric_and_its_inverse(sample: Any) -> None:
    """Requirement: a^ij a_jk = delta^i_k and area^2 = det a_ij; source: their definitions."""
    g = sample.make().geometry(sample.coordinates(1000))
    unit = np.einsum("nij,njk->nik", g.a_contra, g.a_co)
    weight = np.sqrt(np.einsum("nii->ni", g.a_co))
    unit *= weight[:, :, None] / weight[:, None, :]
    assert np.abs(unit - np.eye(2)).max() < LIMIT
    np.testing.assert_allclose(g.area**2, np.linalg.det(g.a_co), rtol=LIMIT)


def test_gauss(sample: Any) -> None:
    """Requirement: rho_ij = Gamma^k_ij rho_k + h_ij n; source: Gauss."""
    surface, xi = sample.make(), sample.coordinates(1000)
    jet, g = surface.jet(xi), surface.geometry(xi)
    second = jet.d2[:, [[0, 1], [1, 2]]]
    built = np.einsum("nkij,nkc->nijc", g.christoffel, jet.d1)
    built += g.h_co[..., None] * g.normal[:, None, None, :]
    assert np.all(size(second - built, 3) <= LIMIT * size(second, 3))


def test_weingarten(sample: Any) -> None:
    """Requirement: n_i = -h^j_i rho_j; source: Weingarten, n_i by dual numbers."""
    surface, xi = sample.make(), sample.coordinates(1000)
    jet, g = surface.jet(xi), surface.geometry(xi)
    n_i = surface.geometry_derivatives(xi).normal
    built = -np.einsum("nji,njc->nic", g.h_mixed, jet.d1)
    assert np.all(size(n_i - built) <= LIMIT * np.linalg.norm(jet.d1, axis=2) / sample.size)


def test_christoffel_from_the_metric(sample: Any) -> None:
    """Requirement: Gamma^k_ij = a^kl (a_li,j + a_lj,i - a_ij,l)/2; source: the metric connection,
    a_ij,k by dual numbers."""
    surface, xi = sample.make(), sample.coordinates(1000)
    g, d = surface.geometry(xi), surface.geometry_derivatives(xi).a_co
    lower = 0.5 * (d + np.swapaxes(d, 2, 3) - np.moveaxis(d, 3, 1))
    built = np.einsum("nkl,nlij->nkij", g.a_contra, lower)
    weight = np.sqrt(np.einsum("nii->ni", g.a_co))
    error = (g.christoffel - built) * weight[:, :, None, None]
    error /= weight[:, None, :, None] * weight[:, None, None, :]
    assert np.abs(error).max() < LIMIT * 10 / sample.size


def test_codazzi(sample: Any) -> None:
    """Requirement: h_ij|k = h_ik|j; source: Codazzi, h_ij,k by dual numbers."""
    surface, xi = sample.make(), sample.coordinates(1000)
    g, d = surface.geometry(xi), surface.geometry_derivatives(xi).h_co
    covariant = d - np.einsum("nlik,nlj->nijk", g.christoffel, g.h_co)
    covariant -= np.einsum("nljk,nil->nijk", g.christoffel, g.h_co)
    error = covariant - np.swapaxes(covariant, 2, 3)
    weight = np.sqrt(np.einsum("nii->ni", g.a_co))
    error /= np.einsum("ni,nj,nk->nijk", weight, weight, weight)
    assert np.abs(error).max() < LIMIT * 10 / sample.size**2


def test_curvatures(sample: Any) -> None:
    """Requirement: Gauss and mean curvature; source: closed forms of docs/theory/surfaces.md."""
    if sample.curvature is None:
        pytest.skip("no closed form")
    xi = sample.coordinates(1000)
    g = sample.make().geometry(xi)
    gauss, mean = sample.curvature(xi[:, 0], xi[:, 1])
    scale = 1 / sample.size
    np.testing.assert_allclose(g.gaussian_curvature, gauss, rtol=LIMIT, atol=LIMIT * scale**2)
    np.testing.assert_allclose(g.mean_curvature, mean, rtol=LIMIT, atol=LIMIT * scale)


@pytest.mark.parametrize("order", [1, 2])
def test_jets_by_order_of_convergence(sample: Any, order: int) -> None:
    """Requirement: rho_i, rho_ij are the derivatives of rho; source: central differences, whose
    error falls by four when the step is halved. Only exact derivatives keep that order; where the
    difference itself is exact (lines) there is nothing but rounding."""
    surface, xi = sample.make(), sample.coordinates(400)

    def lower(at: Any) -> Any:
        jet = surface.jet(at)
        return jet.position[:, None] if order == 1 else jet.d1

    xi = xi[sample.smooth(xi, 0.03)]
    exact = surface.jet(xi)
    steps = 0.02 * np.diff(sample.window).ravel()
    for k in range(2):
        wanted = exact.d1[:, [k]] if order == 1 else exact.d2[:, [k, k + 1]]
        errors = []
        for halving in (1, 2):
            e = np.eye(2)[k] * steps[k] / halving
            difference = (lower(xi + e) - lower(xi - e)) / (2 * e[k])
            errors.append(np.linalg.norm(difference - wanted))
        if errors[1] > 1e-9 * np.linalg.norm(exact.d1):
            assert 3.8 < errors[0] / errors[1] < 4.2


def test_spatial_basis(sample: Any) -> None:
    """Requirement: r_i = d(rho + n xi^3)/d xi^i, r_3 = n; source: (3), n_i by dual numbers."""
    surface, xi = sample.make(), sample.coordinates(500)
    gap = np.random.default_rng(1).uniform(-sample.size, sample.size, len(xi))
    jet, g = surface.jet(xi), surface.geometry(xi)
    basis = g.spatial_basis(gap)
    built = jet.d1 + gap[:, None, None] * surface.geometry_derivatives(xi).normal
    assert np.all(size(basis[:, :2] - built) <= 2 * LIMIT * np.linalg.norm(jet.d1, axis=2))
    np.testing.assert_array_equal(basis[:, 2], g.normal)


def test_covariant_derivative(sample: Any) -> None:
    """Requirement: the tangential part of a constant spatial vector c has the covariant derivatives
    (c . n) h_ij and (c . n) h^i_j; source: Gauss, T_i = c . rho_i."""
    surface, xi = sample.make(), sample.coordinates(500)
    c = np.array([0.4, -1.3, 0.8])
    jet, g, d = surface.jet(xi), surface.geometry(xi), surface.geometry_derivatives(xi)
    t = jet.d1 @ c
    dt = jet.d2[:, [[0, 1], [1, 2]]] @ c
    through = (g.normal @ c)[:, None, None]
    error = per_tangents(g.covariant_derivative(t, dt, "co") - through * g.h_co, jet.d1)
    assert np.abs(error).max() < 10 * LIMIT / sample.size
    da = -np.einsum("nik,nklm,nlj->nijm", g.a_contra, d.a_co, g.a_contra)
    v = np.einsum("nij,nj->ni", g.a_contra, t)
    dv = np.einsum("nijm,nj->nim", da, t) + np.einsum("nij,njm->nim", g.a_contra, dt)
    mixed = g.covariant_derivative(v, dv, "contra") - through * g.h_mixed
    error = per_tangents(np.einsum("nij,njk->nik", g.a_co, mixed), jet.d1)
    assert np.abs(error).max() < 10 * LIMIT / sample.size


@pytest.mark.parametrize("scale", [1.0, 1e-6, 1e6])
def test_motion_and_units(sample: Any, surfaces: Any, scale: float) -> None:
    """Requirement: a turned, shifted surface in other units has the turned, shifted geometry;
    source: t + s Q rho. The shift is of the size of the surface, so that its rounding is too."""
    from anisocontact.surfaces import make_surface

    q = surfaces.rotation((1, 2, 3), 0.7)
    t = scale * np.array([1.0, -2.0, 0.5])
    here = sample.make()
    there = make_surface(
        sample.shape, **surfaces.moved(sample.parameters, sample.shape, q, t, scale)
    )
    xi = sample.coordinates(300)
    same = sample.scaled(xi, scale)
    g, h = here.geometry(xi), there.geometry(same)
    error = there.position(same) - (t + scale * here.position(xi) @ q.T)
    assert np.abs(error).max() < LIMIT * 10 * sample.size * scale
    np.testing.assert_allclose(h.normal, g.normal @ q.T, atol=LIMIT)
    np.testing.assert_allclose(
        h.mean_curvature * scale, g.mean_curvature, rtol=LIMIT, atol=LIMIT / sample.size
    )
    np.testing.assert_allclose(
        h.gaussian_curvature * scale**2,
        g.gaussian_curvature,
        rtol=LIMIT,
        atol=LIMIT / sample.size**2,
    )
