"""Samples of every registered surface, with parametrisations written down anew in NumPy."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from scipy.interpolate import CubicSpline, NdBSpline

from anisocontact.base import registry
from anisocontact.surfaces import PROJECTION_STATUS, Surface, make_surface

Floats = npt.NDArray[np.float64]

#: A script that runs in a process of its own, with a package that need not be there.
collect_ignore = ["external_operator_assembled.py"]
ORIGIN = np.array([0.3, -0.7, 1.1])
AXIS = np.array([2.0, -1.0, 2.0]) / 3.0
START = np.array([1.0, 2.0, 0.0]) / np.sqrt(5.0)
AXES = np.stack([START, np.cross(AXIS, START), AXIS])
INFINITE = 1e4


@dataclass(frozen=True)
class SurfaceSample:
    """A surface of the core beside formulas of its own.

    Args:
        name: Name of the sample.
        shape: Name in the registry.
        parameters: Those of `make_surface`.
        size: A length of the surface.
        centre: A point the surface is about.
        window: Coordinates where it is regular, ((from, to), (from, to)).
        whole: All its coordinates, as far as they are looked at.
        local: rho in its own axes.
        curvature: Gauss and mean curvature in closed form, None where there is none.
        mirrored: Whether its second axis is reversed (the material outside).
        closed: Whether each coordinate may run past its ends.
        axis: Direction near which points are ambiguous or singular.
        breaks: Lines of each coordinate where the surface is less smooth, seams and poles included.
    """

    name: str
    shape: str
    parameters: dict[str, Any]
    size: float
    centre: Floats
    window: tuple[tuple[float, float], tuple[float, float]]
    whole: tuple[tuple[float, float], tuple[float, float]]
    local: Callable[[Floats, Floats], tuple[Floats, ...]]
    curvature: Callable[[Floats, Floats], tuple[Floats, Floats]] | None = None
    mirrored: bool = False
    closed: tuple[bool, bool] = (False, False)
    axis: Floats = field(default_factory=lambda: AXIS)
    breaks: tuple[tuple[float, ...], tuple[float, ...]] = ((), ())

    def make(self) -> Surface:
        """The surface of the core."""
        return make_surface(self.shape, **self.parameters)

    def position(self, xi: Floats) -> Floats:
        """rho at coordinates (..., 2), in NumPy."""
        y = np.stack(np.broadcast_arrays(*self.local(xi[..., 0], xi[..., 1])), axis=-1)
        return self.centre + y @ (AXES * [[1], [-1 if self.mirrored else 1], [1]])

    def coordinates(self, n: int, seed: int = 0) -> Floats:
        """Random coordinates in the window, (n, 2)."""
        lower, upper = np.transpose(self.window)
        return np.random.default_rng(seed).uniform(lower, upper, (n, 2))

    def smooth(self, xi: Floats, margin: float) -> npt.NDArray[np.bool_]:
        """Which coordinates are farther from every break than a fraction of the range, (n,)."""
        clear = np.ones(len(xi), bool)
        for k in range(2):
            width = margin * np.diff(self.whole[k])[0]
            for line in self.breaks[k]:
                clear &= np.abs(xi[:, k] - line) > width
        return clear

    def bore(self) -> SurfaceSample:
        """The same with the slave inside: the angle runs the other way, curvatures change sign."""
        curvature = self.curvature

        def turned(u: Floats, v: Floats) -> tuple[Floats, Floats]:
            gauss, mean = curvature(u, v)
            return gauss, -mean

        return replace(
            self,
            name=f"{self.name}-bore",
            parameters=self.parameters | {"inside": True},
            curvature=turned if curvature else None,
            mirrored=True,
        )


def moved(parameters: dict[str, Any], shape: str, q: Floats, t: Floats, scale: float) -> Any:
    """Parameters of the surface whose points are t + scale Q rho."""
    entry = registry.entry(registry.surfaces(), shape)
    units = {p.name: (p.kind, p.unit) for p in entry.parameters}
    result = {}
    for name, value in parameters.items():
        kind, unit = units[name]
        lengths = name in ("semi_axes", "profile", "rounding") or kind == "scalar"
        if lengths and unit == "length":
            result[name] = scale * np.asarray(value)
        elif unit == "length":
            result[name] = (t + scale * np.reshape(value, (-1, 3)) @ q.T).ravel()
        elif kind == "vector":
            result[name] = q @ np.asarray(value)
        else:
            result[name] = value
    return result


def rotation(axis: npt.ArrayLike, angle: float) -> Floats:
    """Rotation matrix."""
    a = np.asarray(axis, float) / np.linalg.norm(axis)
    k = np.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])
    return np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k


PI = np.pi
ROUND = ((-PI, PI), (-PI / 2, PI / 2))
PLACED: dict[str, Any] = {"axis": AXIS, "start": START}


def _plane() -> SurfaceSample:
    return SurfaceSample(
        name="plane",
        shape="plane",
        parameters={"point": ORIGIN, "normal": 2 * AXIS, "tangent": START},
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


def _nurbs(
    name: str,
    degrees: tuple[int, int],
    knots: tuple[list[float], list[float]],
    net: Floats,
    weights: Floats | None = None,
    closed: tuple[bool, bool] = (False, False),
    window: tuple[float, float] = (0.02, 0.98),
) -> SurfaceSample:
    """A patch over the unit square with a net (n, m, 3) in its own axes; evaluated by SciPy."""
    w = np.ones(net.shape[:2]) if weights is None else weights
    spline = NdBSpline(
        tuple(np.asarray(k, float) for k in knots),
        np.concatenate([net * w[..., None], w[..., None]], axis=2),
        degrees,
    )

    def local(u: Floats, v: Floats) -> tuple[Floats, ...]:
        xi = np.stack([x - np.floor(x) if c else x for x, c in zip((u, v), closed, strict=True)])
        h = spline(np.moveaxis(xi, 0, -1))
        return tuple(np.moveaxis(h[..., :3] / h[..., 3:], -1, 0))

    first, second = (tuple(k for k in set(line) if 0 < k < 1) for line in knots)
    ends = tuple((0.0, 1.0) if c or name == "nurbs-sphere" else () for c in closed)
    return SurfaceSample(
        name=name,
        shape="nurbs",
        parameters={
            "degrees": degrees,
            "knots_1": knots[0],
            "knots_2": knots[1],
            "points": (ORIGIN + net @ AXES).ravel(),
            "weights": w.ravel(),
        },
        size=1.0,
        centre=ORIGIN,
        window=(window, window),
        whole=((0.0, 1.0), (0.0, 1.0)),
        local=local,
        closed=closed,
        breaks=(first + ends[0], second + ends[1]),
    )


def _even(degree: int, count: int) -> list[float]:
    """Clamped knots, evenly spaced inside."""
    inside = [float(k) for k in np.linspace(0, 1, count - degree + 1)]
    return [0.0] * degree + inside + [1.0] * degree


#: Full and half circle of radius one as quadratic NURBS: points, weights and knots.
ROOT = np.sqrt(0.5)
CIRCLE = np.array([[1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0], [-1, -1], [0, -1], [1, -1], [1, 0]])
CIRCLE_WEIGHTS = np.array([1, ROOT, 1, ROOT, 1, ROOT, 1, ROOT, 1])
CIRCLE_KNOTS = [0, 0, 0, 0.25, 0.25, 0.5, 0.5, 0.75, 0.75, 1, 1, 1]
ARC = np.array([[0, -1], [1, -1], [1, 0], [1, 1], [0, 1]])
ARC_KNOTS = [0, 0, 0, 0.5, 0.5, 1, 1, 1]


def nurbs_cylinder(radius: float = 0.8, height: float = 1.5) -> SurfaceSample:
    """The cylinder exactly, its axis from the origin on."""
    net = np.empty((9, 2, 3))
    net[..., :2] = radius * CIRCLE[:, None]
    net[..., 2] = (0.0, height)
    return _nurbs(
        "nurbs-cylinder",
        (2, 1),
        (CIRCLE_KNOTS, [0, 0, 1, 1]),
        net,
        np.repeat(CIRCLE_WEIGHTS[:, None], 2, axis=1),
        (True, False),
    )


def nurbs_sphere(radius: float = 1.7) -> SurfaceSample:
    """The sphere exactly, with its poles."""
    net = np.empty((9, 5, 3))
    net[..., :2] = radius * CIRCLE[:, None] * ARC[:, :1]
    net[..., 2] = radius * ARC[:, 1]
    weights = CIRCLE_WEIGHTS[:, None] * CIRCLE_WEIGHTS[:5]
    return _nurbs(
        "nurbs-sphere", (2, 2), (CIRCLE_KNOTS, ARC_KNOTS), net, weights, (True, False), (0.06, 0.94)
    )


def _patches() -> list[SurfaceSample]:
    """A wavy bicubic spline, a rational patch of mixed degrees, a roof with a ridge and a valley, a
    twisted bilinear patch, and a patch of degree five."""
    rng = np.random.default_rng(42)

    def sheet(n: int, m: int, height: float) -> Floats:
        x, y = np.meshgrid(np.linspace(-1, 1, n), np.linspace(-1, 1, m), indexing="ij")
        return np.stack([x, y, height * rng.normal(size=(n, m))], axis=-1)

    ridge = sheet(5, 4, 0.1)
    ridge[:, :, 2] += 0.8 * np.array([0, 0.5, 1, 0.5, 0])[:, None]
    twisted = np.array([[[-1, -1, 0.7], [-1, 1, -0.7]], [[1, -1, -0.7], [1, 1, 0.9]]])
    bent = sheet(4, 5, 0.3)
    bent += 0.1 * rng.normal(size=bent.shape)
    return [
        _nurbs("nurbs-wavy", (3, 3), (_even(3, 8), _even(3, 7)), sheet(8, 7, 0.25)),
        _nurbs(
            "nurbs-rational",
            (3, 2),
            (_even(3, 4), _even(2, 5)),
            bent,
            rng.uniform(0.4, 2.5, (4, 5)),
        ),
        _nurbs("nurbs-ridge", (2, 3), ([0, 0, 0, 0.5, 0.5, 1, 1, 1], _even(3, 4)), ridge),
        _nurbs("nurbs-twisted", (1, 1), (_even(1, 2), _even(1, 2)), twisted),
        _nurbs("nurbs-quintic", (5, 4), (_even(5, 7), _even(4, 6)), sheet(7, 6, 0.4)),
    ]


def _revolution(name: str, profile: Any, radius: Any, breaks: Any, **more: Any) -> SurfaceSample:
    """A profile turned about the axis; `radius` gives r, z of its share."""
    closed, ends = more.pop("closed", False), more.pop("ends", ())
    low, high = more.pop("window", (0.02, 0.98))

    def local(u: Floats, v: Floats) -> tuple[Floats, ...]:
        r, z = radius(v - np.floor(v) if closed else v)
        return r * np.cos(u), r * np.sin(u), z

    return SurfaceSample(
        name=name,
        shape="revolution",
        parameters={"point": ORIGIN, "profile": profile} | PLACED | more,
        size=1.0,
        centre=ORIGIN,
        window=((-PI, PI), (low, high)),
        whole=((-PI, PI), (0.0, 1.0)),
        local=local,
        closed=(True, closed),
        breaks=((), (*breaks, *((0.0, 1.0) if closed else ends))),
    )


def _pieces(*pieces: Any) -> Any:
    """r, z over the share of chords, and where pieces meet.

    A line is (start, end), an arc (centre, radius, first angle, last angle). The tangent of half
    the angle from the middle of an arc is linear in its share.
    """

    def ends(piece: Any) -> Floats:
        if len(piece) == 2:
            return np.array(piece, float)
        centre, radius, *angles = piece
        return centre + radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)

    chords = [np.linalg.norm(np.diff(ends(p), axis=0)) for p in pieces]
    knots = np.concatenate([[0.0], np.cumsum(chords)]) / np.sum(chords)

    def at(v: Floats) -> tuple[Floats, ...]:
        v = np.asarray(v)
        found = np.zeros((*v.shape, 2))
        for k, piece in enumerate(pieces):
            here = (v >= knots[k]) & (v <= knots[k + 1])
            share = ((v[here] - knots[k]) / (knots[k + 1] - knots[k]))[:, None]
            if len(piece) == 2:
                found[here] = (1 - share) * piece[0] + share * np.array(piece[1])
            else:
                centre, radius, first, last = piece
                half = (last - first) / 2
                angle = first + half + 2 * np.arctan((2 * share - 1) * np.tan(half / 2))
                found[here] = centre + radius * np.hstack([np.cos(angle), np.sin(angle)])
        return found[..., 0], found[..., 1]

    return at, tuple(knots[1:-1].tolist())


def revolutions() -> list[SurfaceSample]:
    """A die with a rounding, a ring with the profile of a stadium, a nose with a tip and a corner,
    and a vase whose profile is a spline that begins on the axis."""
    die = _pieces(((2, 0), (1.4, 0)), ((1.4, -0.4), 0.4, PI / 2, PI), ((1, -0.4), (1, -2)))
    quarter = PI / 2
    ring = _pieces(
        ((1, -0.5), (2, -0.5)),
        *(((2, 0), 0.5, k * quarter, (k + 1) * quarter) for k in (-1, 0)),
        ((2, 0.5), (1, 0.5)),
        *(((1, 0), 0.5, k * quarter, (k + 1) * quarter) for k in (1, 2)),
    )
    nose = _pieces(((0, 0), (1, 0.5)), ((1, 0.5), (1.2, 1.6)))
    points = np.array([[0, 0], [0.5, 0.05], [0.9, 0.4], [0.8, 1.0], [0.5, 1.4], [0.9, 2.0]])
    chords = np.linalg.norm(np.diff(points, axis=0), axis=1)
    share = np.concatenate([[0.0], np.cumsum(chords)]) / chords.sum()
    vase = CubicSpline(share, points)
    return [
        _revolution("revolution-die", [2, 0, 1, 0, 1, -2], *die, rounding=[0.4]),
        _revolution(
            "revolution-ring",
            [(1, -0.5), (2, -0.5), (2, 0.5), (1, 0.5), (1, -0.5)],
            *ring,
            arcs=(0, PI, 0, PI),
            closed=True,
        ),
        _revolution(
            "revolution-nose",
            [(0, 0), (1, 0.5), (1.2, 1.6)],
            *nose,
            ends=(0.0,),
            window=(0.06, 0.98),
        ),
        _revolution(
            "revolution-vase",
            points,
            lambda v: tuple(np.moveaxis(vase(v), -1, 0)),
            share[2:-2],
            spline=True,
            ends=(0.0,),
            window=(0.06, 0.98),
        ),
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
    splines = [nurbs_cylinder(), nurbs_sphere(), *_patches()]
    turned = revolutions()
    bores = [s.bore() for s in (*revolved, turned[0])]
    return [_plane(), *revolved, *bores, *spheroids, *splines, *turned]


def one_sheet(surface: Surface, x: Floats, step: Floats, size: float) -> npt.NDArray[np.bool_]:
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
