"""Matrices of forms that several processes share are those that PETSc sums up."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

ROOT = Path(__file__).parents[2]


@pytest.mark.mpi
@pytest.mark.parametrize("ranks", [2, 3])
def test_rows_of_dolfinx_and_their_places_are_those_of_petsc(ranks: int) -> None:
    """Summed in rows of DOLFINx, written and added beside other entries, with unknowns behind.

    Requirement: the matrix that PETSc sums up cell by cell, anew for other coefficients; nothing
    is written on any process where one lacks a place. Tolerance: cells are summed in another order
    where processes meet, 2e-16 measured.
    """
    if shutil.which("mpirun") is None:
        pytest.skip("no mpirun")
    script = [sys.executable, "-m", "tests.unit.matrices_on_ranks"]
    command = ["timeout", "-k", "5", "60", "mpirun", "-n", str(ranks), *script]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert np.array(done.stdout.split(), dtype=float).max() < 1e-14
