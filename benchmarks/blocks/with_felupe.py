"""FElupe with Pardiso, in a Python of its own: `BENCH_PYTHON`, the path of its executable."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

from blocks.problem import KINDS

_VERSIONS = "import felupe, pypardiso; print('FElupe', felupe.__version__)"


def available() -> str:
    """Version, empty if it is not installed."""
    python = os.environ.get("BENCH_PYTHON", "")
    if not python:
        return ""
    found = subprocess.run([python, "-c", _VERSIONS], capture_output=True, text=True, check=False)
    return found.stdout.strip()


def command(kind: str, n: int, folder: Path) -> list[str] | None:
    """How to run it; None for block on block, which it has no contact for."""
    if kind != KINDS[0]:
        return None
    script = Path(__file__).with_name("felupe_block.py")
    return [os.environ["BENCH_PYTHON"], str(script), str(n)]


def forces(folder: Path) -> list[tuple[float, float]]:
    """Tangential and normal force after each increment."""
    lines = [line.split() for line in (folder / "stdout").read_text().splitlines()]
    return [(float(v[1]), float(v[2])) for v in lines if v[:1] == ["force"]]
