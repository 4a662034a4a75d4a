"""NURBS patches: exact circles, edges, corners, seams, poles, ridges."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from anisocontact.interface import Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.surfaces import PROJECTION_STATUS, Surface, make_surface

INTERIOR, EDGE, CORNER, SINGULAR, AMBIGUOUS, FAILED = range(len(PROJECTION_STATUS))


def sample_named(surfaces: Any, name: str) -> Any:
    return next(s for s in surfaces.samples if s.name == name)


@pytest.mark.parametrize("name", ["cylinder", "sphere"])
def test_exact_shapes(surfaces: Any, name: str) -> None:
    """Requirement: a cylinder and a sphere as rational quadratic patches have the curvature, the
    closest points, gaps and derivatives of the analytic surfaces; source: the circle is a rational
    quadratic exactly, so nothing but rounding may differ. Coordinates differ, so what is compared
    does not depend on them. 1e-11: rounding grows towards the poles of the patch, where points are
    left out."""
    exact, patch = (sample_named(surfaces, n) for n in (name, f"nurbs-{name}"))
    reference, surface = exact.make(), patch.make()
    xi = patch.coordinates(2_000)
    g = surface.geometry(xi)
    h = reference.geometry(reference.project(surface.position(xi)).xi)
    np.testing.assert_allclose(g.normal, h.normal, atol=1e-11)
    np.testing.assert_allclose(g.gaussian_curvature, h.gaussian_curvature, atol=1e-11)
    np.testing.assert_allclose(g.mean_curvature, h.mean_curvature, atol=1e-11)

    rng = np.random.default_rng(1)
    gap = rng.uniform(-0.7, 3.0, len(xi)) * exact.size
    x = surface.position(xi) + gap[:, None] * g.normal
    p, q = surface.project(x), reference.project(x)
    assert np.all(p.status == INTERIOR) and np.all(q.status == INTERIOR)
    np.testing.assert_allclose(p.gap, gap, atol=1e-12)
    np.testing.assert_allclose(p.gap, q.gap, atol=1e-12)
    np.testing.assert_allclose(surface.position(p.xi), reference.position(q.xi), atol=1e-11)
    moves = [
        np.einsum("nik,nij->nkj", r.dxi_dx, s.jet(r.xi).d1)
        for s, r in ((surface, p), (reference, q))
    ]
    np.testing.assert_allclose(*moves, atol=1e-10)


@pytest.mark.parametrize("name", ["wavy", "rational", "twisted", "quintic", "cylinder"])
def test_derivatives_on_edges(surfaces: Any, name: str) -> None:
    """Requirement: beyond an edge the derivatives are those of the closest point of the edge, with
    one coordinate fixed, in a corner zero; source: central differences, whose error falls by four
    when the step is halved."""
    sample = sample_named(surfaces, f"nurbs-{name}")
    surface, rng = sample.make(), np.random.default_rng(2)
    x = sample.centre + rng.uniform(-3, 3, (4_000, 3))
    direction = rng.normal(size=x.shape)
    step = 1e-3
    p = surface.project(x)
    corner = p.status == CORNER
    np.testing.assert_array_equal(p.dxi_dx[corner], 0.0)
    assert name == "cylinder" or np.count_nonzero(corner) > 100

    shifted = [surface.project(x + s * step * direction) for s in (-1.0, -0.5, 0.5, 1.0)]
    feet = surface.position(p.xi)
    on = (p.status == EDGE) & sample.smooth(p.xi, 0.05)
    for q in shifted:
        jump = np.linalg.norm(surface.position(q.xi) - feet, axis=1)
        on &= (q.status == EDGE) & (jump < 30 * step)
    assert np.count_nonzero(on) > 300
    rate = np.einsum("nij,nj->ni", p.dxi_dx, direction), np.einsum("nj,nj->n", p.dgap_dx, direction)
    for at, wanted in zip(("xi", "gap"), rate, strict=True):
        far_back, back, ahead, far_ahead = (getattr(q, at)[on] for q in shifted)
        coarse = np.abs((far_ahead - far_back) / (2 * step) - wanted[on])
        fine = np.abs((ahead - back) / step - wanted[on])
        # the largest errors are near the evolute of an edge; the median is not
        if np.median(fine) > 1e-9:
            assert 3.7 < np.median(coarse) / np.median(fine) < 4.3
        else:
            assert np.median(coarse) < 1e-8


def test_edges_and_corners_of_a_flat_patch() -> None:
    """Requirement: which coordinate is held, and where; source: a unit square, by hand."""
    square = make_surface(
        "nurbs",
        degrees=(1, 1),
        knots_1=(0, 0, 1, 1),
        knots_2=(0, 0, 2, 2),
        points=[(0, 0, 0), (0, 1, 0), (1, 0, 0), (1, 1, 0)],
    )
    x = [(0.3, 0.4, -2), (1, 0.4, 5), (1.5, 0.4, 1), (0.3, -1, 0), (-1, 2, 0.5), (-1e-9, 0.5, 1)]
    p = square.project(x)
    assert p.status.tolist() == [INTERIOR, INTERIOR, EDGE, EDGE, CORNER, EDGE]
    np.testing.assert_allclose(
        p.xi, [(0.3, 0.8), (1, 0.8), (1, 0.8), (0.3, 0), (0, 2), (0, 1)], atol=1e-15
    )
    np.testing.assert_allclose(p.gap, [-2, 5, 1, 0, 0.5, 1], atol=1e-15)
    np.testing.assert_allclose(p.dxi_dx[2], [(0, 0, 0), (0, 2, 0)], atol=1e-15)
    np.testing.assert_allclose(p.dgap_dx, np.tile((0, 0, 1), (6, 1)), atol=1e-15)


def test_no_contact_beyond_an_edge() -> None:
    """Requirement: a patch that ends does not carry points beside it, on whatever side of its
    tangent plane they are; they come into contact when they are over it."""
    square = make_surface(
        "nurbs",
        degrees=(1, 1),
        knots_1=(0, 0, 1, 1),
        knots_2=(0, 0, 1, 1),
        points=[(0, 0, 0), (0, 1, 0), (1, 0, 0), (1, 1, 0)],
    )
    interface = Interface(
        square,
        NormalLaw(penalty=1e3),
        Adhesion(stiffness=(1e3, 1e3)),
        Friction(coefficients=(0.3, 0.3)),
    )
    start = [(1.5, 0.5, -0.01), (0.5, 0.5, -0.01)]
    state = interface.initial_state(start)
    r = interface.update(state, start)
    np.testing.assert_allclose(r.traction, [(0, 0, 0), (0, 0, 10)], atol=1e-12)
    assert r.status.tolist() == [0, 1] and r.gap[0] > 0
    r = interface.update(r.state, [(0.5, 0.5, -0.01), (1.5, 0.5, -0.01)])
    assert r.status.tolist()[1] == 0 and r.pressure[0] == pytest.approx(10.0)


def test_seam(surfaces: Any) -> None:
    """Requirement: a patch that closes smoothly has no edge there, and coordinates may run on;
    source: the analytic cylinder."""
    surface = sample_named(surfaces, "nurbs-cylinder").make()
    assert surface.domain == ((0.0, 0.0), (1.0, 1.0), (True, False))
    xi = np.array([[0.0, 0.3], [1e-9, 0.3], [1 - 1e-9, 0.3]])
    g = surface.geometry(xi)
    x = surface.position(xi) + 0.1 * g.normal
    p = surface.project(x)
    assert np.all(p.status == INTERIOR)
    np.testing.assert_allclose((p.xi - xi + 0.5) % 1.0, 0.5, atol=1e-14)
    for turns in (-2.0, 1.0):
        beyond = surface.jet(np.add(xi, (turns, 0.0)))
        np.testing.assert_allclose(beyond.position, surface.position(xi), atol=1e-14)
        np.testing.assert_allclose(beyond.d1, surface.jet(xi).d1, atol=1e-13)


@pytest.mark.parametrize("height", [-2.5, 1.9])
def test_pole(surfaces: Any, height: float) -> None:
    """Requirement: a pole is found, with the gap to rounding and the normal of the sphere to seven
    digits, the foot being moved by 1e-8 of the range; source: the analytic sphere."""
    sample = sample_named(surfaces, "nurbs-sphere")
    axis = sample.axis * np.sign(height)
    p = sample.make().project(sample.centre + abs(height) * axis)
    assert p.status == SINGULAR
    np.testing.assert_allclose(p.gap, abs(height) - 1.7, atol=1e-14)
    np.testing.assert_allclose(p.dgap_dx[0], axis, atol=5e-7)
    assert np.isfinite(p.dxi_dx).all()


@pytest.mark.parametrize("scale", [(1.0, 1.0, 1.0), (1.5, 1.25, 1.0)])
@pytest.mark.parametrize("end", [-1.0, 1.0])
def test_near_a_pole(scale: tuple[float, float, float], end: float) -> None:
    """Requirement: on the axis and right beside it, above and below the surface, a patch has the
    gap of the ellipsoid, and from 1e-8 of its size on the derivative of the gap, 1e-7.

    The foot keeps off the pole by 1e-8 of the range; nearer to the axis rounding is divided by the
    distance to that. Source: the analytic ellipsoid. The last steps of the search ended on the
    pole, where there is no normal: the gap of a node below it was no number; up to 1e-6 from the
    axis rounding made an edge of the coordinate around it, beyond which nothing is in contact.
    """
    square = np.sqrt(0.5)
    sides = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0)]
    rise = [(0, -1), (1, -1), (1, 0), (1, 1), (0, 1)]
    net = [(x * r, y * r, z) for x, y in sides for r, z in rise]
    weight = np.array([1, square] * 4 + [1])
    patch = make_surface(
        "nurbs",
        degrees=(2, 2),
        knots_1=(0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4),
        knots_2=(0, 0, 0, 1, 1, 2, 2, 2),
        points=np.array(net) * scale,
        weights=np.outer(weight, weight[:5]).ravel(),
    )
    ellipsoid = make_surface("ellipsoid", centre=(0, 0, 0), semi_axes=scale, axis=(0, 0, 1))
    aside = [0.0, 1e-15, 1e-12, 1e-10, 1e-9, 3e-9, 1e-8, 3e-8, 1e-7, 3e-7, 1e-6, 1e-5]
    gaps = [0.0, 1e-12, -1e-12, 1e-6, -1e-6, 0.1, -0.1]
    x = np.array([(0.6 * a, 0.8 * a, end * (scale[2] + g)) for a in aside for g in gaps])
    p, q = patch.project(x), ellipsoid.project(x)
    assert set(p.status) <= {INTERIOR, SINGULAR}
    np.testing.assert_allclose(p.gap, q.gap, atol=1e-13)
    clear = np.repeat(np.array(aside) >= 1e-8, len(gaps))
    np.testing.assert_allclose(p.dgap_dx[clear], q.dgap_dx[clear], atol=1e-7)
    assert np.isfinite(p.dgap_dx).all() and np.isfinite(p.dxi_dx).all()


def test_axis_is_ambiguous(surfaces: Any) -> None:
    """Requirement: on the axis every angle is as near; a status, and the same answer always."""
    sample = sample_named(surfaces, "nurbs-cylinder")
    x = sample.centre + np.linspace(0.1, 1.4, 20)[:, None] * sample.axis
    p, q = sample.make().project(x), sample.make().project(x[::-1], threads=1)
    assert np.all(p.status == AMBIGUOUS)
    np.testing.assert_allclose(p.gap, -0.8, rtol=1e-14)
    np.testing.assert_array_equal(p.xi, q.xi[::-1])
    np.testing.assert_allclose(p.dxi_dx[:, 0], 0.0, atol=1e-12)


def test_ridge(surfaces: Any) -> None:
    """Requirement: above a ridge the closest point is on it, an edge inside the patch, with that
    coordinate fixed; source: the knot of full multiplicity at 1/2."""
    sample = sample_named(surfaces, "nurbs-ridge")
    surface = sample.make()
    v = np.linspace(0.1, 0.9, 9)
    ridge = surface.position(np.stack([0 * v + 0.5, v], axis=1))
    p = surface.project(ridge + 0.5 * sample.axis)
    assert np.all(p.status == EDGE)
    np.testing.assert_array_equal(p.xi[:, 0], 0.5)
    np.testing.assert_array_equal(p.dxi_dx[:, 0], 0.0)


def flipped(surface: Surface, parameters: dict[str, Any]) -> tuple[Surface, Surface]:
    return surface, make_surface("nurbs", **(parameters | {"flip": True}))


def test_flip(surfaces: Any) -> None:
    """Requirement: `flip` reverses the first coordinate, so that the normal turns and the surface
    stays; source: rho(1 - xi^1, xi^2)."""
    for sample in surfaces.samples:
        if sample.shape != "nurbs":
            continue
        surface, other = flipped(sample.make(), sample.parameters)
        xi = sample.coordinates(100)
        there = np.stack([1 - xi[:, 0], xi[:, 1]], axis=1)
        np.testing.assert_allclose(surface.position(xi), other.position(there), atol=1e-14)
        normals = surface.geometry(xi).normal, other.geometry(there).normal
        np.testing.assert_allclose(normals[0], -normals[1], atol=1e-11)


def test_unclamped_and_highest_degree() -> None:
    """Requirement: any knots and degrees up to eight; source: the graph of a polynomial of degree
    eight, whose curvature at the origin is the second derivative of its height, and unclamped knots
    of a plane, whose control points are evenly spaced (linear precision)."""
    n = 9
    knots = [0.0] * n + [1.0] * n
    u = np.linspace(0, 1, n)
    # Bezier coefficients of t^2: k (k - 1) / (8 * 7)
    square = np.arange(n) * (np.arange(n) - 1) / (8 * 7)
    net = np.stack(np.broadcast_arrays(u[:, None], u[None, :], square[:, None]), axis=-1)
    trough = make_surface("nurbs", degrees=(8, 8), knots_1=knots, knots_2=knots, points=net)
    xi = np.random.default_rng(3).uniform(0, 1, (200, 2))
    np.testing.assert_allclose(trough.position(xi)[:, 2], xi[:, 0] ** 2, atol=1e-13)
    np.testing.assert_allclose(trough.jet(xi).d2[:, 0, 2], 2.0, rtol=1e-11)
    x = [(0.0, 0.5, 0.25)]  # below the centre of curvature of the bottom, which is at 1/2
    p = trough.project(x)
    assert p.status == INTERIOR
    np.testing.assert_allclose(p.xi, [(0.0, 0.5)], atol=1e-9)

    even = np.arange(8.0)
    greville = (even[1:5] + even[2:6]) / 2
    net = np.stack(np.broadcast_arrays(greville[:, None], greville[None, :], 0.0), axis=-1)
    plane = make_surface("nurbs", degrees=(2, 2), knots_1=even[:7], knots_2=even[:7], points=net)
    assert plane.domain[:2] == ((2.0, 2.0), (4.0, 4.0))
    p = plane.project([(2.5, 3.25, 1.0), (5.0, 3.0, 0.0)])
    np.testing.assert_allclose(p.xi, [(2.5, 3.25), (4.0, 3.0)], atol=1e-14)
    assert p.status.tolist() == [INTERIOR, EDGE]
