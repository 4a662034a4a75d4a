"""Points whose closest point is not unique or lies where the coordinates are singular."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from anisocontact.anisotropy import make_directions
from anisocontact.base.errors import InputError
from anisocontact.interface import Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.surfaces import PROJECTION_STATUS, Surface, make_surface

INTERIOR, EDGE, CORNER, SINGULAR, AMBIGUOUS, FAILED = range(len(PROJECTION_STATUS))
TILTED: dict[str, Any] = {"axis": (1, 1, 1), "start": (1, -1, 0)}


def sphere(**more: Any) -> Surface:
    return make_surface("sphere", centre=(1, 2, 3), radius=2.0, **(TILTED | more))


def cylinder(**more: Any) -> Surface:
    return make_surface("cylinder", point=(1, 2, 3), radius=2.0, **(TILTED | more))


def project_one(surface: Surface, x: Any) -> Any:
    p = surface.project(x)
    assert np.isfinite(p.xi).all() and np.isfinite(p.gap).all()
    assert np.isfinite(p.dxi_dx).all() and np.isfinite(p.dgap_dx).all()
    return p


@pytest.mark.parametrize("inside", [False, True])
def test_axis_of_a_cylinder(inside: bool) -> None:
    """The point at angle zero is taken; the coordinate along the axis keeps its derivative."""
    p = project_one(cylinder(inside=inside), [3, 4, 5])
    assert p.status == AMBIGUOUS
    np.testing.assert_allclose(p.xi, [[0, 2 * np.sqrt(3)]], rtol=1e-14)
    np.testing.assert_allclose(p.gap, 2.0 if inside else -2.0, rtol=1e-14)
    np.testing.assert_allclose(p.dxi_dx[0, 0], 0.0, atol=1e-15)
    np.testing.assert_allclose(p.dxi_dx[0, 1], np.ones(3) / np.sqrt(3), rtol=1e-12)


@pytest.mark.parametrize("inside", [False, True])
def test_centre_of_a_sphere(inside: bool) -> None:
    p = project_one(sphere(inside=inside), [1, 2, 3])
    assert p.status == AMBIGUOUS
    np.testing.assert_array_equal(p.xi, 0.0)
    np.testing.assert_allclose(p.gap, 2.0 if inside else -2.0, rtol=1e-14)
    np.testing.assert_array_equal(p.dxi_dx, 0.0)


@pytest.mark.parametrize("offset", [0.0, 1e-14, 1e-12])
@pytest.mark.parametrize("gap", [-0.5, 0.0, 3.0])
def test_pole_of_a_sphere(offset: float, gap: float) -> None:
    """At the pole the gap is right to rounding, the normal to 1e-12, by the foot beside it."""
    axis = np.ones(3) / np.sqrt(3)
    aside = np.array([1, -1, 0]) / np.sqrt(2)
    p = project_one(sphere(), np.array([1, 2, 3]) + (2 + gap) * axis + offset * aside)
    assert p.status == SINGULAR
    np.testing.assert_allclose(p.gap, gap, atol=1e-14)
    np.testing.assert_allclose(p.dgap_dx[0], axis, atol=2e-12)


def cone(**more: Any) -> Surface:
    return make_surface("cone", apex=(1, 2, 3), angle=0.6, axis=(0, 0, 1), start=(1, 0, 0), **more)


@pytest.mark.parametrize("inside", [False, True])
def test_apex_of_a_cone(inside: bool) -> None:
    """The apex holds the length; the angle follows the point, at the rate of its direction about
    the axis. The foot is moved by 1e-8 of the distance."""
    p = project_one(cone(inside=inside), [1.3, 2.4, 1.0])
    assert p.status == SINGULAR
    r, height, sign = 0.5, -2.0, -1.0 if inside else 1.0
    normal = np.array([np.cos(0.6) * 0.6, np.cos(0.6) * 0.8, -np.sin(0.6)]) * sign
    np.testing.assert_allclose(p.xi[0, 0], sign * np.arctan2(0.4, 0.3), rtol=1e-14)
    np.testing.assert_allclose(p.gap, normal @ [0.3, 0.4, height], rtol=1e-7)
    around = sign * np.array([-0.8, 0.6, 0]) / r
    np.testing.assert_allclose(p.dxi_dx[0], [around, 0 * around], atol=1e-6)
    np.testing.assert_allclose(p.dgap_dx[0], normal, atol=1e-6)


@pytest.mark.parametrize("x", [(1, 2, 3), (1, 2, 1)])
def test_apex_and_below(x: Any) -> None:
    """At the apex, and below it on the axis, nothing has a direction: no derivative."""
    p = project_one(cone(), x)
    assert p.status == SINGULAR
    np.testing.assert_array_equal(p.dxi_dx, 0.0)


def test_apex_in_the_origin() -> None:
    """The apex is no length away from a point in it: still numbers, and a gap of zero."""
    surface = make_surface("cone", apex=(0, 0, 0), angle=0.6, axis=(0, 0, 1))
    p = project_one(surface, [0, 0, 0])
    assert p.status == SINGULAR
    np.testing.assert_allclose(p.gap, 0.0, atol=1e-140)
    assert np.isfinite(surface.geometry(p.xi).normal).all()


def test_axis_of_a_cone() -> None:
    p = project_one(cone(), [1, 2, 5])
    assert p.status == AMBIGUOUS
    np.testing.assert_allclose(p.xi, [[0, 2 * np.cos(0.6)]], rtol=1e-14)
    np.testing.assert_allclose(p.gap, -2 * np.sin(0.6), rtol=1e-14)


@pytest.mark.parametrize(
    ("x", "xi", "gap"),
    [
        ((1, 2, 3), (0, np.pi), 2.0),
        ((1, 2, 6), (0, np.arctan2(3, -3)), np.sqrt(18) - 1),
        ((1, 5, 3), (np.pi / 2, 0), -1.0),
    ],
)
def test_axis_and_centre_line_of_a_torus(x: Any, xi: Any, gap: float) -> None:
    torus = make_surface(
        "torus", centre=(1, 2, 3), axis=(0, 0, 1), start=(1, 0, 0), radius=3.0, tube=1.0
    )
    p = project_one(torus, x)
    assert p.status == AMBIGUOUS
    np.testing.assert_allclose(p.xi, [xi], atol=1e-14)
    np.testing.assert_allclose(p.gap, gap, rtol=1e-14)


@pytest.mark.parametrize(
    ("semi_axes", "x", "foot", "status"),
    [
        ((2, 3, 4), (0, 0, 0), (2, 0, 0), AMBIGUOUS),
        ((3, 2, 4), (0, 0, 0), (0, 2, 0), AMBIGUOUS),
        ((4, 3, 2), (0, 0, 0), (0, 0, 2), AMBIGUOUS),
        ((2, 2, 2), (0, 0, 0), (2, 0, 0), AMBIGUOUS),
        ((2, 2, 4), (0, 0, 1), (2 * np.sqrt(8) / 3, 0, 4 / 3), AMBIGUOUS),
        # Centre of curvature of the end of the longest axis, in the plane of the least: c - a^2/c.
        ((2, 3, 4), (0, 0, 3), (0, 0, 4), AMBIGUOUS),
        ((2, 3, 4), (0, 0, 3.5), (0, 0, 4), SINGULAR),
        ((4, 3, 2), (0, 0, 0.5), (0, 0, 2), SINGULAR),
        ((2, 3, 4), (0, 0, -9), (0, 0, -4), SINGULAR),
        ((2, 3, 4), (0, 7, 0), (0, 3, 0), INTERIOR),
    ],
)
def test_symmetry_of_an_ellipsoid(semi_axes: Any, x: Any, foot: Any, status: int) -> None:
    """Points on the axes: feet by elementary geometry; poles are kept off by 1e-8 of the angle."""
    ellipsoid = make_surface(
        "ellipsoid", centre=(0, 0, 0), semi_axes=semi_axes, axis=(0, 0, 1), start=(1, 0, 0)
    )
    p = project_one(ellipsoid, x)
    assert p.status == status
    np.testing.assert_allclose(ellipsoid.position(p.xi), [foot], atol=5e-8)
    distance = np.linalg.norm(np.subtract(x, foot))
    np.testing.assert_allclose(np.abs(p.gap), distance, rtol=1e-14)


def through(surface: Surface, path: Any) -> Any:
    """Tractions of a point dragged along a path, frictional and sticking."""
    marks = make_directions("constant", vector=(1, 0.2, -0.4))
    interface = Interface(
        surface,
        NormalLaw(penalty=1e3),
        Adhesion(stiffness=(1e3, 3e2), directions=marks),
        Friction(coefficients=(0.4, 0.2), directions=marks),
    )
    state = interface.initial_state(path[0])
    responses = []
    for x in path:
        r = interface.update(state, x)
        assert not r.failure.any()
        state = r.state
        responses.append(r)
    return responses


def test_path_over_the_pole() -> None:
    """A contact point runs over the pole: nothing but the coordinates is special there, so that the
    same path on a sphere whose poles are elsewhere has the same tractions and tangents.

    At the pole the foot is moved by 1e-8 of the radius, 2e-8. With a stiffness of 1e3 that may
    change the traction by 2e-5, and with increments of 0.01 the direction of slip, on which the
    tangent of size 1e3 depends, by 2e-6.
    """
    axis, aside = np.ones(3) / np.sqrt(3), np.array([1, -1, 0]) / np.sqrt(2)
    angles = np.linspace(-0.1, 0.1, 41)[:, None]  # the middle one is the pole
    path = np.array([1, 2, 3]) + 1.99 * (np.cos(angles) * axis + np.sin(angles) * aside)
    over = through(sphere(), path)
    beside = through(sphere(axis=(1, -1, 0), start=(0, 0, 1)), path)
    assert any(r.status == 2 for r in over)
    for a, b in zip(over, beside, strict=True):
        np.testing.assert_allclose(a.traction, b.traction, rtol=0, atol=2e-5)
        np.testing.assert_allclose(a.tangent, b.tangent, rtol=0, atol=2e-3)


@pytest.mark.parametrize(
    ("shape", "parameters", "message"),
    [
        ("cylinder", {"point": (0, 0, 0), "axis": (0, 0, 0), "radius": 1}, "axis: .*not be zero"),
        ("cylinder", {"point": (0, 0, 0), "axis": (0, 0, 1), "radius": 0}, "radius: .*> 0"),
        ("sphere", {"centre": (0, 0, 0), "radius": -1}, "radius: .*> 0"),
        (
            "cylinder",
            {"point": (0, 0, 0), "axis": (0, 0, 1), "radius": 1, "start": (0, 0, 2)},
            "start is parallel to axis",
        ),
        ("sphere", {"centre": (0, 0, 0), "radius": 1, "inside": 1}, "inside: .*true or false"),
        (
            "torus",
            {"centre": (0, 0, 0), "axis": (0, 0, 1), "radius": 1, "tube": 1},
            "tube must be less than radius",
        ),
        (
            "cone",
            {"apex": (0, 0, 0), "axis": (0, 0, 1), "angle": np.pi / 2},
            "angle must be less than a right angle",
        ),
        ("ellipsoid", {"centre": (0, 0, 0), "semi_axes": (1, 0, 1)}, "semi_axes: .*> 0"),
    ],
)
def test_wrong_parameters(shape: str, parameters: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        make_surface(shape, **parameters)


@pytest.mark.parametrize("centre", [(3e3, 4e3, 0.0), (0.0, -3e3, 4e3), (5e3, 0.0, 0.0)])
def test_lengths_of_a_surface_are_those_of_the_turned_one(centre):
    """What its points are rounded to is a share of them: 5000 to the centre, and the radius."""
    assert make_surface("sphere", centre=centre, radius=1e4).extent == pytest.approx(1.5e4)
