"""Faces of linear bodies that turn about an axis: their pressure acts on them like friction.

Linear bodies take forces where their nodes were. On a ring that has turned by w on its shaft the
pressure, along the radius to where a node is now, has the moment N r sin w about the axis where the
node was, like friction of sin w that drives it on.

Source: moments of the nodal forces about where nodes are and were. Requirement: the warning has
that coefficient, for the whole ring, a sector, and around an axis, and there is none at finite
strain, with large friction, or where a block is dragged far. Tolerance: the ring is widened by 1 %;
friction strains it, so that its inner face turns by up to 8 % less than the outer one.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from tests.verification.hard.case_texts import on_a_floor

from anisocontact.base.errors import RunWarning

ANGLE = 0.4
#: Way of the outer face by that angle.
SIDEWAYS = 1.5 * float(np.radians(ANGLE))

RING = """
title = "Ring turned on a shaft"
[idealisation]
kind = "{kind}"
{lateral}
{mesh}
[material.ring]
model = "{model}"
E = 1000
nu = 0.3
[surface.shaft]
shape = "cylinder"
point = [0, 0, 0]
axis = {axis}
radius = 1.01
[[contact]]
slave = "ring.{inner}"
master = "shaft"
friction = {{ coefficients = {friction} }}
{more}
[[step]]
name = "turn"
increments = 2
{turn}
"""
ANNULUS = """
[mesh.annulus.ring]
inner = 1
outer = 1.5
cells = [3, {around}]
{ends}
"""
SECTOR = """
[[cyclic]]
slave = "ring.end"
master = "ring.start"
sectors = 6
"""
RECTANGLE = """
[mesh.rectangle.ring]
origin = [1, 0]
size = [0.5, 0.2]
cells = [3, 1]
"""
PLANE = {
    "kind": "plane-strain",
    "lateral": "",
    "mesh": ANNULUS.format(around=48, ends=""),
    "axis": [0, 0, 1],
    "inner": "inner",
    "more": "",
    "turn": f'rotation = {{ "ring.outer" = {{ axis = [0, 0, 1], angle_deg = {ANGLE} }} }}',
}
ENDS = "start_deg = 0\nend_deg = 60"
AROUND = PLANE | {
    "kind": "axisymmetric",
    "lateral": "lateral = true",
    "mesh": RECTANGLE,
    "axis": [0, 1, 0],
    "inner": "left",
    "turn": f'displacement = {{ "ring.right" = {{ x = 0, y = 0, z = {SIDEWAYS} }} }}',
}
CASES = {
    "plane": PLANE,
    "sector": PLANE | {"mesh": ANNULUS.format(around=8, ends=ENDS), "more": SECTOR},
    "axisymmetric": AROUND,
}


def _told(found: list[Any]) -> list[str]:
    return [str(one.message) for one in found if "like friction" in str(one.message)]


@pytest.mark.parametrize("friction", [0.0, 0.03])
@pytest.mark.parametrize("shape", CASES)
def test_friction_that_is_not_there(
    shape: str, friction: float, to_the_end: Callable[..., Any]
) -> None:
    """Its coefficient, and what the nodal forces have of it."""
    given = CASES[shape] | {"model": "linear-elastic", "friction": friction}
    with pytest.warns(RunWarning, match=r"drives it on like friction of 0\.00"):
        run = to_the_end(RING.format(**given))
    (face,) = run.accepted[-1].faces[run.problem.contacts[0].name]
    assert face.friction == pytest.approx(np.sin(face.angle), rel=0.02)
    assert face.angle == pytest.approx(np.radians(ANGLE), rel=0.08 if friction else 0.03)
    assert face.share == pytest.approx(face.friction / friction if friction else np.inf, rel=0.02)
    if shape == "plane" and not friction:
        (contact,) = run.problem.contacts
        forces = np.zeros_like(run.problem.nodal)
        contact.add_force(forces)
        x = run.problem.model.positions
        were, are = (np.cross(at, forces)[:, 2].sum() for at in (x, x + run.problem.nodal))
        radii = np.hypot(*contact.points[:, :2].T)
        pressed = contact.last.pressure @ (contact.areas * radii)
        # the ring turns about +z
        assert (were - are) / pressed == pytest.approx(face.friction, rel=0.01)


@pytest.mark.parametrize(("model", "friction"), [("neo-hookean", 0.03), ("linear-elastic", 0.3)])
def test_nothing_to_be_told(model: str, friction: float, to_the_end: Callable[..., Any]) -> None:
    """At finite strain, and where friction is much larger."""
    with warnings.catch_warnings(record=True) as found:
        run = to_the_end(RING.format(**PLANE, model=model, friction=friction))
    assert not _told(found)
    assert not run.accepted[-1].faces


DRAGGED = """
[contact.friction]
coefficients = [0.3, 0.1]
directions = { kind = "constant", vector = [1, 0, 0], angle_deg = 30 }
[[step]]
name = "press"
increments = 1
displacement = { "block.top" = { x = 0, y = 0, z = -0.02 } }
[[step]]
name = "drag"
increments = 3
displacement = { "block.top" = { x = 5, y = 1 } }
"""


def test_block_dragged_far(to_the_end: Callable[..., Any]) -> None:
    """What is moved and not turned has no such arm."""
    run = to_the_end(on_a_floor("block", [1, 1, 0.5], [3, 3, 2], 1000, nu=0.3) + DRAGGED)
    assert not any(part.faces for part in run.accepted)


def test_shaft_is_held_back(to_the_end: Callable[..., Any]) -> None:
    """As the master, in a bush at finite strain."""
    text = RING.format(**PLANE, model="neo-hookean", friction=0.03)
    start, end = text.index("[surface.shaft]"), text.index("[[contact]]")
    shaft = ANNULUS.format(around=60, ends="").replace("ring", "shaft")
    shaft = shaft.replace("inner = 1\n", "inner = 0.5\n").replace("outer = 1.5", "outer = 1.01")
    material = '[material.shaft]\nmodel = "linear-elastic"\nE = 1000\nnu = 0.3\n'
    text = text[:start] + shaft + material + text[end:]
    text = text.replace('master = "shaft"', 'master = "shaft.outer"')
    text = text.replace('"ring.outer" = { axis', '"shaft.inner" = { axis')
    text += 'displacement = { "ring.outer" = { x = 0, y = 0 } }\n'
    with pytest.warns(RunWarning, match=r"'shaft', at small strain.*holds it back like"):
        run = to_the_end(text)
    (face,) = run.accepted[-1].faces[run.problem.contacts[0].name]
    assert not face.driven
    assert face.friction == pytest.approx(face.angle, rel=0.03)
