"""Runs on several processes that go wrong: one message, the right exit code, no hang."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.cli import main
from anisocontact.results.read import Results

#: `anisocontact` with an error, or a signal, in the fourth evaluation on the ranks that are given.
SCRIPT = """
import os, signal, sys
from anisocontact.cli import main
where, what = sys.argv.pop(1), sys.argv.pop(1)

def prepared():
    from contextlib import nullcontext
    from anisocontact.results import report_process
    from anisocontact.solver.system.problem import Problem

    report_process.report_beside = lambda wanted: nullcontext(lambda folder: [])
    evaluate, count = Problem.evaluate, [0]

    def failing(self, x):
        count[0] += 1
        if count[0] == 4 and str(self.comm.rank) in where:
            if what in ("SIGINT", "SIGTERM"):
                os.kill(os.getpid(), getattr(signal, what))
            elif what == "memory":
                raise MemoryError("Unable to allocate 74.5 GiB")
            elif what == "raise":
                raise ValueError("it failed")
        return evaluate(self, x)

    Problem.evaluate = failing

from anisocontact.base.processes import started_together
entry = sys.modules["anisocontact.cli.main"]
entry.started_together = lambda: (started_together(), prepared())[0]
sys.exit(main(sys.argv[1:]))
"""


@pytest.fixture
def case(tmp_path: Path, unpictured: str) -> Path:
    if shutil.which("mpirun") is None:
        pytest.skip("no mpirun")
    path = tmp_path / "case.toml"
    path.write_text(unpictured)
    return path


def run(case: Path, where: str, what: str) -> subprocess.CompletedProcess[str]:
    """Two processes; a hang is a failure (exit code 124)."""
    command = ["timeout", "-k", "5", "200", "mpirun", "-n", "2", sys.executable, "-c", SCRIPT]
    command += [where, what, "run", str(case), "-o", str(case.parent / "out")]
    return subprocess.run(command, capture_output=True, text=True, check=False)


@pytest.mark.mpi
def test_bad_input_is_told_once(case: Path) -> None:
    case.write_text(case.read_text().replace("nu = ", "nu = 7"))
    done = run(case, "", "")
    assert done.returncode == 2
    assert done.stderr.count("error:") == 1
    assert "nu" in done.stderr


@pytest.mark.mpi
@pytest.mark.slow
@pytest.mark.parametrize("where", ["1", "0", "01"])
def test_an_error_on_some_ranks_ends_all(case: Path, where: str) -> None:
    """What an error leaves others waiting for is not waited for."""
    done = run(case, where, "raise")
    assert done.returncode == 1, done.stderr
    assert done.stderr.count("error: internal: ValueError: it failed") == 1
    assert "Abort(" not in done.stderr
    folder = case.parent / "out"
    summary = json.loads((folder / "summary.json").read_text())
    assert (summary["status"], summary["message"]) == (
        "stopped",
        "internal error: ValueError: it failed",
    )
    assert "it failed" in (folder / "run.log").read_text()


LAW = """
import numpy as np
from mpi4py import MPI
from anisocontact.bulk import PointResult
from anisocontact.interface import LawResult

class Own:
    internal, calls = 0, 0
    def count(self):
        self.calls += 1
        if MPI.COMM_WORLD.rank == 1 and self.calls > {after}: raise ValueError("too fast")
    def update(self, state, kinematics):
        self.count()
        n = len(kinematics.pressure)
        none, block = np.zeros((n, 2)), np.zeros((n, 2, 2))
        at = state.internal, none[:, 0], none[:, 0]
        return LawResult(none, none, block, none, block, block, *at)

class Spring(Own):
    history, young = {{}}, 1e3
    def update(self, state):
        self.count()
        eye = np.eye(3)
        unit = np.einsum("ik,jl->ijkl", eye, eye) + np.einsum("il,jk->ijkl", eye, eye)
        slope = np.tile(500.0 * unit, (len(state.strain), 1, 1, 1, 1))
        return PointResult(1e3 * state.strain, slope, {{}})
