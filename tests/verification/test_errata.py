"""Every row of docs/theory/errata.md: what holds, holds in the code, and what is printed does not.

Source: [Konyukhov Schweizerhof 2006], equation numbers in brackets. Tolerances are rounding, 1e-12
of the largest number that enters, unless a test says otherwise. A test fails where the code follows
the printed form, and where the printed form would be right after all.
"""

from __future__ import annotations

import numpy as np
import pytest

from anisocontact.anisotropy import DirectionField, make_directions, tensor
from anisocontact.interface import Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw, slide
from anisocontact.surfaces import make_surface
from anisocontact.surfaces.kinematics import relative_variation

TIGHT = 1e-12
N, PENALTY = 10.0, 1e5
DEPTH = N / PENALTY
RADIUS, PITCH = 0.8, 0.5
PLANE = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1), tangent=(1, 0, 0))
CYLINDER = make_surface("cylinder", point=(0, 0, 0), axis=(0, 0, 1), start=(1, 0, 0), radius=RADIUS)
SPIRAL = make_directions("spiral", axis=((0, 0, 0), (0, 0, 1)), pitch=PITCH)


def marks(angle: float = 0.0) -> DirectionField:
    """Orthogonal axes on the plane, the first at an angle to x."""
    return make_directions("constant", vector=(1, 0, 0), angle=angle)


def interface(
    stiffness: tuple[float, float] = (2e5, 5e4),
    mu: tuple[float, float] = (0.3, 0.1),
    angles: tuple[float, float] = (0.0, 0.0),
    evolution: str = "transport",
    **rule: object,
) -> Interface:
    """A plane with the axes of adhesion and of friction at the angles alpha and beta to x."""
    return Interface(
        PLANE,
        NormalLaw(penalty=PENALTY),
        Adhesion(stiffness=stiffness, directions=marks(angles[0])),
        Friction(coefficients=mu, directions=marks(angles[1]), **rule),
        evolution=evolution,
    )


def pressed(xy: np.ndarray, depth: float = DEPTH) -> np.ndarray:
    """Slave points below the plane, (n, 3)."""
    xy = np.atleast_2d(xy)
    return np.column_stack([xy, np.full(len(xy), -depth)])


def moved(itf: Interface, xy: np.ndarray) -> np.ndarray:
    """Status of points moved from the origin by xy (n, 2) under the pressure N."""
    x = pressed(xy)
    return itf.update(itf.initial_state(pressed(0.0 * xy)), x, tangent=False).status


def rotated(values: tuple[float, float], angle: float) -> np.ndarray:
    """Q diag(values) Q^T, (41)."""
    c, s = np.cos(angle), np.sin(angle)
    q = np.array([[c, -s], [s, c]])
    return q @ np.diag(values) @ q.T


# --- signs -------------------------------------------------------------------------------------


def test_pressure_has_the_sign_of_12() -> None:
    """(11) prints N = eps_N xi^3 < 0 in contact; (12), and the code, have N = -eps_N xi^3 > 0."""
    x = pressed(np.zeros(2))
    r = interface().update(interface().initial_state(x), x)
    assert r.gap[0] < 0.0
    assert r.pressure[0] == pytest.approx(-PENALTY * r.gap[0], rel=TIGHT)
    assert r.traction[0] @ r.normal[0] == pytest.approx(N, rel=TIGHT)
    rate = r.normal[0] @ r.tangent[0] @ r.normal[0]
    assert rate == pytest.approx(-PENALTY, rel=TIGHT)


def test_work_of_the_traction() -> None:
    """(18) holds with N of (12): t . (dx_s - drho) = N d xi^3 + T_j d xi^j; with (11) it does not.

    On a cylinder of radius 0.8 so that the coordinates are no lengths, and with T of size N.
    """
    rng = np.random.default_rng(1)
    itf = Interface(
        CYLINDER,
        NormalLaw(penalty=PENALTY),
        Adhesion(stiffness=(2e5, 5e4), directions=SPIRAL),
        Friction(coefficients=(3.0, 1.0), directions=SPIRAL),
    )
    xi = rng.uniform(-1.0, 1.0, (50, 2))
    g = CYLINDER.geometry(xi)
    x = CYLINDER.position(xi) - DEPTH * g.normal
    state = itf.initial_state(x)
    x += 1e-3 * np.cross(g.normal, rng.normal(size=(50, 3)))
    r = itf.update(state, x)
    d_slave, d_master = rng.normal(size=(2, 50, 3))
    d = relative_variation(CYLINDER, r.state["xi"], d_slave, d_master)
    work = np.einsum("ni,ni->n", r.traction, d_slave - d_master)
    tangential = np.einsum("ni,ni->n", r.state["traction"], d.xi)
    size = np.abs(work).max()
    np.testing.assert_allclose(work, r.pressure * d.gap + tangential, atol=TIGHT * size)
    assert np.abs(work - (-r.pressure * d.gap + tangential)).max() > 0.1 * size


