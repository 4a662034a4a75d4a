"""Mutated cases and meshes, run: a clean result or one line, never anything else."""

from __future__ import annotations

import copy
import math
import signal
import tomllib
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

pytest.importorskip("anisocontact._fenicsx", exc_type=ImportError)

from anisocontact.cli import main
from anisocontact.results import Results

#: Seconds after which a run counts as one that hangs; a healthy one takes a fraction of a second.
PATIENCE = 60
#: A drop of everything in a run of two bodies: three increments on forty-eight unknowns.
CASE = """
title = "Two cubes and a plate"

[mesh.box.upper]
origin = [0, 0, 0]
size = [1, 1, 1]
cells = [1, 1, 1]

[mesh.box.lower]
origin = [-0.5, -0.5, -1]
size = [2, 2, 1]
cells = [1, 1, 1]

[material.upper]
model = "neo-hookean"
E = 10
nu = 0.3

[material.lower]
model = "linear-elastic"
E = 20
nu = 0.2

[surface.wall]
shape = "sphere"
centre = [3.02, 0.5, 0.5]
radius = 2

[[contact]]
slave = "upper.bottom"
master = "lower.top"
pass = "two-half"
degree = 2
adhesion = { stiffness = [80, 160], directions = { kind = "constant", vector = [1, 0, 0], angle_deg = 30 } }
friction = { coefficients = [0.2, 0.4], directions = { kind = "constant", vector = [1, 0, 0] } }

[[contact]]
slave = "upper.right"
master = "wall"
normal = { penalty = 100 }
friction = { coefficients = 0.2 }

[[step]]
name = "press"
increments = 1
displacement = { "lower.bottom" = { x = 0, y = 0, z = 0 }, "upper.top" = { x = 0, y = 0, z = -0.05 } }

[[step]]
name = "drag"
increments = 2
displacement = { "upper.top" = { x = 0.05, z = "free" } }
traction = { "upper.top" = { z = -0.2 } }

[output]
every = 2

[solver]
smallest_increment = 0.1
options = { snes_max_it = 12 }
"""  # noqa: E501
Place = tuple[Any, ...]
#: Numbers of things: a large one is a large run, not a mistake.
COUNTS = {"cells", "increments", "degree", "every", "cuts", "snes_max_it", "order"}

SMALL = st.integers(-3, 4) | st.sampled_from([2.5, math.nan, -math.inf, 10**400, "many", True])
NUMBERS = st.one_of(
    st.floats(),
    st.floats(-2.0, 2.0),
    st.integers(-3, 4),
    st.sampled_from([0.0, 1e-300, 1e300, 1e-12, 1e12, 0.5, 10**400]),
)
VALUES = st.one_of(
    NUMBERS,
    st.lists(NUMBERS, max_size=4),
    st.booleans(),
    st.text(max_size=8),
    st.sampled_from(
        ["auto", "free", "upper.top", "lower.left", "wall", "explicit", "polar", "plane", "single"]
    ),
    st.dictionaries(st.text(max_size=5), st.integers(-3, 8), max_size=2),
)


def places(node: Any, at: Place = ()) -> list[Place]:
    """Paths of everything in nested tables and lists."""
    found = [at] if at else []
    if isinstance(node, dict | list):
        for key, child in node.items() if isinstance(node, dict) else enumerate(node):
            found += places(child, (*at, key))
    return found


PLACES = places(tomllib.loads(CASE))


@st.composite
def mutated(draw: st.DrawFn) -> dict[str, Any]:
    """The case with one to three values changed, left out or doubled in size."""
    data = copy.deepcopy(tomllib.loads(CASE))
    for place in draw(st.lists(st.sampled_from(PLACES), min_size=1, max_size=3, unique=True)):
        parent: Any = data
        try:
            for key in place[:-1]:
                parent = parent[key]
            old = parent[place[-1]]
        except (KeyError, IndexError, TypeError):
            continue  # an earlier change took it away
        if not isinstance(parent, dict | list):
            continue
        kind = draw(st.sampled_from(["change", "scale", "leave out"]))
        if kind == "leave out":
            del parent[place[-1]]
        elif kind == "scale" and isinstance(old, int | float) and not COUNTS & set(place):
            parent[place[-1]] = old * draw(st.floats(-3.0, 3.0))
        else:
            parent[place[-1]] = draw(SMALL if COUNTS & set(place) else VALUES)
    return data


