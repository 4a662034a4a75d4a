"""A blade whose flanks are steep: they face what they cut by 75 degrees, and have to meet it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.verification.hard.drawn import drawn

gmsh = pytest.importorskip("gmsh")

DEPTH = 0.3

CASE = """
[idealisation]
kind = "plane-strain"
[mesh]
file = "blade.msh"
[material.blade]
model = "neo-hookean"
E = 20000
nu = 0.3
[material.base]
model = "neo-hookean"
E = 100
nu = 0.3
[[contact]]
slave = "SLAVE"
master = "MASTER"
friction = { coefficients = 0.1 }
[[step]]
name = "cut"
increments = 10
displacement = { "base.bottom" = { x = 0, y = 0 }, "blade.back" = { x = 0, y = -0.3 } }
"""


def _polygon(name: str, corners: list[tuple[float, float]], size: float, *sides: str) -> None:
    """A body with the sides named in turn."""
    shapes = gmsh.model.geo
    points = [shapes.addPoint(x, y, 0, size) for x, y in corners]
    lines = [shapes.addLine(*ends) for ends in zip(points, points[1:] + points[:1], strict=True)]
    surface = shapes.addPlaneSurface([shapes.addCurveLoop(lines)])
    shapes.synchronize()
    gmsh.model.addPhysicalGroup(2, [surface], name=name)
    for side in dict.fromkeys(sides):
        own = [line for line, of in zip(lines, sides, strict=True) if of == side]
        gmsh.model.addPhysicalGroup(1, own, name=side)


def _blade(path: Path, half_angle: float) -> None:
    with drawn(path):
        wide = 2.0 * np.tan(np.radians(half_angle))
        _polygon("blade", [(0, 0), (wide, 2), (-wide, 2)], 0.12, "flanks", "back", "flanks")
        low, high = [(-3, -2), (3, -2)], [(3, 0), (-3, 0)]
        _polygon("base", low + high, 0.15, "bottom", "right", "top", "left")


@pytest.mark.parametrize("half_angle", [15.0, 50.0])
@pytest.mark.parametrize("sides", [("base.top", "blade.flanks"), ("blade.flanks", "base.top")])
def test_blade(
    half_angle: float, sides: tuple[str, str], tmp_path: Path, to_the_end: Callable[..., Any]
) -> None:
    """A blade is pressed into a soft base, both as the slave.

    Requirement: the base goes down with the tip, within a third of a facet of 0.15, and bears a
    force. Source: bodies do not pass through each other; the flanks are no edge beside a face that
    faces the base better, so that what stands steeply counts as well.
    """
    _blade(tmp_path / "blade.msh", half_angle)
    run = to_the_end(CASE.replace("SLAVE", sides[0]).replace("MASTER", sides[1]), most=6000)
    (contact,) = run.problem.contacts
    top = run.problem.model.facet_nodes("base.top")
    lowest = run.problem.nodal[top, 1].min()
    assert lowest == pytest.approx(-DEPTH, abs=0.05)
    assert abs(contact.resultant()[0][1]) > 10.0