"""


@pytest.mark.mpi
@pytest.mark.ci
@pytest.mark.slow
@pytest.mark.parametrize(
    ("law", "after", "code"), [("Own", 0, 2), ("Own", 12, 3), ("Spring", 12, 3)]
)
def test_a_law_in_python_that_fails_on_one_rank(
    case: Path, law: str, after: int, code: int
) -> None:
    """The run stops with the file and line of the law, on both processes, and says it once."""
    (case.parent / "own.py").write_text(LAW.format(after=after))
    text, table = case.read_text(), f'file = "own.py"\nlaw = "{law}"\n'
    if law == "Own":
        first, last = text.index("adhesion ="), text.index("[[step]]")
        text = f"{text[:first]}[contact.python]\n{table}isotropic = true\n{text[last:]}"
    else:
        first, last = text.index("model ="), text.index("[", text.index("model ="))
        text = f'{text[:first]}model = "python"\n{table}{text[last:]}'
    case.write_text(text)
    done = run(case, "", "")
    assert done.returncode == code, done.stderr
    assert done.stderr.count("own.py, line 11: ValueError: too fast") == 1
    if code == 3:
        assert json.loads((case.parent / "out" / "summary.json").read_text())["steps"] > 0


@pytest.mark.mpi
@pytest.mark.slow
def test_memory_that_ends_on_one_rank(case: Path) -> None:
    """One line for all of them; it is no mistake of the program."""
    done = run(case, "1", "memory")
    assert done.returncode == 3, done.stderr
    assert done.stderr.count("out of memory (Unable to allocate 74.5 GiB): take") == 1
    assert "internal" not in done.stderr and "Abort(" not in done.stderr
    summary = json.loads((case.parent / "out" / "summary.json").read_text())
    assert summary["message"].startswith("out of memory")


@pytest.mark.mpi
@pytest.mark.slow
@pytest.mark.parametrize(("where", "what"), [("1", "SIGINT"), ("01", "SIGINT"), ("0", "SIGTERM")])
def test_interrupt(case: Path, where: str, what: str) -> None:
    """Ctrl-C or TERM, on one rank or on all, ends the run after the increment; it can go on."""
    done = run(case, where, what)
    assert done.returncode == 3, done.stderr
    assert done.stderr.count("error: stopped: interrupted after step") == 1
    assert (case.parent / "out" / "checkpoint.npz").is_file()


@pytest.mark.mpi
@pytest.mark.slow
def test_files_in_pieces_are_those_of_one_process(case: Path) -> None:
    """Volume, extremes of the fields, slave points and tables do not depend on the processes."""
    case.write_text(case.read_text() + "\n[solver]\noptions = { snes_rtol = 1e-12 }\n")
    two = Results((run(case, "", ""), case.parent / "out")[1])
    assert main(["run", str(case), "-o", str(case.parent / "one")]) == 0
    one = Results(case.parent / "one")
    assert two.fields_file().suffix == ".pvtu"
    assert len(two.times) == len(one.times) > 2
    a, b = one.fields(), two.fields()
    assert a.n_cells == b.n_cells
    assert b.volume == pytest.approx(a.volume, rel=1e-12)
    for name in ("displacement", "stress", "von_mises"):
        low, high = a[name].min(axis=0), a[name].max(axis=0)
        assert b[name].min(axis=0) == pytest.approx(low, abs=1e-9 * np.abs(a[name]).max())
        assert b[name].max(axis=0) == pytest.approx(high, abs=1e-9 * np.abs(a[name]).max())
    c, d = one.contact(), two.contact()
    assert list((two.folder / "contact").glob("*.pvtp"))
    assert set(c.point_data.keys()) == set(d.point_data.keys())
    order = [np.lexsort(np.round(x.points, 6).T) for x in (c, d)]
    assert np.allclose(c["traction"][order[0]], d["traction"][order[1]], rtol=1e-9)
    assert two.surfaces().n_points == one.surfaces().n_points
    for name, column in one.history.items():
        if column.dtype.kind == "f" and name not in ("residual",):
            near = 1e-9 * np.abs(column[np.isfinite(column)]).max(initial=0.0)
            same = pytest.approx(column, rel=1e-8, abs=near, nan_ok=True)
            assert two.history[name] == same, name
