"""Equations of the paper that hold as printed and are closed forms, entry by entry.

Source: [Konyukhov Schweizerhof 2006], equation numbers in brackets. Tolerances are rounding, 1e-12
of the largest number that enters, unless a test says otherwise. Equations with a misprint are in
test_errata.py; docs/theory/equations.md says which test pins which equation.
"""

from __future__ import annotations

import numpy as np
import pytest

from anisocontact.anisotropy import DirectionField, make_directions, tensor
from anisocontact.interface import Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw, slide
from anisocontact.surfaces import Surface, make_surface

TIGHT = 1e-12
EPS, EPS_N, DEPTH, MU = (3e4, 1e4), 1e5, 1e-4, (0.3, 0.1)
N = EPS_N * DEPTH
RADIUS, PITCH = 0.8, 0.5
PLANE = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1), tangent=(1, 0, 0))
CYLINDER = make_surface("cylinder", point=(0, 0, 0), axis=(0, 0, 1), start=(1, 0, 0), radius=RADIUS)
SPIRAL = make_directions("spiral", axis=((0, 0, 0), (0, 0, 1)), pitch=PITCH)


def marks(angle: float = 0.0) -> DirectionField:
    return make_directions("constant", vector=(1, 0, 0), angle=angle)


def sticking(
    surface: Surface, directions: DirectionField | None, evolution: str = "transport"
) -> Interface:
    """An interface that never slides; isotropic without directions."""
    stiffness = EPS if directions else (EPS[0], EPS[0])
    return Interface(
        surface,
        NormalLaw(penalty=EPS_N),
        Adhesion(stiffness=stiffness, directions=directions),
        Friction(coefficients=(1e6, 1e6)),
        evolution=evolution,
    )


def below(surface: Surface, xi: np.ndarray, depth: float = DEPTH) -> np.ndarray:
    """Slave points under the surface at coordinates (n, 2)."""
    return np.asarray(surface.position(xi) - depth * surface.geometry(xi).normal)


def angles(n: int, seed: int) -> np.ndarray:
    return np.random.default_rng(seed).uniform(-1.5, 1.5, n)


# --- forces and evolution ----------------------------------------------------------------------


def test_components_of_the_traction() -> None:
    """(7): t = T_i rho^i + N n, on a cylinder of radius 0.8, where rho^i and rho_i differ."""
    itf = sticking(CYLINDER, SPIRAL)
    xi = np.array([[0.2, 0.3], [-1.0, 0.5]])
    start = itf.initial_state(below(CYLINDER, xi))
    r = itf.update(start, below(CYLINDER, xi + 1e-3))
    g = CYLINDER.geometry(r.state["xi"])
    dual = g.a_contra @ CYLINDER.jet(r.state["xi"]).d1
    built = np.einsum("ni,nic->nc", r.state["traction"], dual)
    built += r.pressure[:, None] * g.normal
    np.testing.assert_allclose(r.traction, built, atol=TIGHT * np.abs(built).max())


def test_isotropic_evolution_is_diagonal() -> None:
    """(9), (12), (19), (20): dR/dt = diag(-eps_T, -eps_T, -eps_N) v on a plane, in stick."""
    itf = sticking(PLANE, None)
    x = below(PLANE, np.array([[0.1, 0.2]]))
    r = itf.update(itf.initial_state(x), x + np.array([1e-4, -2e-4, -3e-5]))
    expected = -np.diag([EPS[0], EPS[0], EPS_N])
    np.testing.assert_allclose(r.tangent[0], expected, atol=1e-9 * EPS_N)


