"""What every registered sliding rule has to do, the law alone; a new rule is tested by being there.

Requirement and source: the contract of a sliding rule (`law/slide.hpp`,
docs/theory/sliding-rules.md) — on the yield ellipse, exact tangent, no energy from nothing, no word
of basis or units, eq. (100) of the paper in the isotropic limit, and finite numbers for any input.
Where nothing else is said, a tolerance of 1e-12 is some 1e3 to 1e4 roundings of quantities of size
one at tensors of condition 10.
"""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from anisocontact.base import registry
from anisocontact.laws import slide

POINTS = 500
CLOSE = {"rtol": 0.0, "atol": 1e-12}
ANGLE = st.floats(0.0, 2.0 * np.pi)
SIZE = st.floats(-3.0, 3.0)  # powers of ten


def solve(rule, *problem, parameters=None, **more):
    values = rule.parameters if parameters is None else parameters
    r = slide(*problem, rule.name, **more, **values)
    assert r.converged.all()
    return r


def test_every_rule_has_a_sample(samples):
    missing = {e.name for e in registry.sliding_rules()} - set(samples)
    assert not missing, f"no sample in tests/verification/laws/conftest.py: {sorted(missing)}"


def test_descriptor(rule):
    """The entry says what it is, in words, a unit and a form for each parameter; and the samples
    cover its parameters."""
    entry = registry.entry(registry.sliding_rules(), rule.name)
    assert entry.doc and entry.kind == "sliding rule"
    for p in entry.parameters:
        assert p.doc and p.unit and p.name.isidentifier()
        assert p.name in rule.parameters


def test_on_the_ellipse(random_slides, rule):
    """|T|_F = N to 1e-12 of N; what is remembered is not outside, up to the rounding of the trial
    force, which is up to 1e4 N away: 1e-11."""
    p = random_slides(2000, 51, condition=1e2)
    r = solve(rule, *p)
    assert r.slides.all()
    np.testing.assert_allclose(p.size(r.traction), 1.0, **CLOSE)
    assert p.size(r.stored).max() < 1.0 + 1e-11


def test_slip_belongs_to_the_force(random_slides, rule):
    """T = T_tr + S dxi_sl for what the next step starts from: 1e-11 of the trial force, roundings
    times the condition of S."""
    p = random_slides(2000, 52, condition=1e2)
    r = solve(rule, *p)
    change = np.einsum("nij,nj->ni", p.stiffness, r.slip)
    np.testing.assert_allclose(r.stored, p.trial + change, rtol=0.0, atol=1e-11)


def test_stick(random_slides, rule):
    """Inside the ellipse the force is the trial force: tangent one and zero, to the last digit."""
    p = random_slides(200, 53)
    r = solve(rule, p.stiffness, p.friction, p.trial, 1e5 * p.pressure)
    assert not r.slides.any()
    np.testing.assert_array_equal(r.traction, p.trial)
    np.testing.assert_array_equal(r.stored, p.trial)
    np.testing.assert_array_equal(r.d_trial, np.broadcast_to(np.eye(2), (200, 2, 2)))
    np.testing.assert_array_equal(r.d_pressure, 0.0)
    np.testing.assert_array_equal(r.slip, 0.0)


@pytest.mark.parametrize("variable", ["T_tr,1", "T_tr,2", "N"])
def test_tangent_in_slip(random_slides, rule, variable):
    """By order: halving the step quarters the error of the central difference, 2 +- 0.1 at steps of
    1e-3 of the force, where the next term of the error is some percent. Away from the limit and
    from a second meeting with the ellipse: N between 0.3 and 0.8 of the trial force. Where T is
    linear in the variable there is no error but rounding, 1e-16/h."""
    p = random_slides(2000, 54, condition=10.0, ratio=(0.3, 0.8))
    r = solve(rule, *p)
    direction = {"T_tr,1": (1, 0, 0), "T_tr,2": (0, 1, 0), "N": (0, 0, 1)}[variable]
    exact = r.d_trial @ direction[:2] + r.d_pressure * p.pressure[:, None] * direction[2]

    def error(h):
        at = [
            solve(
                rule,
                p.stiffness,
                p.friction,
                p.trial + x * np.array(direction[:2]),
                p.pressure * (1.0 + x * direction[2]),
            ).traction
            for x in (h, -h)
        ]
        return np.sqrt(np.mean(((at[0] - at[1]) / (2.0 * h) - exact) ** 2))

    errors = np.array([error(h) for h in (2e-3, 1e-3, 5e-4)])
    if (errors < 1e-12).all():
        return
    order = np.log2(errors[:-1] / errors[1:])
    assert ((order > 1.9) & (order < 2.1)).all(), order


