"""The adhesion domain: exact ellipse and strip in the plane of forces and on the tangent plane.

Source: Konyukhov and Schweizerhof 2006, eq. (115)-(121), with the corrections of
docs/theory/errata.md: axes and inclination of B F B in general, not for coaxial B and F alone.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from anisocontact.anisotropy import make_directions
from anisocontact.base.errors import InputError
from anisocontact.interface import Interface
from anisocontact.laws import (
    Adhesion,
    Ellipse,
    Friction,
    NormalLaw,
    Strip,
    adhesion_domain,
    domain_from_tensors,
    draw_force_plane,
    draw_tangent_plane,
    force_domain,
)
from anisocontact.surfaces import make_surface

EPS = np.finfo(float).eps


def random_case(rng: Any) -> tuple[Any, float, Any, float, float]:
    """Stiffness over four decades, coefficients over two, any angles."""
    return (
        tuple(10.0 ** rng.uniform(1.0, 5.0, 2)),
        rng.uniform(-np.pi, np.pi),
        tuple(10.0 ** rng.uniform(-2.0, 0.0, 2)),
        rng.uniform(-np.pi, np.pi),
        10.0 ** rng.uniform(-3.0, 3.0),
    )


def turned(values: Any, angle: float) -> Any:
    """Symmetric tensor with eigenvalues on axes at an angle, (2, 2)."""
    c, s = np.cos(angle), np.sin(angle)
    q = np.array([[c, -s], [s, c]])
    return q @ np.diag(values) @ q.T


def roundings_off_yield(x: Any, stiffness: Any, root: Any, pressure: float) -> float:
    """Largest | |F^(1/2) S x| - N | of points x, in units of the rounding of the products.

    That is eps |F^(1/2)| |S| |x|: what a rounding of x alone makes of the norm. With it 8 is a
    tolerance for any ratio of stiffnesses and coefficients.
    """
    error = np.abs(np.linalg.norm(x @ stiffness.T @ root, axis=1) - pressure)
    unit = EPS * np.linalg.norm(root, 2) * np.linalg.norm(stiffness, 2) * np.linalg.norm(x, axis=1)
    return float((error / unit).max())


def root_of_friction(coefficients: Any, beta: float) -> Any:
    """F^(1/2), (2, 2)."""
    return turned(1.0 / np.array(coefficients), beta)


def tensors(case: Any) -> tuple[Any, Any, float]:
    stiffness, alpha, coefficients, beta, pressure = case
    return turned(stiffness, alpha), turned(np.array(coefficients) ** -2.0, beta), pressure


def test_ten_thousand_ellipses() -> None:
    """Boundary points are on yield, and the axes are the eigenpairs of BFB/N^2.

    10,000 random cases. On yield to 8 roundings, see `roundings_off_yield`. Eigenvalues and
    axes by NumPy to 8 roundings of forming BFB, eps |S|^2 |F|/N^2, in the axes over the distance
    of the eigenvalues.
    """
    rng = np.random.default_rng(11)
    for _ in range(10_000):
        case = random_case(rng)
        s, f, n = tensors(case)
        domain = adhesion_domain(*case)
        assert isinstance(domain, Ellipse)
        a, b = domain.semi_axes
        assert a >= b > 0.0 and -np.pi / 2 <= domain.angle < np.pi / 2
        root = root_of_friction(*case[2:4])
        assert roundings_off_yield(domain.points(13), s, root, n) < 8.0, case
        m = s @ f @ s / n**2
        w, v = np.linalg.eigh(m)
        rounding = 8 * EPS * np.linalg.norm(s, 2) ** 2 * np.linalg.norm(f, 2) / n**2
        assert abs(w[1] - b**-2) < rounding and abs(w[0] - a**-2) < rounding
        across = [-np.sin(domain.angle), np.cos(domain.angle)]
        assert abs(v[:, 0] @ across) * (w[1] - w[0]) < rounding


def test_small_axis_and_product_are_exact() -> None:
    """Area: the semi-axes have the product mu_1 mu_2 N^2/(eps_1 eps_2) whatever the angles.

    Source: det BFB. Tolerance: 1e-14, the closed form takes the small eigenvalue from it.
    """
    rng = np.random.default_rng(12)
    for _ in range(1000):
        case = random_case(rng)
        (e1, e2), (m1, m2), n = case[0], case[2], case[4]
        a, b = adhesion_domain(*case).semi_axes
        assert a * b == pytest.approx(m1 * m2 * n**2 / (e1 * e2), rel=1e-14)
        s, f, n = tensors(case)
        other = domain_from_tensors(s, f, n)
        condition = max(e1 / e2, e2 / e1) * max(m1 / m2, m2 / m1)
        np.testing.assert_allclose(other.semi_axes, (a, b), rtol=8 * EPS * condition**2 + 1e-13)


@pytest.mark.parametrize("angle", [0.0, 0.4, -1.2])
def test_coaxial(angle: float) -> None:
    """(120) holds for alpha = beta: semi-axes mu_i N/eps_i on the common axes; rel. 1e-14."""
    domain = adhesion_domain((2e3, 1e3), angle, (0.3, 0.1), angle, 10.0)
    assert domain.semi_axes == pytest.approx((0.3 * 10 / 2e3, 0.1 * 10 / 1e3), rel=1e-14)
    assert domain.angle == pytest.approx(angle, abs=1e-14)
    crossed = adhesion_domain((2e3, 1e3), angle, (0.1, 0.3), angle, 10.0)
    assert crossed.semi_axes == pytest.approx((0.3 * 10 / 1e3, 0.1 * 10 / 2e3), rel=1e-14)
    assert np.cos(crossed.angle - angle) == pytest.approx(0.0, abs=1e-14)


def test_printed_axes_are_wrong_in_general() -> None:
    """Errata of (120), (121): the printed ellipse is not on yield where B and F are not coaxial."""
    stiffness, alpha, coefficients, beta, n = (2e3, 1e3), 0.3, (0.3, 0.1), 0.8, 10.0
    printed = Ellipse(
        tuple(m * n / e for m, e in zip(coefficients, stiffness, strict=True)), 2 * alpha - beta
    )
    force = printed.points(181) @ turned(stiffness, alpha)
    f = turned(np.array(coefficients) ** -2.0, beta)
    norm = np.sqrt(np.einsum("ni,ij,nj->n", force, f, force)) / n
    assert np.abs(norm - 1.0).max() > 0.3


def test_forces() -> None:
    """(115), (119): points on yield to 8 roundings, semi-axes mu_i N; 1000 random cases."""
    rng = np.random.default_rng(13)
    for _ in range(1000):
        _, _, coefficients, beta, n = random_case(rng)
        domain = force_domain(coefficients, beta, n)
        root = root_of_friction(coefficients, beta)
        assert roundings_off_yield(domain.points(13), np.eye(2), root, n) < 8.0
        assert sorted(domain.semi_axes) == pytest.approx(
            sorted(m * n for m in coefficients), rel=1e-14
        )


@pytest.mark.parametrize("zero", [0, 1])
def test_strip(zero: int) -> None:
    """Errata: half-width N/(e2 sqrt(s^2/m1^2 + c^2/m2^2)) along alpha, where eps_1 = 0.

    1000 random cases: edge points are on yield to 8 roundings, and the strip is the limit of the
    ellipse as eps_1 -> 0. The difference to the ellipse with eps_1 = delta eps_2 is of the order
    delta m1/m2 in the angle, delta^2 (m1/m2)^2 in the width: delta = 1e-6 and coefficients up to
    a hundred apart give 2e-4 and 1e-7.
    """
    rng = np.random.default_rng(14)
    for _ in range(1000):
        stiffness, alpha, coefficients, beta, n = random_case(rng)
        e = list(stiffness)
        e[zero] = 0.0
        strip = adhesion_domain(e, alpha, coefficients, beta, n)
        assert isinstance(strip, Strip)
        s, f, _ = tensors((e, alpha, coefficients, beta, n))
        edges = strip.edges(20.0 * strip.half_width).reshape(-1, 2)
        root = root_of_friction(coefficients, beta)
        assert roundings_off_yield(edges, s, root, n) < 8.0
        general = domain_from_tensors(s, f, n)
        assert isinstance(general, Strip)
        assert general.half_width == pytest.approx(strip.half_width, rel=1e-12)
        assert abs(np.sin(general.angle - strip.angle)) < 1e-12
        e[zero] = 1e-6 * e[1 - zero]
        near = adhesion_domain(e, alpha, coefficients, beta, n)
        assert near.semi_axes[1] == pytest.approx(strip.half_width, rel=1e-7)
        assert abs(np.sin(near.angle - strip.angle)) < 2e-4
        assert near.semi_axes[0] > 1e3 * strip.half_width


def test_printed_strip_is_wrong_in_general() -> None:
    """Errata: the printed half-width mu_2 N/eps_2 holds for alpha = beta alone."""
    assert adhesion_domain((0, 1e3), 0.3, (0.3, 0.1), 0.3, 10.0).half_width == pytest.approx(1e-3)
    assert adhesion_domain((0, 1e3), 0.3, (0.3, 0.1), 0.8, 10.0).half_width > 1.1e-3


def test_unsymmetric_stiffness() -> None:
    """Any S, as a viscoelastic model has: points of the ellipse are on yield, 1000 random cases.

    To 64 roundings: S^T F S is formed and its eigenvalues taken.
    """
    rng = np.random.default_rng(15)
    for _ in range(1000):
        s = rng.normal(size=(2, 2))
        coefficients, beta = rng.uniform(0.1, 1.0, 2), rng.uniform(0.0, np.pi)
        f = turned(coefficients**-2.0, beta)
        domain = domain_from_tensors(s, f, 3.0)
        root = root_of_friction(coefficients, beta)
        assert roundings_off_yield(domain.points(13), s, root, 3.0) < 64.0


@pytest.mark.parametrize("stiffness", [(2e3, 5e2), (0.0, 1e3)])
def test_an_interface_sticks_inside_and_slips_outside(stiffness: Any) -> None:
    """The kernel agrees with the domain: a part in 1e9 inside it sticks, outside it slips.

    Tolerance 1e-9: far above the rounding of positions (1e-13 of the slip), far below anything
    that is seen.
    """
    alpha, coefficients, beta, n, penalty = 0.3, (0.3, 0.1), 1.1, 2.0, 1e3
    adhesion, friction = (
        make_directions("constant", vector=(1, 0, 0), angle=a) for a in (alpha, beta)
    )
    interface = Interface(
        make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1), tangent=(1, 0, 0)),
        NormalLaw(penalty=penalty),
        Adhesion(stiffness=stiffness, directions=adhesion),
        Friction(coefficients=coefficients, directions=friction),
    )
    domain = adhesion_domain(stiffness, alpha, coefficients, beta, n)
    edge = domain.points(100) if isinstance(domain, Ellipse) else domain.edges(0.01).reshape(-1, 2)
    start = np.zeros((len(edge), 3)) - (0, 0, n / penalty)
    state = interface.initial_state(start)
    for factor, status in ((1 - 1e-9, 1), (1 + 1e-9, 2)):
        r = interface.update(state, start + np.pad(factor * edge, ((0, 0), (0, 1))))
        assert np.all(r.status == status)
        assert np.all(domain.contains(factor * edge) == (status == 1))


def test_mistakes() -> None:
    """One line that names the entry; source: requirement."""
    good: list[Any] = [(2e3, 1e3), 0.0, (0.3, 0.1), 0.0, 10.0]
    for place, bad, line in (
        (0, (0, 0), "stiffness: (0, 0) given, must be >= 0 and not both 0"),
        (0, (-1, 1), "stiffness: (-1, 1) given"),
        (2, (0.3, 0), "coefficients: (0.3, 0) given, must be > 0"),
        (4, -1.0, "pressure: (-1.0,) given, must be > 0"),
    ):
        values = [*good[:place], bad, *good[place + 1 :]]
        with pytest.raises(InputError) as caught:
            adhesion_domain(*values)
        assert str(caught.value).startswith(line)
    with pytest.raises(InputError, match=r"^friction: .* symmetric positive definite needed"):
        domain_from_tensors(np.eye(2), [[1.0, 2.0], [2.0, 1.0]], 1.0)
    with pytest.raises(InputError, match=r"^stiffness: zero given"):
        domain_from_tensors(np.zeros((2, 2)), np.eye(2), 1.0)


@pytest.mark.parametrize("stiffness", [(2.0, 1.0), (0.0, 1.0)])
def test_drawings(stiffness: Any) -> None:
    """What is drawn is the domain, about the first and the last centre; labels, units, legend."""
    domain = adhesion_domain(stiffness, 0.3, (0.3, 0.1), 0.8, 1.0)
    centres = np.array([[0.0, 0.0], [0.1, 0.2]])
    ax = draw_tangent_plane(domain, path=centres + 0.1, centres=centres, unit="mm")
    lines = [np.asarray(line.get_xydata()) for line in ax.lines]
    for c in centres:
        outline = (
            domain.at(c).points()
            if isinstance(domain, Ellipse)
            else domain.at(c).edges(8 * domain.half_width)[0]
        )
        assert any(line.shape == outline.shape and np.allclose(line, outline) for line in lines)
    assert any(np.allclose(line, centres) for line in lines if line.shape == centres.shape)
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("ξ¹ [mm]", "ξ² [mm]")
    shown = {t.get_text() for t in ax.get_legend().get_texts()}
    assert {"path of the centre", "path of the point S"} < shown
    forces = draw_force_plane(force_domain((0.3, 0.1), 0.8, 1.0), force=[[0.1, 0.0]], unit="MPa")
    assert forces.get_xlabel() == "T₁ [MPa]"


def test_one_number_stands_for_both_axes():
    """As for the laws: one number is a circle; 0, which has no domain, is one line."""
    assert force_domain(0.3, 0.0, 2.0) == force_domain((0.3, 0.3), 0.0, 2.0)
    assert adhesion_domain(5.0, 0.1, 0.3, 0.2, 2.0) == adhesion_domain(
        (5.0, 5.0), 0.1, (0.3, 0.3), 0.2, 2.0
    )
    with pytest.raises(InputError, match=r"coefficients: .*must be > 0"):
        force_domain(0, 0.0, 2.0)
