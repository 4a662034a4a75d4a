"""A rigid ball that rolls on a block with a little creep along and across its way, and spin.

Source: J. J. Kalker, On the rolling contact of two elastic bodies in the presence of dry friction
(1967): as long as hardly anything slips the forces are linear in creepages xi, eta and spin phi,

    F_x = -G a^2 C_11 xi ,  F_y = -G a^2 (C_22 eta + C_23 a phi) ,

of equal bodies in a round contact with nu = 0.25: C = 4.12, 3.67, 1.47; spin pushes sideways
[Johnson 1958]. The ball starts from rest, so that its forces grow over some radii of the contact:
here they are computed by steps of the half space, with tractions that are constant on squares and
carry its surface along with the ball [Kalker 1990, ch. 4], on a lattice in the disc of the area of
the contact. One half space gives half as much as two do, which the coefficients check.

Pressed by its radius of contact over a thousand, incompressible, so that pressing does not shear;
rolled by 2 a with creepages and spin of 1e-4, a node an increment.

Requirement: both forces in every increment, over those at the end; all but a few nodes stick; no
cut; corrections. Tolerance: measured 1.1 and 3.4 % with four facets of order 1 across the radius,
1.5 and 1.3 % with two of order 2; three to five corrections, 8 in one increment.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.linalg import lu_factor, lu_solve
from tests.verification.hard.drawn import graded

RADIUS, SIZE, WAY, CREEP, DEPTH = 1000.0, 12.0, 2.0, 1e-4, 1e-3

CASE = """
title = "Rolling ball"
[mesh.box.block]
origin = [{start}, {start}, {start}]
size = [{long}, {long}, {high}]
cells = {cells}
planes_x = {x}
planes_y = {y}
planes_z = {z}
order = {order}
[material.block]
model = "linear-elastic-incompressible"
E = 3
nu = 0.5
[surface.ball]
shape = "sphere"
centre = [0, 0, 1000]
radius = 1000
[rigid.ball]
reference = [0, 0, 1000]
[[contact]]
slave = "block.top"
master = "ball"
friction = {{ coefficients = 10 }}
[[step]]
name = "press"
increments = 1
displacement = {{ "block.bottom" = {{ x = 0, y = 0, z = 0 }} }}
motion.ball = {{ z = {depth} }}
[[step]]
name = "roll"
increments = {increments}
[step.rotation.ball]
axis = {axis}
angle_deg = {angle!r}
point = [0, 0, {height!r}]
move = {move}
"""


def tractions(kind: int, x: np.ndarray, y: np.ndarray, h: float, nu: float) -> np.ndarray:
    """2 pi G u at (x, y) of a square of the traction 1 [Johnson 1985, sec. 3.6].

    Args:
        kind: 0: u_x of q_x; 1: u_x of q_y and u_y of q_x; 2: u_y of q_y.
    """
    total = np.zeros_like(x)
    for along in (h / 2.0, -h / 2.0):
        for across in (h / 2.0, -h / 2.0):
            p, q = x + along, y + across
            r = np.hypot(p, q)
            one, other = q * np.log(p + r), p * np.log(q + r)
            both = (one + (1.0 - nu) * other, -nu * r, other + (1.0 - nu) * one)
            total += np.sign(along * across) * both[kind]
    return total


def rolled(count: int, way: float, creep: np.ndarray, a: float, nu: float) -> np.ndarray:
    """Way, F_x and F_y on the half space after each step of a square, for G = 1.

    Args:
        count: Squares across the radius.
        way: How far the ball rolls.
        creep: What its surface gains on that below it in a unit of way: along, across, spin.
        a: Radius of the contact.
        nu: Poisson's ratio.
    """
    lattice = np.arange(-count, count + 1)
    i, j = (k.ravel() for k in np.meshgrid(lattice, lattice))
    inside = np.hypot(i, j) < count
    h = a * np.sqrt(np.pi / inside.sum())
    x, y = h * i[inside], h * j[inside]

    def given(ahead: float) -> np.ndarray:
        """Displacement at squares, or so far ahead of them, of all tractions."""
        at = (x[:, None] - x + ahead, y[:, None] - y, h, nu)
        xx, xy, yy = (tractions(kind, *at) for kind in range(3))
        return np.block([[xx, xy], [xy, yy]]) / (2.0 * np.pi)

    carried = h * np.concatenate([creep[0] - creep[2] * y, creep[1] + creep[2] * x])
    now, before = lu_factor(given(0.0)), given(h)
    q, rows = np.zeros(2 * len(x)), []
    for step in range(1, round(way / h) + 2):
        q = lu_solve(now, before @ q + carried)
        rows.append([step * h, *(h * h * q.reshape(2, -1).sum(axis=1))])
    return np.array(rows)


def test_coefficients() -> None:
    """Kalker's, of steady rolling; spin, whose tractions are at the edge, has a larger error."""
    for creep, part, coefficient, error in (
        ((1.0, 0.0, 0.0), 1, 4.12, 0.01),
        ((0.0, 1.0, 0.0), 2, 3.67, 0.02),
        ((0.0, 0.0, 1.0), 2, 1.47, 0.06),
    ):
        force = rolled(9, 5.0, np.array(creep), 1.0, 0.25)[-1, part]
        assert force / 2.0 == pytest.approx(coefficient, rel=error)


