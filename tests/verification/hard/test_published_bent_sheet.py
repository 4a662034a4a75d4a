"""A sheet bent between a punch and round shoulders, as in unconstrained cylindrical bending.

Source: the set-up of NUMISHEET 2002 (NAFEMS R0094, 3), with a sheet that stays elastic; forces by
the elastica over two supports [Frisch-Fay 1962]. From the shoulder, which carries `N (n + mu t)` at
the slope theta of the sheet, on a circle of its radius and half of the thickness, the sheet turns
inwards with

    E' I dtheta/ds = - (r_c - r) x N (n + mu t)    until theta = 0, which is to be at x = 0.

Requirement: force of the punch at each of eight increments, up to a slope of 41 degrees, and at
most 14 corrections in each (it was 25 in the first one): the sheet is free to move, one node
carries it on each side, and moves on over the shoulder. The node in the plane of symmetry, under
the punch, does not slip: its friction is nothing. Tolerance: 2 % of the largest force (measured
1.1, 0.6, 1.6 %): the node on the shoulder is up to half of a facet beside the place where the sheet
would be, and one that comes down has to slip before all of its friction acts.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from anisocontact.base.array_types import Floats

E, NU, HALF, SHOULDER, RADIUS, WAY = 70e3, 0.3, 60.0, 29.0, 4.0, 14.4
BENDS = E / (1.0 - NU**2) / 12.0

CASE = f"""
title = "Sheet bent over shoulders"
symmetry = ["sheet.left"]
[idealisation]
kind = "plane-strain"
[mesh.rectangle.sheet]
origin = [0, 0]
size = [{HALF}, 1]
cells = [{{cells}}, 2]
order = 2
[material.sheet]
model = "neo-hookean"
E = {E}
nu = {NU}
[surface.shoulder]
shape = "cylinder"
point = [{SHOULDER}, -{RADIUS}, 0]
axis = [0, 0, 1]
radius = {RADIUS}
[surface.punch]
shape = "cylinder"
point = [0, 6, 0]
axis = [0, 0, 1]
radius = 5
[rigid.punch]
reference = [0, 6, 0]
[[contact]]
slave = "sheet.top"
master = "punch"
friction = {{{{ coefficients = {{mu}} }}}}
[[contact]]
slave = "sheet.bottom"
master = "shoulder"
friction = {{{{ coefficients = {{mu}} }}}}
[[step]]
name = "form"
increments = 8
motion = {{{{ punch = {{{{ y = -{WAY} }}}} }}}}
"""


def middle(slope: float, normal: float, mu: float) -> tuple[Floats, float]:
    """Where the sheet is horizontal, (2,), and the vertical force of the shoulder."""
    n = np.array([-np.sin(slope), np.cos(slope)])
    force = normal * (n + mu * np.array([np.cos(slope), np.sin(slope)]))
    at = np.array([SHOULDER, -RADIUS]) + (RADIUS + 0.5) * n

    def inwards(_: float, y: Floats) -> list[float]:
        arm = at - y[:2]
        turn = -(arm[0] * force[1] - arm[1] * force[0]) / BENDS
        return [-np.cos(y[2]), -np.sin(y[2]), turn]

    def horizontal(_: float, y: Floats) -> float:
        return float(y[2])

    horizontal.terminal = True  # type: ignore[attr-defined]
    way = solve_ivp(inwards, [0.0, 99.0], [*at, slope], events=horizontal, rtol=1e-9, atol=1e-9)
    return way.y[:2, -1], force[1]


def vertical(way: float, mu: float) -> float:
    """Force of the punch on half of the sheet where it has moved by a way."""

    def state(slope: float) -> tuple[float, float]:
        normal = brentq(lambda size: middle(slope, size, mu)[0][0], 1.1 * slope, 40.0 * slope)
        found, force = middle(slope, normal, mu)
        return 0.5 - found[1], force

    slope = brentq(lambda angle: state(angle)[0] - way, 0.05, 0.9)
    return state(slope)[1]


@pytest.mark.parametrize(("mu", "cells"), [(0.0, 60), (0.1342, 60), (0.3, 120)])
def test_sheet(to_the_end: Callable[..., Any], mu: float, cells: int) -> None:
    """Forces of all increments, corrections, and no friction in the plane of symmetry."""
    run = to_the_end(CASE.format(mu=mu, cells=cells), most=4000)
    assert not run.cuts
    assert max(one.iterations for one in run.accepted) <= 14
    forces = [one.resultants["sheet.top on punch"][0] for one in run.accepted]
    assert np.abs([force[0] for force in forces]).max() <= 1e-12
    expected = [vertical(WAY * (i + 1) / 8.0, mu) for i in range(8)]
    assert [-force[1] for force in forces] == pytest.approx(expected, abs=0.02 * max(expected))
