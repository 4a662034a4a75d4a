"""The general linear model of adhesion: which tensors can create energy, and what is stored.

Requirement: df/dt + A f = S v + R x with f = -T is taken where no path from rest gives back more
work than was put in. Source: the positive real lemma [Anderson Vongpanitlerd 1973, section 5]; the
law decides by the spring K = A^-1 R beside Maxwell elements S - K (docs/theory/interface-model.md),
the tests by the impedance Z(p) = (p + A)^-1 (S + R/p), Re p > 0, by work on closed paths and by the
balance of energy.
"""

from __future__ import annotations

import numpy as np
import pytest

from anisocontact.anisotropy import make_directions
from anisocontact.base.errors import InputError
from anisocontact.interface import Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.surfaces import make_surface

PLANE = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
AXES = make_directions("constant", vector=(1, 0, 0))
OBLIQUE = make_directions("oblique", vector=(1, 0, 0), angle_first=0.35, angle_second=1.3)
ONE = np.eye(2)
#: A spring beside Maxwell elements whose axes are apart, with an unsymmetric A.
K = np.array([[5.0, 2.0], [2.0, 4.0]])
K1 = np.array([[9.0, -3.0], [-3.0, 6.0]])
LOSS = np.array([[40.0, 3.0], [11.0, 25.0]])
PASSIVE = (LOSS @ np.linalg.inv(K1), K + K1, LOSS @ np.linalg.inv(K1) @ K)


def interface(tensors, mu=1e6, directions=AXES, **more) -> Interface:
    names = ("relaxation", "stiffness_instant", "stiffness_rate")
    given = {name: np.ravel(m).tolist() for name, m in zip(names, tensors, strict=True)}
    return Interface(
        PLANE,
        NormalLaw(penalty=1e3),
        Adhesion("general-linear", directions=directions, **given, **more),
        Friction(coefficients=(mu, mu)),
    )


def refused(tensors) -> str:
    """What is said against tensors; nothing where they are taken."""
    try:
        interface(tensors)
    except InputError as error:
        return str(error)
    return ""


def least_power(tensors) -> float:
    """Smallest eigenvalue of Z + Z^H in the right half plane, over the size of Z."""
    a, s, r = map(np.asarray, tensors)
    growth, w = np.meshgrid(np.logspace(-5, 2, 15), np.append(0.0, np.logspace(-4, 4, 100)))
    p = (growth + 1j * w).reshape(-1, 1, 1)
    z = np.linalg.solve(p * ONE + a, s + r / p)
    power = np.linalg.eigvalsh(z + z.conj().transpose(0, 2, 1))[:, 0]
    return float((power / np.abs(z).max(axis=(1, 2))).min())


