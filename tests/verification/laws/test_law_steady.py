"""Closed forms of steady slip, of the onset of slip and of stick.

Source: the rules themselves (docs/theory/sliding-rules.md), with h = sqrt(m1^2 cos^2 q + m2^2 sin^2
q) for slip at the angle q to the first friction axis. A point that is dragged along a straight line
approaches its steady force geometrically, so that after 400 steps of a fifth of the elastic slip
what is left is below rounding; 1e-12 are some 1e4 roundings.
"""

from __future__ import annotations

import numpy as np
import pytest

from anisocontact.laws import slide

M1, M2, N = 0.3, 0.1, 2.0
F = np.diag([1.0 / M1**2, 1.0 / M2**2])
ANGLES = np.radians([0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 90.0, 130.0, 200.0, 300.0])
TIGHT = {"rtol": 0.0, "atol": 1e-12}


def directions(angles):
    return np.stack([np.cos(angles), np.sin(angles)], -1)


def turned(first, second, angle):
    c, s = np.cos(angle), np.sin(angle)
    q = np.array([[c, -s], [s, c]])
    return q @ np.diag([first, second]) @ q.T


def drag(rule, parameters, stiffness, angles, step=None, count=400, friction=F, stored=None):
    """The law alone along straight lines: T_tr = stored - S dxi in every step."""
    n = len(angles)
    s, f = np.broadcast_to(stiffness, (n, 2, 2)), np.broadcast_to(friction, (n, 2, 2))
    size = step if step is not None else 0.2 * N * 0.3 / np.linalg.eigvalsh(stiffness)[-1]
    increment = size * directions(angles)
    stored = np.zeros((n, 2)) if stored is None else stored
    for _ in range(count):
        trial = stored - np.einsum("nij,nj->ni", s, increment)
        r = slide(s, f, trial, np.full(n, N), rule, increment=increment, **parameters)
        assert r.converged.all()
        stored = r.stored
    assert r.slides.all()
    return r


def unit_force(t, friction=F):
    """The force of size N in the direction t."""
    return N * t / np.sqrt(np.einsum("ni,ij,nj->n", t, friction, t))[:, None]


STIFFNESSES = {
    "isotropic": np.eye(2) * 50.0,
    "coaxial": np.diag([20.0, 80.0]),
    "turned": turned(20.0, 80.0, 0.6),
}


@pytest.mark.parametrize("stiffness", STIFFNESSES.values(), ids=STIFFNESSES)
def test_maximum_dissipation(stiffness):
    """T/N = -(m1^2 cos q, m2^2 sin q)/h: drag h, lateral force dh/dq; whatever the adhesion."""
    r = drag("maximum-dissipation", {}, stiffness, ANGLES, count=1500)
    c, s = np.cos(ANGLES), np.sin(ANGLES)
    h = np.sqrt(M1**2 * c**2 + M2**2 * s**2)
    np.testing.assert_allclose(
        r.traction, -N * np.stack([M1**2 * c, M2**2 * s], -1) / h[:, None], **TIGHT
    )
    e, across = directions(ANGLES), directions(ANGLES + np.pi / 2)
    np.testing.assert_allclose(-(r.traction * e).sum(-1) / N, h, **TIGHT)
    lateral = (M2**2 - M1**2) * s * c / h
    np.testing.assert_allclose(-(r.traction * across).sum(-1) / N, lateral, **TIGHT)


@pytest.mark.parametrize(
    ("angle", "of_force", "size"),
    [(15, 1.705, 0.29093), (30, 3.670, 0.26458), (45, 6.340, 0.22361), (60, 10.893, 0.17321)],
)
def test_table_of_steady_slip(angle, of_force, size):
    """The printed digits of the table: half a unit of the last."""
    t = -drag("maximum-dissipation", {}, np.eye(2) * 50.0, np.radians([angle])).traction[0]
    assert np.degrees(np.arctan2(t[1], t[0])) == pytest.approx(of_force, abs=5e-4)
    e = directions(np.radians(angle))
    assert t @ e / N == pytest.approx(size, abs=5e-6)


