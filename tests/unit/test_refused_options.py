"""Options that PETSc refuses, when they are given or later, end a run in one line.

Many options are read when something is first solved: kinds of factors, thresholds of aggregates.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from tests.unit.test_unread_options import said as warned
from tests.unit.test_unread_options import script

from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import PETSc
from anisocontact.bulk import make_material
from anisocontact.solver import ElasticSupport, Problem, Solver, Step

PREFIX = "unread_"
WRONG = [
    ("direct", {"pc_factor_mat_solver_type": "mumpz"}, "Could not locate solver type mumpz"),
    ("iterative", {"pc_type": "ilu"}, "does not support factorization type ILU"),
    ("iterative", {"aggregates_pc_gamg_threshold": "x"}, "Input string x has no numeric value"),
    ("iterative", {"smoother_pc_type": "jacoby"}, "jacoby"),
    ("condensed", {"snes_type": "newtontr"}, "multiply transpose"),
]


@pytest.mark.parametrize(("strategy", "options", "why"), WRONG)
def test_what_petsc_refuses_late_is_one_line(
    fe: Any, strategy: str, options: dict[str, Any], why: str
) -> None:
    """Requirement: field, option, and PETSc's reason without its stack; none stay behind."""
    with pytest.raises(InputError) as refused:
        warned(fe, strategy, options)
    line = str(refused.value)
    assert line.startswith(f"options: PETSc fails with {next(iter(options))}: ")
    assert why in line
    assert "error code" not in line
    assert PETSc.Options(PREFIX).getAll() == {}


@pytest.mark.parametrize("strategy", ["direct", "condensed", "iterative"])
@pytest.mark.parametrize(
    ("method", "why"),
    [
        ("ksponly", "never asks whether forces are in balance"),
        ("fas", "needs coarser problems, and there are none"),
    ],
)
def test_methods_that_do_not_fit_are_refused(fe: Any, strategy: str, method: str, why: str) -> None:
    """One linear solution, whose result PETSc calls converged whatever forces are left; full
    approximation storage, for which there is one level."""
    with pytest.raises(InputError, match=f"^options.snes_type: '{method}' given, which {why}$"):
        warned(fe, strategy, {"snes_type": method})


@pytest.mark.parametrize("method", ["newtontr", "newtontrdc"])
def test_trust_regions_have_no_line_search(method: str) -> None:
    """Requirement: corrections in full, asked for and not, leave a method alone that has no line
    search; to give it back what it never had ended the process."""
    problem = script({"snes_type": method})
    for full_steps in (True, False):
        x = problem.new_vector()
        assert problem.newton.solve(x, full_steps).reason == ""
        assert np.allclose(x.array_r[2::3], 0.01, rtol=0.0, atol=1e-9)  # moved as a whole


def test_a_factorisation_of_symmetric_matrices_is_refused(fe: Any) -> None:
    """Friction makes a tangent unsymmetric [Wriggers 2006, 9.5], and so do prescribed rows."""
    said = "^options.pc_type: 'cholesky' given, which needs a symmetric tangent: prescribed "
    with pytest.raises(InputError, match=said):
        warned(fe, "direct", {"pc_type": "cholesky"})
    # Krylov iterations look at the whole matrix
    assert warned(fe, "iterative", {"pc_type": "cholesky"}) == []


def test_cholesky_of_a_symmetric_tangent_is_lu(fe: Any) -> None:
    """A block on a frictionless elastic bed: Cholesky's factor gives what LU gives, to rounding."""
    model = fe.block(fe.interface(), cells=(2, 2, 2)).problem.model
    materials = {"block": make_material("linear-elastic", E=100.0, nu=0.3)}
    step = Step("push", 1, {}, traction={"block.top": {"x": 0.1, "z": -1.0}})
    bed = [ElasticSupport("block.bottom", normal=50.0, tangential=20.0)]
    found = []
    for kind in ("lu", "cholesky"):
        problem = Problem(model, materials, attached=bed)
        (accepted,) = Solver(problem, [step], options={"pc_type": kind}, strategy="direct").run()
        assert accepted.iterations == 1
        found.append(problem.u.x.array.copy())
    assert np.abs(found[0]).max() > 1e-3
    assert np.allclose(*found, rtol=0.0, atol=1e-12)


def test_scripts_are_told_in_one_line() -> None:
    problem = script({"pc_factor_mat_solver_type": "mumpz"})
    with pytest.raises(InputError, match=r"^petsc_options: PETSc fails with .*: Could not locate"):
        problem.solve()


@pytest.mark.parametrize("name", ["pc_precision", "coarse_pc_precision"])
@pytest.mark.parametrize("word", ["half", "singel", 1])
def test_precisions_that_would_end_the_process_are_refused(fe: Any, name: str, word: Any) -> None:
    """PETSc crashes where it reads the name of a precision that it does not have."""
    block = fe.block(fe.interface(), cells=(1, 1, 1))
    said = f"^options.{name}: {word!r} given, allowed: single, double"
    with pytest.raises(InputError, match=said):
        Solver(block.problem, [Step("press", 1, {"block.top": {"z": -0.01}})], options={name: word})


@pytest.mark.parametrize("option", ["snes_rtol", "snes_atol"])
def test_states_out_of_balance_are_told(fe: Any, option: str) -> None:
    """Requirement: a tolerance that accepts what is no equilibrium is never silent; once a run.

    Tolerance: the run warns from 1e-4 of the forces at work on. The block is dragged as well: where
    it is pressed alone rounding says what touches first, and the second iterate may be exact.
    """
    drag = Step("drag", 2, {"block.top": {"x": 0.02, "y": 0.0, "z": -0.01}})

    def lines(options: dict[str, Any]) -> list[str]:
        block = fe.block(fe.interface(coefficients=(0.3, 0.3)), cells=(3, 3, 2))
        warnings: list[str] = []
        run = Solver(block.problem, [drag], PREFIX, options, strategy="direct")
        list(run.run(on_warning=warnings.append))
        return warnings

    told = "of the forces at work are out of balance"
    said = lines({option: 0.99 if option == "snes_rtol" else 1e3})
    assert sum(told in line for line in said) == 1
    assert not any(told in line for line in lines({"snes_rtol": 1e-4}))


def test_options_that_petsc_cannot_read_are_no_error_of_the_program(tmp_path: Path) -> None:
    """Requirement: PETSc reads its environment as it is loaded; a file that is not there is said
    in the last line, as what the machine lacks."""
    case = Path(__file__).with_name("small_block.toml")
    command = [sys.executable, "-m", "anisocontact", "check", str(case)]
    options = {"PETSC_OPTIONS": f"-options_file {tmp_path}/none"}
    done = subprocess.run(
        command, env=os.environ | options, capture_output=True, text=True, check=False
    )
    assert done.returncode == 3
    last = done.stderr.strip().splitlines()[-1]
    assert last.startswith("error: PETSc cannot be loaded (error code ")
    assert "PETSC_OPTIONS" in last
