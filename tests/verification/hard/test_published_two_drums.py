"""A belt over one drum and under a second one, of another radius and friction, that both turn.

Two arcs with a straight piece between them, tied to each other, touch one drum with each side.
One end is held, the other has a dead load. Source: L. Euler, 1769, once for each drum, with the
friction of a drum on its radius R and the tension half a thickness t further out:

    T2 / T1 = exp(a (m1 R1 / (R1 + t / 2) + m2 R2 / (R2 + t / 2))) .

Requirement: 0.3 % of it once all slides, from when on an increment takes at most two iterations.
Tolerance: measured 0.15 %, what stiffness the belt has in bending.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

THICK, ANGLE = 0.05, 150.0
RADII, FRICTION = (5.0, 3.0), (0.2, 0.35)

CASE = """
title = "Two drums"
[idealisation]
kind = "plane-strain"
[mesh.annulus.over]
inner = 5
outer = 5.05
cells = [1, {over}]
start_deg = 0
end_deg = 150
order = {order}
[mesh.annulus.under]
inner = 3
outer = 3.05
cells = [1, {under}]
start_deg = 180
end_deg = 330
order = {order}
move = [{x!r}, {y!r}, 0]
[material.over]
model = "neo-hookean"
E = 1e4
nu = 0.3
[material.under]
model = "neo-hookean"
E = 1e4
nu = 0.3
[mesh.rectangle.between]
origin = [0, 0]
size = [2, 0.05]
cells = [16, 1]
order = {order}
rotate = {{ axis = [0, 0, 1], angle_deg = 240 }}
move = [{left!r}, {lower!r}, 0]
[material.between]
model = "neo-hookean"
E = 1e4
nu = 0.3
[[tie]]
slave = "between.left"
master = "over.end"
[[tie]]
slave = "between.right"
master = "under.end"
[surface.one]
shape = "cylinder"
point = [0, 0, 0]
axis = [0, 0, 1]
radius = 5
[surface.two]
shape = "cylinder"
point = [{x!r}, {y!r}, 0]
axis = [0, 0, 1]
radius = 3
[rigid.one]
reference = [0, 0, 0]
[rigid.two]
reference = [{x!r}, {y!r}, 0]
[[contact]]
slave = "over.inner"
master = "one"
friction = {{ coefficients = 0.2 }}
[[contact]]
slave = "under.inner"
master = "two"
friction = {{ coefficients = 0.35 }}
[[step]]
name = "tighten"
increments = 2
displacement = {{ "over.start" = {{ y = 0 }} }}
traction = {{ "under.start" = {{ y = 1 }} }}
[[step]]
name = "turn"
increments = 4
motion = {{ one = {{ rz_deg = 20 }}, two = {{ rz_deg = -30 }} }}
"""


def two_drums(order: int, over: int, under: int) -> str:
    """The case, with so many cells along the arcs."""
    at = np.radians(ANGLE)
    out, along = np.array([np.cos(at), np.sin(at)]), np.array([-np.sin(at), np.cos(at)])
    left, lower = map(float, (RADII[0] + THICK) * out)
    x, y = map(float, (sum(RADII) + THICK) * out + 2.0 * along)
    return CASE.format(order=order, over=over, under=under, x=x, y=y, left=left, lower=lower)


@pytest.mark.parametrize(
    ("order", "cells"), [(1, (60, 40)), pytest.param(2, (30, 20), marks=pytest.mark.slow)]
)
def test_two_drums(order: int, cells: tuple[int, int], to_the_end: Callable[..., Any]) -> None:
    """Pulls of both ends in the last two increments, and their iterations."""
    run = to_the_end(two_drums(order, *cells))
    drums = [contact.name for contact in run.problem.contacts]
    grown = [sum(part.resultants[name][0][1] for name in drums) / THICK for part in run.accepted]
    shares = [m * r / (r + 0.5 * THICK) for m, r in zip(FRICTION, RADII, strict=True)]
    expected = np.exp(np.radians(ANGLE) * sum(shares))
    np.testing.assert_allclose(1.0 + np.array(grown[-2:]), expected, rtol=3e-3)
    assert max(part.iterations for part in run.accepted[-2:]) <= 2
