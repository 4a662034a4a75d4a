"""More processes than cells: one of them has no cell, or none of the facets in contact."""

from __future__ import annotations

import csv
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

CASE = """
[mesh.box.block]
origin = [0, 0, 0]
size = [1, 1, 1]
cells = [1, 1, 1]
[material.block]
model = "python"
file = "spring.py"
law = "Spring"
[surface.ground]
shape = "plane"
point = [0, 0, 0]
normal = [0, 0, 1]
[[contact]]
slave = "block.bottom"
master = "ground"
friction = { coefficients = [0.3, 0.3] }
[[step]]
name = "press"
increments = 1
displacement = { "block.top" = { x = 0.01, y = 0, z = -0.02 } }
[output]
pictures = false
"""
#: A law of points: Hooke's without lateral contraction.
LAW = """
import numpy as np
from anisocontact.bulk import PointResult
class Spring:
    young, history = 80.0, {}
    def update(self, state):
        one = np.eye(3)
        unit = np.einsum("ik,jl->ijkl", one, one) + np.einsum("il,jk->ijkl", one, one)
        slope = np.broadcast_to(0.5 * self.young * unit, (len(state.strain), 3, 3, 3, 3))
        return PointResult(self.young * state.strain, slope, {})
"""
#: Fields of directions by one vector and by two for each point.
DIRECTIONS = """
import numpy as np
from anisocontact.contact.directions import facet_directions
from anisocontact.mesh import BoxSpec, build_box
model = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1))})
for axes in (np.eye(3)[:1], np.eye(3)[:2]):
    f = lambda x: np.tile(axes, (len(x), 1, 1)).reshape(len(x), *axes.squeeze().shape)
    assert facet_directions(model, "block.bottom", f).name == "tabulated-points"
"""


def _on_two(*arguments: str) -> None:
    if shutil.which("mpirun") is None:
        pytest.skip("no mpirun")
    command = ["timeout", "-k", "5", "100", "mpirun", "-n", "2", sys.executable, *arguments]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.mpi
def test_run_of_one_cell(tmp_path: Path) -> None:
    """Requirement: the run ends with results, and forces are those of one process.

    Tolerance: sums of 8 nodes in another order, behind a residual of 1e-8 of the forces.
    """
    (tmp_path / "case.toml").write_text(CASE)
    (tmp_path / "spring.py").write_text(LAW)
    run = ["-m", "anisocontact", "run", str(tmp_path / "case.toml"), "-o"]
    subprocess.run([sys.executable, *run, str(tmp_path / "1")], check=True, capture_output=True)
    _on_two(*run, str(tmp_path / "2"))
    tables = [(tmp_path / name / "history.csv").read_text().splitlines() for name in "12"]
    one, two = (list(csv.DictReader(lines))[-1] for lines in tables)
    force = [name for name in one if "force" in name]
    assert force
    for name in force:
        assert float(two[name]) == pytest.approx(float(one[name]), rel=1e-6, abs=1e-8), name


@pytest.mark.mpi
def test_directions_of_facets_that_another_process_has() -> None:
    """Requirement: directions given as a function come from the processes that have facets."""
    _on_two("-c", DIRECTIONS)
