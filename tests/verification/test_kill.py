"""Runs that are killed and go on."""

from __future__ import annotations

import json
import random
import subprocess
import sys
import time
from pathlib import Path

import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

#: Two soft bodies whose meshes do not match, at slave nodes; so few Newton iterations are not
#: enough for some increments, so that parts, cuts and extrapolation are at work too.
CASE = """
[mesh.box.block]
origin = [-1, -1, 0]
size = [2, 2, 1]
cells = [2, 2, 1]

[mesh.box.mat]
origin = [-2, -2, -1]
size = [4, 4, 1]
cells = [3, 3, 1]

[material.block]
model = "neo-hookean"
E = 8
nu = 0.4

[material.mat]
model = "neo-hookean"
E = 3
nu = 0.4

[[contact]]
slave = "block.bottom"
master = "mat.top"
pass = "mortar"
adhesion = { stiffness = [8, 16], directions = { kind = "constant", vector = [1, 0, 0], angle_deg = 30 } }
friction = { coefficients = [0.2, 0.4], directions = { kind = "constant", vector = [1, 0, 0], angle_deg = 30 } }

[[step]]
name = "press"
increments = 2
[step.displacement]
"mat.bottom" = { x = 0, y = 0, z = 0 }
"block.top" = { x = 0, y = 0, z = -0.2 }

[[step]]
name = "drag"
increments = INCREMENTS
displacement = { "block.top" = { x = 0.8 } }

[[step]]
name = "lift"
increments = 2
displacement = { "block.top" = { z = 0.1 } }

[output]
every = 2
checkpoint_every = SECONDS

[solver]
options = { snes_max_it = 3 }
"""  # noqa: E501


#: The command without pictures, which take longer than the run and are no part of its state.
MAIN = """
import sys
from contextlib import nullcontext
from anisocontact.cli import main
from anisocontact.results import report_process
report_process.report_beside = lambda wanted: nullcontext(lambda folder: [])
sys.exit(main(sys.argv[1:]))
"""


def command(case: Path, folder: Path, *more: str) -> list[str]:
    return [sys.executable, "-c", MAIN, "run", str(case), "-o", str(folder), *more]


def content(folder: Path) -> dict[str, bytes]:
    """Everything a run leaves but its log, pictures and checkpoint; without the wall time."""
    found = {}
    for path in sorted(folder.rglob("*")):
        name = str(path.relative_to(folder))
        if path.is_file() and path.suffix in (".csv", ".json", ".pvd", ".vtu", ".vtp"):
            found[name] = path.read_bytes()
    summary = json.loads(found["summary.json"])
    assert summary["status"] == "done"
    del summary["wall_time_s"]
    found["summary.json"] = json.dumps(summary).encode()
    return found


def killed(case: Path, folder: Path, lines: int, pause: float) -> bool:
    """Start or go on, and kill after some accepted parts and a pause; whether it was alive."""
    more = ["--restart"] if folder.exists() else []
    with subprocess.Popen(
        command(case, folder, *more), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as run:
        assert run.stdout is not None
        for line in run.stdout:
            lines -= "iterations  residual" in line
            if lines < 0:
                break
        time.sleep(pause)
        alive = run.poll() is None
        run.kill()
    return alive


def check(
    tmp_path: Path, strategy: str, kills: int, increments: int, seed: int, seconds: float
) -> None:
    text = CASE.replace("INCREMENTS", str(increments)).replace("SECONDS", str(seconds))
    text += f'strategy = "{strategy}"\n'
    if strategy == "condensed":
        text = text.replace("neo-hookean", "linear-elastic")
    case = tmp_path / "case.toml"
    case.write_text(text)
    whole = tmp_path / "whole"
    subprocess.run(command(case, whole), check=True, capture_output=True)
    assert json.loads((whole / "summary.json").read_text())["cuts"]
    chance = random.Random(seed)
    folder = tmp_path / "killed"
    # The first one may fall before the folder is there; the pause covers a part and its files.
    alive = [
        killed(case, folder, chance.randint(0, 2), chance.uniform(0.0, 0.1)) for _ in range(kills)
    ]
    assert all(alive), "the run ended before it could be killed"
    subprocess.run(command(case, folder, "--restart"), check=True, capture_output=True)
    a, b = content(whole), content(folder)
    assert a.keys() == b.keys()
    assert [name for name in a if a[name] != b[name]] == []
    log = (folder / "run.log").read_text()
    assert "goes on after" in log
    assert not list(folder.rglob(".*"))


@pytest.mark.ci
@pytest.mark.slow
@pytest.mark.parametrize("strategy", ["direct", "condensed"])
def test_a_run_that_is_killed_three_times(tmp_path, strategy):
    """Three SIGKILLs at random moments, on a run that needs cuts.

    Requirement: a run killed at any moment resumes from its last checkpoint, some accepted parts
    back, and ends bitwise equal to an uninterrupted one: history, summary but for the wall time,
    and all fields. Tolerance: none, files are compared byte by byte.
    """
    check(tmp_path, strategy, kills=3, increments=12, seed=1, seconds=0.01)


@pytest.mark.slow
@pytest.mark.parametrize("strategy", ["direct", "condensed"])
def test_a_run_that_is_killed_twenty_times(tmp_path, strategy):
    """Twenty SIGKILLs in one run with a checkpoint after each part; otherwise as above."""
    check(tmp_path, strategy, kills=20, increments=90, seed=2, seconds=0.0)
