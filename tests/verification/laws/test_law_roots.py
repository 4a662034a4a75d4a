"""The smallest multiplier of the implicit rules: several roots, extreme ratios and the strip.

Requirement: the force is where the path T(lambda) = (I + lambda S K)^-1 T_tr first meets the yield
ellipse, for every ratio N/|T_tr|, every condition of S and F up to 1e8, and in the strip eps_1 ->
0. Source: backward Euler of the rules of section 4.1 of the paper; for K != F the path can meet the
ellipse three times (docs/theory/sliding-rules.md), and only its first meeting is reached from T_tr.
"""

from __future__ import annotations

import numpy as np
import pytest

from anisocontact.laws import slide

IMPLICIT = (
    ("maximum-dissipation", {}),
    ("linear", {}),
    ("coaxial", {}),
    ("slip-ellipse", {"slip_axes": (30.0, 1.0), "slip_angle": 0.7}),
)


def conjugate(name, friction, parameters):
    if name == "maximum-dissipation":
        return friction
    if name == "coaxial":
        return np.broadcast_to(np.eye(2), friction.shape)
    if name == "linear":
        values, q = np.linalg.eigh(friction)
        return np.einsum("nij,nj,nkj->nik", q, np.sqrt(values), q)
    c, s = np.cos(parameters["slip_angle"]), np.sin(parameters["slip_angle"])
    q = np.array([[c, -s], [s, c]])
    weights = np.square(parameters["slip_axes"][0] / np.asarray(parameters["slip_axes"]))
    return np.broadcast_to(q @ np.diag(weights) @ q.T, friction.shape)


def path_size(problem, k, multiplier):
    """|T(lambda)|_F/N for a table of multipliers (n, m), in long double."""
    s, f, t = (np.asarray(v, np.longdouble) for v in tuple(problem)[:3])
    sk = np.einsum("nij,njk->nik", s, np.asarray(k, np.longdouble))
    trace = sk[:, 0, 0] + sk[:, 1, 1]
    det = (s[:, 0, 0] * s[:, 1, 1] - s[:, 0, 1] ** 2) * np.linalg.det(k)
    m = np.stack(
        [
            sk[:, 1, 1] * t[:, 0] - sk[:, 0, 1] * t[:, 1],
            sk[:, 0, 0] * t[:, 1] - sk[:, 1, 0] * t[:, 0],
        ],
        -1,
    )
    u = t[:, None, :] + multiplier[..., None] * m[:, None, :]
    d = 1 + multiplier * (trace[:, None] + multiplier * det[:, None])
    size = np.sqrt(np.einsum("nmi,nij,nmj->nm", u, f, u)) / d
    return (size / problem.pressure[:, None]).astype(float)


def test_first_of_three_meetings():
    """Built by hand: S K = diag(1, 1e-4) and an F whose ellipse the path enters, leaves and enters
    again. The roots are those of the quartic, by NumPy's companion matrix (its own rounding, some
    1e-10, is the tolerance)."""
    s, f, t = np.diag([1.0, 1e-4]), np.array([[1.0, -0.9], [-0.9, 1.0]]), np.array([3.0, 2.0])
    adjugate = np.diag([1e-4, 1.0])
    m = adjugate @ t
    d = np.polynomial.Polynomial([1.0, 1.0001, 1e-4])
    p = np.polynomial.Polynomial([t @ f @ t, 2 * t @ f @ m, m @ f @ m])
    roots = (d**2 - p).roots()
    roots = np.sort(roots[(np.abs(roots.imag) < 1e-12) & (roots.real > 0)].real)
    assert len(roots) == 3
    r = slide(s[None], f[None], t[None], [1.0], "coaxial")
    assert r.converged.all()
    multiplier = -r.slip[0] / r.traction[0]
    np.testing.assert_allclose(multiplier, roots[0], rtol=1e-10)


def test_far_meeting_where_the_near_pair_is_gone():
    """The same path with an ellipse too small for the near pair: one root, far out."""
    s, f, t = np.diag([1.0, 1e-4]), np.array([[1.0, -0.9], [-0.9, 1.0]]), np.array([3.0, 2.0])
    r = slide(s[None], f[None], t[None], [0.8], "coaxial")
    assert r.converged.all()
    assert -r.slip[0, 0] / r.traction[0, 0] > 1e3
    assert r.traction[0] @ f @ r.traction[0] == pytest.approx(0.64, rel=1e-14)


