"""A thin pad of rubber that is pressed between two plates and slips at its edges.

Source: J. M. Kelly, D. A. Konstantinidis, Mechanics of Rubber Bearings (2011), unbonded bearings,
from memory; the equations follow from squeezed layers: a pad of half-width a and thickness t, which
keeps its volume, in plane strain under the mean strain e has

    dp/dx = -2 q / t ,  q = 6 G e x / t where it sticks, x < c ,  q = m p where it slips,

and 4 G e at its edge: p = 4 G e exp(2 m (a - x) / t) out to c, and a parabola within,

    F = 2 (p(c) c + 4 G e c^3 / t^2) + 4 G e t (exp(2 m (a - c) / t) - 1) / m .

Requirement: force and edge of stick of pads ever thinner, with m a / t the same: the force comes to
that of a thin pad with the square of t / a; corrections. Tolerance: measured 4.4, 1.35 and 0.35 %
with a / t of 10, 20, 40, ratios of 3.3 and 3.9, cells of order 2; 1.5 % for 1.35 % with half their
size of order 1. The edge of stick is within a node, corrections are 7 to 9.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

SHEAR, STRAIN, OVER = 1.0, 1e-3, 2.0  # over: friction times half-width over thickness

CASE = f"""
title = "Unbonded pad"
symmetry = ["pad.left", "pad.bottom"]
[idealisation]
kind = "plane-strain"
[mesh.rectangle.pad]
origin = [0, 0]
size = [{{half}}, 0.5]
cells = {{cells}}
order = {{order}}
[material.pad]
model = "linear-elastic-incompressible"
E = {3.0 * SHEAR}
nu = 0.5
[surface.plate]
shape = "plane"
point = [0, 0.5, 0]
normal = [0, -1, 0]
[rigid.plate]
reference = [0, 0.5, 0]
[[contact]]
slave = "pad.top"
master = "plate"
friction = {{{{ coefficients = {{friction}} }}}}
[[step]]
name = "press"
increments = 1
motion.plate = {{{{ y = {-0.5 * STRAIN} }}}}
"""


def thin(half: float, friction: float) -> tuple[float, float]:
    """Force on the half to the right, and the edge of stick, of a thickness of 1."""
    edge = 4.0 * SHEAR * STRAIN

    def pressure(x: float) -> float:
        return float(edge * np.exp(2.0 * friction * (half - x)))

    def lacking(x: float) -> float:
        return 6.0 * SHEAR * STRAIN * x - friction * pressure(x)

    c = float(brentq(lacking, 0.0, half))
    outside = (pressure(c) - edge) / (2.0 * friction)
    return pressure(c) * c + edge * c**3 + outside, c


def test_pads_ever_thinner(to_the_end: Callable[..., Any]) -> None:
    """Force and edge of stick by the half-width."""
    off = []
    for half, per, order in ((10.0, 2, 2), (20.0, 2, 2), (40.0, 2, 2), (20.0, 4, 1)):
        friction, cells = OVER / half, [int(per * half), per]
        run = to_the_end(CASE.format(half=half, cells=cells, order=order, friction=friction))
        assert not run.cuts
        assert run.ends["press"].iterations <= 11
        force, c = thin(half, friction)
        off.append(-run.force("press")[1] / force - 1.0)
        (contact,) = run.problem.contacts
        assert abs(contact.points[contact.last.status == 1, 0].max() - c) < 0.5
    assert 0.0 < off[0] < 0.05
    assert 3.0 < off[0] / off[1] < 4.2
    assert 3.5 < off[1] / off[2] < 4.4
    assert off[3] == pytest.approx(off[1], abs=2e-3)
