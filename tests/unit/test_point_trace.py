"""The case file of the driver and `anisocontact trace`: one line for each mistake, exit codes."""

from __future__ import annotations

import copy
import csv
import json
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import pytest

from anisocontact.case.read import CaseError
from anisocontact.case.trace import load_trace, trace_schema, validate_trace
from anisocontact.cli import main
from anisocontact.point import DeadLoad, DraggingSpring, PrescribedPath, Push

CASE = """
title = "a point"
[surface]
shape = "plane"
point = [0, 0, 0]
normal = [0, 0, 1]
[contact]
normal = { penalty = 1e5 }
adhesion = { stiffness = 1e5 }
friction = { coefficients = [0.3, 0.1], directions = { kind = "constant", vector = [1, 0, 0] } }
[load]
kind = "path"
path = [[0, 0, 0], [1e-3, 0, 0]]
pressure = 10.0
increments = 4
[output]
pictures = false
"""


@pytest.fixture
def data() -> dict[str, Any]:
    """The case as nested tables."""
    return tomllib.loads(CASE)


@pytest.fixture
def case(tmp_path: Path) -> Path:
    """The case as a file."""
    path = tmp_path / "point.toml"
    path.write_text(CASE)
    return path


ALONG = 'directions = { kind = "constant", vector = [1, 0, 0] }'
START, NORMAL = {"start": [0, 0]}, {"pressure": 10.0}


@pytest.mark.parametrize(
    ("load", "kind"),
    [
        ({"kind": "path", "path": [[0, 0], [1, 0]], "gap": [-1e-4, -2e-4]}, PrescribedPath),
        (
            {"kind": "spring", "path": [[0, 0, 0], [1, 0, 0]], "stiffness": [1, 2, 3]},
            DraggingSpring,
        ),
        ({"kind": "dead-load", "force": [[0, 0, 0], [1, 0, 0]], **START, **NORMAL}, DeadLoad),
        ({"kind": "push", "direction": [1, 0], "frame": "friction", "travel": [0, 1]}, Push),
    ],
)
def test_every_kind_of_load(data: dict[str, Any], load: dict[str, Any], kind: type) -> None:
    data["load"] = load if kind is not Push else load | START | NORMAL
    assert isinstance(validate_trace(data).load, kind)


def changed(data: dict[str, Any], path: str, value: Any) -> dict[str, Any]:
    """A copy with another value at a dotted path; None takes it away."""
    new = copy.deepcopy(data)
    *tables, key = path.split(".")
    at = new
    for name in tables:
        at = at.setdefault(name, {})
    if value is None:
        del at[key]
    else:
        at[key] = value
    return new


@pytest.mark.parametrize(
    ("path", "value", "line"),
    [
        ("load.kind", "pull", "load.kind: 'pull' given; "),
        ("load.kind", None, "load.kind: missing; allowed: path, spring, dead-load, push"),
        ("load.path", None, "load.path: missing; knots"),
        ("load.path", [0, 0, 0], "load.path: [0, 0, 0] given, a list of lists of numbers needed"),
        ("load.path", [[0, 0, 0], [1]], "load.path: [[0, 0, 0], [1]] given, an array of numbers"),
        ("load.path", [[0, 0, "x"]], "load.path: [[0, 0, 'x']] given"),
        ("load.path", [[0, 0, float("nan")]], "load.path: [[0, 0, nan]] given"),
        ("load.pressure", True, "load.pressure: True given, a number or a list"),
        ("load.gap", -1e-4, "load.pressure: given with a gap; either pressure or gap"),
        ("load.increments", 0, "load.increments: 0 given"),
        ("load.increments", 2.5, "load.increments: 2.5 given"),
        ("load.increments", [1, 2], "load.increments: 2 given, one or 1 needed"),
        ("load.times", [1, 0], "load.times: [1.0, 0.0] given, increasing times needed"),
        ("load.presure", 1, "load.presure: unknown key; did you mean"),
        ("contact.normal", {}, 'contact.normal.penalty: "auto" given or nothing'),
        ("contact.adhesion", {"stiffness": "auto"}, "contact.adhesion.stiffness"),
        ("contact.friction.coefficients", -1, "contact.friction.coefficients: -1 given"),
        ("contact.slave", "a.b", "contact.slave: unknown key"),
        ("surface.shape", "plain", "surface.shape: 'plain' given; did you mean"),
        ("surface.normal", [0, 0, 0], "surface.normal: [0, 0, 0] given"),
        ("group.areas", 0, "group.areas: 0 given"),
        ("group.offsets", [[1, 2, 3, 4]], "group.offsets: an array of shape (1, 4)"),
        ("group.orientation", "loose", "group.orientation: 'loose' given"),
        ("output.pictures", 1, "output.pictures: 1 given"),
        ("compare", [{"sliding_rule": "none"}], "compare[0].sliding_rule: 'none' given"),
        ("compare", [{"sliding_rule": "slip-ellipse"}], "compare[0].slip_axes: missing"),
        ("compare", [{"friction": 1}], "compare[0].friction: unknown key"),
        ("compare", [{"label": 1, "coefficients": 0.1}], "compare[0].label: 1 given"),
        ("compare", [{}], "compare[0]: nothing of the friction given, one key or more"),
        ("compare", [{"label": "same"}], "compare[0]: nothing of the friction given"),
        (
            "compare",
            [{"label": "low", "coefficients": mu} for mu in (0.1, 0.2)],
            "compare[1].label: 'low' given, compare[0] has that label",
        ),
        (
            "compare",
            [{"sliding_rule": "radial"}, {"sliding_rule": "radial", "label": "radial"}],
            "compare[1].label: 'radial' given, compare[0] has that label",
        ),
        ("solver", {}, "solver: unknown key"),
    ],
)
def test_one_line_for_a_mistake(data: dict[str, Any], path: str, value: Any, line: str) -> None:
    with pytest.raises(CaseError) as caught:
        validate_trace(changed(data, path, value))
    (error,) = caught.value.errors
    assert str(error).startswith(line)
    assert "\n" not in str(error)