def tensor(angle, first, second):
    c, s = np.cos(angle), np.sin(angle)
    q = np.array([[c, -s], [s, c]])
    return q @ np.diag([10.0**first, 10.0**second]) @ q.T


def vector(angle, size):
    return 10.0**size * np.array([np.cos(angle), np.sin(angle)])


@settings(max_examples=200, deadline=None)
@given(
    s=st.tuples(ANGLE, SIZE, SIZE),
    f=st.tuples(ANGLE, SIZE, SIZE),
    stored=st.tuples(ANGLE, SIZE),
    increment=st.tuples(ANGLE, SIZE),
    ratio=st.floats(-8.0, -1e-6),
)
def test_every_slip_dissipates(rule, s, f, stored, increment, ratio):
    """D = -T . dxi_sl >= 0 from any stored force and any increment, T_tr = T_n - S dxi. Allowed
    below zero is the rounding of the force times that of the slip, 1e-13 (|dxi_sl| + |S^-1|
    |T_tr|)."""
    s, f, increment = tensor(*s), tensor(*f), vector(*increment)
    trial = vector(*stored) - s @ increment
    assume(np.linalg.norm(trial) > 0.0)
    n = 10.0**ratio * np.sqrt(trial @ f @ trial)
    r = solve(rule, s[None], f[None], trial[None], [n], increment=increment[None])
    assert r.slides.all()
    traction, slip = r.traction[0], r.slip[0]
    size = np.linalg.norm(slip) + np.linalg.norm(np.linalg.inv(s)) * np.linalg.norm(trial)
    assert -traction @ slip >= -1e-13 * np.linalg.norm(traction) * size


def test_isotropic_limit(random_slides, rule):
    """For isotropic B and F all are T = mu N T_tr/|T_tr|, or stick, with the slip of that force
    [Konyukhov Schweizerhof 2006, eq. (100)]."""
    p = random_slides(1000, 55)
    mu, e, n = 0.27, 40.0, np.full(1000, 2.0)
    s, f = (np.broadcast_to(x * np.eye(2), (1000, 2, 2)) for x in (e, 1.0 / mu**2))
    r = solve(rule, s, f, p.trial, n, parameters=rule.isotropic)
    length = np.linalg.norm(p.trial, axis=1)
    expected = p.trial * np.minimum(1.0, mu * n / length)[:, None]
    np.testing.assert_allclose(r.traction, expected, **CLOSE)
    np.testing.assert_allclose(r.stored, expected, **CLOSE)
    np.testing.assert_allclose(r.slip, (expected - p.trial) / e, **CLOSE)


@pytest.fixture
def problem(random_slides):
    """Tensors whose friction axes are the frame's, and an increment."""
    p = random_slides(POINTS, 41, condition=10.0, ratio=(0.05, 0.9))
    r = np.random.default_rng(42)
    values = 10.0 ** r.uniform(-0.5, 0.5, (POINTS, 2))
    f = np.einsum("ni,ij->nij", values, np.eye(2))
    n = r.uniform(0.05, 0.9, POINTS) * np.sqrt(np.einsum("ni,nij,nj->n", p.trial, f, p.trial))
    return p.stiffness, f, p.trial, n, r.normal(size=(POINTS, 2))


def bases():
    """Bases rho_1, rho_2, (n, 2, 2), column by column: turned, mirrored, oblique and stretched."""
    r = np.random.default_rng(43)
    angle, stretch = r.uniform(0, 2 * np.pi, POINTS), 10.0 ** r.uniform(-0.4, 0.4, (POINTS, 2))
    c, s = np.cos(angle), np.sin(angle)
    turn = np.stack([np.stack([c, -s], -1), np.stack([s, c], -1)], -2)
    shear = np.eye(2) + np.einsum("n,ij->nij", r.uniform(-0.8, 0.8, POINTS), [[0, 1.0], [0, 0]])
    flip = np.stack([np.ones(POINTS), np.sign(r.uniform(-1.0, 1.0, POINTS))], -1)
    return turn @ shear * (flip * stretch)[:, None, :]