def test_largest_deviation():
    """Between slip and force at most atan((m1^2 - m2^2)/(2 m1 m2)), at tan q = m1/m2: no slip of a
    fine fan deviates more, and the one at that angle by that much."""
    best = np.arctan2(M1, M2)
    angles = np.append(np.linspace(0.0, np.pi / 2, 181), best)
    t = -drag("maximum-dissipation", {}, np.eye(2) * 50.0, angles, count=1000).traction
    deviation = angles - np.arctan2(t[:, 1], t[:, 0])
    largest = np.arctan2(M1**2 - M2**2, 2.0 * M1 * M2)
    assert deviation[-1] == pytest.approx(largest, abs=1e-12)
    assert deviation.max() <= largest + 1e-12


@pytest.mark.parametrize("stiffness", STIFFNESSES.values(), ids=STIFFNESSES)
def test_linear(stiffness):
    """T = -N F^(-1/2) v/|v| = -N (m1 cos q, m2 sin q)."""
    r = drag("linear", {}, stiffness, ANGLES, count=1500)
    np.testing.assert_allclose(r.traction, -N * np.array([M1, M2]) * directions(ANGLES), **TIGHT)


@pytest.mark.parametrize("stiffness", STIFFNESSES.values(), ids=STIFFNESSES)
def test_coaxial(stiffness):
    """The force opposes the slip and has the size of the friction ellipse."""
    r = drag("coaxial", {}, stiffness, ANGLES, count=1500)
    np.testing.assert_allclose(r.traction, unit_force(-directions(ANGLES)), **TIGHT)


@pytest.mark.parametrize("stiffness", STIFFNESSES.values(), ids=STIFFNESSES)
@pytest.mark.parametrize("angle", [0.0, 0.5])
def test_slip_ellipse(stiffness, angle):
    """Slip normal to (T1/k1)^2 + (T2/k2)^2: T is along K^-1 v, K^-1 with the eigenvalues k^2; where
    slip can be steady, FT . SKT > 0 (see the next test)."""
    axes = np.array([2.0, 1.5])
    t = unit_force(-directions(ANGLES) @ turned(*axes**2, angle))
    can_be = loading(t, stiffness, turned(*axes**-2, angle)) > 0.0
    assert can_be.sum() > 6
    r = drag(
        "slip-ellipse",
        {"slip_axes": axes, "slip_angle": angle},
        stiffness,
        ANGLES[can_be],
        count=1500,
    )
    np.testing.assert_allclose(r.traction, t[can_be], **TIGHT)


def loading(t, stiffness, conjugate):
    """Sign of FT . SKT: whether slip normal to K relieves the yield function."""
    return np.einsum("ni,ni->n", t @ F, t @ (stiffness @ conjugate).T)


def test_no_steady_slip_where_slip_does_not_relieve():
    """Where FT . SKT < 0 a slip in the direction -KT would load the yield function further.
    Backward Euler then does what the law does: the point sticks, jumps to another part of the
    ellipse, sticks again. It cannot happen for K = F, nor for S ~ I with K and F of the same
    axes."""
    stiffness, axes, turn = STIFFNESSES["turned"], np.array([2.0, 1.5]), 0.5
    v = directions(np.radians([5.0]))
    t = unit_force(-v @ turned(*axes**2, turn))
    assert loading(t, stiffness, turned(*axes**-2, turn)) < 0.0
    stored, sliding = t, []
    for _ in range(300):
        trial = stored - 1e-4 * v @ stiffness
        r = slide(
            stiffness[None], F[None], trial, [N], "slip-ellipse", slip_axes=axes, slip_angle=turn
        )
        assert r.converged.all()
        stored = r.stored
        sliding.append(r.slides[0])
    assert 0 < sum(sliding) < 150


def test_slip_ellipse_contains_the_others(random_slides):
    """Similar to the friction ellipse it is maximum dissipation, a circle is `coaxial`, k ~ sqrt(m)
    is `linear`; in one step from any trial force. 1e-13: roundings."""
    p = random_slides(1000, 21, aligned=True)
    f = np.broadcast_to(F, p.friction.shape)
    n = 0.3 * np.sqrt(np.einsum("ni,nij,nj->n", p.trial, f, p.trial))
    for other, axes in (
        ("maximum-dissipation", (M1, M2)),
        ("coaxial", (7.0, 7.0)),
        ("linear", (np.sqrt(M1), np.sqrt(M2))),
    ):
        a = slide(p.stiffness, f, p.trial, n, "slip-ellipse", slip_axes=axes)
        b = slide(p.stiffness, f, p.trial, n, other)
        np.testing.assert_allclose(a.traction, b.traction, rtol=0, atol=1e-13)


