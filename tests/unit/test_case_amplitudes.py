"""Amplitudes and paths in the case file: one line for what is wrong, a run that goes on."""

from __future__ import annotations

import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.base.errors import InputError
from anisocontact.bulk import make_material
from anisocontact.cli import main
from anisocontact.mesh import BoxSpec, build_box
from anisocontact.solver import Problem, Solver, Step, Turn

CASE = """
[mesh.box.bar]
origin = [0, 0, 0]
size = [1, 1, 2]
cells = [1, 1, 2]

[material.bar]
model = "linear-elastic"
E = 10000
nu = 0.3

[amplitude.wave]
kind = "sine"
period = 3
time_of = "total"

[amplitude.own]
kind = "python"
file = "own.py"
function = "power"
arguments = { k = 2 }

[path.round]
kind = "circle"
radius = 0.01

[spring.pull]
group = "bar.top"
stiffness = [20, 20, 20]

[output]
pictures = false

[[step]]
name = "load"
increments = 4
displacement = { "bar.bottom" = { x = 0, y = 0, z = 0 } }
pressure = { "bar.top" = { amplitude = "wave", value = 10 } }
anchor = { pull = { path = "round", z = { amplitude = "own", value = 0.1 } } }

[[step]]
name = "on"
increments = 4
pressure = { "bar.top" = { amplitude = "wave", value = 10 } }
anchor = { pull = { path = "round" } }
"""
OWN = "def power(time, k):\n    return time**k\n"


@pytest.fixture
def case(tmp_path):
    """The case with its Python file."""
    (tmp_path / "own.py").write_text(OWN)
    path = tmp_path / "case.toml"
    path.write_text(CASE)
    return path


def test_a_run_goes_on_bit_by_bit(gone_on, case):
    """Requirement: a run that is stopped in a step with amplitudes ends as one that was not."""
    whole, out = gone_on(case, 6)
    assert (whole / "history.csv").read_bytes() == (out / "history.csv").read_bytes()


@pytest.mark.parametrize(
    ("end", "told"), [('"polyline"\nduration = 5', 2), ('"table"\ntime = [0, 1]', 0)]
)
def test_a_path_longer_than_its_step_is_told(case, capsys, end, told):
    """Requirement: a path that ends after the step that follows it is a warning that says when both
    end. One of 5 in a step of 1 was followed for a fifth, and nothing was said. Lines are
    counted, one for each of the two steps."""
    path = f"kind = {end}\nx = [0, 0.01]\ny = [0, 0.01]\n"
    case.write_text(CASE.replace('kind = "circle"\nradius = 0.01\n', path))
    assert main(["check", str(case)]) == 0
    lines = [line for line in capsys.readouterr().out.splitlines() if "its path ends" in line]
    assert len(lines) == told
    assert all("anchor.pull: its path ends at the time 5 and the step at 1" in s for s in lines)


@pytest.mark.parametrize(("total", "told"), [(False, 1), (True, 0)])
def test_an_amplitude_of_other_times_is_told(case, capsys, total, told):
    """Requirement: an amplitude that stays at one value in a step is a warning that says of which
    times it is. Times of the run in the second step moved nothing, and nothing was said. Held
    values of an amplitude of the run are meant. Lines are counted."""
    table = '[amplitude.late]\nkind = "table"\ntime = [1, 2]\nvalue = [0, 1]\n'
    table += 'time_of = "total"\n' * total
    late = 'pressure = { "bar.top" = { amplitude = "late", value = 10 } }\n'
    waves = 'pressure = { "bar.top" = { amplitude = "wave", value = 10 } }\n'
    text = CASE.replace("[amplitude.wave]", f"{table}\n[amplitude.wave]").replace(waves, late)
    case.write_text(text.replace(late, "", 1))
    assert main(["check", str(case)]) == 0
    lines = [line for line in capsys.readouterr().out.splitlines() if "at one value" in line]
    assert len(lines) == told
    assert all("step 'on'.pressure.\"bar.top\": its amplitude" in line for line in lines)


def test_what_nothing_names_is_told(case, capsys):
    """Requirement: a surface, amplitude or path that is defined and not named again is a warning.

    Source: by hand. A die that no contact had as its master was passed through without a word.
    """
    plane = '[surface.die]\nshape = "plane"\npoint = [0, 0, 9]\nnormal = [0, 0, -1]\n'
    late = '[amplitude.late]\nkind = "table"\ntime = [0, 2]\nvalue = [0, 1]\n'
    way = '[path.way]\nkind = "circle"\nradius = 1\n'
    unnamed = "\n".join([plane, late, way, "[amplitude.wave]"])
    case.write_text(CASE.replace("[amplitude.wave]", unnamed))
    assert main(["check", str(case)]) == 0
    told = [s for s in capsys.readouterr().out.splitlines() if s.startswith("warning")]
    assert [s.split()[1] for s in told[:3]] == ["surface.die:", "amplitude.late:", "path.way:"]


def test_another_file_is_another_run(case, capsys):
    """Requirement: a function that has changed is not gone on with."""
    out = case.parent / "out"
    assert main(["run", str(case), "-o", str(out)]) == 0
    (case.parent / "own.py").write_text(OWN.replace("time**k", "time"))
    capsys.readouterr()
    assert main(["run", str(case), "-o", str(out), "--restart"]) == 2
    assert capsys.readouterr().err.startswith("error: amplitude.own.file: 'own.py' has changed")


