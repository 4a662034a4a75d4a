"""A test that kills its process, or hangs, ends `make test` in time and is named."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
QUIET = """
import pytest

@pytest.mark.parametrize("number", range(3))
def test_quiet(number):
    pass
"""
DEADLY = """
import os, signal, time

def test_deadly():
    {deed}
"""


def _options() -> list[str]:
    """What `make test` gives pytest to share the tests among processes."""
    command = ["make", "-C", str(ROOT), "--no-print-directory", "--dry-run", "test"]
    env = {name: value for name, value in os.environ.items() if not name.startswith("MAKE")}
    told = subprocess.run(command, env=env, capture_output=True, text=True, check=True).stdout
    given = re.search(r"pytest (-n auto .*?)--durations", told.replace("\\\n", " "))
    assert given
    return shlex.split(given[1])


@pytest.mark.parametrize(
    "deed", ["os.abort()", "os.kill(os.getpid(), signal.SIGKILL)", "time.sleep(60)"]
)
def test_a_dead_worker_ends_the_run(tmp_path: Path, deed: str) -> None:
    """Requirement: pytest fails within seconds and names the test.

    Source: with workers that are replaced, xdist 3.8 by files hangs where a test dies twice. A test
    that hangs is given a second here.
    """
    for name in "abc":
        (tmp_path / f"test_{name}.py").write_text(QUIET)
    (tmp_path / "test_b.py").write_text(QUIET + DEADLY.format(deed=deed) + QUIET)
    command = [sys.executable, "-m", "pytest", *_options(), "-n", "2", "--rootdir", str(tmp_path)]
    command += ["-c", str(ROOT / "pyproject.toml"), "-o", "faulthandler_timeout=1"]
    command += ["-p", "no:cacheprovider", "-p", "no:hypothesispytest", str(tmp_path)]
    done = subprocess.run(
        command, cwd=tmp_path, capture_output=True, text=True, check=False, timeout=50
    )
    assert done.returncode == 1
    assert re.search(r"crashed while running '.*test_b\.py::test_deadly'", done.stdout)


def test_a_test_that_hangs_is_ended(pytestconfig: pytest.Config) -> None:
    assert pytestconfig.getini("faulthandler_exit_on_timeout")
    assert 300 <= float(pytestconfig.getini("faulthandler_timeout")) <= 1800