@pytest.mark.parametrize(("name", "parameters"), IMPLICIT)
@pytest.mark.parametrize(("condition", "decades"), [(1e2, 12.0), (1e8, 12.0), (1e8, 2.0)])
def test_first_meeting_over_twelve_decades(random_slides, name, parameters, condition, decades):
    """Tensors along the axes, so that their conditions do no harm to the reference. Before the root
    the path is outside the ellipse (1e-9: a meeting that close is the root itself), at the root on
    it (1e-11, the rounding of two nearly opposite terms of 1e-12 relative size at worst)."""
    p = random_slides(
        2000, 5, condition=condition, ratio=(10.0**-decades, 1.0 - 1e-9), aligned=True
    )
    r = slide(*p, name, **parameters)
    assert r.converged.all() and np.isfinite(r.d_trial).all() and np.isfinite(r.d_pressure).all()
    assert np.abs(p.size(r.traction) - 1.0).max() < 1e-14
    k = conjugate(name, p.friction, parameters)
    kt = np.einsum("nij,nj->ni", k, r.traction)
    multiplier = -(r.slip * kt).sum(1) / (kt * kt).sum(1)
    assert (multiplier > 0.0).all()
    part = np.unique(np.concatenate([np.linspace(0.0, 1.0, 300), np.logspace(-12, 0, 300)]))[:-1]
    assert path_size(p, k, multiplier[:, None] * part).min() > 1.0 - 1e-9
    assert np.abs(path_size(p, k, multiplier[:, None]) - 1.0).max() < 1e-11


@pytest.mark.parametrize("angle", [0.0, 0.4])
def test_strip_is_the_limit_of_a_thin_ellipse(rule, angle):
    """eps_1 -> 0 [Konyukhov Schweizerhof 2006, section 4.6]: a force in the range of S, as the
    strip makes it, gives the force and slip of eps_1 = 0. The difference is of first order in
    eps_1: it falls by 100 (90 to 110) when eps_1 does, and at eps_1/eps_2 = 1e-10 is below 1e-7
    (what the rounding of S against eps_1 leaves). The slip of `incremental` has no such limit: its
    force lies a little off the range of S, which S^-1 turns into a slip along the strip."""
    along = np.array([np.cos(angle), np.sin(angle)])
    across = np.array([-along[1], along[0]])
    f, t, e2 = np.diag([1 / 0.09, 100.0]), 5.0 * across, 5e4

    def solve(ratio):
        s = e2 * (np.outer(across, across) + ratio * np.outer(along, along))
        return slide(s[None], f[None], t[None], [2.0], rule.name, **rule.parameters)

    strip = solve(0.0)
    assert strip.converged.all()
    error = [np.abs(solve(x).traction - strip.traction).max() for x in (1e-4, 1e-6, 1e-10)]
    assert error[2] < 1e-7
    if rule.parameters.get("history") != "incremental":
        np.testing.assert_allclose(
            solve(1e-10).slip, strip.slip, rtol=0.0, atol=1e-5 * np.abs(strip.slip).max()
        )
    if error[0] > 1e-12:  # at angle 0, and where nothing depends on S, they are the same
        assert 90.0 < error[0] / error[1] < 110.0


@pytest.mark.parametrize(("name", "parameters"), IMPLICIT)
@pytest.mark.parametrize("angle", [0.0, 0.4])
def test_strip_with_a_force_it_cannot_relieve(name, parameters, angle):
    """A force along the strip (a direction field that turns can leave one) does not yield by slip.
    The force is then the limit eps_1 -> 0, of infinite lambda: N m/|m|_F with m = adj(S K) T_tr;
    its tangent is that of this map, checked against the thin ellipse to first order (1e-8 at
    eps_1/eps_2 = 1e-9)."""
    along = np.array([np.cos(angle), np.sin(angle)])
    across = np.array([-along[1], along[0]])
    f, t, e2 = np.diag([1 / 0.09, 100.0]), 5.0 * across + 3.0 * along, 5e4
    thin, strip = (
        slide(
            e2 * (np.outer(across, across) + x * np.outer(along, along))[None],
            f[None],
            t[None],
            [2.0],
            name,
            **parameters,
        )
        for x in (1e-9, 0.0)
    )
    assert thin.converged.all() and strip.converged.all()
    np.testing.assert_allclose(thin.traction, strip.traction, atol=1e-7)
    np.testing.assert_allclose(thin.d_trial, strip.d_trial, atol=1e-8)
    np.testing.assert_allclose(thin.d_pressure, strip.d_pressure, atol=1e-8)
    # the slip of least length: none along the strip
    assert abs(strip.slip[0] @ along) < 1e-12 * np.linalg.norm(strip.slip)