RULES = [
    {"sliding_rule": "maximum-dissipation"},
    {"sliding_rule": "linear"},
    {"sliding_rule": "coaxial"},
    {"sliding_rule": "slip-ellipse", "slip_axes": (1.0, 2.0), "slip_angle": 0.4},
    {"sliding_rule": "radial"},
    {"sliding_rule": "explicit", "history": "centre"},
    {"sliding_rule": "explicit", "history": "incremental"},
]


@pytest.mark.parametrize("rule", RULES, ids=lambda r: "-".join(map(str, r.values())))
def test_dissipation_is_minus_traction_times_slip(rule: dict[str, object]) -> None:
    """D = -T . dxi_sl > 0 for slides from rest; (81), (87) print D = T . dxi_sl, which is negative.

    100 random directions of slip. The state accumulates D; the metric is the unit matrix.
    """
    itf = interface(angles=(0.3, 0.9), **rule)
    angle = np.random.default_rng(2).uniform(0.0, 2.0 * np.pi, 100)
    xy = 1e-3 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    s = itf.update(itf.initial_state(pressed(0.0 * xy)), pressed(xy), tangent=False).state
    assert (s["status"] == 2).all()
    printed = np.einsum("ni,ni->n", s["traction"], s["slip"])
    assert (printed < 0.0).all()
    np.testing.assert_allclose(s["dissipation"], -printed, rtol=TIGHT)


# --- yield and friction tensor -----------------------------------------------------------------


def test_limit_is_mu_times_pressure() -> None:
    """Sticking ends at |T| = mu N, so (16) has mu^2 N^2 and not mu |N|^2.

    With mu = 0.25 the printed limit would be mu^(1/2) N, twice as large. The point moves along x
    to 1e-9 below and above the limit, far more than the rounding of the force.
    """
    mu, eps = 0.25, 1e5
    itf = interface((eps, eps), (mu, mu))
    for factor, status in ((1.0 - 1e-9, 1), (1.0 + 1e-9, 2), (0.5 * (1.0 + mu**-0.5), 2)):
        assert moved(itf, np.array([[factor * mu * N / eps, 0.0]]))[0] == status


def test_yield_function_takes_the_root_before_the_pressure() -> None:
    """(56) prints one root over T.FT - |N|, whose zero is T.FT = N; the limit is T.FT = N^2, (33).

    In slip T.FT/N^2 = 1 to rounding for pressures from 0.1 to 1,000.
    """
    pressure = np.array([0.1, 1.0, 10.0, 1000.0])
    f = np.diag([1 / 0.09, 1 / 0.01])
    n = len(pressure)
    r = slide([np.eye(2)] * n, [f] * n, [[3e3, 4e3]] * n, pressure)
    squared = np.einsum("ni,ij,nj->n", r.traction, f, r.traction)
    np.testing.assert_allclose(squared, pressure**2, rtol=TIGHT)


def test_components_over_mu_are_no_tensor() -> None:
    """(37), f^ij = a^ij/mu_ij^2 in every basis, depends on the basis; F of (57) does not.

    The limit of a force in one direction, with (37) in a basis turned by 30 degrees and mu_12 as
    before, changes by more than half; with (57) it stays. In the turned basis a^12 = 0 while f^12
    is not, which no finite mu_12 can give.
    """
    turn, mu = np.radians(30.0), np.array([0.3, 0.1])
    c, s = np.cos(turn), np.sin(turn)
    basis = np.array([[c, s], [-s, c]])
    f = tensor(PLANE, [[0, 0]], marks(), mu**-2.0, "contra")[0]
    f_turned = tensor(
        PLANE, [[0, 0]], marks(), mu**-2.0, "contra", basis=np.column_stack([basis, [0, 0]])
    )[0]
    printed = np.eye(2) / np.array([[mu[0], 0.2], [0.2, mu[1]]]) ** 2
    t = np.array([1.0, 0.0])
    limit = (t @ f @ t) ** -0.5
    t_turned = basis @ t
    assert (t_turned @ f_turned @ t_turned) ** -0.5 == pytest.approx(limit, rel=TIGHT)
    assert (t @ printed @ t) ** -0.5 == pytest.approx(limit, rel=TIGHT)
    assert (t_turned @ printed @ t_turned) ** -0.5 < 0.6 * limit
    assert abs(f_turned[0, 1]) > 1.0


def test_friction_components_are_contravariant() -> None:
    """(57) contracts with rho^k (x) rho^l and so gives f^kl, not f_kl; T_k T_l f^kl is T.FT.

    On the cylinder of radius 0.8, where the two differ by factors R^2.
    """
    xi = np.random.default_rng(4).uniform(-1, 1, (20, 2))
    friction = Friction(coefficients=(0.3, 0.1), directions=SPIRAL)
    g, jet = CYLINDER.geometry(xi), CYLINDER.jet(xi)
    e, _ = SPIRAL.axes(CYLINDER, xi)
    dual = np.einsum("nij,njc->nic", g.a_contra, jet.d1)
    along = np.einsum("nac,nic->nai", e, dual)
    by_57 = np.einsum("a,nak,nal->nkl", [1 / 0.09, 1 / 0.01], along, along)
    contra = friction.tensor(CYLINDER, xi, "contra")
    np.testing.assert_allclose(contra, by_57, atol=TIGHT * 200)
    assert np.abs(contra - friction.tensor(CYLINDER, xi, "co")).max() > 1.0
    t = np.random.default_rng(5).normal(size=(20, 2))
    spatial = np.einsum("ni,nic->nc", t, dual)
    size = np.einsum("nc,ncd,nd->n", spatial, friction.tensor(CYLINDER, xi, "spatial"), spatial)
    np.testing.assert_allclose(np.einsum("nk,nkl,nl->n", t, contra, t), size, rtol=TIGHT)


