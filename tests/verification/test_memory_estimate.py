"""Memory of static condensation: what `auto` expects a run to take against what it takes."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

CASE = """
{idealisation}
[mesh.{shape}.block]
origin = {first}
size = {size}
cells = {cells}
[mesh.{shape}.base]
origin = {second}
size = {below}
cells = {cells_below}
[material.block]
model = "{model}"
E = 1000
nu = 0.3
[material.base]
model = "{model}"
E = 1000
nu = 0.3
[[contact]]
slave = "block.bottom"
master = "base.top"
pass = "single"
degree = 2
normal = {{ penalty = 1e5 }}
adhesion = {{ stiffness = [1e5, 1e5] }}
friction = {{ coefficients = [0.3, 0.3] }}
[[step]]
name = "press"
increments = 1
displacement = {{ "block.top" = {top}, "base.bottom" = {bottom} }}
"""
IN_SPACE = {
    "idealisation": "",
    "shape": "box",
    "first": [0, 0, 0],
    "size": [1, 1, 0.5],
    "second": [-0.5, -0.5, -0.5],
    "below": [2, 2, 0.5],
    "top": "{ x = 0, y = 0, z = -0.002 }",
    "bottom": "{ x = 0, y = 0, z = 0 }",
}
IN_THE_PLANE = {
    "idealisation": '[idealisation]\nkind = "plane-strain"',
    "shape": "rectangle",
    "first": [0, 0],
    "size": [1, 0.5],
    "second": [-0.5, -0.5],
    "below": [2, 0.5],
    "top": "{ x = 0, y = -0.002 }",
    "bottom": "{ x = 0, y = 0 }",
}
LINEAR, RUBBER = "linear-elastic", "neo-hookean"
#: Solves a case, and prints what was expected and what was taken, bytes.
PROGRAM = """
import sys
from pathlib import Path
from anisocontact.case import load
from anisocontact.case.build import build
from anisocontact.solver.strategies import costs
from anisocontact.solver.strategies.condensed import eliminate, strategy
from anisocontact.solver.strategies.strategy import Task

def status(name):
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(1024 * int(line.split()[1]) for line in lines if line.startswith(name))

built = build(load(sys.argv[1]))
task = Task(built.problem, built.steps, "", {})
touched = strategy.touched_nodes(built.problem, built.steps)
expected = costs.condensing_bytes(strategy._condensable(task, touched))
solver, before = built.solver, status("VmRSS")
Path("/proc/self/clear_refs").write_text("5")
for _ in solver.run(*4 * [lambda *_: None]):
    pass
way = eliminate.chosen()[0].partition(" ")[0]
print(solver.choice.name, way, expected, status("VmHWM") - before)
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("where", "model", "cells", "below"),
    [
        (IN_SPACE, LINEAR, [18, 18, 9], [27, 27, 6]),
        (IN_SPACE, RUBBER, [16, 16, 8], [24, 24, 6]),
        (IN_THE_PLANE, LINEAR, [120, 60], [360, 90]),
    ],
)
def test_memory_is_what_was_expected(
    tmp_path: Path, where: dict[str, object], model: str, cells: list[int], below: list[int]
) -> None:
    """Largest resident memory of a process from before the first increment on.

    Required: within 5 %, so that what `auto` says decides between strategies. Repeated runs differ
    by less than 1 %.
    """
    if not Path("/proc/self/clear_refs").exists():
        pytest.skip("the kernel does not say how much memory a process has had")
    case = CASE.format(**where, model=model, cells=cells, cells_below=below)
    (tmp_path / "case.toml").write_text(case)
    command = [sys.executable, "-c", PROGRAM, str(tmp_path / "case.toml")]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    strategy, way, expected, taken = done.stdout.split()
    if way != "MUMPS":
        pytest.skip(f"the numbers are those of MUMPS, not of {way}")
    assert strategy == "condensed"
    assert float(expected) == pytest.approx(float(taken), rel=0.05)