def test_steps_add_up_to_the_whole_displacement() -> None:
    """(13)-(15): after ten steps T_i = -eps a_ij (xi^j - xi_(0)^j) and |T|^2 = T_i T_j a^ij.

    On the cylinder, whose metric is constant, in the evolution form that keeps components. The
    angle of a point is the result of an arctangent: 1e-16, which eps turns into 1e-11.
    """
    itf = sticking(CYLINDER, None, "incremental")
    xi = start = np.array([[0.2, 0.3]])
    state = itf.initial_state(below(CYLINDER, xi))
    rng = np.random.default_rng(1)
    for _ in range(10):
        xi = xi + rng.uniform(-1e-2, 1e-2, (1, 2))
        r = itf.update(state, below(CYLINDER, xi), tangent=False)
        state = r.state
    a = np.diag([RADIUS**2, 1.0])
    d = (xi - start)[0]
    np.testing.assert_allclose(state["traction"][0], -EPS[0] * a @ d, atol=1e-10)
    assert r.traction_t[0] @ r.traction_t[0] == pytest.approx(EPS[0] ** 2 * d @ a @ d, rel=1e-12)


def test_curvature_term() -> None:
    """(8), (10): dT_i = -h_i^k T_k dxi^3 while a point moves along the normal alone.

    On the cylinder h_1^1 = -1/R and h_2^2 = 0; backward Euler makes T_1 (1 - dxi^3/R) = T_1^(n).
    The rest of the motion must not matter, so the point goes straight to or from the axis.
    """
    itf = sticking(CYLINDER, SPIRAL, "covariant")
    xi = np.array([[0.3, 0.1]])
    start = itf.initial_state(below(CYLINDER, xi))
    pushed = itf.update(start, below(CYLINDER, xi + 1e-3), tangent=False).state
    force = pushed["traction"][0]
    for lift in (-0.05, -0.1):
        x = below(CYLINDER, xi + 1e-3, DEPTH - lift)
        after = itf.update(pushed, x, tangent=False).state["traction"][0]
        expected = force / np.array([1.0 - lift / RADIUS, 1.0])
        np.testing.assert_allclose(after, expected, rtol=1e-10)


@pytest.mark.parametrize("depth", [1e-5, 1e-4, 1e-3])
def test_friction_cone(depth: float) -> None:
    """(17): sticking ends at a displacement of mu eps_N |xi^3|/eps_T, a cone over the depth.

    Points at 1e-9 inside and outside, relative, in 12 directions.
    """
    mu, eps = 0.3, 2e4
    itf = Interface(
        PLANE,
        NormalLaw(penalty=EPS_N),
        Adhesion(stiffness=(eps, eps)),
        Friction(coefficients=(mu, mu)),
    )
    a = np.linspace(0.0, 6.0, 12)
    circle = mu * EPS_N * depth / eps * np.stack([np.cos(a), np.sin(a)], axis=1)
    start = itf.initial_state(below(PLANE, 0 * circle, depth))
    for factor, status in ((1.0 - 1e-9, 1), (1.0 + 1e-9, 2)):
        x = below(PLANE, factor * circle, depth)
        assert (itf.update(start, x, tangent=False).status == status).all()


def test_start_is_free_of_tangential_force(sample: object) -> None:
    """(24), (25), (101): a point starts at its projection without T and without slip.

    On every surface, above it and below it. N is measured from xi^3 = 0, so a point that starts
    below the surface is pressed at once, N = -eps_N xi^3, and is open above.
    """
    surface = sample.make()  # type: ignore[attr-defined]
    itf = sticking(surface, None)
    xi = sample.coordinates(20)  # type: ignore[attr-defined]
    size = sample.size  # type: ignore[attr-defined]
    for gap, status in ((-1e-3 * size, 1), (1e-3 * size, 0)):
        x = below(surface, xi, -gap)
        state = itf.initial_state(x)
        back = surface.position(state["xi"]) - surface.position(xi)
        assert np.abs(back).max() < 1e-12 * max(size, np.abs(x).max())
        r = itf.update(state, x, tangent=False)
        assert (r.status == status).all()
        assert np.abs(r.traction_t).max() < 1e-9 * EPS_N * size
        np.testing.assert_allclose(r.pressure, max(-EPS_N * gap, 0.0), rtol=1e-9)
        assert not r.state["slip"].any()


# --- tensors -----------------------------------------------------------------------------------