def test_mistakes_of_all_tables_are_said_at_once(data: dict[str, Any]) -> None:
    wrong = changed(changed(data, "load.increments", [1, 2]), "group.areas", 0)
    wrong = changed(wrong, "contact.normal", {})
    with pytest.raises(CaseError) as caught:
        validate_trace(wrong)
    fields = {error.field for error in caught.value.errors}
    assert fields == {"load.increments", "group.areas", "contact.normal.penalty"}


def test_compared_rule_keeps_no_parameter_of_the_one_it_replaces(data: dict[str, Any]) -> None:
    friction = data["contact"]["friction"] | {"sliding_rule": "explicit", "history": "centre"}
    new = changed(data, "contact.friction", friction)
    new["compare"] = [{"sliding_rule": "radial"}, {"label": "low", "coefficients": [0.1, 0.1]}]
    (radial, low) = validate_trace(new).compared
    assert (radial[0], radial[1].tangential.friction.rule[0]) == ("radial", "radial")
    assert (low[0], low[1].tangential.friction.rule[0]) == ("low", "explicit")
    assert low[1].tangential.friction.named[1]["coefficients"] == (0.1, 0.1)


def test_schema_describes_every_key() -> None:
    """What an editor needs; no "auto", which only a mesh could resolve."""
    schema = trace_schema()
    text = json.dumps(schema)
    assert '"auto"' not in text and "null" not in text
    assert set(schema["properties"]) == {
        "title", "surface", "contact", "load", "group", "compare", "output",
    }  # fmt: skip
    assert set(schema["required"]) == {"surface", "contact", "load"}
    penalty = schema["$defs"]["NormalPenalty"]
    assert penalty["required"] == ["penalty"] and "default" not in penalty["properties"]["penalty"]
    push = schema["$defs"]["PushSection"]
    assert {"direction", "travel", "start"} <= set(push["required"])
    assert push["properties"]["frame"]["default"] == "space"