def test_any_basis(rule, problem):
    """S_ij, f^ij, a_ij, e_a^i, T_i and dxi^i of any basis give the same force, slip and tangent."""
    s, f, t, n, dxi = problem
    plain = solve(rule, s, f, t, n, increment=dxi)
    j = bases()  # v = J v', T' = J^T T
    jt, j_inv = j.swapaxes(1, 2), np.linalg.inv(j)
    back = j_inv.swapaxes(1, 2)
    r = solve(
        rule,
        jt @ s @ j,
        j_inv @ f @ back,
        np.einsum("nij,nj->ni", jt, t),
        n,
        metric=jt @ j,
        axes=back,
        increment=np.einsum("nij,nj->ni", j_inv, dxi),
    )
    np.testing.assert_allclose(np.einsum("nij,nj->ni", back, r.traction), plain.traction, **CLOSE)
    np.testing.assert_allclose(np.einsum("nij,nj->ni", back, r.stored), plain.stored, **CLOSE)
    np.testing.assert_allclose(back @ r.d_trial @ jt, plain.d_trial, **CLOSE)
    d_pressure = np.einsum("nij,nj->ni", back, r.d_pressure)
    np.testing.assert_allclose(d_pressure, plain.d_pressure, **CLOSE)
    slip, expected = np.einsum("nij,nj->ni", j, r.slip), plain.slip
    assert (np.abs(slip - expected).max(1) <= 1e-12 * (1.0 + np.abs(expected).max(1))).all()


@pytest.mark.parametrize(("stress", "length"), [(1e6, 1e3), (3e-9, 2e-7), (7e11, 1.3)])
def test_units(rule, problem, stress, length):
    """Another unit of stress and of length: forces scale with the first, slip with the second."""
    s, f, t, n, dxi = problem
    plain = solve(rule, s, f, t, n, increment=dxi)
    r = solve(rule, s * (stress / length), f, t * stress, n * stress, increment=dxi * length)
    np.testing.assert_allclose(r.traction / stress, plain.traction, **CLOSE)
    np.testing.assert_allclose(r.d_trial, plain.d_trial, **CLOSE)
    np.testing.assert_allclose(r.d_pressure, plain.d_pressure, **CLOSE)
    atol = 1e-12 * (1.0 + np.abs(plain.slip).max())
    np.testing.assert_allclose(r.slip / length, plain.slip, rtol=0.0, atol=atol)


def test_turned_tensors_of_condition_1e8(random_slides, rule):
    """Turned axes: the components of F themselves carry its condition times the rounding, so that
    the force is on the ellipse to 1e-7, and every number is finite; over 12 decades of N."""
    p = random_slides(10_000, 56, condition=1e8, ratio=(1e-12, 0.999))
    r = solve(rule, *p)
    for a in (r.traction, r.stored, r.slip, r.d_trial, r.d_pressure):
        assert np.isfinite(a).all()
    assert np.abs(p.size(r.traction) - 1.0).max() < 1e-7


@pytest.mark.parametrize("ratio", [1e-300, 1e-100, 1e-30, 1.0 - 2e-16])
def test_vanishing_pressure_and_the_limit_itself(rule, ratio):
    """The force is N times a unit vector of the ellipse, whatever the size of N: 1e-14,
    roundings."""
    s, f = np.array([[3.0, 1.0], [1.0, 2.0]]), np.array([[10.0, 2.0], [2.0, 90.0]])
    t = np.array([1.0, -0.4])
    n = ratio * np.sqrt(t @ f @ t)
    r = solve(rule, s[None], f[None], t[None], [n])
    assert np.isfinite(r.d_trial).all() and np.isfinite(r.d_pressure).all()
    unit = r.traction[0] / n
    assert np.sqrt(unit @ f @ unit) == pytest.approx(1.0, rel=1e-14)


def test_threads_and_tangent_do_not_matter(random_slides, rule):
    """One thread or two, with tangent or without: the same bits."""
    p = random_slides(1000, 57)
    a, b = solve(rule, *p, threads=1), solve(rule, *p, threads=2, tangent=False)
    for name in ("traction", "stored", "slip", "slides"):
        np.testing.assert_array_equal(getattr(a, name), getattr(b, name))
    assert b.d_trial.shape == (0, 2, 2) and b.d_pressure.shape == (0, 2)