def drawn(rng: np.random.Generator, k: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Tensors of a spring and Maxwell elements, spoilt in one of five ways or not at all."""
    roots = rng.normal(size=(3, 2, 2))
    spring, relaxing, loss = roots @ roots.transpose(0, 2, 1) + 0.05 * ONE
    loss = loss + rng.normal() * np.array([[0, 1], [-1, 0]])
    a = loss @ np.linalg.inv(relaxing)
    s, r = spring + relaxing, a @ spring
    skew = 0.1 * np.linalg.norm(s) * np.array([[0, 1], [-1, 0]])
    spoilt = [
        (a, s, r),
        (a, s + skew, r + a @ skew),
        (a, s, a @ (spring + 0.5 * skew)),
        (a, s, a @ (spring - 1.2 * np.linalg.eigvalsh(spring)[0] * ONE)),
        (a, s - 1.02 * np.linalg.eigvalsh(relaxing)[0] * ONE, r),
        ((loss - 0.7 * np.linalg.eigvalsh(loss + loss.T)[0] * ONE) @ np.linalg.inv(relaxing), s, r),
    ]
    a, s, r = spoilt[k % len(spoilt)]
    return a, s, (a @ spring if k % len(spoilt) == 5 else r)


def test_refuses_what_is_not_positive_real() -> None:
    """Taken and refused as Z + Z^H >= 0 says at 1515 points of the half plane, 300 tensors.

    Growth rates over seven decades, frequencies over eight. Z is exact to rounding: 1e-7 of its
    size, below the 1e-6 up to which tensors count as equal.
    """
    rng = np.random.default_rng(4)
    taken = 0
    for k in range(300):
        tensors = drawn(rng, k)
        if np.linalg.eigvalsh(tensors[1] + tensors[1].T)[0] <= 0.0:
            continue
        passive = least_power(tensors) > -1e-7
        assert (refused(tensors) == "") == passive, tensors
        taken += passive
    assert 40 < taken < 100


@pytest.mark.parametrize(
    ("tensors", "said"),
    [
        ((ONE, 100 * ONE, -300 * ONE), "A^-1 R has the eigenvalue -300, must be >= 0"),
        ((ONE, 100 * ONE, 300 * ONE), "S - A^-1 R, has the eigenvalue -200, must be >= 0"),
        ((ONE, [[3, 1], [-1, 3]], 0 * ONE), "S has 1 and -1 beside the diagonal"),
        (
            (np.diag([2.0, 1.0]), 100 * ONE, [[30, 5], [5, 10]]),
            "A^-1 R has 2.5 and 5 beside the diagonal, must be symmetric: slow slip in a circle",
        ),
        (
            (np.diag([10.0, 1.0]), [[5.5, 4.5], [4.5, 5.5]], 0 * ONE),
            "symmetric part of A S - R has the eigenvalue -4.75",
        ),
        ((np.diag([1.0, 0.0]), 5 * ONE, ONE), "this singular A leaves no stiffness at rest"),
        ((np.diag([-1.0, 1.0]), 5 * ONE, 0 * ONE), "relaxation: has an eigenvalue"),
    ],
)
def test_says_what_creates_energy(tensors, said: str) -> None:
    """One line with the number that violates and what is allowed; 1000 times the units too."""
    a, s, r = map(np.asarray, tensors)
    assert said in refused(tensors)
    assert refused((a, s, r)).startswith("adhesion.")
    assert "\n" not in refused(tensors)
    assert refused((1e-3 * a, 1e6 * s, 1e3 * r))


@pytest.mark.parametrize(
    "tensors",
    [
        PASSIVE,
        (1e-9 * PASSIVE[0], 1e12 * PASSIVE[1], 1e3 * PASSIVE[2]),
        (np.round(PASSIVE[0], 6), np.round(PASSIVE[1], 6), np.round(PASSIVE[2], 6)),
        (0 * ONE, K, 0 * ONE),
        (np.diag([2.0, 0.0]), np.diag([5.0, 4.0]), 0 * ONE),
        (np.diag([2.0, 0.0]), 5 * ONE, np.diag([4.0, 0.0])),
        (2 * ONE, K, 2 * K),
    ],
    ids=["apart", "units", "six digits", "elastic", "one axis", "solid along one", "at rest"],
)
def test_takes_what_is_passive(tensors) -> None:
    assert refused(tensors) == ""


def moved(itf: Interface, path: np.ndarray, dt: float) -> tuple[float, np.ndarray]:
    """Work put in along a path of slips, (n, 2), from rest, and the last state."""
    state = itf.initial_state([[0.0, 0.0, -1e-3]])
    work, force, last = 0.0, np.zeros(2), np.zeros(2)
    for slip in path:
        r = itf.update(state, [[*slip, -1e-3]], dt, tangent=False)
        t = r.traction[0, :2]
        work -= 0.5 * (t + force) @ (slip - last)
        state, force, last = r.state, t, slip
    return work, state[0]


def test_a_loop_creates_energy_where_tensors_are_refused() -> None:
    """Why symmetry is asked for: A, S, R positive definite, axes apart, slow slip in a circle.

    A slow circle of radius c takes pi c^2 (K_12 - K_21) of the stiffness at rest, negative one way
    round, and what its rate loses: together pi/w Re(v.Z v). Backward Euler, 3000 steps: 1 %.
    """
    a, s = np.diag([2.0, 1.0]), 100 * ONE
    r = np.array([[30.0, 5.0], [5.0, 10.0]])
    itf = interface((a, s, r), energy="none")
    w = 2.0 * np.pi / 3000
    turn = w * np.arange(1, 6001)
    circle = 1e-3 * np.stack([np.cos(turn) - 1.0, -np.sin(turn)], axis=1)
    once, twice = (moved(itf, circle[:n], 1.0)[0] for n in (3000, 6000))
    v = 1e-3 * 1j * w * np.array([1.0, 1j])
    z = np.linalg.solve(1j * w * ONE + a, s + r / (1j * w))
    exact = np.pi / w * (v.conj() @ z @ v).real
    assert exact < 0.0
    assert abs((twice - once) / exact - 1.0) < 0.01
    assert "slow slip in a circle" in refused((a, s, r))


@pytest.mark.parametrize("directions", [AXES, OBLIQUE], ids=["orthogonal", "oblique"])
def test_energy_balance_with_axes_apart(directions) -> None:
    """Work = stored + lost for full tensors whose axes are apart, with slip: first order.

    Before, the energies of tensors with axes apart did not converge to the work.
    """
    off = []
    for n in (400, 800):
        s = 2.0 * np.pi * np.arange(1, n + 1) / n
        path = 0.02 * np.stack([np.sin(s), 0.5 * np.sin(2.0 * s)], axis=1)
        work, state = moved(interface(PASSIVE, 0.1, directions), path, 4.0 / n)
        kept = state["energy_adhesion"] + state["dissipation"] + state["dissipation_viscous"]
        assert min(state["energy_adhesion"], state["dissipation"]) > 1e-3 * work
        off.append(abs(kept / work - 1.0))
    assert off[0] < 0.02
    assert off[0] / off[1] > 1.7


def test_no_energy_is_no_number() -> None:
    """Tensors that store none: adhesion and viscous energy are not a number, forces the same."""
    path = np.array([[1e-3, 0.0], [1e-3, 2e-3]])
    with_energy = moved(interface(PASSIVE), path, 0.1)[1]
    without = moved(interface(PASSIVE, energy="none"), path, 0.1)[1]
    assert np.isnan(without["energy_adhesion"])
    assert np.isnan(without["dissipation_viscous"])
    assert without["energy_normal"] == with_energy["energy_normal"]
    np.testing.assert_array_equal(without["traction"], with_energy["traction"])