@pytest.mark.parametrize("stiffness", STIFFNESSES.values(), ids=STIFFNESSES)
@pytest.mark.parametrize("load", np.radians([10.0, 30.0, 45.0, 70.0]))
def test_dead_load_just_past_the_limit(stiffness, load):
    """A load at the angle f one part in 1e7 above the limit: slip starts along F T, at
    tan q = (m1/m2)^2 tan f. The direction is that of T up to the excess: 1e-6."""
    t = unit_force(directions(np.array([load]))) * (1.0 + 1e-7)
    r = slide(stiffness[None], F[None], -t, [N], "maximum-dissipation")
    slip = r.slip[0]
    q = np.arctan2(slip[1], slip[0])
    assert np.tan(q) == pytest.approx((M1 / M2) ** 2 * np.tan(load), rel=1e-6 * 100)


def test_stick_direction():
    """Below the limit dxi = B^-1 T: tan(angle of dxi) = (e1/e2) tan(angle of T)."""
    e1, e2, q = 20.0, 80.0, np.radians(35.0)
    dxi = 1e-4 * directions(q)
    trial = -np.diag([e1, e2]) @ dxi
    r = slide(np.diag([e1, e2])[None], F[None], trial[None], [N])
    assert not r.slides.any()
    t = r.traction[0]
    assert e1 / e2 * t[1] / t[0] == pytest.approx(np.tan(q), rel=1e-14)


@pytest.mark.parametrize("stiffness", STIFFNESSES.values(), ids=STIFFNESSES)
def test_radial(stiffness):
    """The stored force turns to -S e: T = -N S e/sqrt(Se.FSe)."""
    r = drag("radial", {}, stiffness, ANGLES, count=1500)
    np.testing.assert_allclose(r.traction, unit_force(-directions(ANGLES) @ stiffness), **TIGHT)


@pytest.mark.parametrize("stiffness", STIFFNESSES.values(), ids=STIFFNESSES)
def test_explicit_centre(stiffness):
    """T = -N SFSe/sqrt(SFSe.F.SFSe)."""
    r = drag("explicit", {"history": "centre"}, stiffness, ANGLES, count=1500)
    t = -directions(ANGLES) @ (stiffness @ F @ stiffness)
    np.testing.assert_allclose(r.traction, unit_force(t), **TIGHT)


def test_explicit_centre_as_a_slip_ellipse():
    """For coaxial tensors steady `centre` is the rule of Michalowski and Mroz with
    k1/k2 = (e1/m1)/(e2/m2), which is the associated rule only where e_i ~ m_i^2."""
    e1, e2 = 20.0, 80.0
    a = drag("explicit", {}, np.diag([e1, e2]), ANGLES, count=1500)
    b = drag("slip-ellipse", {"slip_axes": (e1 / M1, e2 / M2)}, np.eye(2) * 50.0, ANGLES)
    np.testing.assert_allclose(a.traction, b.traction, **TIGHT)
    c = drag("explicit", {}, 5e3 * np.diag([M1**2, M2**2]), ANGLES, count=1500)
    d = drag("maximum-dissipation", {}, np.eye(2) * 50.0, ANGLES)
    np.testing.assert_allclose(c.traction, d.traction, **TIGHT)


@pytest.mark.parametrize(("steps", "angle"), [(10, 84.9), (40, 86.8), (320, 89.3)])
def test_explicit_incremental_does_not_converge(steps, angle):
    """Isotropic S, slip at 45 degrees over 0.05, S/N = 100 per length: the force turns to the
    dominant eigenvector of S F the more, the finer the steps. Printed digits of the table."""
    length, s = 0.05, 100.0 * N * np.eye(2)
    r = drag(
        "explicit",
        {"history": "incremental"},
        s,
        np.radians([45.0]),
        step=length / steps,
        count=steps,
    )
    t = -r.traction[0]
    assert np.degrees(np.arctan2(t[1], t[0])) == pytest.approx(angle, abs=0.05)