def test_isotropic_friction_is_the_metric() -> None:
    """(21), (33), (36): equal coefficients give f^ij = a^ij/mu^2, and F = f^ij rho_i (x) rho_j."""
    xi = np.stack([angles(10, 2), angles(10, 3)], axis=1)
    g, d1 = CYLINDER.geometry(xi), CYLINDER.jet(xi).d1
    contra = Friction(coefficients=(0.3, 0.3)).tensor(CYLINDER, xi)
    np.testing.assert_allclose(contra, g.a_contra / 0.09, atol=TIGHT * 20)
    turned = Friction(coefficients=MU, directions=SPIRAL)
    spatial = np.einsum("nij,nik,njl->nkl", turned.tensor(CYLINDER, xi), d1, d1)
    np.testing.assert_allclose(turned.tensor(CYLINDER, xi, "spatial"), spatial, atol=TIGHT * 200)


def test_adhesion_tensor_from_its_axes() -> None:
    """(49)-(55): b_ij = -eps_a (r_a . rho_i)(r_a . rho_j)/g_aa, and the force of one step with it.

    The spiral with r_1, r_2 as in (68), (69), which are no unit vectors; and T_k of a step in stick
    on the cylinder, in coordinates, is b_kj dxi^j. 1e-15 in the angle is 1e-10 in the force.
    """
    xi = np.stack([angles(10, 5), angles(10, 6)], axis=1)
    h, (sin, cos) = PITCH / (2 * np.pi), (np.sin(xi[:, 0]), np.cos(xi[:, 0]))
    one = np.ones(10)
    r_1 = np.stack([-RADIUS * sin, RADIUS * cos, h * one], axis=1)
    r_2 = np.stack([h * sin, -h * cos, RADIUS * one], axis=1)
    d1 = CYLINDER.jet(xi).d1
    b = np.zeros((10, 2, 2))
    for eps, r in zip(EPS, (r_1, r_2), strict=True):
        along = np.einsum("nc,nic->ni", r, d1)
        g = np.einsum("nc,nc->n", r, r)
        b -= eps * np.einsum("ni,nj->nij", along, along) / g[:, None, None]
    co = tensor(CYLINDER, xi, SPIRAL, (-EPS[0], -EPS[1]))
    np.testing.assert_allclose(co, b, atol=TIGHT * EPS[0])
    itf = sticking(CYLINDER, SPIRAL, "incremental")
    step = np.array([1e-3, 2e-3])
    start = itf.initial_state(below(CYLINDER, xi - step))
    force = itf.update(start, below(CYLINDER, xi), tangent=False).state["traction"]
    np.testing.assert_allclose(force, b @ step, atol=1e-9)


def test_cylinder() -> None:
    """(64)-(66), (75): position, tangents rho_i = dx/dxi^i, outward normal and metric."""
    xi = np.stack([angles(10, 10), angles(10, 11)], axis=1)
    g, jet, r = CYLINDER.geometry(xi), CYLINDER.jet(xi), RADIUS
    for k, (alpha, z) in enumerate(xi):
        c, s = np.cos(alpha), np.sin(alpha)
        np.testing.assert_allclose(jet.position[k], [r * c, r * s, z], atol=TIGHT)
        np.testing.assert_allclose(jet.d1[k], [[-r * s, r * c, 0], [0, 0, 1]], atol=TIGHT)
        np.testing.assert_allclose(g.normal[k], [c, s, 0], atol=TIGHT)
        np.testing.assert_allclose(g.a_co[k], np.diag([r * r, 1]), atol=TIGHT)


# --- sliding -----------------------------------------------------------------------------------


