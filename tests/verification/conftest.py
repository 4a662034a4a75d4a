"""Samples of every registered surface, with parametrisations written down anew in NumPy."""

from __future__ import annotations

import numpy as np
import pytest
from tests.verification.profile_samples import nurbs_cylinder, nurbs_sphere, patches, revolutions
from tests.verification.surface_sample import (
    AXES,
    INFINITE,
    ORIGIN,
    PI,
    PLACED,
    ROUND,
    SurfaceSample,
    moved,
    rotation,
)

from anisocontact.base.array_types import Flags, Floats
from anisocontact.surfaces import PROJECTION_STATUS, Surface

#: A script that runs in a process of its own, with a package that need not be there.
collect_ignore = ["external_operator_assembled.py"]


def _plane() -> SurfaceSample:
    return SurfaceSample(
        name="plane",
        shape="plane",
        parameters={"point": ORIGIN, "normal": 2 * AXES[2], "tangent": AXES[0]},
        size=1.0,
        centre=ORIGIN,
        window=((-2, 2), (-2, 2)),
        whole=((-INFINITE, INFINITE), (-INFINITE, INFINITE)),
        local=lambda u, v: (u, v, 0 * u),
        curvature=lambda u, v: (0 * u, 0 * u),
    )


def _cylinder(r: float = 0.8) -> SurfaceSample:
    return SurfaceSample(
        name="cylinder",
        shape="cylinder",
        parameters={"point": ORIGIN, "radius": r} | PLACED,
        size=r,
        centre=ORIGIN,
        window=((-PI, PI), (-2, 2)),
        whole=((-PI, PI), (-INFINITE, INFINITE)),
        local=lambda u, v: (r * np.cos(u), r * np.sin(u), v),
        curvature=lambda u, v: (0 * u, 0 * u - 1 / (2 * r)),
        closed=(True, False),
    )


def _sphere(r: float = 1.7) -> SurfaceSample:
    return SurfaceSample(
        name="sphere",
        shape="sphere",
        parameters={"centre": ORIGIN, "radius": r} | PLACED,
        size=r,
        centre=ORIGIN,
        window=((-PI, PI), (-1.4, 1.4)),
        whole=ROUND,
        local=lambda u, v: (r * np.cos(u) * np.cos(v), r * np.sin(u) * np.cos(v), r * np.sin(v)),
        curvature=lambda u, v: (0 * u + 1 / r**2, 0 * u - 1 / r),
        closed=(True, True),
    )


def _cone(angle: float = 0.6) -> SurfaceSample:
    sin, cos, tan = np.sin(angle), np.cos(angle), np.tan(angle)
    return SurfaceSample(
        name="cone",
        shape="cone",
        parameters={"apex": ORIGIN, "angle": angle} | PLACED,
        size=1.0,
        centre=ORIGIN,
        window=((-PI, PI), (0.3, 3.0)),
        whole=((-PI, PI), (0.0, INFINITE)),
        local=lambda u, v: (v * sin * np.cos(u), v * sin * np.sin(u), v * cos),
        curvature=lambda u, v: (0 * u, -1 / (2 * v * tan)),
        closed=(True, False),
    )


def _torus(ring: float = 1.4, tube: float = 0.5) -> SurfaceSample:
    def local(u: Floats, v: Floats) -> tuple[Floats, ...]:
        out = ring + tube * np.cos(v)
        return out * np.cos(u), out * np.sin(u), tube * np.sin(v)

    def curvature(u: Floats, v: Floats) -> tuple[Floats, Floats]:
        out = ring + tube * np.cos(v)
        return np.cos(v) / (tube * out), -(ring + 2 * tube * np.cos(v)) / (2 * tube * out)

    return SurfaceSample(
        name="torus",
        shape="torus",
        parameters={"centre": ORIGIN, "radius": ring, "tube": tube} | PLACED,
        size=tube,
        centre=ORIGIN,
        window=((-PI, PI), (-PI, PI)),
        whole=((-PI, PI), (-PI, PI)),
        local=local,
        curvature=curvature,
        closed=(True, True),
    )


