"""Equations of the paper that hold as printed and are closed forms, entry by entry.

Source: [Konyukhov Schweizerhof 2006], equation numbers in brackets. Tolerances are rounding, 1e-12
of the largest number that enters, unless a test says otherwise. Equations with a misprint are in
test_errata.py; docs/theory/equations.md says which test pins which equation.
"""

from __future__ import annotations

import numpy as np
import pytest

from anisocontact.adhesion_domain import force_domain
from anisocontact.anisotropy import (
    DirectionField,
    from_reparametrisation,
    make_directions,
    tensor,
)
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


def test_force_of_two_orthotropic_surfaces() -> None:
    """(30) with constant alpha_i: T = -N (a1 E + a2 m (x) m + a3 k (x) k) u, against the slip u.

    The yield ellipse is F = C^-2, and the rule `linear` makes the force so: after 500 elastic
    lengths in 300 steps nothing is left of the start (1e-10).
    """
    a1, a2, a3 = 0.2, 0.15, -0.05
    m, k = (np.array([np.cos(a), np.sin(a)]) for a in (0.3, 1.2))
    c = a1 * np.eye(2) + a2 * np.outer(m, m) + a3 * np.outer(k, k)
    friction = Friction(
        "he-curnier",
        alpha=(a1, a2, a3),
        directions=marks(0.3),
        directions_second=marks(1.2),
        sliding_rule="linear",
    )
    inverse = np.linalg.inv(c)
    np.testing.assert_allclose(friction.tensor(PLANE, [[0, 0]])[0], inverse @ inverse, rtol=1e-11)
    itf = Interface(
        PLANE, NormalLaw(penalty=EPS_N), Adhesion(stiffness=EPS, directions=marks()), friction
    )
    for angle in (0.1, 1.0, 2.5):
        u = np.array([np.cos(angle), np.sin(angle)])
        state = itf.initial_state(below(PLANE, np.zeros((1, 2))))
        for s in np.linspace(0.0, 0.1, 301)[1:]:
            r = itf.update(state, below(PLANE, s * u[None]), tangent=False)
            state = r.state
        np.testing.assert_allclose(r.traction_t[0, :2], -N * c @ u, atol=1e-10 * N)


def test_spectral_form() -> None:
    """(38)-(43): Q diag Q^T with the entries printed, for B with -eps_i and F with 1/mu_i^2."""
    for a in angles(10, 4):
        c, s = np.cos(a), np.sin(a)
        for l1, l2 in ((-EPS[0], -EPS[1]), (MU[0] ** -2, MU[1] ** -2)):
            off = (l1 - l2) * s * c
            printed = [[l1 * c * c + l2 * s * s, off], [off, l1 * s * s + l2 * c * c]]
            mixed = tensor(PLANE, [[0, 0]], marks(a), (l1, l2), "mixed")[0]
            np.testing.assert_allclose(mixed, printed, atol=TIGHT * abs(l1))


def test_second_parametrisation() -> None:
    """(44)-(48): the lines of a second coordinate system of the plane, r and phi, are the axes.

    The field is sampled on a grid and exact at its nodes; there it is that of the polar field, up
    to the sign of the axes, which the tensor does not see.
    """

    def jacobian(xi: np.ndarray) -> np.ndarray:
        x, y = xi.T
        r = np.hypot(x, y)
        return np.stack([x / r, y / r, -y / r**2, x / r**2], axis=1).reshape(-1, 2, 2)

    field = from_reparametrisation(PLANE, jacobian, counts=(6, 5), lower=(1, -1), upper=(2, 1))
    nodes = np.stack(
        np.meshgrid(np.linspace(1, 2, 6), np.linspace(-1, 1, 5), indexing="ij"), axis=-1
    ).reshape(-1, 2)
    polar = make_directions("polar", axis=((0, 0, 0), (0, 0, 1)))
    for placement in ("co", "spatial"):
        found = tensor(PLANE, nodes, field, (3.0, 1.0), placement)
        np.testing.assert_allclose(
            found, tensor(PLANE, nodes, polar, (3.0, 1.0), placement), atol=1e-12
        )


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


def test_oblique_directions_on_a_plane() -> None:
    """(58)-(60) entry by entry; with beta = alpha + pi/2 the orthotropic (42)."""
    for a, b in zip(angles(10, 7), angles(10, 8), strict=True):
        field = make_directions("oblique", vector=(1, 0, 0), angle_first=a, angle_second=b)
        e1, e2 = EPS
        off = e1 * np.sin(a) * np.cos(a) + e2 * np.sin(b) * np.cos(b)
        xx = e1 * np.cos(a) ** 2 + e2 * np.cos(b) ** 2
        yy = e1 * np.sin(a) ** 2 + e2 * np.sin(b) ** 2
        spatial = tensor(PLANE, [[0, 0]], field, (-e1, -e2), "spatial")[0]
        printed = -np.array([[xx, off, 0], [off, yy, 0], [0, 0, 0]])
        np.testing.assert_allclose(spatial, printed, atol=TIGHT * e1)
        right = make_directions(
            "oblique", vector=(1, 0, 0), angle_first=a, angle_second=a + np.pi / 2
        )
        two = [tensor(PLANE, [[0, 0]], f, (-e1, -e2), "mixed") for f in (right, marks(a))]
        np.testing.assert_allclose(*two, atol=TIGHT * e1)