def test_trace_writes_what_it_says(
    case: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "out"
    assert main(["trace", str(case), "-o", str(folder)]) == 0
    end, done = capsys.readouterr().out.splitlines()[-2:]
    assert end == "end       position (0.001, 0, -0.0001), force (3, 0, -10)"
    assert done == f"done      {folder}"
    assert {p.name for p in folder.iterdir()} == {"summary.json", "trace.csv", "case.toml"}
    summary = json.loads((folder / "summary.json").read_text())
    assert summary["status"] == "done" and summary["steps"] == 4
    assert summary["force"] == pytest.approx([3.0, 0.0, -10.0])
    with (folder / "trace.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [row["status"] for row in rows] == ["stick", "slip", "slip", "slip", "slip"]
    assert (folder / "case.toml").read_text() == CASE
    assert main(["trace", str(case), "-o", str(folder)]) == 2
    assert "--overwrite" in capsys.readouterr().err
    assert main(["trace", str(case), "-o", str(folder), "--overwrite"]) == 0


def test_bad_input_writes_nothing(
    case: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    case.write_text(CASE.replace("1e5", "-1e5"))
    assert main(["trace", str(case), "-o", str(tmp_path / "out")]) == 2
    lines = capsys.readouterr().err.splitlines()
    assert [line.split(":")[1].strip() for line in lines] == [
        "contact.normal.penalty",
        "contact.adhesion.stiffness",
    ]
    assert not (tmp_path / "out").exists()
    assert main(["trace", str(tmp_path / "none.toml")]) == 2


def test_what_a_load_cannot_do_on_its_way_is_told_by_its_place(
    case: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Requirement: the place in the file, as where values are wrong before anything moves."""
    path = 'kind = "path"\npath = [[0, 0, 0], [1e-3, 0, 0]]'
    push = 'kind = "push"\ndirection = [0, 0, 1]\ntravel = [0, 1e-3]\nstart = [0, 0, 0]'
    case.write_text(CASE.replace(path, push))
    assert main(["trace", str(case), "-o", str(tmp_path / "out")]) == 2
    assert "error: load.direction: no tangential part" in capsys.readouterr().err


def test_stopped_drive_keeps_what_converged(
    case: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A path over the pole of the directions: exit code 3, the table up to there."""
    text = CASE.replace(
        '"constant", vector = [1, 0, 0]', '"polar", axis = [[5e-4, 0, 0], [0, 0, 1]]'
    )
    case.write_text(text)
    folder = tmp_path / "out"
    assert main(["trace", str(case), "-o", str(folder)]) == 3
    assert "stopped in step 2, at time 0.5" in capsys.readouterr().err
    summary = json.loads((folder / "summary.json").read_text())
    assert summary["status"] == "stopped" and summary["steps"] == 1
    assert len((folder / "trace.csv").read_text().splitlines()) == 3


def test_pictures_and_report(case: Path, tmp_path: Path) -> None:
    """Pictures, one page with all of them inside, and a table of all compared runs."""
    case.write_text(
        CASE.replace("pictures = false", "pictures = true")
        + '[[compare]]\nsliding_rule = "radial"\n[group]\noffsets = [[0, 0], [1e-4, 0]]\n'
    )
    folder = tmp_path / "out"
    assert main(["trace", str(case), "-o", str(folder)]) == 0
    pictures = {p.name for p in (folder / "pictures").iterdir()}
    assert pictures == {"path.png", "forces.png", "time.png", "compare.png"}
    page = (folder / "report.html").read_text()
    assert page.count("data:image/png;base64,") == 4 and "://" not in page
    labels = {row.split(",")[0] for row in (folder / "compare.csv").read_text().splitlines()[1:]}
    assert labels == {"as given: maximum-dissipation", "radial"}


def test_equal_runs_give_equal_tables(case: Path, tmp_path: Path) -> None:
    for name in ("a", "b"):
        assert main(["trace", str(case), "-o", str(tmp_path / name)]) == 0
    assert (tmp_path / "a/trace.csv").read_bytes() == (tmp_path / "b/trace.csv").read_bytes()


def test_name_of_the_case(tmp_path: Path) -> None:
    (tmp_path / "plate").mkdir()
    for name, expected in (("plate/case.toml", "plate"), ("plate/drag.toml", "drag")):
        (tmp_path / name).write_text(CASE)
        assert load_trace(tmp_path / name).name == expected


def test_schema_command(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["schema", "--trace"]) == 0
    assert json.loads(capsys.readouterr().out) == trace_schema()


@pytest.mark.parametrize(
    ("code", "heavy"),
    [
        ("import anisocontact.point", "dolfinx pydantic matplotlib pyvista rich"),
        ("import anisocontact.cli.trace", "dolfinx pyvista matplotlib"),
    ],
)
def test_imports_are_light(code: str, heavy: str) -> None:
    """The driver works where no finite elements are installed."""
    code = f"{code}; import sys; print(*(set({heavy.split()!r}) & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == ""


def test_a_trace_with_pictures_needs_no_finite_elements(tmp_path: Path) -> None:
    """Requirement: the base dependencies are enough for a whole trace, its report included."""
    (tmp_path / "case.toml").write_text(CASE.replace("pictures = false", "pictures = true"))
    code = (
        "import sys; sys.modules.update(dict.fromkeys(['mpi4py', 'petsc4py', 'dolfinx', 'ufl'])); "
        "from anisocontact.cli import main; sys.exit(main(['trace', 'case.toml', '-o', 'out']))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert list((tmp_path / "out").rglob("*.png"))


@pytest.mark.parametrize("where", ["contact", "bare"])
@pytest.mark.parametrize("stiffness", ["1e5", "[9e5, 1e5]"])
def test_a_rule_whose_forces_jump_is_named(case, tmp_path, capsys, where, stiffness):
    """Requirement: as in cases of bodies; not where stiffnesses go with the squares."""
    rule = 'sliding_rule = "explicit"'
    text = CASE.replace("stiffness = 1e5", f"stiffness = {stiffness}, {ALONG}")
    if where == "contact":
        text = text.replace("coefficients =", f"{rule}, coefficients =")
    else:
        text += f'[[compare]]\nlabel = "bare"\n{rule}\n'
    case.write_text(text)
    assert main(["trace", str(case), "-o", str(tmp_path / "out")]) == 0
    said = f"warning: {where}: with sliding_rule = 'explicit' tangential forces turn at once"
    assert (said in capsys.readouterr().err) == (stiffness == "1e5")
