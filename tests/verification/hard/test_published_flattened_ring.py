"""A thin ring flattened between two plates: contact in two points that move apart.

Source: R. Frisch-Fay, Flexible Bars (1962), the elastica between plates. Until the ring has no
curvature below the plate it touches in one point; then a flat piece lies there, and forces are at
its two ends, where each quarter is a rectangular elastica: with G = 2.622058 and H = 1.198140, the
integrals of sin^(-1/2) and of sin^(1/2) over a right angle, half the height of the middle line is h
and the force on a unit of depth

    F = E' t^3 / 12 (H / h)^2 ,    from  h = H pi R / 2 G  on.

Requirement: the force in every increment from there on, and corrections: what the plate touches is
the two points, and the flat piece between them presses nothing. Tolerance: measured 0.06 %, a
thickness of 1 / 50 of the radius; 143 corrections.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

RADIUS, THICK, E, NU, WAY, INCREMENTS = 10.0, 0.2, 910.0, 0.3, 6.0, 5
G, H = 2.6220575543, 1.1981402347

CASE = f"""
title = "Flattened ring"
symmetry = ["ring.start", "ring.end"]
[idealisation]
kind = "plane-strain"
[mesh.annulus.ring]
inner = 9.9
outer = 10.1
start_deg = 0
end_deg = 90
cells = [1, 48]
order = 2
[material.ring]
model = "neo-hookean"
E = {E}
nu = {NU}
[surface.plate]
shape = "plane"
point = [0, 10.1, 0]
normal = [0, -1, 0]
[rigid.plate]
reference = [0, 10.1, 0]
[[contact]]
slave = "ring.outer"
master = "plate"
friction = {{ coefficients = 0 }}
[[step]]
name = "flatten"
increments = {INCREMENTS}
motion.plate = {{ y = -{WAY} }}
"""


def test_flattened_ring(to_the_end: Callable[..., Any]) -> None:
    """Force of the ring, twice that of its quarter, and all corrections."""
    run = to_the_end(CASE)
    assert not run.cuts
    (contact,) = run.problem.contacts
    force = 2.0 * np.array([-part.resultants[contact.name][0][1] for part in run.accepted])
    height = RADIUS - WAY * np.arange(1, INCREMENTS + 1) / INCREMENTS
    flat = height < 0.5 * np.pi * RADIUS * H / G
    assert flat.sum() >= 3
    stiffness = E * THICK**3 / (12.0 * (1.0 - NU**2))
    assert force[flat] == pytest.approx(stiffness * (H / height[flat]) ** 2, rel=2e-3)
    # between the two points the ring presses nothing
    apart = 0.5 * np.pi * RADIUS - G * height[-1] / H
    inside = contact.points[:, 0] < apart - 0.5
    weights = contact.last.pressure / contact.last.pressure.sum()
    assert weights[inside].sum() < 0.01
    assert sum(part.iterations for part in run.accepted) <= 160
