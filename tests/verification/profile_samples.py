"""Samples of surfaces from splines and from profiles that are turned about an axis."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline, NdBSpline
from tests.verification.surface_sample import AXES, ORIGIN, PI, PLACED, SurfaceSample

from anisocontact.base.array_types import Floats


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


def patches() -> list[SurfaceSample]:
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
