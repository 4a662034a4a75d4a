"""The law does not know which basis, axis order or units it is written in.

Requirement and source: the theory is covariant [Konyukhov Schweizerhof 2006, section 2]; a result
that changed with the frame, with the names of the axes or with the units would be wrong whatever
its value. 1e-12 relative: some 1e3 roundings at tensors of condition 10 in a basis of condition
below 10.
"""

from __future__ import annotations

import numpy as np
import pytest

from anisocontact.anisotropy import make_directions
from anisocontact.interface import Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw, slide
from anisocontact.surfaces import make_surface

POINTS = 500
CLOSE = {"rtol": 0.0, "atol": 1e-12}


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
    oblique = np.eye(2) + np.einsum("n,ij->nij", r.uniform(-0.8, 0.8, POINTS), [[0, 1.0], [0, 0]])
    mirror = np.where(r.uniform(size=POINTS) < 0.5, 1.0, -1.0)[:, None, None]
    flip = np.broadcast_to(np.eye(2), oblique.shape).copy()
    flip[:, 1, 1] = mirror[:, 0, 0]
    return turn @ oblique @ flip * stretch[:, None, :]


def test_any_basis(rule, problem):
    """S_ij, f^ij, a_ij, e_a^i, T_i and dxi^i of any basis give the same force, slip and tangent."""
    s, f, t, n, dxi = problem
    plain = slide(s, f, t, n, rule.name, increment=dxi, **rule.parameters)
    j = bases()  # v = J v', T' = J^T T
    jt, j_inv = j.swapaxes(1, 2), np.linalg.inv(j)
    r = slide(
        jt @ s @ j,
        j_inv @ f @ j_inv.swapaxes(1, 2),
        np.einsum("nji,nj->ni", j, t),
        n,
        rule.name,
        metric=jt @ j,
        axes=j_inv.swapaxes(1, 2),
        increment=np.einsum("nij,nj->ni", j_inv, dxi),
        **rule.parameters,
    )
    back = j_inv.swapaxes(1, 2)
    np.testing.assert_allclose(np.einsum("nij,nj->ni", back, r.traction), plain.traction, **CLOSE)
    np.testing.assert_allclose(np.einsum("nij,nj->ni", back, r.stored), plain.stored, **CLOSE)
    np.testing.assert_allclose(back @ r.d_trial @ jt, plain.d_trial, **CLOSE)
    np.testing.assert_allclose(
        np.einsum("nij,nj->ni", back, r.d_pressure), plain.d_pressure, **CLOSE
    )
    slip, expected = np.einsum("nij,nj->ni", j, r.slip), plain.slip
    assert (np.abs(slip - expected).max(1) <= 1e-12 * (1.0 + np.abs(expected).max(1))).all()


@pytest.mark.parametrize(("stress", "length"), [(1e6, 1e3), (3e-9, 2e-7), (7e11, 1.3)])
def test_units(rule, problem, stress, length):
    """Another unit of stress and of length: forces scale with the first, slip with the second."""
    s, f, t, n, dxi = problem
    plain = slide(s, f, t, n, rule.name, increment=dxi, **rule.parameters)
    r = slide(
        s * (stress / length),
        f,
        t * stress,
        n * stress,
        rule.name,
        increment=dxi * length,
        **rule.parameters,
    )
    np.testing.assert_allclose(r.traction / stress, plain.traction, **CLOSE)
    np.testing.assert_allclose(r.d_trial, plain.d_trial, **CLOSE)
    np.testing.assert_allclose(r.d_pressure, plain.d_pressure, **CLOSE)
    scale = 1.0 + np.abs(plain.slip).max()
    np.testing.assert_allclose(r.slip / length, plain.slip, rtol=0, atol=1e-12 * scale)


def random_path(itf, rotate=None):
    """The last response on a path of four steps over a plane through the origin."""
    rotate = np.eye(3) if rotate is None else rotate
    r = np.random.default_rng(5)
    start = r.uniform(-1.0, 1.0, (50, 3)) * [1.0, 1.0, 0.0] - [0.0, 0.0, 2e-3]
    steps = r.normal(scale=3e-3, size=(4, 50, 3)) * [1.0, 1.0, 0.1]
    state = itf.initial_state(start @ rotate.T)
    for x in start + np.cumsum(steps, axis=0):
        response = itf.update(state, x @ rotate.T)
        state = response.state
    assert (response.status == 2).any() and not response.failed.any()
    return response


def interface(rule, rotate=None, *, swapped=False):
    """Axes of adhesion and friction apart; `swapped`: the same with the axes in the other order."""
    rotate = np.eye(3) if rotate is None else rotate
    order = -1 if swapped else 1
    parameters = dict(rule.parameters)
    if "slip_axes" in parameters:
        parameters["slip_axes"] = parameters["slip_axes"][::order]

    def field(angle):
        quarter = np.pi / 2 if swapped else 0.0
        return make_directions("constant", vector=rotate @ [1, 0, 0], angle=angle + quarter)

    return Interface(
        make_surface("plane", point=(0, 0, 0), normal=rotate @ [0, 0, 1]),
        NormalLaw(penalty=1e3),
        Adhesion(stiffness=(4e2, 1e2)[::order], directions=field(0.3)),
        Friction(
            coefficients=(0.4, 0.2)[::order],
            directions=field(-0.2),
            sliding_rule=rule.name,
            **parameters,
        ),
    )


def test_interface_in_a_turned_space(rule):
    """A rotation of surface, directions and path rotates tractions and tangent, history
    included."""
    r = np.random.default_rng(6)
    q = np.linalg.qr(r.normal(size=(3, 3)))[0]
    q *= np.sign(np.linalg.det(q))
    plain, turned = random_path(interface(rule)), random_path(interface(rule, q), q)
    np.testing.assert_array_equal(plain.status, turned.status)
    np.testing.assert_allclose(turned.traction @ q, plain.traction, **CLOSE)
    np.testing.assert_allclose(q.T @ turned.tangent @ q, plain.tangent, rtol=0, atol=1e-12 * 1e3)
    np.testing.assert_allclose(
        turned.state["dissipation"], plain.state["dissipation"], rtol=0, atol=1e-14
    )


def test_axes_in_the_other_order(rule):
    """(first, second) along (e_1, e_2) is (second, first) along (e_2, -e_1)."""
    plain, swapped = random_path(interface(rule)), random_path(interface(rule, swapped=True))
    np.testing.assert_array_equal(plain.status, swapped.status)
    np.testing.assert_allclose(swapped.traction, plain.traction, **CLOSE)
    np.testing.assert_allclose(swapped.tangent, plain.tangent, rtol=0, atol=1e-12 * 1e3)
