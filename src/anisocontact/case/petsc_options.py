"""Options of PETSc in a case file."""

from __future__ import annotations

from collections.abc import Mapping

from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import PETSc
from anisocontact.base.strategies import AUTO, CONDENSED, DIRECT, ITERATIVE

_OF_PETSC = ("snes_", "ksp_", "pc_", "mat_", "vec_", "sub_", "mg_", "fieldsplit_")
_OF_LEVELS = (*_OF_PETSC, "smoother_", "coarse_", "aggregates_")
#: How names of options begin that a strategy reads.
PARTS = {AUTO: _OF_LEVELS, ITERATIVE: _OF_LEVELS, DIRECT: _OF_PETSC, CONDENSED: _OF_PETSC}


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
    prefix = "anisocontact_check_"
    database = PETSc.Options()
    for name, value in options.items():
        database.setValue(prefix + name, value)
    snes = PETSc.SNES().create()
    snes.setOptionsPrefix(prefix)
    try:
        snes.setFromOptions()
        snes.getKSP().setFromOptions()
        snes.getKSP().getPC().setFromOptions()
        for name in options:
            # What the matrices and preconditioners read, they read when they are set up.
            if name.startswith(("snes_", "ksp_")) and not database.used(prefix + name):
                raise InputError(
                    "PETSc's SNES and KSP know no such option", field=f"solver.options.{name}"
                )
    except PETSc.Error as error:
        reason = str(error).splitlines()[-1]
        raise InputError(f"PETSc refuses them: {reason}", field="solver.options") from None
    finally:
        snes.destroy()
        for name in options:
            database.delValue(prefix + name)
