"""Friction of two orthotropic surfaces, F = C^-2 with C = a1 I + a2 m (x) m + a3 k (x) k.

Source: He and Curnier 1993; Konyukhov and Schweizerhof 2006, eq. (30) with constant alpha, and
docs/theory/direction-fields.md.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from anisocontact.anisotropy import make_directions
from anisocontact.base.errors import InputError
from anisocontact.interface import Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.surfaces import make_surface

LIMIT = 1e-12
RNG = np.random.default_rng(5)
PENALTY = 1e4


def plane() -> Any:
    return make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1), tangent=(1, 0, 0))


def model(alpha: Any, m: float, k: float, **more: Any) -> Any:
    """Friction of two surfaces whose first axes are at the angles m and k."""
    first, second = (make_directions("constant", vector=(1, 0, 0), angle=a) for a in (m, k))
    return Friction(
        model="he-curnier", alpha=alpha, directions=first, directions_second=second, **more
    )


def matrix_c(alpha: Any, m: float, k: float) -> Any:
    vectors = [np.array([np.cos(a), np.sin(a)]) for a in (m, k)]
    parts = (np.eye(2), *(np.outer(v, v) for v in vectors))
    return sum(a * p for a, p in zip(alpha, parts, strict=True))


def admissible(n: int) -> Any:
    """Random alpha with C positive definite at every angle, half of them with negative parts."""
    alpha = np.column_stack([RNG.uniform(0.1, 0.5, n), RNG.uniform(-0.6, 0.6, (n, 2))])
    least = alpha[:, 0] + np.minimum(alpha[:, 1:], 0.0).sum(axis=1)
    return alpha[least > 0.01]


def test_tensor() -> None:
    """F = C^-2 entrywise, 300 random alpha and angles.

    Tolerance: 1e-12 of F times the condition of C^2, the rounding of two inversions.
    """
    for alpha in admissible(500)[:300]:
        m, k = RNG.uniform(-np.pi, np.pi, 2)
        c = matrix_c(alpha, m, k)
        f = model(alpha, m, k).tensor(plane(), [[0.3, -0.2]])[0]
        inverse = np.linalg.inv(c)
        error = np.abs(f - inverse @ inverse).max() / np.abs(f).max()
        assert error < LIMIT * np.linalg.cond(c) ** 2


def test_limit_of_the_force() -> None:
    """T = -N C u is on T.FT = N^2 for every direction u of slip.

    Tolerance: 1e-12 times the condition of C^2, as above.
    """
    u = np.stack([np.cos(t := np.linspace(0, 2 * np.pi, 73)), np.sin(t)], axis=1)
    for alpha in admissible(300)[:100]:
        m, k = RNG.uniform(-np.pi, np.pi, 2)
        c = matrix_c(alpha, m, k)
        f = model(alpha, m, k).tensor(plane(), [[0.0, 0.0]])[0]
        force = -7.0 * u @ c
        norm = np.einsum("ni,ij,nj->n", force, f, force)
        assert np.abs(norm / 49.0 - 1.0).max() < LIMIT * np.linalg.cond(c) ** 2


def test_one_rough_surface_is_orthotropic() -> None:
    """a3 = 0: C has the eigenvalues a1 + a2 along m and a1 across, which are mu_1 and mu_2."""
    m = 0.7
    field = make_directions("constant", vector=(1, 0, 0), angle=m)
    expected = Friction(coefficients=(0.3, 0.1), directions=field).tensor(plane(), [[0.0, 0.0]])
    computed = model((0.1, 0.2, 0.0), m, -0.4).tensor(plane(), [[0.0, 0.0]])
    np.testing.assert_allclose(computed, expected, rtol=1e-12, atol=1e-10)


def test_surfaces_may_be_exchanged() -> None:
    """m with a2 and k with a3 play the same part; source: the formula."""
    a = model((0.3, -0.1, 0.2), 0.7, -0.4).tensor(plane(), [[0.0, 0.0]])
    b = model((0.3, 0.2, -0.1), -0.4, 0.7).tensor(plane(), [[0.0, 0.0]])
    np.testing.assert_allclose(a, b, rtol=1e-12)


def test_positive_definite_at_every_angle_or_refused() -> None:
    """The check of alpha is sharp: 2000 random alpha against the smallest eigenvalue over angles.

    Angles of m and k at every half degree contain 0 and 90 degrees, where the extremes are.
    Alpha within 1e-9 of the limit are left out.
    """
    angles = np.radians(np.arange(0.0, 180.0, 0.5))
    for alpha in RNG.uniform(-0.5, 0.5, (2000, 3)):
        mean = alpha[0] + 0.5 * (alpha[1] + alpha[2])
        root = alpha[1] ** 2 + alpha[2] ** 2 + 2 * alpha[1] * alpha[2] * np.cos(2 * angles)
        least = (mean - 0.5 * np.sqrt(np.maximum(root, 0.0))).min()
        if abs(least) < 1e-9:
            continue
        if least > 0.0:
            model(alpha, 0.0, 1.0)
        else:
            with pytest.raises(InputError, match=r"^friction\.alpha: alpha_"):
                model(alpha, 0.0, 1.0)


@pytest.mark.parametrize(
    ("alpha", "which"),
    [
        ((-0.2, 0.1, 0.1), "alpha_1 = -0.2 given, must be > 0 "),
        ((0.2, -0.3, 0.1), "alpha_2 = -0.3 given, must be > -0.2 "),
        ((0.2, 0.1, -0.25), "alpha_3 = -0.25 given, must be > -0.2 "),
        ((0.2, -0.15, -0.1), r"alpha_2 \+ alpha_3 = -0.25 given, must be > -0.2 "),
    ],
)
def test_message_says_which_alpha(alpha: Any, which: str) -> None:
    """One line that names the entry; source: requirement."""
    with pytest.raises(InputError, match="^friction.alpha: " + which) as caught:
        model(alpha, 0.0, 1.0)
    assert "\n" not in str(caught.value)


def dragged(friction: Any, angle: float, steps: int = 60) -> tuple[Any, float]:
    """Force after a long slip at an angle, and its pressure."""
    interface = Interface(
        plane(), NormalLaw(penalty=PENALTY), Adhesion(stiffness=(1e4, 1e4)), friction
    )
    direction = np.array([np.cos(angle), np.sin(angle), 0.0])
    state = interface.initial_state([[0.0, 0.0, -1e-3]])
    for n in range(1, steps + 1):
        r = interface.update(state, (0.01 * n * direction + (0, 0, -1e-3))[None])
        assert not r.failed.any()
        state = r.state
    assert r.status[0] == 2
    return r.traction[0, :2], float(r.pressure[0])


@pytest.mark.parametrize("angle", [0.0, 0.5, 1.3, 2.9])
def test_steady_slip_of_the_linear_rule(angle: float) -> None:
    """Steady slip along u with the rule `linear` gives T = -N C u, (30) to the letter.

    Tolerance: 1e-9 of N; 60 steps of one ellipse each have long forgotten the start.
    """
    alpha, m, k = (0.2, 0.15, -0.1), 0.3, 1.0
    force, pressure = dragged(model(alpha, m, k, sliding_rule="linear"), angle)
    expected = -pressure * matrix_c(alpha, m, k) @ [np.cos(angle), np.sin(angle)]
    assert np.abs(force - expected).max() < 1e-9 * pressure


def test_turning_one_surface_changes_the_limit() -> None:
    """With m along k the drag is N (a1 + a2 + a3), across it N (a1 + a2); source: the formula.

    Slip along m, rule `linear`. Tolerance: 1e-9 of N, as above.
    """
    for k, expected in ((0.0, 0.45), (np.pi / 2, 0.35)):
        force, pressure = dragged(model((0.2, 0.15, 0.1), 0.0, k, sliding_rule="linear"), 0.0)
        assert force[0] == pytest.approx(-expected * pressure, abs=1e-9 * pressure)


def test_tangent_by_order_of_convergence() -> None:
    """dt/dx of sliding points on a cylinder with two curved fields; central differences.

    Halving the step quarters the error; tolerance 0.1 in the ratio of 4.
    """
    surface = make_surface("cylinder", point=(0, 0, 0), axis=(0, 0, 1), radius=0.8)
    friction = Friction(
        model="he-curnier",
        alpha=(0.3, -0.1, 0.15),
        directions=make_directions("spiral", axis=((0, 0, 0), (0, 0, 1)), pitch=2.0),
        directions_second=make_directions("polar", axis=((4, 3, 0), (0.1, -0.5, 1.0))),
    )
    interface = Interface(surface, NormalLaw(penalty=1e3), Adhesion(stiffness=(2e3, 2e3)), friction)
    xi = RNG.uniform(-1.0, 1.0, (50, 2))
    g = surface.geometry(xi)
    x = surface.position(xi) - 1e-3 * g.normal
    state = interface.initial_state(x)
    slip = np.cross(g.normal, RNG.normal(size=(50, 3)))
    x = x + 2e-3 * slip / np.linalg.norm(slip, axis=1)[:, None]
    exact = interface.update(state, x)
    assert np.all(exact.status == 2)

    def error(h: float) -> float:
        columns = [
            interface.update(state, x + h * e).traction
            - interface.update(state, x - h * e).traction
            for e in np.eye(3)
        ]
        return float(np.abs(np.stack(columns, axis=2) / (2 * h) - exact.tangent).max())

    assert error(4e-5) / error(2e-5) == pytest.approx(4.0, abs=0.1)
