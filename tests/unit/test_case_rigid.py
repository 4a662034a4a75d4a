"""Rigid bodies in a case file: what a step moves, and what is refused in one line."""

from __future__ import annotations

import json
import tomllib

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.case.build import build
from anisocontact.case.read import CaseError, load, validate
from anisocontact.cli import main
from anisocontact.results import Results
from anisocontact.solver import StoppedError

RIGID = """
[rigid.plate]
reference = [0.5, 0.5, 0]
springs = { x = 20, rz = 3 }

[[contact]]"""
MOTION = """
motion = { plate = { z = 0.01 } }

[[step]]
name = "drag"
increments = 4
motion = { plate = { x = "free", rz_deg = 5 } }
load = { plate = { x = 2 } }
"""


@pytest.fixture
def rigid_text(case_text: str) -> str:
    """The small block, its plate a rigid body that presses, is pulled and turned."""
    start, end = (
        case_text.index("z = -0.01 } }") + len("z = -0.01 } }"),
        case_text.index("[output]"),
    )
    text = case_text[:start].replace("z = -0.01", "z = 0") + MOTION + case_text[end:]
    return text.replace("\n[[contact]]", RIGID, 1)


def test_run(rigid_text, tmp_path, capsys):
    """From file to history, summary and report."""
    case = tmp_path / "case.toml"
    case.write_text(rigid_text)
    assert main(["check", str(case)]) == 0
    assert "rigid     plate: reference point (0.5, 0.5, 0), free where" in capsys.readouterr().out
    assert main(["run", str(case), "-o", str(tmp_path / "out")]) == 0
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    plate = summary["rigid"]["plate"]
    assert plate["turn"] == pytest.approx([0, 0, np.radians(5.0)])
    assert plate["position"][2] == 0.01
    # pulled by 2, held by contact and spring
    assert plate["force"][0] + 2.0 == pytest.approx(20.0 * plate["translation"][0], rel=1e-6)
    assert plate["support_force"][2] == pytest.approx(-plate["force"][2], rel=1e-9)
    assert np.allclose(plate["force"], np.negative(summary["contacts"][0]["force"]), rtol=1e-9)
    assert summary["energy"]["springs"] > 0.0
    history = Results(tmp_path / "out").history
    assert history["rigid.plate.translation.x"][-1] == plate["translation"][0]
    patch = Results(tmp_path / "out").surfaces()
    assert patch.bounds[4:] == pytest.approx([0.01, 0.01])
    marks = patch.point_data["direction_friction_1"]
    assert np.allclose(marks, [np.cos(plate["turn"][2]), np.sin(plate["turn"][2]), 0.0])
    report = (tmp_path / "out" / "report.html").read_text()
    assert "Rigid bodies at the end" in report
    assert "picture" not in (tmp_path / "out" / "run.log").read_text()


def test_one_body_of_two_surfaces_and_any_axis(rigid_text, tmp_path):
    """`surfaces` names several; `rotation` leads the body about any axis."""
    text = rigid_text.replace("springs = {", 'surfaces = ["plate"]\nsprings = {')
    turn = "rotation = { plate = { axis = [0, 3, 4], angle_deg = 10, point = [0, 0, 1] } }"
    case = tmp_path / "case.toml"
    case.write_text(
        text.replace("\n[output]", f'\n[[step]]\nname = "t"\nincrements = 1\n{turn}\n[output]')
    )
    built = build(load(case))
    assert [body.name for body in built.problem.rigid.bodies] == ["plate"]
    turned = built.steps[2].rotation["plate"]
    assert turned.vector == pytest.approx(np.radians(10.0) * np.array([0.0, 0.6, 0.8]))
    assert turned.point == (0.0, 0.0, 1.0)


