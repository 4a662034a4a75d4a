"""Every code on every problem, one after the other."""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path

import measure
from about import made, paths
from records import Record

from blocks import calculix, ours
from blocks.code import Code, Increment, Script
from blocks.problem import ALONG, DRAGS, KINDS, PRESSES, lower, upper

PART = "blocks"
OURS = "anisocontact"
# it does not know its own version, Debian does
_GETFEM = """
import getfem, shutil, subprocess
query = ["dpkg-query", "-W", "-f", "${Version}", "python3-getfem"]
print(subprocess.check_output(query, text=True) if shutil.which(query[0]) else "unknown")
"""
# it finds MKL where that is a package beside it
_NGSOLVE = """
import ngsolve, importlib.metadata
importlib.metadata.version("mkl")
print(ngsolve.__version__)
"""
CODES: dict[str, Code] = {
    OURS: ours,
    "CalculiX": calculix,
    "NGSolve": Script("blocks.ngsolve_block", _NGSOLVE, "Pardiso"),
    "FElupe": Script(
        "blocks.felupe_block",
        "import felupe, pypardiso; print(felupe.__version__)",
        "Pardiso",
        KINDS[:1],
    ),
    "GetFEM": Script("blocks.getfem_block", _GETFEM, "MUMPS"),
}
THREADS = 2
#: The same in words; this code runs as it is installed.
SAID = f"{THREADS} threads, {OURS} with one of OpenBLAS"
#: Drag at which the tangential force is compared while part of the face still sticks.
PARTLY = 0.006
LIMIT = 3600.0


def unknowns(kind: str, n: int) -> int:
    """Three for every node of the bodies that deform."""
    boxes = [upper(n)] + [lower(n)] * (kind == KINDS[1])
    return sum(3 * (a + 1) * (b + 1) * (c + 1) for a, b, c in boxes)


def forces(increments: Sequence[Increment]) -> dict[str, float]:
    """Resultants to compare, and iterations.

    Raises:
        ValueError: Increments are missing.
    """
    if len(increments) != PRESSES + DRAGS:
        raise ValueError(f"{len(increments)} increments given, {PRESSES + DRAGS} needed")
    partly = PRESSES - 1 + round(DRAGS * PARTLY / ALONG)
    return {
        "iterations": float(sum(one.iterations for one in increments)),
        "normal force pressed": increments[PRESSES - 1].normal,
        "tangential force partly": abs(increments[partly].tangential),
        "tangential force at the end": abs(increments[-1].tangential),
        "normal force at the end": increments[-1].normal,
    }


def one(name: str, kind: str, n: int, limit: float = LIMIT) -> Record:
    """Run one code on one problem; a record without values says why."""
    code = CODES[name]
    about = made() | {"version": code.version(), "threads": str(THREADS)}
    about["solver"] = code.solver
    with tempfile.TemporaryDirectory() as there:
        folder = Path(there)
        where = {"PYTHONPATH": paths()}
        used = measure.run(code.command(kind, n, folder), folder, THREADS, limit, where)
        values, note = used.values | {"unknowns": float(unknowns(kind, n))}, ""
        done: list[Increment] = []
        try:
            done = code.increments(folder)
            values |= forces(done)
        except (OSError, ValueError) as error:
            last = (folder / "stdout").read_text().strip().splitlines()[-1:]
            note = f"stopped after {used.wall:.0f} s: {error} {' '.join(last)}"
            if used.wall >= limit:
                note = f"{len(done)} of {PRESSES + DRAGS} increments in {limit:.0f} s"
    return Record(PART, kind, n, name, {} if note else values, about, note)


def everything(
    sizes: Sequence[int], kinds: Sequence[str], names: Sequence[str], limit: float
) -> Iterator[Record]:
    """All runs of the codes that are installed, the smallest first."""
    for name in names:
        if not CODES[name].version():
            print(f"{name}: not installed, left out", file=sys.stderr)
    present = [name for name in names if CODES[name].version()]
    for n in sizes:
        for kind in kinds:
            for name in present:
                if kind in CODES[name].kinds:
                    yield one(name, kind, n, limit)