def test_kuhn_tucker_stays_where_it_was():
    """(111) slides along the increment, which leaves the elastic force where it met the ellipse as
    long as the increment leads outward: after a turn of the path the force does not follow."""
    first = drag("explicit", {"history": "kuhn-tucker"}, np.eye(2) * 50.0, np.radians([20.0]))
    second = drag(
        "explicit",
        {"history": "kuhn-tucker"},
        np.eye(2) * 50.0,
        np.radians([50.0]),
        stored=first.stored,
    )
    np.testing.assert_allclose(second.stored, first.stored, rtol=0, atol=1e-13)


def test_force_jumps_between_stick_and_slip():
    """At the limit the sticking force is T_tr, the sliding force (96) is along S F T_tr: `explicit`
    jumps by that angle, 45 degrees on an isotropic S to atan(9) at m1/m2 = 3. The implicit rules
    and `radial` do not jump: the difference is of the size of the excess, 1e-9."""
    t = unit_force(directions(np.radians([45.0])))
    s = np.eye(2)[None] * 50.0
    for rule, parameters, jump in (
        ("explicit", {}, np.degrees(np.arctan(9.0)) - 45.0),
        ("explicit", {"history": "kuhn-tucker"}, np.degrees(np.arctan(9.0)) - 45.0),
        ("maximum-dissipation", {}, 0.0),
        ("linear", {}, 0.0),
        ("coaxial", {}, 0.0),
        ("slip-ellipse", {"slip_axes": (3.0, 1.0)}, 0.0),
        ("radial", {}, 0.0),
    ):
        below = slide(s, F[None], t * (1 - 1e-10), [N], rule, **parameters)
        above = slide(s, F[None], t * (1 + 1e-10), [N], rule, **parameters)
        assert not below.slides.any() and above.slides.all()
        turn = [np.degrees(np.arctan2(r.traction[0, 1], r.traction[0, 0])) for r in (below, above)]
        assert turn[1] - turn[0] == pytest.approx(jump, abs=1e-6)
    # S F ~ I: no jump
    s = np.diag([M1**2, M2**2])[None] * 50.0
    above = slide(s, F[None], t * (1 + 1e-10), [N], "explicit")
    np.testing.assert_allclose(above.traction, t, rtol=0, atol=1e-9)


def test_larger_root_of_kuhn_tucker_would_create_energy():
    """From no force T_tr = -S dxi the roots of (111) are lambda = 1 -+ N/|S dxi|_F: the rule takes
    the smaller; the larger one leaves an elastic force that pushes along the slip, D < 0."""
    s, dxi = STIFFNESSES["turned"], np.array([0.05, 0.02])
    trial = -s @ dxi
    r = slide(
        s[None], F[None], trial[None], [N], "explicit", history="kuhn-tucker", increment=dxi[None]
    )
    part = N / np.sqrt(trial @ F @ trial)
    np.testing.assert_allclose(r.slip[0], (1.0 - part) * dxi, rtol=1e-13)
    larger = (1.0 + part) * dxi
    assert -(trial + s @ larger) @ larger < 0.0 < -r.stored[0] @ r.slip[0]


@pytest.mark.parametrize("dxi", [(0.0, 1e-3), (1e-3, 0.0), (0.0, 0.0)])
def test_kuhn_tucker_without_a_root_returns_radially(dxi):
    """N has dropped, and the increment leads past the ellipse, back, or nowhere: (111) has no
    positive real root. The elastic force then falls along the trial force."""
    s = np.eye(2) * 50.0
    trial = np.array([0.5, 0.02]) - s @ dxi
    n = 0.3 * np.sqrt(trial @ F @ trial)
    r = slide(
        s[None], F[None], trial[None], [n], "explicit", history="kuhn-tucker", increment=[dxi]
    )
    np.testing.assert_allclose(r.stored[0], 0.3 * trial, rtol=1e-13)
