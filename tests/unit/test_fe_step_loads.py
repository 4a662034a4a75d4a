"""Loads and rotations of a step: names, values, what is held; and in the case file."""

import math

import numpy as np
import pytest

from anisocontact.base.errors import InputError

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.case import load
from anisocontact.case.build import build
from anisocontact.cli import main
from anisocontact.mesh import Placement
from anisocontact.solver import Cylindrical, Solver, Step, Turn

NOTHING = {"x": 0.0, "y": 0.0, "z": 0.0}
CASE = """
[mesh.box.bar]
origin = [0, 0, 0]
size = [1, 1, 2]
cells = [1, 1, 2]

[material.bar]
model = "linear-elastic"
E = 10000
nu = 0
density = 0.5

[[step]]
name = "load"
increments = 1
displacement = { "bar.bottom" = { x = 0, y = 0, z = 0 } }
LINE
"""


@pytest.mark.parametrize(
    ("values", "line"),
    [
        ({"force": {"b.top": {"w": 1.0}}}, "step 'a'.force.b.top.w: no axis 'w', allowed: x, y, z"),
        (
            {"body_force": {"b": {"x": math.nan}}},
            "step 'a'.body_force.b.x: nan given, needs a finite number",
        ),
        (
            {"force": {"b.top": {"x": -1e60}}},
            "step 'a'.force.b.top.x: -1e+60 given, must be 0, or from 1e-50 to 1e+50 in size",
        ),
        (
            {"duration": 1e-60},
            "step 'a'.duration: 1e-60 given, must be from 1e-50 to 1e+50 in size",
        ),
        (
            {"pressure": {"b.top": "high"}},
            "pressure.b.top: 'high' given, a number or LoadCurve needed",
        ),
        (
            {"rotation": {"b.top": Turn((0, 0, 1), 1.0)}, "displacement": {"b.top": {"x": 1.0}}},
            "step 'a'.rotation.b.top: given with a displacement of the same group, one of "
            "the two is allowed",
        ),
    ],
)
def test_wrong_load_is_one_line(values, line):
    """Requirement: bad input is one line that names the field and what is allowed."""
    with pytest.raises(InputError) as caught:
        Step("a", 1, **values)
    assert str(caught.value) == line


@pytest.mark.parametrize(
    ("make", "line"),
    [
        (lambda: Turn((0, 0, 0), 1.0), "axis: [0, 0, 0] given, must not be zero"),
        (
            lambda: Turn((0, 0, 1), 1.0, move=(0, 0)),
            "move: (0, 0) given, three finite numbers are needed",
        ),
        (
            lambda: Cylindrical({"radial": 1e60}),
            "radial: 1e+60 given, must be 0, or from 1e-50 to 1e+50 in size",
        ),
        (
            lambda: Turn((0, 0, 1), 1.0, move=(0, 1e60, 0)),
            "move: (0, 1e+60, 0) given, must be 0, or from 1e-50 to 1e+50 in size",
        ),
        (
            lambda: Placement(scale=1e60),
            "scale: 1e+60 given, must be from 1e-50 to 1e+50 in size",
        ),
    ],
)
def test_wrong_turn_is_one_line(make, line):
    """Requirement: bad input is one line that names the field and what is allowed."""
    with pytest.raises(InputError) as caught:
        make()
    assert str(caught.value) == line


@pytest.mark.parametrize(
    ("values", "says"),
    [
        ({"force": {"block.tpo": {"x": 1.0}}}, "no facet group 'block.tpo'"),
        ({"pressure": {"block.tpo": 1.0}}, "no facet group 'block.tpo'"),
        ({"rotation": {"block.tpo": Turn((0, 0, 1), 1.0)}}, "no facet group 'block.tpo'"),
        ({"body_force": {"blok": {"x": 1.0}}}, "no body 'blok'"),
    ],
)
def test_unknown_names_are_found_before_anything_is_solved(fe, values, says):
    """Requirement: a misspelt group or body suggests the near one, whatever the step."""
    block = fe.block(fe.interface(), cells=(2, 2, 1))
    with pytest.raises(InputError, match=says) as caught:
        Solver(block.problem, [Step("a", 1), Step("b", 1, **values)])
    assert caught.value.field == f"step 'b'.{next(iter(values))}"


def test_a_turn_and_a_value_clash_on_shared_nodes(fe):
    """Requirement: an edge cannot go two ways; the line names both groups and the values."""
    block = fe.block(fe.interface(), cells=(2, 2, 1))
    turn = Turn((0, 0, 1), math.pi / 2)
    step = Step("a", 1, {"block.left": {"x": 0.0}}, rotation={"block.top": turn})
    # The corner on the axis stays where it is, but for round-off.
    clash = r"'block.left' prescribes 0 and 'block.top' -[\d.]+ for x on 2 shared nodes"
    with pytest.raises(InputError, match=clash):
        Solver(block.problem, [step])


