"""A clamped strip buckles in a channel: its middle touches a wall, then presses it at one point.

Source: G. Domokos, P. Holmes, B. Royce, Constrained Euler buckling, J. Nonlinear Sci. 7 (1997) 281.
Between P1 = 4 pi^2 E' I / L^2 and 4 P1, where halves buckle on their own, each of them is a column
of the length l = L / 2, clamped at both ends, one of them beside the other by the height h of the
channel. With k^2 = P / E' I and w = A (1 - cos kx) + B (kx - sin kx), w(l) = h and w'(l) = 0,

    F = 2 E' I k^3 B ,    d = P L / E' t + integral of w'^2 over l ,

the force on the wall and the way of the ends towards each other.

Requirement: both by the load P, and corrections: all but one of the points that come to the wall
at once have to open. Tolerance: measured 0.5 and 0.4 %, a thickness of a hundredth of the length
and slopes of a tenth; 13 corrections in an increment at most, 40 where others are tried before
points close one at a time.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad

LENGTH, HEIGHT, MODULUS = 100.0, 3.0, 1e6
HALF, BENDING = LENGTH / 2.0, MODULUS / 12.0
FIRST = 4.0 * np.pi**2 * BENDING / LENGTH**2
#: Ways of the ends: before the middle touches, and in the end.
BENT, PUSHED = 0.15, 0.36

CASE = f"""
title = "Strip in a channel"
[idealisation]
kind = "plane-strain"
[mesh.rectangle.strip]
origin = [0, -0.5]
size = [{LENGTH}, 1]
cells = [40, 1]
order = 2
[material.strip]
model = "st-venant-kirchhoff"
E = 910e3
nu = 0.3
[surface.upper]
shape = "plane"
point = [0, {HEIGHT + 0.5}, 0]
normal = [0, -1, 0]
[surface.lower]
shape = "plane"
point = [0, -{HEIGHT + 0.5}, 0]
normal = [0, 1, 0]
[[contact]]
slave = "strip.top"
master = "upper"
friction = {{ coefficients = 0 }}
[[contact]]
slave = "strip.bottom"
master = "lower"
friction = {{ coefficients = 0 }}
[[step]]
name = "bend"
increments = 1
displacement = {{ "strip.left" = {{ x = 0, y = 0 }}, "strip.right" = {{ x = 0, y = 0 }} }}
body_force = {{ strip = {{ y = 0.1 }} }}
[[step]]
name = "buckle"
increments = 2
displacement = {{ "strip.right" = {{ x = -{BENT} }} }}
[[step]]
name = "let go"
increments = 1
body_force = {{ strip = {{ y = 0 }} }}
[[step]]
name = "push"
increments = 4
displacement = {{ "strip.right" = {{ x = -{PUSHED} }} }}
"""


def column(load: float) -> tuple[float, float, float]:
    """k, A and B of one half."""
    k = float(np.sqrt(load / BENDING))
    a, s, c = k * HALF, np.sin(k * HALF), np.cos(k * HALF)
    both = np.linalg.solve([[1.0 - c, a - s], [s, 1.0 - c]], [HEIGHT, 0.0])
    return k, float(both[0]), float(both[1])


def way(load: float) -> float:
    """By which the ends have come towards each other."""
    k, a, b = column(load)
    slope = quad(lambda x: (k * (a * np.sin(k * x) + b * (1.0 - np.cos(k * x)))) ** 2, 0.0, HALF)
    return load * LENGTH / MODULUS + float(slope[0])


def test_strip_in_a_channel(to_the_end: Callable[..., Any]) -> None:
    """Way and force on the wall, by the load that holds the ends; the other wall is not touched."""
    run = to_the_end(CASE)
    assert not run.cuts
    upper, lower = (contact.name for contact in run.problem.contacts)
    pushes = [part for part in run.accepted if part.step == "push"]
    assert max(part.iterations for part in pushes) <= 20
    for part in pushes[-2:]:
        load, force = -part.reactions["strip.right"][0], -part.resultants[upper][0][1]
        assert FIRST < load < 4.0 * FIRST
        k, _, b = column(load)
        assert way(load) == pytest.approx(BENT + (PUSHED - BENT) * part.increment / 4, rel=6e-3)
        assert force == pytest.approx(2.0 * BENDING * k**3 * b, rel=8e-3)
        assert not part.resultants[lower][0].any()
