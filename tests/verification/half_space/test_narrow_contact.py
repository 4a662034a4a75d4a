"""Contacts narrower than two facets are told: pressures at their points are those of the mesh."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.bulk import make_material
from anisocontact.cli import main
from anisocontact.contact import Contact
from anisocontact.contact.narrow import NARROW, is_narrow
from anisocontact.laws import Friction
from anisocontact.mesh import BoxSpec, build_box
from anisocontact.results import Results
from anisocontact.rigid import MovingSurface, RigidBody
from anisocontact.solver import Problem, Solver, Step
from anisocontact.surfaces import make_surface

E, NU, RADIUS, FACET = 1000.0, 0.3, 10.0, 0.25


def test_pressures_of_hertz_are_off_where_it_says_so():
    """Requirement: told below a facet of radius, where the peak is 10 to 40 % off; not from 1.3 on.

    Source: Hertz, by the force that comes out, so that the size of the block hardly counts: a
    quarter of a ball on a quarter of a block, a node on its pole. Tolerance: 5 %, which is what the
    block and the facets that are resolved leave, measured 0.98 to 1.05.
    """
    model = build_box({"block": BoxSpec((0, 0, -2), (2, 2, 2), (8, 8, 5))})
    ball = RigidBody("ball", (0, 0, RADIUS))
    sphere = make_surface("sphere", centre=(0, 0, RADIUS), radius=RADIUS)
    smooth = Friction(coefficients=0.0)
    contact = Contact(model, "block.top", MovingSurface(sphere, ball), smooth)
    held = {"block.bottom": {"z": 0.0}, "block.left": {"x": 0.0}, "block.front": {"y": 0.0}}
    steel = {"block": make_material("linear-elastic", E=E, nu=NU)}
    steps = [
        Step("touch", 2, held, motion={"ball": {"z": -0.004}}),
        Step("press", 2, motion={"ball": {"z": -0.03}}),
    ]
    found = []
    for _ in Solver(Problem(model, steel, [contact]), steps).run():
        force = 4.0 * abs(contact.resultant()[0][2])
        radius = (0.75 * force * RADIUS * (1.0 - NU**2) / E) ** (1 / 3)
        peak = contact.last.pressure.max() / (1.5 * force / (np.pi * radius**2))
        found.append((radius / FACET, peak, is_narrow(contact)))
    for size, peak, narrow in found:
        assert narrow == (size < 1.2)
        assert 0.6 < peak < 0.91 if narrow else peak == pytest.approx(1.0, abs=0.05)
    assert [narrow for *_, narrow in found] == [True, True, False, False]


CASE = """
[mesh.box.block]
origin = [-1, -1, -1]
size = [2, 2, 1]
cells = [4, 4, 2]

[material.block]
model = "linear-elastic"
E = 1000
nu = 0.3

[surface.die]
shape = "sphere"
centre = [0, 0, 3]
radius = 3

[rigid.die]
reference = [0, 0, 3]

[[contact]]
slave = "block.top"
master = "die"
friction = { coefficients = 0.1 }

[[step]]
name = "press"
increments = 2
displacement = { "block.bottom" = { x = 0, y = 0, z = 0 } }
motion = { die = { z = DEEP } }

[[step]]
name = "lift"
increments = 2
motion = { die = { z = -0.002 } }

[output]
pictures = false
"""


@pytest.mark.parametrize(("deep", "narrow"), [("-0.01", True), ("-0.1", False)])
def test_a_run_says_so_of_contacts_that_never_were_wider(tmp_path, deep, narrow):
    """What is narrow at the beginning and at the end alone is worth no word."""
    path = tmp_path / "case.toml"
    path.write_text(CASE.replace("DEEP", deep))
    assert main(["run", str(path), "-o", str(tmp_path / "out")]) == 0
    summary = Results(tmp_path / "out").summary
    assert summary["contacts"][0]["narrow"] is narrow
    assert any(NARROW in line for line in summary["warnings"]) is narrow


PLANE = """
[idealisation]
kind = "plane-strain"

[mesh.rectangle.base]
origin = [0, 0]
size = [4, 1]
cells = [16, 4]

[mesh.rectangle.block]
origin = [1.5, 1]
size = [1, 1]
cells = [WIDE, 4]
BLOCK

[material.base]
model = "linear-elastic"
E = 1000
nu = 0.3

[material.block]
model = "linear-elastic"
E = 1000
nu = 0.3

[[contact]]
slave = "block.bottom"
master = "base.top"
friction = { coefficients = 0.1 }

[[step]]
name = "press"
increments = 1

[step.displacement]
"base.bottom" = { x = 0, y = 0 }
"block.top" = { x = 0, y = -0.002 }

[output]
pictures = false
"""


@pytest.mark.parametrize(
    ("tilt", "narrow"),
    [
        ("", False),
        ("rotate = { axis = [0, 0, 1], angle_deg = -5, point = [2.5, 1, 0] }", True),
    ],
    ids=["flat", "edge"],
)
def test_in_the_plane(tmp_path, tilt, narrow):
    """A block that lies on another one is not narrow, one that stands on an edge is."""
    path = tmp_path / "case.toml"
    path.write_text(PLANE.replace("WIDE", "4").replace("BLOCK", tilt))
    assert main(["run", str(path), "-o", str(tmp_path / "out")]) == 0
    assert Results(tmp_path / "out").summary["contacts"][0]["narrow"] is narrow