WRONG = [
    ("motion = { plate = { z", "motion = { plat = { z", "step[0].motion", 'did you mean "plate"?'),
    ("load = { plate", "load = { plat", "step[1].load", 'did you mean "plate"?'),
    ("[rigid.plate]", "[rigid.die]", "rigid.die", '"die" is no surface'),
    ("reference = [0.5, 0.5, 0]\n", "", "rigid.plate.reference", "missing"),
    ("reference = [0.5, 0.5, 0]", "reference = [0, 1]", "rigid.plate.reference", "three"),
    ("reference", "referenc", "rigid.plate.referenc", 'did you mean "reference"?'),
    ("x = 20", "x = -20", "rigid.plate.springs.x", ">= 0"),
    ("x = 20", "u = 20", "rigid.plate.springs.u", "allowed: x, y, z, rx, ry, rz"),
    ('x = "free", ', "", "step[1].load.plate.x", 'the component is fixed; motion.plate.x = "free"'),
    ("x = 2 }", "rz = 2 }", "step[1].load.plate.rz", 'motion.plate.rz_deg = "free"'),
    ("x = 2 }", 'x = "free" }', "step[1].load.plate.x", "a number needed"),
    ("x = 2 }", "}", "step[1].load.plate", "at least one of x, y, z, rx, ry, rz"),
    ("z = 0.01 }", "}", "step[0].motion.plate", "at least one of x, y, z, rx_deg"),
    ("rz_deg = 5", "rz = 5", "step[1].motion.plate.rz", "in degrees: rz_deg"),
    ("rz_deg = 5", 'rz_deg = "fre"', "step[1].motion.plate.rz_deg", '"free"'),
    ("load = {", "rotation = { plate = { axis = [0, 0, 1], angle_deg = 5 } }\nload = {",
     "step[1].rotation.plate", "given with a motion of the same body"),
    ("motion = { plate = { z = 0.01", "rotation = { plat = { axis = [0, 0, 1], angle_deg = 5",
     "step[0].rotation", 'did you mean "plate"?'),
    ("motion = { plate = { z = 0.01", "rotation = { plate = { axis = [0, 0, 0], angle_deg = 5",
     "step[0].rotation.plate.axis", "zero"),
    ("springs = {", "surfaces = []\nsprings = {", "rigid.plate.surfaces", "at least one"),
    ("springs = {", 'surfaces = ["disc"]\nsprings = {', "rigid.plate.surfaces", "no surface"),
    ("springs = {", "surfaces = 3\nsprings = {", "rigid.plate.surfaces", "a list"),
    ("[rigid.plate]", '[rigid.second]\nsurfaces = ["plate"]\nreference = [0, 0, 0]\n[rigid.plate]',
     "rigid.plate", '"plate" belongs to rigid.second already'),
    ("[rigid.plate]", '[rigid."a.b"]\nsurfaces = ["plate"]', "rigid", "without a dot"),
    ("[rigid.plate]", '[surface.disc]\nshape = "plane"\npoint = [0, 0, 9]\nnormal = [0, 0, 1]\n\n'
     "[rigid.disc]\nreference = [0, 0, 0]\n\n[rigid.plate]", "rigid.disc", "no contact has"),
    ('motion = { plate = { x = "free", rz_deg = 5 } }\nload = { plate = { x = 2 } }',
     "motion = { plate = { x = 1 } }", "rigid.plate.springs", "no step frees"),
]  # fmt: skip


@pytest.mark.parametrize(("old", "new", "field", "says"), WRONG)
def test_one_line_names_the_field(old, new, field, says, rigid_text):
    """Every mistake: the field, what was given, what is allowed."""
    assert rigid_text.count(old) >= 1
    with pytest.raises(CaseError) as caught:
        validate(tomllib.loads(rigid_text.replace(old, new, 1)))
    lines = [str(error) for error in caught.value.errors if error.field == field]
    assert any(says in line for line in lines), [str(error) for error in caught.value.errors]
    assert all("\n" not in line for line in lines)


def test_a_surface_that_rests(case_text):
    """Motion of a surface without a table of its own says what is missing."""
    text = case_text.replace("increments = 2", "increments = 2\nmotion = { plate = { z = 1 } }")
    with pytest.raises(CaseError, match=r"surface \"plate\" rests; a table \[rigid.plate\]"):
        validate(tomllib.loads(text))


def test_a_body_that_nothing_holds(rigid_text, tmp_path, capsys):
    """Stopped with the name of the body and its free directions; nothing touches, no springs."""
    text = rigid_text.replace("springs = { x = 20, rz = 3 }\n", "").replace("z = 0.01", "z = -1")
    case = tmp_path / "case.toml"
    case.write_text(text)
    text = "step 'drag', increment 1: nothing holds the rigid body 'plate' along x: it touches"
    with pytest.raises(StoppedError, match=text):
        list(build(load(case)).solver.run())