def places(facets: int, end: float, growth: float) -> np.ndarray:
    """Nodes from -SIZE to SIZE, even around the contact up to an end."""
    away = (SIZE - end) * graded(facets, 0, SIZE - end, growth)
    even = np.arange(round((end + 1.25) * facets) + 1) / facets - 1.25
    back = (SIZE - 1.25) * graded(facets, 0, SIZE - 1.25, growth)
    return np.concatenate([-1.25 - back[:0:-1], even, end + away[1:]])


@pytest.mark.slow
@pytest.mark.parametrize(
    ("facets", "order", "along", "across"), [(4, 1, 0.02, 0.05), (2, 2, 0.025, 0.025)]
)
def test_forces(
    to_the_end: Callable[..., Any], facets: int, order: int, along: float, across: float
) -> None:
    """Forces along and across the way, in every increment."""
    growth = 1.5 if order == 1 else 2.0
    x, y = places(facets, 1.25 + WAY, growth), places(facets, 1.25, growth)
    z = 1.0 - graded(facets, facets // 2 + 1, SIZE, growth)[::-1]
    turn = np.array([0.0, (1.0 + CREEP) * WAY / RADIUS, CREEP * WAY])
    angle = float(np.linalg.norm(turn))
    increments = round(WAY * facets * order)
    text = CASE.format(
        start=-SIZE,
        long=2.0 * SIZE,
        high=SIZE,
        cells=[len(x) - 1, len(y) - 1, len(z) - 1],
        x=((x + SIZE) / (2.0 * SIZE)).tolist(),
        y=((y + SIZE) / (2.0 * SIZE)).tolist(),
        z=z.tolist(),
        order=order,
        depth=-DEPTH,
        increments=increments,
        axis=(turn / angle).tolist(),
        angle=float(np.degrees(angle)),
        height=RADIUS - DEPTH,
        move=[WAY, CREEP * WAY, 0.0],
    )
    run = to_the_end(text, most=60_000)
    assert not run.cuts
    assert run.ends["press"].iterations <= 9
    assert max(part.iterations for part in run.accepted if part.step == "roll") <= 10
    (contact,) = run.problem.contacts
    status = contact.last.status[contact.last.pressure > 0.0]
    assert np.mean(status == 1) > 0.9
    a = (0.75 * -run.force("press")[2] * RADIUS / 4.0) ** (1.0 / 3.0)
    assert a == pytest.approx(1.0, abs=0.05)
    exact = rolled(12, WAY, CREEP * np.array([-1.0, 1.0, 1.0]), a, 0.5)
    forces = [part.resultants[contact.name][0] for part in run.accepted if part.step == "roll"]
    ways = WAY * np.arange(1, increments + 1) / increments
    for part, most in ((0, along), (1, across)):
        sought = np.interp(ways, exact[:, 0], exact[:, part + 1])
        error = (np.array(forces)[:, part] - sought) / sought[-1]
        assert np.abs(error).max() < most
