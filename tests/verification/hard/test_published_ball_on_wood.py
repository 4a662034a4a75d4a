"""A rigid ball pressed on a body whose fibres lie in its surface: an ellipse of contact.

Source: J. R. Willis, Hertzian contact of anisotropic bodies, J. Mech. Phys. Solids 14 (1966) 163;
S. R. Swanson, Int. J. Solids Struct. 41 (2004) 1945. A force of 1 on the surface depresses a place
at the distance r and the angle q by `h(q) / r`, `2 pi h` the normal part of the inverse of Barnett
and Lothe's tensor L for a line along q, here by its integral over the directions across that line.
Along a line a pressure `p0 sqrt(1 - x^2 / a^2 - y^2 / b^2)` integrates to `pi / 2` times a square,
so that it depresses its ellipse, with `c = (cos q / a)^2 + (sin q / b)^2`, by

    pi / 2 p0 int_0^pi h (1 - ((x sin q - y cos q) / a b)^2 / c) dq / sqrt(c) ,

which is a ball where the terms of x^2 and y^2 are alike.

Requirement: pressure at all nodes within 0.84 of the ellipse, over the largest, and the root mean
square of its error; the axes are 1 and 0.868; corrections. Tolerance: measured 1.6 and 0.57 % with
six facets of order 1 across the longer axis, 0.58 and 0.27 % with eight (2.5 and 0.98 % with five):
it depends on where the edge lies in a facet. A circle of the same area and force would be off by 7
to 10 %. 6 corrections.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from scipy.optimize import brentq
from tests.verification.hard.drawn import graded

type Floats = npt.NDArray[np.float64]

ALONG, ACROSS, NU_ALONG, NU_ACROSS, SHEAR = 20e3, 1e3, 0.3, 0.4, 600.0
RADIUS, SIZE = 1000.0, 12.0

CASE = f"""
title = "Ball on wood"
[mesh.box.block]
origin = [0, 0, -{SIZE}]
size = [{SIZE}, {SIZE}, {SIZE}]
cells = {{cells}}
planes_x = {{across}}
planes_y = {{across}}
planes_z = {{down}}
[material.block]
model = "transversely-isotropic"
E_along = {ALONG}
E_across = {ACROSS}
nu_along = {NU_ALONG}
nu_across = {NU_ACROSS}
G_along = {SHEAR}
along = [1, 0, 0]
[surface.ball]
shape = "sphere"
centre = [0, 0, {RADIUS}]
radius = {RADIUS}
[rigid.ball]
reference = [0, 0, {RADIUS}]
[[contact]]
slave = "block.top"
master = "ball"
friction = {{{{ coefficients = 0 }}}}
[[step]]
name = "touch"
increments = 1
motion.ball = {{{{ z = -0.0005 }}}}
[step.displacement]
"block.bottom" = {{{{ x = 0, y = 0, z = 0 }}}}
"block.left" = {{{{ x = 0 }}}}
"block.front" = {{{{ y = 0 }}}}
[[step]]
name = "press"
increments = 1
motion.ball = {{{{ z = "free" }}}}
load.ball = {{{{ z = {{load!r}} }}}}
"""


def stiffness() -> Floats:
    """C_ijkl of the body."""
    normal = np.diag([1.0 / ALONG, 1.0 / ACROSS, 1.0 / ACROSS])
    normal[0, 1:] = normal[1:, 0] = -NU_ALONG / ALONG
    normal[1, 2] = normal[2, 1] = -NU_ACROSS / ACROSS
    shears = {(1, 2): 0.5 * ACROSS / (1.0 + NU_ACROSS), (0, 2): SHEAR, (0, 1): SHEAR}
    found = np.zeros((3, 3, 3, 3))
    found += np.einsum("ik,ij,kl->ijkl", np.linalg.inv(normal), np.eye(3), np.eye(3))
    for (i, j), modulus in shears.items():
        for place in ((i, j, i, j), (i, j, j, i), (j, i, i, j), (j, i, j, i)):
            found[place] = modulus
    return found


def compliance(angle: float, whole: Floats) -> float:
    """h at an angle to the fibres."""
    side, down = np.array([-np.sin(angle), np.cos(angle), 0.0]), np.array([0.0, 0.0, 1.0])
    turns = (np.arange(200) + 0.5) * np.pi / 200
    inverse, mixed = np.zeros((3, 3)), np.zeros((3, 3))
    for c, s in zip(np.cos(turns), np.sin(turns), strict=True):
        m, n = c * side + s * down, c * down - s * side
        one = np.linalg.inv(np.einsum("ijkl,j,l->ik", whole, n, n))
        inverse += one / 200
        mixed -= one @ np.einsum("ijkl,j,l->ik", whole, m, n).T / 200
    tensor = np.linalg.inv(inverse) @ (np.eye(3) + mixed @ mixed)
    return float(np.linalg.inv(tensor)[2, 2] / (2.0 * np.pi))


def ellipse() -> tuple[float, float]:
    """Shorter axis, along the fibres, and largest pressure where the longer axis is 1."""
    angles, whole = (np.arange(90) + 0.5) * np.pi / 90, stiffness()
    h = np.array([compliance(angle, whole) for angle in angles])

    def sums(a: float) -> tuple[float, float]:
        weight = h * np.pi / 90 / a**2 / (np.cos(angles) ** 2 / a**2 + np.sin(angles) ** 2) ** 1.5
        return float(weight @ np.sin(angles) ** 2), float(weight @ np.cos(angles) ** 2)

    a = float(brentq(lambda a: sums(a)[0] - sums(a)[1], 0.3, 1.5))
    return a, 1.0 / (np.pi * RADIUS * sums(a)[0])


@pytest.mark.parametrize(
    ("facets", "most", "mean"),
    [(6, 0.02, 0.008), pytest.param(8, 0.01, 0.004, marks=pytest.mark.slow)],
)
def test_pressure(to_the_end: Callable[..., Any], facets: int, most: float, mean: float) -> None:
    """A quarter, at the nodes."""
    across = graded(facets, round(1.5 * facets), SIZE, growth=1.5)
    down = 1.0 - graded(facets, facets, SIZE, growth=1.5)[::-1]
    a, largest = ellipse()
    text = CASE.format(
        cells=[len(across) - 1, len(across) - 1, len(down) - 1],
        across=across.tolist(),
        down=down.tolist(),
        load=float(-np.pi / 6.0 * largest * a),
    )
    run = to_the_end(text, most=30_000)
    assert not run.cuts
    assert max(part.iterations for part in run.accepted) <= 7
    (contact,) = run.problem.contacts
    place = (contact.points[:, 0] / a) ** 2 + contact.points[:, 1] ** 2
    error = contact.last.pressure / largest - np.sqrt(np.maximum(1.0 - place, 0.0))
    assert a == pytest.approx(0.868, abs=1e-3)
    assert np.abs(error[place < 0.7]).max() < most
    assert np.sqrt(np.mean(error[place < 0.7] ** 2)) < mean
