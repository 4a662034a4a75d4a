"""Faces of rigid bodies in the case file: what is wrong in one line, a run that goes on."""

from __future__ import annotations

import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.cli import main
from anisocontact.results import Results

CASE = """
[mesh.box.pin]
origin = [0, 0, 0]
size = [1, 1, 1]
cells = [2, 2, 2]

[material.pin]
model = "neo-hookean"
E = 100
nu = 0.3

[surface.disc]
shape = "plane"
point = [0, 0, 0]
normal = [0, 0, 1]

[[contact]]
slave = "pin.bottom"
master = "disc"
normal = { penalty = 1e3 }
adhesion = { stiffness = 1e3 }
friction = { coefficients = 0.2 }

[rigid.head]
faces = ["pin.top"]
reference = [0.5, 0.5, 1]

[path.round]
kind = "circle"
radius = 0.5

[output]
pictures = false

[solver]
strategy = "direct"

[[step]]
name = "press"
increments = 1
motion = { head = { z = -0.01 } }

[[step]]
name = "load"
increments = 1
motion = { head = { z = "free" } }
load = { head = { z = -3 } }

[[step]]
name = "drag"
increments = 8
motion = { head = { path = "round", rz_deg = 20 } }
"""


@pytest.fixture
def case(tmp_path):
    """The case in a folder of its own."""
    path = tmp_path / "case.toml"
    path.write_text(CASE)
    return path


def test_a_run_goes_on_bit_by_bit(gone_on, case):
    """Requirement: a run that is stopped ends as one that was not; the load is carried."""
    whole, out = gone_on(case, 5)
    assert (whole / "history.csv").read_bytes() == (out / "history.csv").read_bytes()
    history = Results(whole).history
    force = [history[f"contacts.0.force.{axis}"][1:] for axis in "xyz"]
    assert force[2] == pytest.approx(3.0, rel=1e-7)
    for axis, own in zip("xy", force, strict=False):
        assert history[f"rigid.head.support_force.{axis}"][1:] == pytest.approx(-own, abs=1e-6)


def test_check_tells_of_the_faces(case, capsys):
    """Requirement: point, and what goes with it."""
    assert main(["check", str(case)]) == 0
    line = "rigid     head: reference point (0.5, 0.5, 1), free where a step frees it, with pin.top"
    assert line in capsys.readouterr().out


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        (
            'faces = ["pin.top"]',
            'faces = ["pin"]',
            'rigid.head.faces[0]: "pin" given, "body.group"',
        ),
        (
            'faces = ["pin.top"]',
            'faces = ["pin.tpo"]',
            "rigid.head.faces[0]: no facet group 'pin.tpo'",
        ),
        ('["pin.top"]', '["pin.top", "pin.top"]', 'rigid.head.faces[1]: "pin.top" given, it is'),
        (
            '["pin.top"]',
            '["pin.top", "pin.left"]',
            "rigid.head.faces[1]: 3 nodes of 'pin.left', which follows the rigid",
        ),
        ('faces = ["pin.top"]\n', "", "rigid.head: "),
        (
            "motion = { head = { z = -0.01 } }",
            'motion = { head = { z = -0.01 } }\ndisplacement = { "pin.left" = { x = 0 } }',
            "step 'press'.displacement: 3 nodes of 'pin.top', which follows the rigid body 'head',",
        ),
        (
            "z = -3",
            "x = -3",
            'the component is fixed; motion.head.x = "free" lets a load act',
        ),
    ],
)
def test_wrong_faces_are_one_line(refused, old, new, line):
    """Requirement: place, what was given, and what is allowed."""
    assert line in refused(CASE, old, new, 1)


RING = """
[idealisation]
kind = "axisymmetric"
lateral = true

[mesh.rectangle.pin]
origin = [0, 0]
size = [1, 1]
cells = [4, 4]

[material.pin]
model = "neo-hookean"
E = 100
nu = 0

[surface.disc]
shape = "plane"
point = [0, 0, 0]
normal = [0, 1, 0]

[[contact]]
slave = "pin.bottom"
master = "disc"
pass = "single"
method = "penalty"
normal = { penalty = 1e3 }
adhesion = { stiffness = 1e3 }
friction = { coefficients = 0.2 }

[rigid.head]
faces = ["pin.top"]
reference = [0, 1, 0]

[output]
pictures = false

[[step]]
name = "press"
increments = 1
motion = { head = { y = -0.01 } }

[[step]]
name = "load"
increments = 1
motion = { head = { y = "free" } }
load = { head = { y = -3 } }

[[step]]
name = "turn"
increments = 3
motion = { head = { ry_deg = 3 } }
"""


def test_a_turned_pin_of_revolution_goes_on_bit_by_bit(gone_on, tmp_path):
    """A pin under a force is turned on a plane until it slides, stopped and gone on with.

    Requirement: force and torque are those of the contact, the torque where all slides mu F 2/3 a;
    a run that is stopped ends as one that was not. Source: balance; mu p r summed over a disc, the
    pressure even as nu = 0. Tolerance: 1e-4 of the torque, as the shear of 0.004 at the edge brings
    a pressure G 0.004^2, 7e-4 of the mean.
    """
    path = tmp_path / "case.toml"
    path.write_text(RING)
    whole, out = gone_on(path, 4)
    assert (whole / "history.csv").read_bytes() == (out / "history.csv").read_bytes()
    history = Results(whole).history
    assert history["contacts.0.force.y"][1:] == pytest.approx(3.0, rel=1e-7)
    torque = history["rigid.head.support_moment.y"][2:]
    assert history["rigid.head.moment.y"][2:] == pytest.approx(-torque, rel=1e-9)
    assert torque[-1] == pytest.approx(0.2 * 3.0 * 2.0 / 3.0, rel=1e-4)
