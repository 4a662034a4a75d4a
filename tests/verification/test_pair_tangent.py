"""The pair kernel against the same update in dual numbers of everything that moves.

Requirement: tractions, all derivatives and trial states of the contact of two facets agree with an
independent evaluation by automatic differentiation, on facets, edges and vertices, with every
sliding rule, adhesion and friction model and with directions on either body.
Source: `tests/cpp/dual_pair.hpp`, the kinematics and the law in the basis of the facet in dual
numbers of 27 inputs. Tolerance: 1e-12 of the largest number of each kind, rounding; it is in the
program, which also fails where stick or slip do not occur.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.mark.slow
def test_pair_kernel_against_dual_numbers(tmp_path):
    """Compiles and runs the program."""
    folders = [Path(p, "cmeel.prefix/include/eigen3") for p in sys.path]
    eigen = next(p for p in (*folders, Path("/usr/include/eigen3")) if (p / "Eigen/Core").is_file())
    compiler = os.environ.get("CXX", "").split() or [shutil.which("c++") or "g++"]
    program = tmp_path / "pair_tangent"
    command = [*compiler, "-std=c++20", "-O0", f"-I{ROOT / 'cpp/include'}", f"-isystem{eigen}"]
    sources = [str(ROOT / name) for name in ("tests/cpp/pair_tangent.cpp", "cpp/src/laws.cpp")]
    subprocess.run([*command, *sources, "-o", str(program), "-pthread"], check=True)
    r = subprocess.run([str(program)], capture_output=True, text=True, check=False)
    assert r.returncode == 0, r.stdout
