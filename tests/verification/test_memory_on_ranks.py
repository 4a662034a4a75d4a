"""Memory that PETSc keeps on several processes while a run goes on."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = """
import sys
from tests.verification.test_fe_iterative import PRESS, _pair
from anisocontact.base.fenicsx import PETSc
from anisocontact.solver import Solver, Step

problem, drag = _pair(3), Step("drag", 8, {"block.top": {"x": 0.02}})
for _ in Solver(problem, [PRESS, drag], strategy=sys.argv[1]).run():
    PETSc.garbage_view(problem.comm)
"""


@pytest.mark.mpi
@pytest.mark.slow
@pytest.mark.parametrize("strategy", ["direct", "iterative"])
def test_what_is_set_aside_does_not_grow(strategy: str) -> None:
    """PETSc objects that wait to be destroyed are those of one increment.

    Requirement: after ten increments at most twice as many as after one of the first two. Source:
    on several processes petsc4py sets objects aside until they are released; a run that never does
    so keeps all vectors that it ever made. Tolerance: an increment makes some for each iteration.
    """
    if shutil.which("mpirun") is None:
        pytest.skip("no mpirun")
    command = ["mpirun", "-n", "2", sys.executable, "-c", SCRIPT, strategy]
    root = Path(__file__).parents[2]
    done = subprocess.run(command, cwd=root, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    kept = [int(count) for count in re.findall(r"Rank 0:: Total entries: (\d+)", done.stdout)]
    assert len(kept) == 10
    assert max(kept[2:]) <= 2 * max(kept[:2])
