"""Options of PETSc that nothing reads are told, those that something reads are not."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.base.errors import ModelWarning
from anisocontact.base.fenicsx import PETSc, fem, ufl
from anisocontact.solver import ContactProblem, Solver, Step

#: Options that a strategy reads, early or late, and some that it does not, for all their prefixes.
READ = {
    "direct": {"snes_max_it": 60, "pc_factor_mat_ordering_type": "nd", "mat_mumps_icntl_14": 50},
    "iterative": {
        "ksp_max_it": 300,
        "smoother_ksp_max_it": 3,
        "smoother_pc_type": "jacobi",
        "coarse_mat_mumps_icntl_14": 40,
    },
    "condensed": {"snes_max_it": 60, "snes_rtol": 1e-9},
}
UNREAD = {
    "direct": {"mat_mumps_icnt_14": 50, "pc_factr_levels": 1},
    "iterative": {"smoother_ksp_max_itt": 3, "coarse_pc_typo": "lu"},
    "condensed": {"snes_max_itt": 60},
}
PREFIX = "unread_"


def said(fe: Any, strategy: str, options: dict[str, Any]) -> list[str]:
    """What a run of two increments warns of."""
    block = fe.block(fe.interface(coefficients=(0.3, 0.3)), cells=(3, 3, 2))
    step = Step("press", 2, {"block.top": {"x": 0.0, "y": 0.0, "z": -0.01}})
    warnings: list[str] = []
    run = Solver(block.problem, [step], PREFIX, options, strategy=strategy)
    list(run.run(on_warning=warnings.append))
    return warnings


@pytest.mark.parametrize("strategy", READ)
def test_what_nothing_reads_is_told(fe: Any, strategy: str) -> None:
    """Requirement: one line after the first increment names these alone; none are left behind."""
    assert said(fe, strategy, READ[strategy]) == []
    (line,) = said(fe, strategy, READ[strategy] | UNREAD[strategy])
    assert f"nothing has read: {', '.join(sorted(UNREAD[strategy]))};" in line
    assert PETSc.Options(PREFIX).getAll() == {}


def test_options_of_the_command_line_count_as_well(fe: Any) -> None:
    """An option that is in the database before comes first, and may be read by its name there."""
    PETSc.Options(PREFIX).setValue("snes_max_it", 40)
    try:
        (line,) = said(fe, "direct", {"snes_max_it": 60, "snes_max_itt": 60})
        assert "read: snes_max_itt;" in line
        assert PETSc.Options(PREFIX).getAll() == {"snes_max_it": "40"}
    finally:
        PETSc.Options(PREFIX).delValue("snes_max_it")


def script(options: dict[str, Any]) -> ContactProblem:
    """A block of a form, held below."""
    from anisocontact.mesh import BoxSpec, build_box

    model = build_box({"bar": BoxSpec((0, 0, 0), (1, 1, 1), (2, 2, 2))})
    u, v = fem.Function(model.space), ufl.TestFunction(model.space)
    form = ufl.inner(ufl.sym(ufl.grad(u)), ufl.grad(v)) * ufl.dx
    below = fem.dirichletbc(
        fem.Constant(model.mesh, (0.0, 0.0, 0.01)), model.nodes("bar.bottom"), model.space
    )
    return ContactProblem(form, u, bcs=[below], petsc_options=options)


def test_scripts_are_told_once() -> None:
    """A warning of Python at the first solution, with the place in the script."""
    problem = script({"snes_max_it": 60, "mat_mumps_icntl_14": 30, "ksp_max_itt": 1})
    with pytest.warns(ModelWarning, match="nothing has read: ksp_max_itt;") as told:
        problem.solve()
        problem.solve()
    assert len(told) == 1
    assert told[0].filename == __file__


RANKS = """
from tests.unit.test_unread_options import READ, UNREAD, said
from tests.conftest import FiniteElements
print(said(FiniteElements(), "iterative", READ["iterative"] | UNREAD["iterative"]))
"""


@pytest.mark.mpi
@pytest.mark.slow
def test_processes_tell_the_same() -> None:
    if shutil.which("mpirun") is None:
        pytest.skip("no mpirun")
    command = ["mpirun", "-n", "2", sys.executable, "-c", RANKS]
    root = Path(__file__).parents[2]
    done = subprocess.run(command, cwd=root, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("nothing has read: coarse_pc_typo, smoother_ksp_max_itt;") == 2
