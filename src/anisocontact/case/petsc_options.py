"""Options of PETSc in a case file."""

from __future__ import annotations

from collections.abc import Mapping

from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import PETSc
from anisocontact.base.strategies import AUTO, CONDENSED, DIRECT, ITERATIVE
from anisocontact.solver.strategies.database import Database, OptionValue
from anisocontact.solver.strategies.iterative.defaults import DEFAULTS

_OF_PETSC = ("snes_", "ksp_", "pc_", "mat_", "vec_", "sub_", "mg_", "fieldsplit_")
_OF_LEVELS = (*_OF_PETSC, "smoother_", "coarse_", "aggregates_")
#: How names of options begin that a strategy reads.
PARTS = {AUTO: _OF_LEVELS, ITERATIVE: _OF_LEVELS, DIRECT: _OF_PETSC, CONDENSED: _OF_PETSC}
#: ... and of those that PETSc reads before it has a matrix of some size.
_EARLY = ("snes_", "ksp_", "smoother_ksp_", "coarse_ksp_", "aggregates_pc_gamg_")
_OF_MUMPS = ("mat_mumps_", "coarse_mat_mumps_")
#: ... and those that it reads when something has been solved.
_LATE = ("_view", "_converged_reason")
#: How names of numbers end that must not be negative: PETSc takes those for something else.
_COUNTED = ("_rtol", "_atol", "_stol", "_max_it")
_PREFIX = "anisocontact_check_"


def check_options(options: Mapping[str, str | int | float | bool], strategy: str) -> None:
    """Let PETSc read the options once: a wrong one is found before anything is written.

    Args:
        options: Values by name, without prefix.
        strategy: Who solves: one that is added from outside may read names of its own.

    Raises:
        InputError: Nobody reads an option, or PETSc refuses one.
    """
    parts = PARTS.get(strategy, ("",))
    for name in options:
        if not name.startswith(parts):
            raise InputError(
                f"no part of the solver reads it: names begin with one of {', '.join(parts)}",
                field=f"solver.options.{name}",
            )
        value = options[name]
        if name.endswith(_COUNTED) and isinstance(value, int | float) and not value >= 0.0:
            raise InputError(f"{value!r} given, must be >= 0", field=f"solver.options.{name}")
    try:
        unread = _unread(options, strategy)
    except PETSc.Error as error:
        raise _refused(options, strategy, _reason(error)) from None
    for name in unread:
        raise InputError("PETSc knows no such option", field=f"solver.options.{name}")


def _refused(options: Mapping[str, OptionValue], strategy: str, reason: str) -> InputError:
    """What PETSc refuses, for a reason: one option, or all together."""
    for name, value in options.items():
        try:
            _unread({name: value}, strategy)
        except PETSc.Error as error:
            if _reason(error) == reason:
                text = f"{value!r} given, PETSc refuses it: {reason}"
                return InputError(text, field=f"solver.options.{name}")
    return InputError(f"PETSc refuses them: {reason}", field="solver.options")


def _reason(error: PETSc.Error) -> str:
    return str(error).splitlines()[-1].split("] ", 1)[-1]


def _unread(options: Mapping[str, OptionValue], strategy: str) -> list[str]:
    """Options that nothing reads of those that are read early.

    Raises:
        PETSc.Error: PETSc refuses one.
    """
    levels = strategy in (AUTO, ITERATIVE)
    # what else a Krylov method reads goes by its type
    types = {n: v for n, v in DEFAULTS.items() if n.endswith("ksp_type")} if levels else {}
    database = Database(_PREFIX, types | dict(options), "solver.options")
    with database:
        snes = PETSc.SNES().create(PETSc.COMM_SELF)
        snes.setOptionsPrefix(_PREFIX)
        snes.setFromOptions()
        mumps = _by_mumps(snes.getKSP(), factorises=strategy != ITERATIVE)
        snes.destroy()
        for part in ("smoother_", "coarse_") if levels else ():
            ksp = PETSc.KSP().create(PETSc.COMM_SELF)
            ksp.setOptionsPrefix(_PREFIX + part)
            mumps = _by_mumps(ksp, factorises=part == "coarse_") or mumps
            ksp.destroy()
        if levels:
            pc = PETSc.PC().create(PETSc.COMM_SELF)
            pc.setOptionsPrefix(f"{_PREFIX}aggregates_")
            pc.setType(PETSc.PC.Type.GAMG)
            pc.setFromOptions()
            pc.destroy()
    early = (*_EARLY, *(_OF_MUMPS if mumps else ()))
    asked = (name for name in options if name.startswith(early) and not name.endswith(_LATE))
    return [name for name in asked if name in database.left]


def _by_mumps(ksp: PETSc.KSP, factorises: bool) -> bool:
    """Let a linear solver read its options, for a factor with a matrix of one row.

    Args:
        ksp: The solver.
        factorises: Whether it factorises unless an option says otherwise.

    Returns:
        Whether MUMPS does.
    """
    pc = ksp.getPC()
    if factorises:
        pc.setType(PETSc.PC.Type.LU)
        if PETSc.Sys.hasExternalPackage("mumps"):
            pc.setFactorSolverType(PETSc.Mat.SolverType.MUMPS)
    ksp.setFromOptions()
    pc.setFromOptions()
    if pc.getType() not in (PETSc.PC.Type.LU, PETSc.PC.Type.CHOLESKY):
        return False
    one = PETSc.Mat().createAIJ(1, comm=PETSc.COMM_SELF)
    one.setValue(0, 0, 1.0)
    one.assemble()
    ksp.setOperators(one)
    ksp.setUp()
    one.destroy()
    return bool(pc.getFactorSolverType() == PETSc.Mat.SolverType.MUMPS)