def _ellipsoid(name: str, a: float, b: float, c: float) -> SurfaceSample:
    def local(u: Floats, v: Floats) -> tuple[Floats, ...]:
        return a * np.cos(u) * np.cos(v), b * np.sin(u) * np.cos(v), c * np.sin(v)

    def curvature(u: Floats, v: Floats) -> tuple[Floats, Floats]:
        x, y, z = local(u, v)
        p = x**2 / a**4 + y**2 / b**4 + z**2 / c**4
        volume2 = (a * b * c) ** 2
        mean = x**2 + y**2 + z**2 - a**2 - b**2 - c**2
        return 1 / (volume2 * p**2), mean / (2 * volume2 * p**1.5)

    return SurfaceSample(
        name=name,
        shape="ellipsoid",
        parameters={"centre": ORIGIN, "semi_axes": (a, b, c)} | PLACED,
        size=min(a, b, c),
        centre=ORIGIN,
        window=((-PI, PI), (-1.4, 1.4)),
        whole=ROUND,
        local=local,
        curvature=curvature,
        closed=(True, True),
    )


def _helicoid(name: str, lead: float, flank: float, *, below: bool = False) -> SurfaceSample:
    """Gauss curvature -c^2/W^4 and mean curvature t ((1 + t^2) r^2 + 2 c^2)/(2 W^3), where W^2 = (1
    + t^2) r^2 + c^2; both from the forms of rho by hand. The mirror makes the hand of the screw
    another one."""
    inner, outer, side = 0.6, 1.5, -1 if below else 1
    c, t = side * lead / (2 * PI), np.tan(flank)

    def curvature(u: Floats, s: Floats) -> tuple[Floats, Floats]:
        w2 = (1 + t**2) * (outer - s) ** 2 + c**2
        return -(c**2) / w2**2, side * t * (w2 + c**2) / (2 * w2**1.5)

    def local(u: Floats, s: Floats) -> tuple[Floats, ...]:
        r = outer - s
        return r * np.cos(u), r * np.sin(u), c * u + t * (r - inner)

    return SurfaceSample(
        name=name,
        shape="helicoid",
        parameters={
            "point": ORIGIN,
            "lead": lead,
            "inner": inner,
            "outer": outer,
            "flank": flank,
            "below": below,
        }
        | PLACED,
        size=0.5,
        centre=ORIGIN,
        window=((-7, 9), (0, outer - inner)),
        whole=((-60, 60), (0, outer - inner)),
        local=local,
        curvature=curvature,
        mirrored=below,
        lengths=(False, True),
    )


def _helicoids() -> list[SurfaceSample]:
    """Of a fastener, of a propeller, right and left, seen from both sides."""
    return [
        _helicoid("helicoid", 1.2, 0.5),
        _helicoid("helicoid-left", -2.0, -0.3),
        _helicoid("helicoid-steep", 9.0, 0.0),
        _helicoid("helicoid-below", 1.2, 0.5, below=True),
    ]


def surface_samples() -> list[SurfaceSample]:
    """All samples; every registered surface has one."""
    revolved = [
        _cylinder(),
        _sphere(),
        _cone(),
        _torus(),
        _ellipsoid("ellipsoid", 1.3, 0.7, 2.0),
    ]
    spheroids = [_ellipsoid("oblate", 1.5, 1.5, 0.6), _ellipsoid("prolate", 0.8, 0.8, 2.4)]
    splines = [nurbs_cylinder(), nurbs_sphere(), *patches()]
    turned = revolutions()
    bores = [s.bore() for s in (*revolved, turned[0])]
    return [_plane(), *revolved, *bores, *spheroids, *splines, *turned, *_helicoids()]


def one_sheet(surface: Surface, x: Floats, step: Floats, size: float) -> Flags:
    """Where the closest point stays interior and goes on, and does not jump to another part of the
    surface that is as near; closer to the surface than 0.6 of its radii of curvature it moves by at
    most 1/(1 - 0.6) = 2.5 steps."""
    feet = []
    inner = np.ones(len(x), bool)
    for sign in (-1.0, 0.0, 1.0):
        p = surface.project(x + sign * step)
        inner &= p.status == PROJECTION_STATUS.index("interior")
        feet.append(surface.position(p.xi))
    moved = np.maximum(*(np.linalg.norm(f - feet[1], axis=1) for f in (feet[0], feet[2])))
    return inner & (moved < 10 * np.linalg.norm(step, axis=1) + 1e-9 * size)


class Surfaces:
    """What the tests of surfaces share."""

    samples = tuple(surface_samples())
    moved = staticmethod(moved)
    rotation = staticmethod(rotation)
    one_sheet = staticmethod(one_sheet)


@pytest.fixture(scope="session")
def surfaces() -> Surfaces:
    """Samples of every registered surface, and how to move one."""
    return Surfaces()


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Run a test that asks for a `sample` once for each."""
    if "sample" in metafunc.fixturenames:
        metafunc.parametrize("sample", surface_samples(), ids=lambda s: s.name)
