"""A rigid surface with waves both ways pressed on a block, from touch at the crests to all over.

Source: K. L. Johnson, J. A. Greenwood, J. G. Higginson, Int. J. Mech. Sci. 27 (1985) 383:
waves `D cos(2 pi x) cos(2 pi y)` touch all over under `p* = sqrt(2) pi E* D`, and under a mean
pressure m beyond that p = m + p* cos(2 pi x) cos(2 pi y). Below it there is no closed form; here it
is computed on a grid, by the transform of the half space and conjugate gradients as by
I. A. Polonsky, L. M. Keer, Wear 231 (1999) 206, as V. A. Yastrebov, G. Anciaux, J.-F. Molinari,
Trib. Int. 86 (2015) 134 have it. Contact goes from patches at the crests, 0.35 of the plane at
m / p* = 0.2, over joined ones to patches without contact in the hollows, 0.1 of it at 0.8.

A quarter of a wave between planes of symmetry, in space, the surface a NURBS patch; one increment.

Requirement: pressure at all nodes but within a facet of the edge of contact, over the largest; no
cut; corrections. Tolerance: measured 0.6 % (order 1, 12 facets over half a wave) and 2.9 % (order
2, 6), 0.1 and 1.6 % in full contact; 7 corrections.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import make_interp_spline
from scipy.ndimage import minimum_filter
from tests.verification.hard.drawn import graded

HIGH, GRID = 0.002, 192
FULL = np.sqrt(2.0) * np.pi * 1000.0 / (1.0 - 0.3**2) * HIGH

CASE = """
title = "Waves both ways"
symmetry = ["block.left", "block.right", "block.front", "block.back"]
[mesh.box.block]
origin = [0, 0, -1]
size = [0.5, 0.5, 1]
cells = [{facets}, {facets}, {layers}]
planes_z = {planes}
order = {order}
[material.block]
model = "linear-elastic"
E = 1000
nu = 0.3
[surface.waves]
shape = "nurbs"
degrees = [3, 3]
knots_1 = {knots}
knots_2 = {knots}
points = {points}
flip = true
[rigid.waves]
reference = [0.25, 0.25, 0]
[[contact]]
slave = "block.top"
master = "waves"
friction = {{ coefficients = 0 }}
[[step]]
name = "press"
increments = 1
displacement = {{ "block.bottom" = {{ z = 0 }} }}
motion = {{ waves = {{ z = "free" }} }}
load = {{ waves = {{ z = {force!r} }} }}
"""


def waves() -> tuple[list[float], list[float]]:
    """Knots along each coordinate and control points of a patch that is the surface to 1e-4 D."""
    places = np.linspace(-0.25, 0.75, 25)
    spline = make_interp_spline(places, np.cos(2.0 * np.pi * places), 3)
    knots, heights = spline.t, spline.c
    middle = (knots[1:-3] + knots[2:-2] + knots[3:-1]) / 3.0
    x, y = np.meshgrid(middle, middle, indexing="ij")
    points = np.stack([x, y, HIGH * (1.0 - np.outer(heights, heights))], axis=-1)
    return knots.tolist(), points.ravel().tolist()


def exact(mean: float) -> np.ndarray:
    """Pressure over p* on a grid of a whole wave, for a mean pressure over p*."""
    crest = np.cos(2.0 * np.pi * np.arange(GRID) / GRID)
    gap = (1.0 - np.outer(crest, crest)) / (np.sqrt(2.0) * np.pi)
    waves = 2.0 * np.pi * np.fft.fftfreq(GRID, 1.0 / GRID)
    numbers = np.hypot(*np.meshgrid(waves, waves))
    numbers[0, 0] = np.inf
    p, way = np.full_like(gap, mean), np.zeros_like(gap)
    size, conjugate = 1.0, 0.0
    while True:
        left, before = np.fft.ifft2(2.0 / numbers * np.fft.fft2(p)).real + gap, p
        on = p > 0.0
        left -= left[on].mean()
        now = np.sum(left[on] ** 2)
        way = np.where(on, left + conjugate * now / size * way, 0.0)
        size, give = now, np.fft.ifft2(2.0 / numbers * np.fft.fft2(way)).real
        step = np.sum(left * way) / np.sum((give - give[on].mean()) * way)
        p = np.maximum(p - step * way, 0.0)
        comes = (p == 0.0) & (left < 0.0)
        p = np.where(comes, -step * left, p)
        conjugate = 0.0 if comes.any() else 1.0
        p *= mean / p.mean()
        if np.abs(p - before).sum() < 1e-8 * p.sum():
            return p


def test_full_contact() -> None:
    """The closed form beyond p*, and Hertz for the smallest load, by the grid."""
    assert exact(1.2)[GRID // 2, 0] == pytest.approx(0.2, abs=1e-9)
    # two crests a wave, of the radius 1 / (4 pi^2 D): p0^3 = 6 P E*^2 / (pi^3 R^2)
    hertz = (6.0 * 0.01 / 2.0 * np.sqrt(2.0) * np.pi * 16.0 * np.pi**4 / np.pi**3) ** (1.0 / 3.0)
    assert exact(0.01).max() * np.sqrt(2.0) * np.pi == pytest.approx(hertz, rel=0.02)


@pytest.mark.parametrize("mean", [0.2, 0.5, 0.8, 1.2])
@pytest.mark.parametrize(("facets", "order", "error"), [(12, 1, 0.01), (6, 2, 0.04)])
def test_pressure(
    to_the_end: Callable[..., Any], facets: int, order: int, error: float, mean: float
) -> None:
    """Pressure at the nodes."""
    planes = 1.0 - graded(2 * facets, facets // 2, 1.0, 1.4)[::-1]
    knots, points = waves()
    text = CASE.format(
        facets=facets,
        layers=len(planes) - 1,
        planes=planes.tolist(),
        order=order,
        knots=knots,
        points=points,
        force=float(-0.25 * mean * FULL),
    )
    run = to_the_end(text, most=9000)
    assert not run.cuts
    assert run.accepted[-1].iterations <= 8
    (contact,) = run.problem.contacts
    places = np.rint(contact.points[:, :2] * GRID).astype(int)
    p = exact(mean)
    facet = GRID // (2 * facets)
    inside = minimum_filter(p, 2 * facet + 1, mode="wrap")[places[:, 0], places[:, 1]] > 0.0
    assert inside.sum() > 0.15 * len(places)
    sought = p[places[:, 0], places[:, 1]]
    off = np.abs(contact.last.pressure / FULL - sought) / p.max()
    assert off[inside].max() < error
