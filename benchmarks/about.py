"""What a benchmark was made with: commit, compiler, versions, machine without its name."""

from __future__ import annotations

import os
import platform
import re
import subprocess
from datetime import UTC, datetime
from pathlib import Path

ROOT = Path(__file__).parent.parent


def commit() -> str:
    """The commit, with "-dirty" where sources differ from it."""
    command = ["git", "-C", str(ROOT), "describe", "--always", "--dirty", "--abbrev=7"]
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    except OSError:
        return "unknown"
    return done.stdout.strip() or "unknown"


def paths() -> str:
    """`PYTHONPATH` for scripts of the benchmarks: this folder, and this code's sources if used."""
    import anisocontact

    here, package = Path(__file__).parent, Path(anisocontact.__file__).parents[1]
    return f"{here}:{package}" if package.name == "src" else str(here)


def compiler() -> str:
    """The compiler that the core itself names."""
    from anisocontact import _core

    binary = Path(_core.__file__).read_bytes()
    found = re.search(rb"GCC: \([^)]*\) [\d.]+|clang version [\d.]+", binary)
    return found[0].decode() if found else "unknown"


def processor() -> str:
    """Kind of processor: maker's name, family and model, as the name alone may say little."""
    try:
        text = Path("/proc/cpuinfo").read_text()
    except OSError:
        return platform.processor()
    found = [re.search(rf"^{key}\s*: (.*)$", text, re.M) for key in _KEYS]
    name, family, model = (m.group(1).strip() if m else "?" for m in found)
    return f"{name}, family {family}, model {model}"


_KEYS = ("model name", "cpu family", "model")


def made() -> dict[str, str]:
    """All of it, by name."""
    return {
        "date": datetime.now(UTC).date().isoformat(),
        "commit": commit(),
        "compiler": compiler(),
        "python": platform.python_version(),
        "processor": processor(),
        "cores": str(os.cpu_count()),
    }
