"""The implicit rules against solvers that share nothing with them.

Requirement: the law alone agrees with an independent solution to 1e-10 over 10,000 random tensors
S, F, forces and pressures. Source: the incremental principle of maximum dissipation is the convex
problem min 1/2 (T - T_tr).S^-1 (T - T_tr) over T.FT <= N^2 [Konyukhov Schweizerhof 2006, section
4.1 a)-d), backward Euler; Simo and Hughes 1992]; the other rules replace its normal F T by K T.

The core finds the multiplier lambda of a rational equation. The solvers here never form it: they
look for the angle of the force on the yield ellipse. They work in long double, so that what is
measured is the error of the core; 1e-10 in units of N is some 1e6 roundings, the tensors having
conditions of up to 1e3 each.
"""

from __future__ import annotations

import numpy as np
import pytest

from anisocontact.laws import slide

Long = np.longdouble
POINTS = 10_000
BOUND = 1e-10


def spectrum(m):
    """Eigenvalues and vectors of symmetric 2 x 2 matrices, in the precision of `m`."""
    a, b, d = m[:, 0, 0], (m[:, 0, 1] + m[:, 1, 0]) / 2, m[:, 1, 1]
    angle = np.arctan2(2 * b, a - d) / 2
    large = (a + d) / 2 + np.hypot((a - d) / 2, b)
    c, s = np.cos(angle), np.sin(angle)
    vectors = np.stack([np.stack([c, -s], -1), np.stack([s, c], -1)], -2)
    return np.stack([large, (a * d - b * b) / large], -1), vectors


def power(m, exponent):
    values, q = spectrum(m)
    return np.einsum("nij,nj,nkj->nik", q, values**exponent, q)


def nearest_on_ellipse(stiffness, friction, trial, pressure):
    """Minimiser of the convex problem: with y = S^(-1/2) T the point of an ellipse that is nearest
    to y_tr. In its principal axes and first quadrant the distance has one stationary point, found
    by halving the angle."""
    s, f, t, n = (np.asarray(v, Long) for v in (stiffness, friction, trial, pressure))
    root, root_inv = power(s, Long(0.5)), power(s, Long(-0.5))
    values, q = spectrum(np.einsum("nij,njk,nkl->nil", root, f, root))
    a, b = (n[:, None] / np.sqrt(values)).T
    z = np.einsum("nji,njk,nk->ni", q, root_inv, t)
    x, y = np.abs(z).T
    low, high = np.zeros_like(a), np.full_like(a, np.pi / 2)
    for _ in range(70):
        middle = (low + high) / 2
        c, si = np.cos(middle), np.sin(middle)
        falls = -a * si * (a * c - x) + b * c * (b * si - y) < 0
        low, high = np.where(falls, middle, low), np.where(falls, high, middle)
    nearest = np.stack([a * np.cos(low), b * np.sin(low)], -1) * np.where(z < 0, -1, 1)
    return np.einsum("nij,njk,nk->ni", root, q, nearest)


def first_with_normal(stiffness, friction, conjugate, trial, pressure, grid=1500):
    """Force on the ellipse with S^-1 (T_tr - T) = lambda K T, of the smallest lambda > 0: every
    change of sign of their cross product on a grid of angles, refined by halving."""
    arrays = (
        np.linalg.inv(stiffness),
        conjugate,
        trial,
        ellipse_map(stiffness, friction, pressure),
    )

    def cross(angle, s_inv, k, t, shape):
        force = np.stack(
            [shape[:, i, 0] * np.cos(angle) + shape[:, i, 1] * np.sin(angle) for i in (0, 1)]
        )
        r = np.einsum("nij,jn->in", s_inv, t.T - force)
        kt = np.einsum("nij,jn->in", k, force)
        return r[0] * kt[1] - r[1] * kt[0], (r * kt).sum(0) / (kt * kt).sum(0), force.T

    angles = np.linspace(0.0, 2.0 * np.pi, grid + 1)
    doubles = [np.asarray(v, float) for v in arrays]
    signs = np.array([np.sign(cross(a, *doubles)[0]) for a in angles])
    cells, rows = np.nonzero(signs[:-1] * signs[1:] < 0)
    low, high = angles[cells].astype(Long), angles[cells + 1].astype(Long)
    longs = [np.asarray(v, Long)[rows] for v in arrays]
    for _ in range(55):
        middle = (low + high) / 2
        left = np.sign(cross(middle, *longs)[0]) == signs[cells, rows]
        low, high = np.where(left, middle, low), np.where(left, high, middle)
    _, multiplier, force = cross(low, *longs)
    multiplier = np.where(multiplier > 0, multiplier, np.inf)
    first = np.lexsort((multiplier, rows))
    _, start = np.unique(rows[first], return_index=True)
    return force[first[start]]


def ellipse_map(stiffness, friction, pressure):
    """Takes the unit circle to the yield ellipse, with the angle of S^(-1/2) T."""
    s, f, n = (np.asarray(v, Long) for v in (stiffness, friction, pressure))
    root = power(s, Long(0.5))
    shape = power(np.einsum("nij,njk,nkl->nil", root, f, root), Long(-0.5))
    return n[:, None, None] * np.einsum("nij,njk->nik", root, shape)


def test_maximum_dissipation_is_the_convex_minimum(random_slides):
    p = random_slides(POINTS, 1, condition=1e3)
    r = slide(*p)
    assert r.slides.all() and r.converged.all()
    assert p.size((r.traction - nearest_on_ellipse(*p)).astype(float)).max() < BOUND


def ellipse(axes, angle):
    c, s = np.cos(angle), np.sin(angle)
    q = np.array([[c, -s], [s, c]])
    return q @ np.diag(1.0 / np.square(axes)) @ q.T


@pytest.mark.parametrize(
    ("name", "parameters", "conjugate"),
    [
        ("linear", {}, lambda f: power(f, 0.5)),
        ("coaxial", {}, lambda f: np.broadcast_to(np.eye(2), f.shape)),
        (
            "slip-ellipse",
            {"slip_axes": (3.0, 1.0), "slip_angle": 0.7},
            lambda f: np.broadcast_to(ellipse((3.0, 1.0), 0.7), f.shape),
        ),
    ],
)
def test_slip_is_normal_to_the_second_ellipse(random_slides, name, parameters, conjugate):
    p = random_slides(POINTS, 2, condition=1e2)
    r = slide(*p, name, **parameters)
    assert r.converged.all()
    expected = first_with_normal(p.stiffness, p.friction, conjugate(p.friction), *tuple(p)[2:])
    assert p.size((r.traction - expected).astype(float)).max() < BOUND
