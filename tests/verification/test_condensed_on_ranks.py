"""Static condensation on several processes: the answers of one, with few factorisations."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from tests.verification.test_pairs_on_ranks import start

from anisocontact.solver.strategies.condensed import bordered

#: At points and at slave nodes, linear and at finite strain, order 1 and 2, with a law in Python, a
#: free rigid body, multipliers, a surface that meets itself, and symmetry planes along axes.
NAMES = (
    "single",
    "in-python",
    "second-order",
    "far",
    "following",
    "under-a-lid",
    "mortar",
    "mortar-far",
    "mortar-folded",
    "mortar-following",
    "mortar-symmetric",
    "mortar-under-a-lid",
)
#: Corrections for each factorisation, at least.
PER_FACTOR = 5

pytestmark = [
    pytest.mark.mpi,
    pytest.mark.skipif(shutil.which("mpirun") is None, reason="no mpirun"),
    pytest.mark.skipif(not bordered.reachable(), reason="a PETSc without MUMPS"),
]


def _compared(folder: Path, ranks: int, names: tuple[str, ...]) -> dict[str, float]:
    """Corrections for each factorisation, by case; answers are those of one process."""
    start(1, folder, "direct", *names, script="condensed_on_ranks")
    start(ranks, folder, "condensed", *names, script="condensed_on_ranks")
    found = {}
    for name in names:
        with np.load(folder / f"{name}-1-direct.npz") as one:
            expected = one["numbers"]
        with np.load(folder / f"{name}-{ranks}-condensed.npz") as several:
            error = np.abs(several["numbers"] - expected).max() / np.abs(expected).max()
            found[name] = float(several["corrections"] / several["factors"])
        assert error < 1e-11, f"{name} on {ranks}: {error}"
    return found


@pytest.mark.ci
@pytest.mark.slow
def test_two_processes(tmp_path: Path) -> None:
    """Energies, forces and reactions after every increment, and how often all is factorised.

    Requirement: the answers of `direct` on one process; one factorisation for five corrections at
    most, where one that does not precondition is replaced in each. Source: the same equations.
    Tolerance 1e-11: residuals are solved to 1e-13, sums are in another order; 5e-13 measured.
    """
    found = _compared(tmp_path, 2, NAMES)
    assert min(found.values()) > PER_FACTOR, found


@pytest.mark.slow
def test_three_processes(tmp_path: Path) -> None:
    """Parts that touch and parts that do not; some are as small as the border between them.

    Requirement: the answers of `direct` on one process. Source: the same equations. Tolerance
    1e-11: residuals are solved to 1e-13, sums are in another order; 7e-13 measured.
    """
    _compared(tmp_path, 3, NAMES)


#: Two bodies on a plane, with a strategy that is asked for.
CASE = """
[mesh.box.block]
origin = [0, 0, 0]
size = [1, 1, 0.5]
cells = [2, 2, 1]

[mesh.box.head]
origin = [0, 0, 0.5]
size = [1, 1, 0.5]
cells = [2, 2, 1]

[material.block]
model = "{model}"
E = 1.0
nu = 0.4

[material.head]
model = "neo-hookean"
E = 1.0
nu = 0.3

[surface.plane]
shape = "plane"
point = [0, 0, 0]
normal = [0, 0, 1]

[[contact]]
slave = "block.bottom"
master = "plane"
normal = {{ penalty = 10.0 }}
adhesion = {{ stiffness = 10.0 }}
friction = {{ coefficients = 0.3 }}

[[step]]
name = "press"
increments = 1

[step.displacement]
"block.top" = {{ x = 0, y = 0, z = -0.01 }}
"head.top" = {{ x = 0, y = 0, z = 0 }}

[output]
pictures = false

{more}
[solver]
strategy = "condensed"
"""


@pytest.mark.ci
@pytest.mark.slow
@pytest.mark.parametrize(
    ("model", "more", "said"),
    [
        (
            "neo-hookean",
            '[[tie]]\nslave = "head.bottom"\nmaster = "block.top"\n',
            "nodes follow other nodes",
        ),
        ("neo-hookean-incompressible", "", "changes of volume are kept apart"),
    ],
)
def test_what_needs_one_process(tmp_path: Path, model: str, more: str, said: str) -> None:
    """It is said in one line where it is asked for, and nothing is written; `auto` takes another.

    Requirement: no silent change of strategy. Source: docs/howto/strategies.md.
    """
    text = CASE.format(model=model, more=more)
    (tmp_path / "case.toml").write_text(text)
    command = "-m anisocontact run case.toml -o out"
    run = ["mpirun", "-n", "2", sys.executable, *command.split()]
    done = subprocess.run(run, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 2, done.stderr
    (line,) = done.stderr.strip().splitlines()
    assert said in line
    assert not (tmp_path / "out").exists()
    (tmp_path / "case.toml").write_text(text.replace('"condensed"', '"auto"'))
    done = subprocess.run(run, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert said in (tmp_path / "out" / "run.log").read_text()
