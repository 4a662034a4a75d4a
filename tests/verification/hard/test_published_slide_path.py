"""A block dragged across rings on a plate, free to give way sideways: the path that it takes.

Source: A. Zmitrowicz, Int. J. Solids Struct. 25 (1989) 837, on paths of bodies under friction that
is not alike in all directions; A. Konyukhov, P. Vielsack, K. Schweizerhof, Wear 264 (2008) 579, who
drag a block over rubber with ribs and follow its middle. The head of the block is moved along x and
free along y, on a spring or not. Where slip is along `-K T`, normal to an ellipse of the semi-axes
k_1 and k_2 across and along the rings, dy/dx is the direction in which the mean of T over the face
has no part along y but the force of the spring: a differential equation, integrated here. It has
only k_1 / k_2 in it where there is no spring, whatever the force is.

Requirement: the path that 24 and 48 increments extrapolate to; both errors, of first order;
corrections. Tolerance: measured 0.04 to 0.06 of a way of 18, of single runs 0.73 and 0.39; friction
is that at the end of an increment, so that a path that turns lags by half of one.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from anisocontact.case import load
from anisocontact.case.build import build

START, WAY, LOAD = (-9.0, 4.0), 18.0, 5.0

CASE = """
title = "Path over rings"
[mesh.box.block]
origin = [-9.5, 3.5, 0]
size = [1, 1, 0.2]
cells = [2, 2, 1]
[material.block]
model = "linear-elastic"
E = 1000
nu = 0.3
[surface.plate]
shape = "plane"
point = [0, 0, 0]
normal = [0, 0, 1]
[rigid.head]
faces = ["block.top"]
reference = [-9, 4, 0.2]
springs = {{ y = {spring} }}
[[contact]]
slave = "block.bottom"
master = "plate"
[contact.friction]
coefficients = {friction}
sliding_rule = "slip-ellipse"
slip_axes = {slip}
directions = {{ kind = "polar", axis = [[0, 0, 0], [0, 0, 1]] }}
[[step]]
name = "touch"
increments = 1
motion = {{ head = {{ z = -0.001 }} }}
[[step]]
name = "load"
increments = 1
motion = {{ head = {{ z = "free" }} }}
load = {{ head = {{ z = -5 }} }}
[[step]]
name = "drag"
increments = {increments}
motion = {{ head = {{ x = 18, y = "free" }} }}
"""

type Pair = tuple[float, float]


def path(friction: Pair, slip: Pair, spring: float, ways: Any) -> npt.NDArray[np.float64]:
    """How far the block has gone sideways after some ways."""
    nodes, weights = np.polynomial.legendre.leggauss(5)
    face = 0.5 * np.stack(np.meshgrid(nodes, nodes), -1).reshape(-1, 2)
    share = 0.25 * np.outer(weights, weights).ravel()

    def side(angle: float, middle: npt.NDArray[np.float64], held: float) -> float:
        across = (face + middle) / np.linalg.norm(face + middle, axis=1)[:, None]
        along = np.stack([-across[:, 1], across[:, 0]], axis=1)
        way = np.array([np.cos(angle), np.sin(angle)])
        first, second = -(slip[0] ** 2) * across @ way, -(slip[1] ** 2) * along @ way
        size = LOAD / np.hypot(first / friction[0], second / friction[1])
        return float(share @ (size * (first * across[:, 1] + second * along[:, 1])) - held)

    def slope(x: float, y: Any) -> list[float]:
        middle = np.add(START, [x, y[0]])
        return [float(np.tan(brentq(side, -1.5, 1.5, (middle, spring * y[0]), xtol=1e-12)))]

    found = solve_ivp(slope, (0.0, WAY), [0.0], t_eval=ways, rtol=1e-8, atol=1e-10)
    return np.asarray(found.y[0])


def dragged(text: str, folder: Path) -> tuple[npt.NDArray[np.float64], list[int]]:
    """Ways along x and y after each increment, and corrections."""
    file = folder / "case.toml"
    file.write_text(text)
    solver = build(load(file)).solver
    (head,) = solver.problem.rigid.bodies
    cuts: list[Any] = []
    found, taken = [], []
    for part in solver.run(on_cut=cuts.append):
        if part.step == "drag":
            found.append(head.accepted.translation[:2])
            taken.append(part.iterations)
    assert not cuts
    return np.array(found), taken


@pytest.mark.parametrize(
    ("friction", "slip", "spring"),
    [
        ((0.4, 0.2), (0.4, 0.2), 0.0),
        ((0.3, 0.3), (0.4, 0.2), 0.0),
        ((0.2, 0.4), (0.2, 0.4), 0.1),
    ],
)
def test_path(tmp_path: Path, friction: Pair, slip: Pair, spring: float) -> None:
    """Slip normal to the ellipse of friction; friction alike all ways, slip not; on a spring."""
    errors = []
    for increments in (24, 48):
        text = CASE.format(friction=[*friction], slip=[*slip], spring=spring, increments=increments)
        found, taken = dragged(text, tmp_path)
        assert taken[0] <= 15
        assert max(taken[1:]) <= 5
        errors.append(found[:, 1] - path(friction, slip, spring, found[:, 0]))
    coarse, fine = errors[0], errors[1][1::2]
    assert np.abs(2.0 * fine - coarse).max() < 0.08
    assert 0.4 < np.abs(coarse).max() < 1.2
    assert np.abs(coarse).max() / np.abs(fine).max() == pytest.approx(2.0, rel=0.15)
