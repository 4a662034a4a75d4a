"""The update of a point takes no memory, whatever the sliding rule.

Requirement: no allocation in the loop over points. `tests/cpp/no_allocation.cpp` replaces malloc by
one that counts, which works with glibc alone, and walks through open, stick and slip with every
rule on four surfaces, with and without tangent. It also fails where its counter does not count.
"""

from __future__ import annotations

import os
import platform
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
SOURCE = ROOT / "tests/cpp/no_allocation.cpp"


def eigen():
    """Headers of the cmeel-eigen package, or those of the system."""
    folders = [Path(p, "cmeel.prefix/include/eigen3") for p in sys.path]
    found = [p for p in (*folders, Path("/usr/include/eigen3")) if (p / "Eigen/Core").is_file()]
    assert found, "Eigen's headers: pip install cmeel-eigen"
    return found[0]


@pytest.mark.ci
@pytest.mark.slow
@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="counts glibc's malloc")
def test_no_allocation_in_the_hot_path(tmp_path):
    compiler = os.environ.get("CXX", "").split() or [shutil.which("c++") or "g++"]
    program = tmp_path / "no_allocation"
    command = [*compiler, "-std=c++20", "-O0", f"-I{ROOT / 'cpp/include'}", f"-isystem{eigen()}"]
    sources = [str(SOURCE), *map(str, (ROOT / "cpp/src").glob("*.cpp"))]
    subprocess.run([*command, *sources, "-o", str(program), "-pthread"], check=True)
    r = subprocess.run([str(program)], capture_output=True, text=True, check=False)
    assert r.returncode == 0, r.stdout
    assert r.stdout == "0 allocations in the hot path\n"
