"""Forms and expressions as machine code, compiled once or found in DOLFINx' cache."""

from __future__ import annotations

import contextlib
import re
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from anisocontact.base.array_types import Floats
from anisocontact.base.compiler import FAST, lack_of_compiler, machine_key
from anisocontact.base.fenicsx import MPI, dolfinx, fem

#: Seconds after which nobody is taken to compile a form any more.
ABANDONED = 60.0
_WAITED = "JIT compilation timed out"
_MODULE = re.compile(r"\(e\.g\. remove (.+?\.c)\)")


def compiled(form: Any, comm: MPI.Comm) -> Any:
    """A form as machine code: `fem.form`, also where a process was killed while it compiled.

    Args:
        form: UFL form.
        comm: Communicator of its mesh.

    Raises:
        MachineError: It cannot be compiled on this machine.
    """
    return _from_cache(lambda options: fem.form(form, jit_options=options), comm)


def compiled_expression(expression: Any, points: Floats, comm: MPI.Comm) -> Any:
    """An expression at points of each cell as machine code: `fem.Expression`, as `compiled`."""
    return _from_cache(
        lambda options: fem.Expression(expression, points, jit_options=options), comm
    )


def _jit_options() -> list[dict[str, Any]]:
    """Ways to compile, the fastest code first: a compiler may not take its arguments.

    Who has set arguments for DOLFINx has chosen.
    """
    given = dolfinx.jit.get_options()
    if given["cffi_extra_compile_args"] != _JIT_DEFAULTS["cffi_extra_compile_args"][0]:
        return [given]
    own = {
        "cffi_extra_compile_args": list(FAST),
        "cache_dir": Path(given["cache_dir"], machine_key()),
    }
    return [given | own, given]


_JIT_DEFAULTS = dolfinx.jit.DOLFINX_DEFAULT_JIT_OPTIONS


def _from_cache(compile_: Callable[[dict[str, Any]], Any], comm: MPI.Comm) -> Any:
    """What FFCx compiles, or has compiled before.

    It marks a form that is being compiled by a file in its cache and gives up after ten seconds
    of waiting for whoever wrote it. A slow compilation is waited for, what a dead one has left is
    removed.
    """
    options, *others = _jit_options()
    while True:
        try:
            return compile_(options)
        except (TimeoutError, RuntimeError) as error:
            if _WAITED in str(error):
                _wait(error, comm)
            elif others:
                options, *others = others
            else:
                raise _not_compiled(error) from error
        except Exception as error:
            if not others:
                raise _not_compiled(error) from error
            options, *others = others


def _wait(error: Exception, comm: MPI.Comm) -> None:
    """Remove the mark that a form waits for if whoever wrote it is dead."""
    if comm.rank == 0 and (found := _MODULE.search(str(error))):
        mark = Path(found[1])
        with contextlib.suppress(FileNotFoundError):
            if time.time() - mark.stat().st_mtime > ABANDONED:
                mark.unlink()
    comm.barrier()


def _not_compiled(error: Exception) -> Exception:
    """What the machine lacks, or the error itself."""
    return lack_of_compiler(Path(dolfinx.jit.get_options()["cache_dir"])) or error