def test_check_can_leave_the_file_alone(case, capsys):
    """Requirement: `check --no-python` runs no file that the case names, and says so."""
    (case.parent / "own.py").write_text("raise RuntimeError('run')")
    assert main(["check", str(case), "--no-python"]) == 0
    assert "not run   own.py: its amplitude is not checked" in capsys.readouterr().out
    assert main(["check", str(case)]) == 2
    line = "error: amplitude.own.file: 'own.py' cannot be run: own.py, line 1: RuntimeError: run\n"
    assert capsys.readouterr().err == line


def test_a_function_that_ends_the_program(case, capsys):
    """Requirement: what an amplitude does is one line, also where it calls `exit` of its own."""
    own = case.parent / "own.py"
    own.write_text(own.read_text().replace("return", "exit(0) if time > 0.9 else 0\n    return"))
    for command in ("check", "run"):
        assert main([command, str(case)]) == 2
        (line,) = capsys.readouterr().err.splitlines()
        assert ": own.py, line 2: SystemExit: 0" in line


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ('"sine"', '"sin"', "amplitude.wave.kind: 'sin' given; did you mean \"sine\"?"),
        ("period = 3", "period = 0", "amplitude.wave.period: 0 given, must be > 0"),
        ('"total"', '"day"', "amplitude.wave.time_of: 'day' given, allowed: step, total"),
        ('"power"', '"pow"', "amplitude.own.function: \"pow\" given, no such function in 'own.py'"),
        (
            "k = 2",
            "k = 'a'",
            "step 'load'.anchor.pull.z: amplitude at the time 0: own.py, line 2: TypeE",
        ),
        ("own.py", "none.py", "amplitude.own.file: 'none.py' given, no such file"),
        ('amplitude = "own"', 'amplitude = "owl"', 'step[0].anchor.pull.z.amplitude: "owl" given'),
        ('path = "round", z', 'path = "sound", z', 'step[0].anchor.pull.path: "sound" given, no'),
        ('path = "round", z', 'path = "round", y', "step[0].anchor.pull.y: given with path"),
        ('"circle"\nradius = 0.01', '"table"\nx = [0, 1]', "path.round.time: missing"),
        ("radius = 0.01", "radius = 0.01\ntime_of = 'total'", "path.round.time_of: unknown key"),
        (
            'kind = "circle"\nradius = 0.01',
            'kind = "table"\ntime = [0, 2, 1]\nx = [0, 1, 2]',
            "path.round.time: 1 after 2 given, two or more numbers",
        ),
        (
            'kind = "circle"\nradius = 0.01',
            'kind = "polyline"\nx = [0, 1, 2]\ny = [0, 1]',
            "path.round.y: 2 numbers given, two or more needed, as many for each axis",
        ),
        (
            '"sine"\nperiod = 3',
            '"ramp"\nstart = 2\nend = 1',
            "amplitude.wave.end: 1 given, must be > start, 2",
        ),
        (
            '"wave", value = 10 } }\nanchor = { pull = { path = "round" } }',
            '"own", value = 10 } }',
            "step 'on'.pressure.bar.top: the amplitude begins at 0 where 8.66025 is",
        ),
        ("value = 10", "value = 'a'", "step[0].pressure.\"bar.top\".value: 'a' given, a number"),
        ("value = 10", "valeu = 10", 'step[0].pressure."bar.top".valeu: unknown key'),
    ],
)
def test_wrong_amplitudes_are_one_line(case, refused, old, new, line):
    """Requirement: place, what was given, and what is allowed."""
    assert line in refused(CASE, old, new, 1)


@pytest.mark.parametrize(
    ("own", "said"),
    [
        ("n = 0\ndef power(time, k):\n    global n\n    n += 1\n    return n * time\n",
         "0.9, and asked again 1: it must depend on the time alone"),
        ("import random\ndef power(time, k):\n    return time * (1 + random.random())\n",
         "it must depend on the time alone"),
        ("def power(time, k):\n    return str(time)\n",
         "TypeError: '0.0' returned, a number needed"),
    ],
    ids=["counts", "random", "text"],
)  # fmt: skip
def test_an_amplitude_that_is_no_function_of_time(case, capsys, own, said):
    """Requirement: increments that are cut, attempts and runs that go on ask for times again."""
    case.with_name("own.py").write_text(own)
    assert main(["check", str(case)]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("error: step 'load'.anchor.pull.z: ")
    assert said in line


def test_a_turn_whose_amplitude_counts():
    """Requirement: as of other motions."""
    values = iter([0.0, *range(100)])
    turn = Turn((0, 0, 1), 0.1, amplitude=lambda time: next(values) * time)
    model = build_box({"bar": BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1))})
    problem = Problem(model, {"bar": make_material("linear-elastic", E=1.0, nu=0.0)})
    step = Step("turn", 1, rotation={"bar.top": turn})
    with pytest.raises(InputError, match=r"^step 'turn'\.rotation\.bar\.top\.amplitude: .* alone"):
        Solver(problem, [step])
