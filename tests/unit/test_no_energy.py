"""Laws of adhesion that store no energy: results say so instead of giving a number.

Requirement: adhesion, viscous loss and residual of the balance are "no energy" in summary and
report and not a number in tables; nothing warns about a balance that there is not. Tensors that can
create energy are one line unless `energy = "none"` is given.
"""

from __future__ import annotations

import csv
import json
import math
from pathlib import Path

import pytest

from anisocontact.cli import main

NONE = {"adhesion", "viscous", "residual"}
#: The stiffness at rest pushes along the slip.
LAW = (
    'adhesion = { model = "general-linear", relaxation = [1, 0, 0, 1], '
    "stiffness_instant = [4e3, 0, 0, 1e3], stiffness_rate = [-1e3, 0, 0, -1e2], %s"
    'directions = { kind = "constant", vector = [1, 0, 0] } }'
)
TRACE = """
[surface]
shape = "plane"
point = [0, 0, 0]
normal = [0, 0, 1]
[contact]
normal = { penalty = 1e5 }
%s
friction = { coefficients = 0.3 }
[load]
kind = "path"
path = [[0, 0, 0], [1e-3, 0, 0]]
pressure = 10.0
increments = 4
"""


@pytest.fixture
def block(case_text: str) -> str:
    """A block on a plate, pressed and dragged, with a place for the adhesion."""
    lines = case_text.splitlines()
    text = "\n".join("%s" if line.startswith("adhesion = ") else line for line in lines)
    return text + "\npictures = false\n"


@pytest.mark.parametrize("command", ["run", "trace"])
def test_tensors_that_create_energy_are_one_line(command, block, tmp_path, capsys) -> None:
    if command == "run":
        pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)
    path = tmp_path / "case.toml"
    path.write_text((block if command == "run" else TRACE) % (LAW % ""))
    assert main([command, str(path), "-o", str(tmp_path / "out")]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "adhesion.stiffness_rate: the stiffness at rest A^-1 R has the eigenvalue -1000" in line
    assert "must be >= 0" in line and 'energy = "none"' in line


def test_run_says_no_energy(block, tmp_path, capsys) -> None:
    pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)
    from anisocontact.results.report import page, step_rows
    from anisocontact.results.report.run_data import RunData

    path, folder = tmp_path / "case.toml", tmp_path / "out"
    path.write_text(block % (LAW % 'energy = "none", '))
    assert main(["run", str(path), "-o", str(folder)]) == 0
    summary = json.loads((folder / "summary.json").read_text())
    assert {name for name, value in summary["energy"].items() if value == "no energy"} == NONE
    assert not any("energ" in warning for warning in summary["warnings"])
    with (folder / "history.csv").open() as file:
        rows = list(csv.DictReader(file))
    for name in summary["energy"]:
        assert math.isnan(float(rows[-1][f"energy.{name}"])) == (name in NONE)
    shown = page(summary, step_rows(RunData(folder)), [])
    assert shown.count("<td>no energy</td>") == len(NONE) + 2  # and the residuals of two steps
    assert "nan" not in shown
    assert main(["run", str(path), "-o", str(folder), "--restart"]) == 0
    assert json.loads((folder / "summary.json").read_text())["energy"] == summary["energy"]


def test_trace_says_no_energy(tmp_path: Path) -> None:
    path, folder = tmp_path / "point.toml", tmp_path / "out"
    path.write_text(TRACE % (LAW % 'energy = "none", '))
    assert main(["trace", str(path), "-o", str(folder)]) == 0
    energy = json.loads((folder / "summary.json").read_text())["energy"]
    assert {name for name, value in energy.items() if value == "no energy"} == NONE
    assert (folder / "report.html").read_text().count("<td>no energy</td>") == len(NONE)
    with (folder / "trace.csv").open() as file:
        last = list(csv.DictReader(file))[-1]
    assert math.isnan(float(last["energy_adhesion"])) and float(last["energy_normal"]) > 0.0