def loaded(tmp_path, line):
    """The case with a line more in its step, solved; last accepted increment."""
    path = tmp_path / "case.toml"
    path.write_text(CASE.replace("LINE", line))
    built = build(load(path))
    return list(built.solver.run())[-1]


@pytest.mark.parametrize(
    ("line", "reaction"),
    [
        ('force = { "bar.top" = { z = 3 } }', [0, 0, -3]),
        ('pressure = { "bar.top" = 3 }', [0, 0, 3]),
        ('pressure = { "bar.left" = 3 }', [-6, 0, 0]),
        ("body_force = { bar = { x = 1, z = -2 } }", [-2, 0, 4]),
        ("body_force = { bar = { z = -10, density = 0.5 } }", [0, 0, 10]),
        ("gravity = { x = 2, z = -10 }", [-2, 0, 10]),
        (
            'gravity = { z = { amplitude = "on", value = -5 } }\n'
            '[amplitude.on]\nkind = "ramp"\nend = 0.5',
            [0, 0, 5],
        ),
    ],
)
def test_loads_of_a_case(tmp_path, line, reaction):
    """Requirement: every load in the case file, with the sign and size that its table says."""
    found = loaded(tmp_path, line).reactions["bar.bottom"]
    assert found == pytest.approx(reaction, abs=1e-10)


def test_rotation_of_a_case(tmp_path):
    """Requirement: a group is led through an angle in degrees; the torsion of the bar."""
    path = tmp_path / "case.toml"
    turn = 'rotation = { "bar.top" = { axis = [0, 0, 1], angle_deg = 90, move = [0, 0, 1] } }'
    rubber = CASE.replace("linear-elastic", "neo-hookean")
    path.write_text(rubber.replace("LINE", turn).replace("increments = 1", "increments = 6"))
    built = build(load(path))
    for _ in built.solver.run():
        u = built.problem.u.x.array.reshape(-1, 3)
    x = built.problem.model.space.tabulate_dof_coordinates()
    top = x[:, 2] == 2.0
    assert (x + u)[top] == pytest.approx(
        np.column_stack([-x[top, 1], x[top, 0], x[top, 2] + 1.0]), abs=1e-12
    )


@pytest.mark.parametrize(
    ("line", "says"),
    [
        ("body_force = { bra = { z = 1 } }", 'step[0].body_force: "bra" given, no such body'),
        ("body_force = { bar = { density = 2 } }", "step[0].body_force.bar: nothing given"),
        (
            "body_force = { bar = { z = 1, density = -2 } }",
            "step[0].body_force.bar.density: -2 given, must be > 0",
        ),
        ('pressure = { "bra.top" = 1 }', 'step[0].pressure: "bra.top" given, no such body'),
        ("gravity = {}", "step[0].gravity: nothing given, at least one of x, y, z needed"),
        (
            "gravity = { z = 1 }\nbody_force = { bar = { z = 1 } }",
            "step[0].body_force.bar: given with gravity, which acts on the body",
        ),
        ('pressure = { "bar.tpo" = 1 }', "step[0].pressure: no facet group 'bar.tpo'"),
        ('pressure = { "bar.top" = "x" }', "'x' given, a number needed"),
        ('force = { "bar.top" = 3 }', "a table needed"),
        (
            'rotation = { "bar.top" = { axis = [0, 0, 0], angle_deg = 1 } }',
            "must not be zero",
        ),
        (
            'rotation = { "bar.bottom" = { axis = [0, 0, 1], angle_deg = 1 } }',
            'step[0].rotation."bar.bottom": given with a displacement of the same group',
        ),
    ],
)
def test_wrong_load_of_a_case(tmp_path, capsys, line, says):
    """Requirement: one line with the place in the file."""
    path = tmp_path / "case.toml"
    path.write_text(CASE.replace("LINE", line))
    assert main(["check", str(path)]) == 2
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 1
    assert says in lines[0]


def test_gravity_wants_a_density(tmp_path, capsys):
    """Requirement: a body of unknown weight is no body without weight."""
    path = tmp_path / "case.toml"
    heavy = CASE.replace("LINE", "gravity = { z = -10 }")
    path.write_text(heavy.replace("density = 0.5\n", ""))
    assert main(["check", str(path)]) == 2
    line = "error: material.bar.density: missing; gravity acts on the body in step[0], 0 if it has"
    assert capsys.readouterr().err.startswith(line)
    path.write_text(heavy.replace("density = 0.5", "density = -0.5"))
    assert main(["check", str(path)]) == 2
    assert "material.bar.density: -0.5 given, must be >= 0" in capsys.readouterr().err
