"""Checkpoints that are damaged, and what a full disk leaves."""

from __future__ import annotations

import errno
import json
import os
import re
import resource
import subprocess
import sys

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.base.errors import RunWarning
from anisocontact.cli import main
from anisocontact.results import checkpoint
from anisocontact.results.files import Disk, WriteError


@pytest.mark.parametrize("kind", ["cut", "noise", "text", "other arrays", "format"])
def test_a_damaged_checkpoint_is_one_line(capsys, case, whole, kind):
    path = whole / "checkpoint.npz"
    if kind == "cut":
        path.write_bytes(path.read_bytes()[:-100])
    elif kind == "noise":
        path.write_bytes(b"PK" + bytes(range(256)))
    elif kind == "text":
        path.write_text("no archive")
    elif kind == "other arrays":
        np.savez(path, x=np.zeros(3))
    else:
        stored = checkpoint.load_checkpoint(whole)
        assert stored is not None
        facts = json.dumps(stored.facts | {"format": 0}).encode()
        np.savez(path, **stored.arrays, facts=np.frombuffer(facts, dtype=np.uint8))
    assert main(["run", str(case), "-o", str(whole), "--restart"]) == 2
    error = capsys.readouterr().err
    assert len(error.splitlines()) == 1
    assert "checkpoint.npz" in error
    assert ("it is no checkpoint of a run" in error) == (kind == "other arrays")
    assert "pickle" not in error  # what NumPy says of files that it does not know


@pytest.mark.parametrize("victim", ["history", "fields", "summary", "checkpoint", "log"])
def test_a_full_disk_loses_nothing(monkeypatch, capsys, case, whole, victim, same):
    """Requirement: a full disk is an error that loses nothing: the run goes on when there is room.

    The named file fails from the third accepted increment on. What was accepted before is kept
    where the checkpoint itself has room.
    """
    from anisocontact.results import collection, writer
    from anisocontact.results.history import HistoryTable

    owner, name = {
        "history": (HistoryTable, "append"),
        "fields": (collection, "_write"),
        "summary": (writer, "write_text"),
        "checkpoint": (checkpoint, "save_checkpoint"),
        "log": (writer.Writer, "_append"),
    }[victim]
    real, full = getattr(owner, name), {"now": False}

    def failing(*arguments, **more):
        if full["now"]:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), f"{victim} file")
        return real(*arguments, **more)

    accept = writer.Writer.accept

    def accepting(self, accepted):
        full["now"] = self.summary["steps"] >= 2
        accept(self, accepted)

    out = case.parent / "out"
    with monkeypatch.context() as patch:
        patch.setattr(owner, name, failing)
        patch.setattr(writer.Writer, "accept", accepting)
        assert main(["run", str(case), "-o", str(out)]) == 3
    error = capsys.readouterr().err.splitlines()
    said = f"error: stopped: cannot write '{victim} file': No space left on device"
    assert error[0].startswith(said)
    assert error[-1].startswith("to go on: anisocontact run ")
    stored = checkpoint.load_checkpoint(out)
    assert stored is not None
    if victim != "checkpoint":
        assert stored.facts["writer"]["summary"]["steps"] >= 2
    assert main(["run", str(case), "-o", str(out), "--restart"]) == 0
    assert same(whole, out)


def test_a_disk_that_is_full_at_the_end_is_told(monkeypatch, capsys, case, whole, same):
    """Requirement: a run whose last numbers cannot be written has not ended in order, and ends so
    when it goes on."""
    from anisocontact.results import writer

    real = writer.write_text

    def failing(path, text):
        if path.name == "summary.json" and json.loads(text)["status"] == "done":
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(path))
        real(path, text)

    out = case.parent / "out"
    with monkeypatch.context() as patch:
        patch.setattr(writer, "write_text", failing)
        assert main(["run", str(case), "-o", str(out)]) == 3
    error = capsys.readouterr().err.splitlines()
    said = f"error: stopped: cannot write '{out / 'summary.json'}': No space left on device"
    assert error[0].startswith(said)
    assert error[-1].startswith("to go on: anisocontact run ")
    assert main(["run", str(case), "-o", str(out), "--restart"]) == 0
    assert same(whole, out)


@pytest.mark.parametrize("script", [False, True])
def test_a_report_for_which_there_is_no_room_is_a_warning(monkeypatch, capsys, case, script):
    """Requirement: one line that says why there are no pictures, and how they are made later."""
    from anisocontact.case.build import build
    from anisocontact.case.read import load
    from anisocontact.results import recorded, writer

    def full(*_):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), "report.html")

    out = case.parent / "out"
    case.write_text(case.read_text().replace("pictures = false", "pictures = true"))
    monkeypatch.setattr(writer.Writer, "_report", full)
    said = (
        "no report: cannot write 'report.html': No space left on device; where there is room: "
        f"anisocontact report {out}"
    )
    if script:
        solver = build(load(case)).solver
        with pytest.warns(RunWarning, match=re.escape(said)):
            assert list(recorded(solver, out))
    else:
        assert main(["run", str(case), "-o", str(out)]) == 0
        assert f"warning: {said}" in capsys.readouterr().err.splitlines()
    assert json.loads((out / "summary.json").read_text())["status"] == "done"


def test_files_that_may_not_grow(case, whole, same):
    """The same with a limit of the system on the size of a file, which VTK meets too."""
    out = case.parent / "out"
    code = (
        "import resource, signal, sys; from anisocontact.cli import main; "
        "import anisocontact.base.fenicsx  # MPI needs larger files\n"
        "from contextlib import nullcontext; from anisocontact.results import report_process; "
        "report_process.report_beside = lambda wanted: nullcontext(lambda folder: []); "
        "signal.signal(signal.SIGXFSZ, signal.SIG_IGN); "
        "resource.setrlimit(resource.RLIMIT_FSIZE, ({0}, {0})); "
        f"sys.exit(main(['run', {str(case)!r}, '-o', {str(out)!r}]))"
    )
    assert resource.getrlimit(resource.RLIMIT_FSIZE)[0] == resource.RLIM_INFINITY
    largest = max(p.stat().st_size for p in (whole / "contact").iterdir())
    done = subprocess.run(
        [sys.executable, "-c", code.replace("{0}", str(largest - 1))],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 3, done.stderr
    (line,) = (one for one in done.stderr.splitlines() if one.startswith("error: stopped:"))
    assert re.search(r"cannot write '.*/out/\w+/\w+\.vtp': File too large", line), line
    assert "Traceback" not in done.stderr
    assert not list(out.rglob(".*"))
    assert main(["run", str(case), "-o", str(out), "--restart"]) == 0
    assert same(whole, out)


def test_writing_stops_at_the_first_failure():
    from mpi4py import MPI

    disk, calls = Disk(MPI.COMM_SELF), []
    disk.write(lambda: calls.append(1))
    disk.check()

    def full():
        raise OSError(errno.ENOSPC, "No space left on device", "a")

    disk.write(full)
    disk.write(lambda: calls.append(2))
    with pytest.raises(WriteError, match="cannot write 'a': No space left on device"):
        disk.check()
    assert calls == [1]
