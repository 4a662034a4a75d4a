"""Forms are compiled once, waited for, and compiled anew where a killed process left a mark."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import time

import pytest

_fenicsx = pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

ANSWER = "JIT compilation timed out, probably due to x. Try cleaning cache (e.g. remove {}) or so."


@pytest.mark.parametrize(("age", "waits"), [(2.0 * _fenicsx.ABANDONED, 1), (1.0, 3)])
def test_marks_of_the_dead_are_removed_and_the_living_waited_for(tmp_path, monkeypatch, age, waits):
    mark = tmp_path / "libffcx_forms_1.c"
    mark.touch()
    os.utime(mark, (time.time() - age,) * 2)
    asked = []

    def form(what):
        asked.append(what)
        if not mark.exists() or len(asked) > waits:
            return "compiled"
        raise TimeoutError(ANSWER.format(mark))

    monkeypatch.setattr(_fenicsx.fem, "form", form)
    assert _fenicsx.compiled("form", _fenicsx.MPI.COMM_SELF) == "compiled"
    assert len(asked) == waits + 1
    assert mark.exists() == (age < _fenicsx.ABANDONED)


def test_other_failures_stay_failures(monkeypatch):
    def form(_):
        raise RuntimeError("no compiler")

    monkeypatch.setattr(_fenicsx.fem, "form", form)
    with pytest.raises(RuntimeError, match="no compiler"):
        _fenicsx.compiled("form", _fenicsx.MPI.COMM_SELF)


@pytest.mark.slow
def test_a_run_after_one_that_was_killed_while_it_compiled(tmp_path, case_text):
    """FFCx waits ten seconds for the mark, then the form is compiled anew."""
    (tmp_path / "case.toml").write_text(case_text)
    check = [sys.executable, "-m", "anisocontact", "check", str(tmp_path / "case.toml")]
    environment = os.environ | {"XDG_CACHE_HOME": str(tmp_path / "cache")}
    cache = tmp_path / "cache" / "fenics"
    subprocess.run(check, env=environment, check=True, capture_output=True)
    marks = list(cache.glob("libffcx_forms_*.c"))
    assert marks
    for path in cache.iterdir():
        if path.suffix != ".c":
            shutil.rmtree(path) if path.is_dir() else path.unlink()
    for mark in marks:
        os.utime(mark, (time.time() - 2.0 * _fenicsx.ABANDONED,) * 2)
    subprocess.run(check, env=environment, check=True, capture_output=True)