def random_problem(n: int, seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """S, F, T_tr and N of points that slide, in an orthonormal basis."""
    rng = np.random.default_rng(seed)
    roots = rng.normal(size=(2, n, 2, 2))
    s, f = roots @ roots.transpose(0, 1, 3, 2) + 0.2 * np.eye(2)
    trial = rng.normal(size=(n, 2))
    size = np.sqrt(np.einsum("ni,nij,nj->n", trial, f, trial))
    return s, f, trial, size * rng.uniform(0.1, 0.9, n)


def test_explicit_force() -> None:
    """(95)-(97): T = -N B F T_tr/sqrt(BFT_tr . F BFT_tr) for 100 random problems."""
    s, f, trial, n = random_problem(100, 12)
    r = slide(s, f, trial, n, "explicit")
    hat = -np.einsum("nij,njk,nk->ni", s, f, trial)
    expected = -hat * (n / np.sqrt(np.einsum("ni,nij,nj->n", hat, f, hat)))[:, None]
    np.testing.assert_allclose(r.traction, expected, rtol=1e-11)


def test_history_of_centres() -> None:
    """(114): dxi_sl = dxi - N dxi/sqrt(dxi.BFB dxi), the whole displacement dxi from the centre."""
    s, f, trial, n = random_problem(100, 13)
    r = slide(s, f, trial, n, "explicit", history="centre")
    dxi = -np.linalg.solve(s, trial[..., None])[..., 0]
    bfb = np.einsum("nij,njk,nkl->nil", s, f, s)
    size = np.sqrt(np.einsum("ni,nij,nj->n", dxi, bfb, dxi))
    slip = dxi * (1.0 - n / size)[:, None]
    np.testing.assert_allclose(r.slip, slip, atol=1e-10 * np.abs(dxi).max())
    stored = trial + np.einsum("nij,nj->ni", s, slip)
    np.testing.assert_allclose(r.stored, stored, atol=1e-10)


def test_history_of_the_force() -> None:
    """(112): the next trial force starts from the force itself."""
    s, f, trial, n = random_problem(100, 14)
    r = slide(s, f, trial, n, "explicit", history="incremental")
    np.testing.assert_array_equal(r.stored, r.traction)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_slip_along_one_axis(sign: float) -> None:
    """(124): dxi_sl = T_tr (mu_1 N - |T_tr|)/(eps_1 |T_tr|) for a move along the first axis.

    Through the interface, and with it the case of fig. 6.
    """
    itf = Interface(
        PLANE,
        NormalLaw(penalty=EPS_N),
        Adhesion(stiffness=EPS, directions=marks()),
        Friction(coefficients=MU, directions=marks(), sliding_rule="explicit"),
    )
    move = np.array([[sign * 5e-4, 0.0]])
    start = itf.initial_state(below(PLANE, 0 * move))
    r = itf.update(start, below(PLANE, move), tangent=False)
    trial = -EPS[0] * move[0, 0]
    slip = trial / (EPS[0] * abs(trial)) * (MU[0] * N - abs(trial))
    np.testing.assert_allclose(r.state["slip"][0], [slip, 0.0], atol=TIGHT * abs(slip) * 10)
    np.testing.assert_allclose(r.traction_t[0, 0], -sign * MU[0] * N, rtol=1e-11)


def test_increment_splits_into_elastic_and_sliding_part() -> None:
    """(78), (79), (83)-(85): dxi = dxi_el + dxi_sl in every step and T_n+1 - T_n = B dxi_el.

    A path of 30 random steps by maximum dissipation, axes of B and F apart.
    """
    itf = Interface(
        PLANE,
        NormalLaw(penalty=EPS_N),
        Adhesion(stiffness=EPS, directions=marks(0.4)),
        Friction(coefficients=MU, directions=marks(1.1)),
    )
    b = tensor(PLANE, [[0, 0]], marks(0.4), (-EPS[0], -EPS[1]))[0]
    rng, at = np.random.default_rng(15), np.zeros((1, 2))
    state = itf.initial_state(below(PLANE, at))
    slides = 0
    for _ in range(30):
        step = rng.uniform(-1e-4, 1e-4, (1, 2))
        at = at + step
        new = itf.update(state, below(PLANE, at), tangent=False).state
        elastic = new["elastic"] - state["elastic"]
        np.testing.assert_allclose(elastic + new["slip"], step, atol=1e-15)
        change = new["traction"] - state["traction"]
        np.testing.assert_allclose(change[0], b @ elastic[0], atol=1e-10)
        slides += int(new["status"][0] == 2)
        state = new
    assert 5 < slides < 30