def test_polar_orthotropy() -> None:
    """(61)-(63) entry by entry, at random points of the plane."""
    field = make_directions("polar", axis=((0, 0, 0), (0, 0, 1)))
    e_r, e_phi = EPS
    for x, y in np.random.default_rng(9).normal(size=(20, 2)):
        off = (e_r - e_phi) * x * y
        b = -np.array([[e_r * x * x + e_phi * y * y, off], [off, e_r * y * y + e_phi * x * x]])
        b /= x * x + y * y
        phi = np.arctan2(y, x)
        spectral = tensor(PLANE, [[x, y]], marks(phi), (-e_r, -e_phi), "spatial")[0]
        np.testing.assert_allclose(
            tensor(PLANE, [[x, y]], field, (-e_r, -e_phi))[0], b, atol=TIGHT * e_r
        )
        np.testing.assert_allclose(spectral[:2, :2], b, atol=TIGHT * e_r)  # (62)


def test_spiral_on_a_cylinder() -> None:
    """(64)-(69), (72)-(75): surface, tangents, normal, metric, thread, and B in space."""
    xi = np.stack([angles(10, 10), angles(10, 11)], axis=1)
    g, jet = CYLINDER.geometry(xi), CYLINDER.jet(xi)
    e, _ = SPIRAL.axes(CYLINDER, xi)
    h, r, (e1, e2) = PITCH / (2 * np.pi), RADIUS, EPS
    d, g_eps = r * r + h * h, e1 * r * r + e2 * h * h
    spatial = tensor(CYLINDER, xi, SPIRAL, (-e1, -e2), "spatial")
    for k, (alpha, z) in enumerate(xi):
        c, s = np.cos(alpha), np.sin(alpha)
        np.testing.assert_allclose(jet.position[k], [r * c, r * s, z], atol=TIGHT)
        np.testing.assert_allclose(jet.d1[k], [[-r * s, r * c, 0], [0, 0, 1]], atol=TIGHT)
        np.testing.assert_allclose(g.normal[k], [c, s, 0], atol=TIGHT)
        np.testing.assert_allclose(g.a_co[k], np.diag([r * r, 1]), atol=TIGHT)
        r_1, r_2 = np.array([-r * s, r * c, h]), np.array([h * s, -h * c, r])
        assert r_1 @ r_1 == pytest.approx(d) and r_2 @ r_2 == pytest.approx(d)
        np.testing.assert_allclose(e[k], np.array([r_1, r_2]) / np.sqrt(d), atol=TIGHT)
        o = (e1 - e2) * r * h
        printed = [
            [g_eps * s * s, -g_eps * s * c, -o * s],
            [-g_eps * s * c, g_eps * c * c, o * c],
            [-o * s, o * c, e1 * h * h + e2 * r * r],
        ]
        np.testing.assert_allclose(spatial[k], -np.array(printed) / d, atol=TIGHT * e1)


# --- sliding -----------------------------------------------------------------------------------


def random_problem(n: int, seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """S, F, T_tr and N of points that slide, in an orthonormal basis."""
    rng = np.random.default_rng(seed)
    roots = rng.normal(size=(2, n, 2, 2))
    s, f = roots @ roots.transpose(0, 1, 3, 2) + 0.2 * np.eye(2)
    trial = rng.normal(size=(n, 2))
    size = np.sqrt(np.einsum("ni,nij,nj->n", trial, f, trial))
    return s, f, trial, size * rng.uniform(0.1, 0.9, n)


def test_explicit_force_in_any_basis() -> None:
    """(94)-(98): T = -N B F T_tr/sqrt(BFT_tr . F BFT_tr), with the indices of (98) in any basis.

    100 random problems, once in an orthonormal basis and once in an oblique one; 1e-10 for the
    condition of the basis.
    """
    s, f, trial, n = random_problem(100, 12)
    r = slide(s, f, trial, n, "explicit")
    hat = -np.einsum("nij,njk,nk->ni", s, f, trial)
    expected = -hat * (n / np.sqrt(np.einsum("ni,nij,nj->n", hat, f, hat)))[:, None]
    np.testing.assert_allclose(r.traction, expected, rtol=1e-11)
    rho = np.array([[1.5, 0.2], [-0.4, 0.7]])  # rho_i in rows
    contra = np.linalg.inv(rho).T
    oblique = slide(
        rho @ s @ rho.T,
        contra @ f @ contra.T,
        trial @ rho.T,
        n,
        "explicit",
        metric=np.broadcast_to(rho @ rho.T, s.shape),
        axes=np.broadcast_to(contra.T, s.shape),
    )
    np.testing.assert_allclose(oblique.traction, expected @ rho.T, rtol=1e-10, atol=1e-12)


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


def test_ellipse_of_forces() -> None:
    """(31), (32), (115), (117)-(119): semi-axes mu_i N at the angle beta, T.F_N T = 1 with F/N^2.

    The boundary of `force_domain` against the friction tensor of a random angle.
    """
    for beta in angles(10, 16):
        f = Friction(coefficients=MU, directions=marks(beta)).tensor(PLANE, [[0, 0]])[0]
        domain = force_domain(MU, beta, N)
        np.testing.assert_allclose(domain.semi_axes, np.multiply(MU, N), rtol=TIGHT)
        t = domain.points()
        np.testing.assert_allclose(np.einsum("ni,ij,nj->n", t, f / N**2, t), 1.0, rtol=1e-11)