def toml(value: Any) -> str:
    """A value as TOML has it, tables inline."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{toml(str(k))} = {toml(v)}" for k, v in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(toml(v) for v in value) + "]"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        plain = value.isprintable() and not set(value) & set('"\\')
        return f'"{value}"' if plain else '"' + "".join(f"\\U{ord(c):08x}" for c in value) + '"'
    return repr(value)


@contextmanager
def patience():
    """A test that takes too long is a run that hangs."""

    def late(*_: object) -> None:
        raise TimeoutError(f"still running after {PATIENCE} s")

    before = signal.signal(signal.SIGALRM, late)
    signal.alarm(PATIENCE)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


def check_run(path: Path, folder: Path, capsys: Any) -> int:
    """Run, and hold the command to what it promises; the exit code."""
    with patience():
        code = main(["run", str(path), "-o", str(folder)])
    error = capsys.readouterr().err
    assert code in (0, 2, 3), error
    assert all(
        line.startswith(("error: ", "warning: ", "to go on: ")) and line.isprintable()
        for line in error.splitlines()
    ), error
    if code == 2:
        assert error.startswith("error: ")
        assert not folder.exists()
        return code
    results = Results(folder)
    assert results.summary["status"] == {0: "done", 3: "stopped"}[code]
    assert len(results.history.get("time", ())) == results.summary["steps"]
    for index in range(len(results.times)):
        assert results.fields(index).n_points > 0
    assert (folder / "checkpoint.npz").is_file()
    assert not list(folder.rglob(".*"))
    return code


def run_table(data: dict[str, Any], tmp_path_factory: Any, capsys: Any) -> int:
    place = tmp_path_factory.mktemp("run")
    path = place / "case.toml"
    text = "".join(f"{toml(str(key))} = {toml(value)}\n" for key, value in data.items())
    path.write_text(text, encoding="utf-8", newline="")
    return check_run(path, place / "out", capsys)


@pytest.fixture(autouse=True)
def no_report(monkeypatch):
    """The pictures take longer than the run, and are tested elsewhere."""
    monkeypatch.setattr("anisocontact.results.writer.write_report", lambda folder: [])


def test_the_case_itself(tmp_path_factory, capsys):
    assert run_table(tomllib.loads(CASE), tmp_path_factory, capsys) == 0


OFTEN = settings(
    max_examples=30,
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)


@OFTEN
@given(data=mutated())
def test_mutated_cases_run_or_are_refused(tmp_path_factory, capsys, data):
    """Requirement: never a traceback, a hang or a partial folder; exit codes hold."""
    run_table(data, tmp_path_factory, capsys)


@pytest.mark.slow
@settings(OFTEN, max_examples=700)
@given(data=mutated())
def test_many_mutated_cases(tmp_path_factory, capsys, data):
    run_table(data, tmp_path_factory, capsys)


MESHED = """
[mesh]
file = "a.msh"

[material.block]
model = "linear-elastic"
E = 10
nu = 0.3

[surface.plate]
shape = "plane"
point = [0, 0, 0]
normal = [0, 0, 1]

[[contact]]
slave = "block.bottom"
master = "plate"
friction = { coefficients = 0.2 }

[[step]]
name = "press"
increments = 1
displacement = { "block.top" = { x = 0, y = 0, z = -0.05 } }

[solver]
smallest_increment = 0.1
options = { snes_max_it = 12 }
"""


@pytest.fixture(scope="module")
def mesh_text(tmp_path_factory):
    """A small mesh of a cube as text of gmsh 4.1."""
    gmsh = pytest.importorskip("gmsh")
    path = tmp_path_factory.mktemp("mesh") / "a.msh"
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("Mesh.MeshSizeMin", 1.0)
        box = gmsh.model.occ.addBox(0, 0, 0, 1, 1, 1)
        gmsh.model.occ.synchronize()
        gmsh.model.addPhysicalGroup(3, [box], name="block")
        gmsh.model.addPhysicalGroup(2, [5], name="bottom")
        gmsh.model.addPhysicalGroup(2, [6], name="top")
        gmsh.model.mesh.generate(3)
        gmsh.write(str(path))
    finally:
        gmsh.finalize()
    return path.read_text()


@st.composite
def damage(draw: st.DrawFn) -> list[tuple[str, float, Any]]:
    """Words that are changed, lines that are dropped or doubled, by where they are."""
    kind = st.sampled_from(["word", "word", "word", "drop", "double", "cut"])
    word = st.one_of(
        st.integers(-3, 60).map(str),
        st.floats(-2.0, 2.0).map(str),
        st.sampled_from(["nan", "inf", "1e300", "1e-300", "x", "$End", "999999999999", '"top"']),
    )
    where = st.floats(0.0, 1.0, exclude_max=True)
    return draw(st.lists(st.tuples(kind, where, word), min_size=1, max_size=3))


def damaged(text: str, changes: list[tuple[str, float, Any]]) -> str:
    lines = text.splitlines()
    for kind, where, word in changes:
        if not lines:
            break
        at = int(where * len(lines))
        words = lines[at].split(" ")
        if kind == "word":
            words[int(where * 7919) % len(words)] = word
            lines[at] = " ".join(words)
        elif kind == "drop":
            del lines[at]
        elif kind == "double":
            lines.insert(at, lines[at])
        else:
            del lines[at:]
    return "\n".join(lines) + "\n"


def run_mesh(text: str, tmp_path_factory: Any, capsys: Any) -> int:
    place = tmp_path_factory.mktemp("run")
    (place / "case.toml").write_text(MESHED)
    (place / "a.msh").write_text(text)
    return check_run(place / "case.toml", place / "out", capsys)


def test_the_mesh_itself(mesh_text, tmp_path_factory, capsys):
    assert run_mesh(mesh_text, tmp_path_factory, capsys) == 0


@OFTEN
@given(changes=damage())
def test_mutated_meshes_run_or_are_refused(mesh_text, tmp_path_factory, capsys, changes):
    """The same with a damaged mesh file."""
    run_mesh(damaged(mesh_text, changes), tmp_path_factory, capsys)


@pytest.mark.slow
@settings(OFTEN, max_examples=300)
@given(changes=damage())
def test_many_mutated_meshes(mesh_text, tmp_path_factory, capsys, changes):
    run_mesh(damaged(mesh_text, changes), tmp_path_factory, capsys)


def test_a_displacement_beyond_all_bounds(tmp_path_factory, capsys):
    """What overflows on the way is a run that stops, not a warning of NumPy."""
    data = tomllib.loads(CASE)
    data["step"][1]["displacement"]["upper.top"]["x"] = 4e80
    assert run_table(data, tmp_path_factory, capsys) == 3
