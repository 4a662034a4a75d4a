"""Runs on several processes that are killed while they write a checkpoint, and go on."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.cli import main
from anisocontact.results.checkpoint import load_checkpoint
from anisocontact.results.read import Results

#: The command; one process kills itself before or after a call of a function of the checkpoints.
#: The clock of the first process goes, those of the others go back.
SCRIPT = """
import os, signal, sys
from anisocontact.cli import main
from contextlib import nullcontext
from anisocontact.results import checkpoint, checkpoint_times, report_process
when, name, where, left = sys.argv.pop(1), sys.argv.pop(1), sys.argv.pop(1), [int(sys.argv.pop(1))]
report_process.report_beside = lambda wanted: nullcontext(lambda folder: [])
real = getattr(checkpoint, name)

def dying(*arguments):
    from anisocontact.base.fenicsx import MPI
    left[0] -= str(MPI.COMM_WORLD.rank) == where
    last = left[0] == 0
    if not (last and when == "before"):
        real(*arguments)
    if last:
        os.kill(os.getpid(), signal.SIGKILL)

def clock():
    from anisocontact.base.fenicsx import MPI
    now[0] += 1.0 if MPI.COMM_WORLD.rank == 0 else -1.0
    return now[0]

now = [0.0]
checkpoint_times.monotonic = clock
setattr(checkpoint, name, dying)
sys.exit(main(sys.argv[1:]))
"""
#: Before and after a process has its piece, and before and after these count.
MOMENTS = [
    ("before", "_save", "1"),
    ("after", "_save", "1"),
    ("before", "save_checkpoint", "0"),
    ("after", "save_checkpoint", "0"),
]


def run(case: Path, ranks: int, moment: tuple[str, str, str], count: int) -> int:
    """Start or go on, and kill at a moment of the checkpoint with this number."""
    folder = case.parent / "out"
    more = ["--restart"] if folder.exists() else []
    command = ["timeout", "-k", "5", "200", "mpirun", "-n", str(ranks), sys.executable, "-c"]
    command += [SCRIPT, *moment, str(count), "run", str(case), "-o", str(folder), *more]
    return subprocess.run(command, capture_output=True, check=False).returncode


@pytest.mark.mpi
@pytest.mark.slow
def test_a_kill_within_a_checkpoint(tmp_path: Path, case_text: str) -> None:
    """Whenever a process is killed, the last good checkpoint is whole, and the run goes on from it.

    Requirement: as for one process; results of several processes are those of one to 1e-8. Source:
    the run on one process. Two processes and three take turns: pieces of both never mix. Their
    clocks differ, and still all write the same checkpoints.
    """
    if shutil.which("mpirun") is None:
        pytest.skip("no mpirun")
    case = tmp_path / "case.toml"
    # where the block just touches, rounding says which points are closed, and how many iterations
    apart = case_text.replace("point = [0, 0, 0]", "point = [0, 0, -1e-4]")
    each = apart.replace("[output]", "[output]\ncheckpoint_every = 0")
    case.write_text(each + "\n[solver]\noptions = { snes_rtol = 1e-12 }\n")
    done = []
    for number, moment in enumerate(MOMENTS):
        # the first checkpoint is that of the state from which the run goes on
        assert run(case, 2 + number % 2, moment, 2) != 0
        stored = load_checkpoint(tmp_path / "out")
        assert stored is not None
        assert all(np.load(path)["nodal/position"].size for path in stored.pieces)
        assert len(stored.pieces) == 2 + number % 2
        done.append(stored.facts["writer"]["summary"]["steps"])
    assert done == [0, 0, 0, 1]
    assert run(case, 2, ("before", "_save", "none"), -1) == 0
    names = [path.name for path in (tmp_path / "out" / "checkpoint").iterdir()]
    stored = load_checkpoint(tmp_path / "out")
    assert stored is not None
    assert sorted(names) == [path.name for path in stored.pieces]
    assert main(["run", str(case), "-o", str(tmp_path / "one")]) == 0
    two, one = Results(tmp_path / "out"), Results(tmp_path / "one")
    assert len(one.history["time"]) > 3
    for name, column in one.history.items():
        if column.dtype.kind == "f" and name != "residual":
            scale = np.abs(column[np.isfinite(column)]).max(initial=0.0)
            expected = pytest.approx(column, rel=1e-8, abs=1e-8 * scale, nan_ok=True)
            assert two.history[name] == expected, name
