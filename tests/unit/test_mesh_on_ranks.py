"""Meshes that several processes share: the same mesh, and nobody holds all of it."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

ROOT = Path(__file__).parents[2]


@pytest.mark.mpi
@pytest.mark.slow
def test_every_process_has_its_share(tmp_path: Path) -> None:
    """Files of all formats and built-in shapes: nodes, cells and memory of a process.

    Requirement: no process holds the whole volume while it is read or made; the mesh is that of one
    process number by number; a damaged file is one line on all of them. Tolerances: a share is a
    third but for rounding; of the peak of memory of one process 0.39 to 0.55 are measured: a piece
    of the file and copies of what is on the way do not shrink.
    """
    ranks = 3
    if shutil.which("mpirun") is None:
        pytest.skip("no mpirun")
    script = [sys.executable, "-m", "tests.unit.mesh_on_ranks", str(tmp_path)]
    command = ["timeout", "-k", "5", "200", "mpirun", "-n", str(ranks), *script]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    found = json.loads((tmp_path / "counts.json").read_text())
    assert min(found.pop("refused")) > 10
    assert len(found) == 5
    for name, share in found.items():
        assert share["nodes"] < 1.02 / ranks, name
        assert share["cells"] < 1.02 / ranks, name
        assert share["peak"] < 0.65, (name, share)
