"""Contact in the plane that is not the same on several processes is told."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

CASE = """
[idealisation]
kind = "plane-strain"
[mesh.rectangle.block]
origin = [0, 0]
size = [1, 0.5]
cells = [4, 2]
[material.block]
model = "linear-elastic"
E = 1000
nu = 0.3
[surface.plate]
shape = "plane"
point = [0, 0, 0]
normal = [0, 1, 0]
[[contact]]
slave = "block.bottom"
master = "plate"
friction = { coefficients = 0.3 }
[[step]]
name = "press"
increments = 1
displacement = { "block.top" = { x = 0, y = -0.01 } }
"""


@pytest.mark.mpi
@pytest.mark.parametrize(("count", "given", "told"), [(1, "", 0), (2, "", 1), (2, "single", 0)])
def test_what_auto_takes_on_several_processes_is_told(
    tmp_path: Path, count: int, given: str, told: int
) -> None:
    """Requirement: one line says that forces are not those of one process, where they are not."""
    if shutil.which("mpirun") is None:
        pytest.skip("no mpirun")
    chosen = CASE.replace("[[step]]", f'pass = "{given}"\n[[step]]') if given else CASE
    case = tmp_path / "case.toml"
    case.write_text(chosen)
    command = ["mpirun", "-n", str(count), sys.executable, "-m", "anisocontact", "check", str(case)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    line = "contact[0].pass: in two dimensions on 2 processes it is at integration points"
    assert done.stdout.count(line) == told
