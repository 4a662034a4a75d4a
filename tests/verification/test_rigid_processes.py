"""Free rigid bodies on several processes: their unknowns live on the last one."""

import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

SCRIPT = """
import numpy as np
from tests.conftest import make_block, make_interface
from anisocontact.rigid import RigidBody
from anisocontact.solver import Solver, Step

die = RigidBody("die", (0.4, 0.7, -0.9), free=True, springs={"x": 5.0, "ry": 5.0, "rz": 3.0})
block = make_block(make_interface(angle=0.4), body=die)
held = {"block.top": dict.fromkeys("xyz", 0.0)}
freed = {"die": dict.fromkeys(("x", "y", "ry", "rz"))}
load = {"die": {"x": 4.0, "y": -1.0, "ry": 1.5, "rz": 1.5}}
steps = [
    Step("touch", 2, held, motion={"die": {"z": 0.02}}),
    Step("load", 3, motion=freed, load=load),
]
list(Solver(block.problem, steps, options={"snes_rtol": 1e-12}).run())
found = np.concatenate([die.accepted.values, block.problem.rigid.support(die)])
if block.problem.comm.rank == 0:
    print(*map(repr, found.tolist()))
"""


@pytest.mark.mpi
@pytest.mark.slow
def test_processes_change_nothing():
    """Pose and supports of a free body on one and on three processes.

    Requirement: 1e-9. Source: the same equations. Tolerance: Newton to 1e-12, and sums
    in another order.
    """
    pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)
    if shutil.which("mpirun") is None:
        pytest.skip("no mpirun")
    root = Path(__file__).parents[2]
    found = []
    for count in (1, 3):
        command = ["mpirun", "-n", str(count), sys.executable, "-c", SCRIPT]
        done = subprocess.run(command, cwd=root, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        found.append(np.array(done.stdout.split(), dtype=float))
    assert np.abs(found[0] - found[1]).max() < 1e-9 * np.abs(found[0]).max()
