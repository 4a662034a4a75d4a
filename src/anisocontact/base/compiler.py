"""Whether forms can be compiled on this machine."""

from __future__ import annotations

import hashlib
import os
import platform
import shlex
import shutil
import subprocess
import sysconfig
import tempfile
from functools import cache as once
from pathlib import Path

from anisocontact.base.errors import MachineError

#: Arguments for code of this machine alone whose sums may be in any order, and in which what is not
#: a number stays none: an iterate far off is judged by that. FFCx writes straight loops: what the
#: second level of optimisation does beyond vectors takes a third longer, to no quicker matrix. But
#: without what GCC calls expensive nothing clears the upper halves of vector registers before a
#: call, and every logarithm or power at a quadrature point waits for some hundred nanoseconds.
FAST = (
    *("-O1", "-fexpensive-optimizations", "-ftree-vectorize", "-march=native"),
    *("-ffast-math", "-fno-finite-math-only", "-g0"),
)

#: What a compiled form begins with.
_PROBE = "#include <Python.h>\n"


@once
def machine_key() -> str:
    """Name of this kind of processor: code made for one may not run on another.

    A home of many machines, or a folder copied to another, so never mixes their code.
    """
    told = [platform.machine(), platform.processor()]
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        lines = []
    for name in _TELLING:
        told += [line for line in lines if line.startswith(name)][:1]
    return f"{platform.machine()}-{hashlib.sha256(chr(10).join(told).encode()).hexdigest()[:12]}"


#: What tells processors apart, lines of the first one: what it can do, and which one it is.
_TELLING = ("vendor_id", "cpu family", "model", "flags", "Features", "CPU part")


def lack_of_compiler(cache: Path) -> MachineError | None:
    """What is missing where forms could not be compiled.

    Args:
        cache: Folder in which compiled forms are kept.

    Returns:
        One line; None if forms can be compiled here.
    """
    try:
        cache.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=cache):
            pass
    except OSError as error:
        text = f"compiled forms cannot be kept in '{cache}' ({error.strerror})"
        return MachineError(text, "set XDG_CACHE_HOME to a folder that can be written")
    compiler = shlex.split(os.environ.get("CC") or sysconfig.get_config_var("CC") or "cc")
    if shutil.which(compiler[0]) is None:
        text = f"no C compiler, '{compiler[0]}' is not found, and forms have to be compiled"
        return MachineError(text, "install gcc or clang, or name yours in the variable CC")
    said = _compiled(compiler)
    if said is None:
        return None
    text = f"the C compiler '{shlex.join(compiler)}' does not compile forms ({said})"
    cure = "install Python's development package, or name another compiler in the variable CC"
    return MachineError(text, cure)


def _compiled(compiler: list[str]) -> str | None:
    """Compile what includes Python's header; None if that works, else what the compiler says."""
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder, "probe.c")
        source.write_text(_PROBE)
        command = [*compiler, f"-I{sysconfig.get_paths()['include']}", "-c", "probe.c"]
        done = subprocess.run(
            command, cwd=folder, capture_output=True, text=True, errors="replace", check=False
        )
    if done.returncode == 0:
        return None
    lines = [line for line in done.stderr.splitlines() if "error" in line.lower()]
    return next(iter(lines), f"exit code {done.returncode}")
