"""Closed forms of the direction fields and of the tensors on them, entrywise.

Source: Konyukhov and Schweizerhof 2006, eq. (40)-(77), with the corrections of
docs/theory/errata.md. Tolerance: 1e-12 of the largest entry where nothing else is said; both
sides are a few products of numbers of one size.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from anisocontact.anisotropy import make_directions, oblique_principal, tensor
from anisocontact.base.errors import InputError
from anisocontact.laws import Friction
from anisocontact.surfaces import make_surface

LIMIT = 1e-12
E1, E2 = 3e5, 4e4
M1, M2 = 0.35, 0.12
RNG = np.random.default_rng(0)
XI = RNG.uniform(-2.0, 2.0, (500, 2))


def plane() -> Any:
    """The plane x_3 = 0 with xi^i = x_i."""
    return make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1), tangent=(1, 0, 0))


def matrix(a: Any, b: Any, c: Any) -> Any:
    """Symmetric matrices [[a, b], [b, c]], (n, 2, 2)."""
    a, b, c = np.broadcast_arrays(a, b, c)
    return np.stack([a, b, b, c], axis=-1).reshape(*a.shape, 2, 2)


def close(computed: Any, expected: Any, limit: float = LIMIT) -> None:
    assert np.abs(computed - expected).max() <= limit * np.abs(expected).max()


@pytest.mark.parametrize("angle", [0.0, 0.4, -2.0])
def test_spectral_form_in_mixed_components(angle: float) -> None:
    """(42), (43): b^i_j and f^i_k in an orthonormal frame, turned by alpha and beta."""
    field = make_directions("constant", vector=(1, 0, 0), angle=angle)
    c, s = np.cos(angle), np.sin(angle)
    b = -matrix(E1 * c * c + E2 * s * s, (E1 - E2) * s * c, E1 * s * s + E2 * c * c)
    close(tensor(plane(), XI, field, (-E1, -E2), "mixed"), b)
    l1, l2 = M1**-2, M2**-2
    f = matrix(l1 * c * c + l2 * s * s, (l1 - l2) * s * c, l1 * s * s + l2 * c * c)
    friction = Friction(coefficients=(M1, M2), directions=field)
    close(friction.tensor(plane(), XI, "mixed"), f)


def test_mixed_components_do_not_hold_in_a_general_basis() -> None:
    """Errata of (42), (43): on a skew basis the matrix of (41) is not that of the tensor."""
    field = make_directions("constant", vector=(1, 0, 0), angle=0.4)
    basis = [[1.0, 0.0, 0.0], [0.6, 0.9, 0.0]]
    skew = tensor(plane(), [[0, 0]], field, (E1, E2), "mixed", basis=basis)[0]
    orthonormal = tensor(plane(), [[0, 0]], field, (E1, E2), "mixed")[0]
    assert np.abs(skew - skew.T).max() > 0.1 * E1
    np.testing.assert_allclose(
        np.sort(np.linalg.eigvals(skew)), np.linalg.eigvalsh(orthonormal), rtol=LIMIT
    )


@pytest.mark.parametrize(("alpha", "beta"), [(0.3, 1.1), (-0.7, 0.9), (0.2, 0.2 + np.pi / 2)])
def test_oblique_plane(alpha: float, beta: float) -> None:
    """(59), (60): two directions that are not orthogonal; (42) where they are."""
    field = make_directions("oblique", vector=(1, 0, 0), angle_first=alpha, angle_second=beta)
    ca, sa, cb, sb = np.cos(alpha), np.sin(alpha), np.cos(beta), np.sin(beta)
    b = -matrix(
        E1 * ca * ca + E2 * cb * cb, E1 * sa * ca + E2 * sb * cb, E1 * sa * sa + E2 * sb * sb
    )
    close(tensor(plane(), XI, field, (-E1, -E2)), b)
    cartesian = np.zeros((3, 3))
    cartesian[:2, :2] = b
    close(tensor(plane(), XI, field, (-E1, -E2), "spatial"), cartesian)
    if np.isclose(beta - alpha, np.pi / 2):
        spectral = make_directions("constant", vector=(1, 0, 0), angle=alpha)
        close(tensor(plane(), XI, field, (E1, E2)), tensor(plane(), XI, spectral, (E1, E2)))


def test_oblique_sum_is_orthotropic() -> None:
    """Errata of (48): eigenvalues (e1+e2)/2 +- 1/2 sqrt(e1^2+e2^2+2 e1 e2 cos 2(a-b)).

    10,000 random pairs against NumPy's eigenvalues. Tolerance: 1e-14 of the largest sum, 4, which
    is rounding; 1e-7 for the root as printed, whose radicand cancels where the sum is isotropic.
    """
    values, angles = RNG.uniform(0.0, 2.0, (10_000, 2)), RNG.uniform(-np.pi, np.pi, (10_000, 2))
    r = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    a = np.einsum("na,nai,naj->nij", values, r, r)
    eigenvalues, angle = oblique_principal(values, angles)
    assert np.abs(eigenvalues[:, ::-1] - np.linalg.eigvalsh(a)).max() < 1e-14 * 4.0
    printed = 0.5 * np.sqrt(
        np.sum(values**2, axis=1)
        + 2 * values.prod(axis=1) * np.cos(2 * (angles[:, 0] - angles[:, 1]))
    )
    np.testing.assert_allclose(0.5 * (eigenvalues[:, 0] - eigenvalues[:, 1]), printed, atol=1e-7)
    axis = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    residual = np.einsum("nij,nj->ni", a, axis) - eigenvalues[:, :1] * axis
    assert np.abs(residual).max() < 1e-14 * 4.0


def test_stiffness_along_an_oblique_direction() -> None:
    """Errata of (48): e1 is not the stiffness along r_1; that is e1 + e2 cos^2(a - b)."""
    field = make_directions("oblique", vector=(1, 0, 0), angle_first=0.0, angle_second=1.0)
    b = tensor(plane(), [[0, 0]], field, (E1, E2))[0]
    assert b[0, 0] == pytest.approx(E1 + E2 * np.cos(1.0) ** 2, rel=LIMIT)


def test_polar_plane() -> None:
    """(62), (63): rays and rings about the origin, 500 random points."""
    field = make_directions("polar", axis=((0, 0, 0), (0, 0, 1)))
    x, y = XI.T
    r2 = x * x + y * y
    b = -matrix(
        (E1 * x * x + E2 * y * y) / r2, (E1 - E2) * x * y / r2, (E1 * y * y + E2 * x * x) / r2
    )
    close(tensor(plane(), XI, field, (-E1, -E2)), b)


def test_polar_with_an_angle_is_a_logarithmic_spiral() -> None:
    """The first axis at a constant angle to the ray; source: definition of the field."""
    field = make_directions("polar", axis=((0.5, -2, 0), (0, 0, 1)), angle=0.4)
    e, _ = field.axes(plane(), XI)
    ray = XI - np.array([0.5, -2.0])
    ray /= np.linalg.norm(ray, axis=1)[:, None]
    close(np.einsum("ni,ni->n", e[:, 0, :2], ray), np.cos(0.4) * np.ones(len(XI)))
    close(ray[:, 0] * e[:, 0, 1] - ray[:, 1] * e[:, 0, 0], np.sin(0.4) * np.ones(len(XI)))


R, H = 0.8, 2.5
PITCHES = [H, -H]


def cylinder(**more: Any) -> Any:
    """The cylinder (64): xi = (alpha, z)."""
    return make_surface(
        "cylinder", point=(0, 0, 0), axis=(0, 0, 1), radius=R, start=(1, 0, 0), **more
    )


def thread(pitch: float) -> Any:
    return make_directions("spiral", axis=((0, 0, 0), (0, 0, 1)), pitch=pitch)


@pytest.mark.parametrize("pitch", PITCHES)
def test_spiral_tangents(pitch: float) -> None:
    """(68), (69): r_1 = (-R sin a, R cos a, H/2pi), r_2 = n x r_1, over sqrt(R^2 + (H/2pi)^2)."""
    e, valid = thread(pitch).axes(cylinder(), XI)
    h, (c, s) = pitch / (2 * np.pi), (np.cos(XI[:, 0]), np.sin(XI[:, 0]))
    one = np.ones(len(XI))
    r1 = np.stack([-R * s, R * c, h * one], axis=1)
    r2 = np.stack([h * s, -h * c, R * one], axis=1)
    g = np.hypot(R, h)  # (72): g_11 = g_22 = R^2 + (H/2pi)^2
    assert valid.all()
    close(e, np.stack([r1, r2], axis=1) / g)


@pytest.mark.parametrize("pitch", PITCHES)
def test_orthogonal_net(pitch: float) -> None:
    """Errata of (70), (71): the line across the thread falls, z = -2 pi R^2 alpha/H + const.

    As printed, with A = +2 pi R/H, it is not orthogonal to the thread.
    """
    e, _ = thread(pitch).axes(cylinder(), XI)
    c, s = np.cos(XI[:, 0]), np.sin(XI[:, 0])
    for sign, orthogonal in ((-1.0, True), (1.0, False)):
        slope = sign * 2 * np.pi * R**2 / pitch
        across = np.stack([-R * s, R * c, slope * np.ones(len(XI))], axis=1)
        across /= np.linalg.norm(across, axis=1)[:, None]
        along = np.abs(np.einsum("ni,ni->n", across, e[:, 1]))
        assert np.allclose(along, 1.0, atol=LIMIT) == orthogonal


@pytest.mark.parametrize("pitch", PITCHES)
def test_spiral_cylinder(pitch: float) -> None:
    """(73), (74), (76): B of the thread in Cartesian and in cylindrical components."""
    h = pitch / (2 * np.pi)
    d, g = R**2 + h**2, E1 * R**2 + E2 * h**2
    c, s, one = np.cos(XI[:, 0]), np.sin(XI[:, 0]), np.ones(len(XI))
    k = (E1 - E2) * R * h
    zz = (E1 * h**2 + E2 * R**2) * one
    rows = [[g * s * s, -g * s * c, -k * s], [-g * s * c, g * c * c, k * c], [-k * s, k * c, zz]]
    cartesian = np.moveaxis(np.array(rows), -1, 0)
    close(tensor(cylinder(), XI, thread(pitch), (-E1, -E2), "spatial"), -cartesian / d)
    b = -matrix(g * R**2, (E1 - E2) * R**2 * h, E1 * h**2 + E2 * R**2) / d
    close(tensor(cylinder(), XI, thread(pitch), (-E1, -E2)), b)


def test_isotropic_spiral_cylinder() -> None:
    """(77): with equal values b_ij = -eps a_ij, and the unit matrix in mixed components alone."""
    b = tensor(cylinder(), XI, thread(H), (-E1, -E1))
    close(b, -E1 * np.diag([R**2, 1.0]))
    close(tensor(cylinder(), XI, thread(H), (-E1, -E1), "mixed"), -E1 * np.eye(2))


@pytest.mark.parametrize("pitch", PITCHES)
def test_friction_of_the_spiral_cylinder(pitch: float) -> None:
    """Errata: f^ij of the thread, which the paper does not give."""
    h = pitch / (2 * np.pi)
    d, l1, l2 = R**2 + h**2, M1**-2, M2**-2
    f = matrix((R**2 * l1 + h**2 * l2) / (R**2 * d), h * (l1 - l2) / d, (h**2 * l1 + R**2 * l2) / d)
    friction = Friction(coefficients=(M1, M2), directions=thread(pitch))
    close(friction.tensor(cylinder(), XI), f)


def test_handedness() -> None:
    """A positive pitch is a right-handed thread: turning about +z it advances along +z.

    Turning the axis around does not change the hand; source: definition of a screw.
    """
    for axis in ((0, 0, 1), (0, 0, -1)):
        field = make_directions("spiral", axis=((0, 0, 3), axis), pitch=H)
        e, _ = field.axes(cylinder(), XI)
        around = np.stack([-np.sin(XI[:, 0]), np.cos(XI[:, 0]), 0 * XI[:, 0]], axis=1)
        advance = e[:, 0, 2] * np.einsum("ni,ni->n", e[:, 0], around)
        assert np.all(advance > 0.0)
    e, _ = thread(-H).axes(cylinder(), XI)
    assert np.all(e[:, 0, 2] * np.einsum("ni,ni->n", e[:, 0], around) < 0.0)


def test_same_thread_in_the_bore() -> None:
    """A nut has the thread of its screw: the tensor does not know the side of the surface."""
    bore = cylinder(inside=True)
    x = cylinder().position(XI)
    inside = bore.project(x).xi
    a = tensor(cylinder(), XI, thread(H), (E1, E2), "spatial")
    close(tensor(bore, inside, thread(H), (E1, E2), "spatial"), a)


def test_thread_of_constant_pitch(sample: Any) -> None:
    """On every surface the thread advances H in a turn, e.z = (H/2pi) e.e_phi/R; e.g. on a cone.

    Source: the helicoid z = H phi/2pi + const of docs/theory/direction-fields.md. R is the
    distance from the axis, not a parameter. Tolerance: 1e-10, the requirement; R is small at some
    of the points.
    """
    surface, xi = sample.make(), sample.coordinates(400)
    axis = np.asarray(sample.axis, dtype=float)
    pitch = 1.5 * sample.size
    field = make_directions("spiral", axis=(sample.centre, axis), pitch=pitch)
    e, valid = field.axes(surface, xi)
    assert valid.mean() > 0.99
    e, xi = e[valid], xi[valid]
    around = np.cross(axis, surface.position(xi) - sample.centre)
    r2 = np.einsum("ni,ni->n", around, around)
    turn = np.einsum("ni,ni->n", e[:, 0], around) / r2
    advance = e[:, 0] @ axis
    error = advance - pitch / (2 * np.pi) * turn
    assert np.abs(error).max() < 1e-10


def test_rays_and_rings_on_surfaces_of_revolution(sample: Any) -> None:
    """On a coaxial surface the second axis of a polar field is along the parallels.

    Source: docs/theory/direction-fields.md. The equator of a sphere and a cylinder, where a ray is
    along the normal, are regular.
    """
    if sample.shape not in ("plane", "cylinder", "cone", "sphere", "torus", "revolution"):
        pytest.skip("no surface of revolution")
    surface, xi = sample.make(), sample.coordinates(400)
    axis = np.asarray(sample.axis, dtype=float)
    e, valid = make_directions("polar", axis=(sample.centre, axis)).axes(surface, xi)
    assert valid.all()
    around = np.cross(axis, surface.position(xi) - sample.centre)
    around /= np.linalg.norm(around, axis=1)[:, None]
    np.testing.assert_allclose(np.abs(np.einsum("ni,ni->n", e[:, 1], around)), 1.0, atol=1e-12)


def test_coordinate_lines(sample: Any) -> None:
    """(47), (48): A^11 = l_1/a_11, A^22 = l_2/a_22, A^12 = 0 along the surface's own lines.

    Tolerance: 1e-10 of the largest entry, for skew coordinate lines.
    """
    surface, xi = sample.make(), sample.coordinates(400)
    a = surface.geometry(xi).a_co
    computed = tensor(surface, xi, make_directions("coordinate-lines"), (E1, E2), "contra")
    expected = matrix(E1 / a[:, 0, 0], 0.0, E2 / a[:, 1, 1])
    scale = np.abs(expected).max(axis=(1, 2))
    assert np.all(np.abs(computed - expected).max(axis=(1, 2)) < 1e-10 * scale)


def test_from_vectors(sample: Any) -> None:
    """(47)-(57): projections of two vectors; b_ij = sum l_a (e_a.rho_i)(e_a.rho_j), in NumPy."""
    surface, xi = sample.make(), sample.coordinates(400)
    v = np.array([[1.0, 0.3, 0.2], [-0.2, 1.0, 0.5]])
    field = make_directions("from-vectors", first=v[0], second=v[1])
    n, d1 = surface.geometry(xi).normal, surface.jet(xi).d1
    e = v[None] - np.einsum("ai,ni->na", v, n)[..., None] * n[:, None]
    e /= np.linalg.norm(e, axis=2)[..., None]
    c = np.einsum("nai,nki->nak", e, d1)
    expected = np.einsum("a,nai,naj->nij", (E1, E2), c, c)
    scale = np.abs(expected).max(axis=(1, 2))
    error = np.abs(tensor(surface, xi, field, (E1, E2)) - expected).max(axis=(1, 2))
    assert np.all(error < 1e-10 * scale)  # 1e-10: where v is nearly normal digits are lost


def test_strip_is_allowed() -> None:
    """eps_1 = 0 is the documented degenerate case of the adhesion: rank one, along e_2 alone."""
    field = make_directions("constant", vector=(1, 0, 0), angle=0.4)
    s = tensor(plane(), [[0, 0]], field, (0.0, E2))[0]
    along = np.array([np.cos(0.4), np.sin(0.4)])
    assert np.abs(s @ along).max() < LIMIT * E2
    with pytest.raises(
        InputError, match=r"^eigenvalues: \(0.0, 0.0\) given, two numbers of one sign"
    ):
        tensor(plane(), [[0, 0]], field, (0.0, 0.0))