# --- kinematics --------------------------------------------------------------------------------


def test_displacement_has_covariant_base_vectors() -> None:
    """(26) prints dxi^i rho^i; the vector is dxi^i rho_i, so isotropic T = -eps dxi^i rho_i.

    Stick on the cylinder along both coordinates. In the evolution form "incremental" the increment
    is in coordinates, so the relation is exact; dxi^i rho^i is another vector as R is not 1.
    """
    eps, xi = 1e4, np.array([[0.3, 0.1]])
    itf = Interface(
        CYLINDER,
        NormalLaw(penalty=PENALTY),
        Adhesion(stiffness=(eps, eps)),
        Friction(coefficients=(100.0, 100.0)),
        evolution="incremental",
    )

    def below(at: np.ndarray) -> np.ndarray:
        return np.asarray(CYLINDER.position(at) - DEPTH * CYLINDER.geometry(at).normal)

    step = np.array([[2e-3, 3e-3]])
    r = itf.update(itf.initial_state(below(xi)), below(xi + step), tangent=False)
    rho = CYLINDER.jet(xi + step).d1[0]
    dual = CYLINDER.geometry(xi + step).a_contra[0] @ rho
    size = eps * np.linalg.norm(step)
    assert r.status[0] == 1
    np.testing.assert_allclose(r.traction_t[0], -eps * step[0] @ rho, atol=1e-11 * size)
    assert np.linalg.norm(r.traction_t[0] + eps * step[0] @ dual) > 0.1 * size


# --- sliding force and slip --------------------------------------------------------------------


def test_consistency_leaves_the_direction_of_slip_open() -> None:
    """(106), (107): dPhi/dt = 0 holds without dxi_sl = dxi, (108), which is sufficient alone.

    A point that slides by maximum dissipation while its force still turns: its slip deviates by
    more than 10 degrees from its displacement, yet F T . S (dxi - dxi_sl), relative to the sizes of
    both, vanishes with the step: halving it halves the rate (1.9 to 2.1, a first-order remainder).
    """
    itf = interface((2e5, 2e5))
    direction = np.array([np.cos(1.0), np.sin(1.0)])
    start = itf.update(
        itf.initial_state(pressed(np.zeros(2))), pressed(2e-5 * direction), tangent=False
    ).state
    rate = []
    for length in (2e-8, 1e-8):
        r = itf.update(start, pressed(2e-5 * direction + length * direction), tangent=False).state
        slip, t = r["slip"][0], r["traction"][0]
        normal = t * np.array([1 / 0.09, 1 / 0.01])
        elastic = length * direction - slip
        assert r["status"][0] == 2
        assert np.degrees(np.arccos(slip @ direction / np.linalg.norm(slip))) > 10.0
        rate.append(abs(normal @ elastic) / np.linalg.norm(normal) / np.linalg.norm(elastic))
    assert rate[0] < 1e-2
    assert 1.9 < rate[0] / rate[1] < 2.1


def test_centre_is_subtracted_once() -> None:
    """(123): T = B (xi_{n+1} - xi_n^c), xi_n^c = xi_(0) + the sum of all slips.

    A path of 40 random steps that starts at xi_(0) = (0.7, -0.4), sliding often. Printed, xi_(0) is
    subtracted twice: that force is larger by B xi_(0). Positions of some 0.7 leave 1e-16 each, the
    stiffness 2e5 makes 1e-9 of it.
    """
    itf = interface(angles=(0.3, 0.9), evolution="total", sliding_rule="explicit")
    rng, b = np.random.default_rng(8), -rotated((2e5, 5e4), 0.3)
    start = at = np.array([0.7, -0.4])
    state = itf.initial_state(pressed(start))
    centre, statuses = start.copy(), []
    for _ in range(40):
        at = at + rng.uniform(-2e-5, 2e-5, 2)
        state = itf.update(state, pressed(at), tangent=False).state
        stuck = state["status"][0] == 1
        statuses.append(stuck)
        force = b @ (at - centre)
        centre += state["slip"][0]
        if stuck:
            np.testing.assert_allclose(state["traction"][0], force, atol=1e-8)
    np.testing.assert_allclose(state["elastic"][0], at - centre, atol=1e-13)
    assert 5 < sum(statuses) < 35
    assert np.linalg.norm(b @ start) > 1e4
