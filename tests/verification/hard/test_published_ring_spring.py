"""A ring spring: four pairs of cones with friction, pressed and let go, its inner rings free.

Source: A. M. Wahl, Mechanical Springs (1963), on ring springs: cones at the angle a to the axis
that press rings of the sections A_o, A_i and mean radii r_o, r_i apart and together, each pair
closed by s, carry

    F = pi E s tan a tan(a +- arctan m) / (r_o / A_o + r_i / A_i) , pressed and let go.

Requirement: axial over radial force of every pair; F, as in one increment as in two; without a
cut, corrections of an increment, though four pairs of bodies that contact alone holds are on top
of each other. Tolerance: measured 1e-4 and 5e-4, as cones turn with their rings; 0.7 % as rings
are as thick as a fifth of their radius; 6 corrections.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.verification.hard.drawn import drawn

CONE, HALF, PITCH, BORE, WALL = float(np.tan(np.radians(14.0))), 4.0, 5.0, 20.0, 2.0
FRICTION, E, WAY = 0.15, 206e3, 0.2
RIM = BORE + PITCH * CONE  # of inner rings, which touch from 1 to 4 beside their middle
RADII = RIM - HALF * CONE - WALL, BORE + HALF * CONE + WALL
CLOSED = 4.0 * np.array([0.5, 1.0, 0.75, 0.5])

MATERIAL = """
[material.{0}]
model = "linear-elastic"
E = 206e3
nu = 0.3
"""
CONTACT = """
[[contact]]
slave = "{}"
master = "{}"
friction = {{ coefficients = 0.15 }}
"""
CASE = """
title = "Ring spring"
[idealisation]
kind = "axisymmetric"
[mesh]
file = "rings.msh"
{rest}
[[step]]
name = "press"
increments = {increments}
displacement = {{ "i0.end" = {{ y = 0 }}, "i2.end" = {{ y = -0.2 }} }}
[[step]]
name = "back"
increments = {increments}
displacement = {{ "i2.end" = {{ y = -0.1 }} }}
"""


def rings() -> dict[str, tuple[list[tuple[float, float]], dict[str, int]]]:
    """Corners of the rings, and which of their edges are cones or ends."""
    thin = RIM - HALF * CONE
    wide = BORE + HALF * CONE
    made: dict[str, tuple[list[tuple[float, float]], dict[str, int]]] = {}
    for name, y in (("o0", PITCH), ("o1", 3.0 * PITCH)):
        outside = [(wide, y - HALF), (RADII[1], y - HALF), (RADII[1], y + HALF), (wide, y + HALF)]
        made[name] = [(BORE, y), *outside], {"low": 0, "up": 4}
    for name, y, below, above in (("i0", 0.0, 0, 1), ("i1", 2.0 * PITCH, 1, 1), ("i2", 20.0, 1, 0)):
        low, up = y - below * HALF, y + above * HALF
        corners = [(RADII[0], low), *[(thin, low)] * below, (RIM, y), *[(thin, up)] * above]
        edges = {"low": below, "up": below + 1, "end": 0 if above else 2}
        kept = [key for key, there in (("low", below), ("up", above)) if there]
        kept += ["end"] * (below != above)
        made[name] = [*corners, (RADII[0], up)], {key: edges[key] for key in kept}
    return made


def mesh(path: Path) -> None:
    """Triangles; inner rings have facets an eighth longer, which do not match."""
    with drawn(path) as gmsh:
        geo, groups = gmsh.model.geo, []
        for name, (corners, edges) in rings().items():
            size = 1.0 if name[0] == "o" else 1.13
            points = [geo.addPoint(x, y, 0.0, size) for x, y in corners]
            lines = [geo.addLine(*ends) for ends in pairwise([*points, points[0]])]
            surface = geo.addPlaneSurface([geo.addCurveLoop(lines)])
            groups += [(2, surface, name)]
            groups += [(1, lines[edge], f"{name}.{key}") for key, edge in edges.items()]
        geo.synchronize()
        for dim, tag, name in groups:
            gmsh.model.addPhysicalGroup(dim, [tag], name=name)


@pytest.mark.parametrize(("swapped", "increments"), [(False, 2), (True, 2), (False, 1)])
def test_pressed_and_let_go(
    tmp_path: Path, to_the_end: Callable[..., Any], swapped: bool, increments: int
) -> None:
    """Forces of all pairs, and that of the spring."""
    mesh(tmp_path / "rings.msh")
    faces = [("o0.low", "i0.up"), ("o0.up", "i1.low"), ("o1.low", "i1.up"), ("o1.up", "i2.low")]
    rest = [MATERIAL.format(name) for name in rings()]
    rest += [CONTACT.format(*(pair[::-1] if swapped else pair)) for pair in faces]
    run = to_the_end(CASE.format(rest="".join(rest), increments=increments))
    assert not run.cuts
    assert max(part.iterations for part in run.accepted) <= 8
    thick = 2.0 * WALL + HALF * CONE  # of the area of half a section, over its half height
    middle = [
        0.5 * (RADII[0] + RIM - 0.5 * HALF * CONE),
        0.5 * (RADII[1] + BORE + 0.5 * HALF * CONE),
    ]
    soft = sum(middle) / (HALF * thick)
    steep, angle = np.arctan(FRICTION), np.arctan(CONE)
    for part in run.accepted:
        forces = np.array([force for force, _ in part.resultants.values()])
        pressed = part.step == "press"
        slope = np.tan(angle + steep if pressed else angle - steep)
        away = part.increment / increments
        closed = 0.25 * WAY * (away if pressed else 1.0 - 0.5 * away)
        np.testing.assert_allclose(
            np.abs(forces[:, 1] / forces[:, 0]), slope, rtol=3e-4 if pressed else 1e-3
        )
        force = np.pi * E * closed * CONE * slope / soft
        assert -part.reactions["i2.end"][1] == pytest.approx(force, rel=0.012)
