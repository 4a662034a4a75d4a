"""The block of rubber in this code and, on the plane, in a plain DOLFINx script."""

from __future__ import annotations

import os
import shutil
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import measure
from about import made, paths
from records import Record

from finite_strain.problem import KINDS, PHASES, read

PART, RANKS = "finite strain", "ranks"
SIZES, THREADS = (12, 18), 1
OURS, CONDENSED, SCRIPT = "anisocontact", "anisocontact, condensed", "DOLFINx script"
#: Who runs what: module, kinds of the problem, further arguments.
MODULES: dict[str, tuple[str, Sequence[str], Sequence[str]]] = {
    OURS: ("finite_strain.ours", KINDS, ["direct"]),
    CONDENSED: ("finite_strain.ours", KINDS, ["condensed"]),
    SCRIPT: ("finite_strain.penalty_script", KINDS[:1], []),
}


def one(name: str, kind: str, n: int, limit: float, ranks: int = 1, part: str = PART) -> Record:
    """Run it once; a record without values says why.

    Args:
        name: The code.
        kind: The problem.
        n: Cells of an edge of the block.
        limit: Wall time after which it is killed, s.
        ranks: Number of processes.
        part: Part of the benchmarks that the record is for.
    """
    module, _, more = MODULES[name]
    command = [sys.executable, "-m", module, kind, str(n), *more]
    if ranks > 1:
        command = [mpirun(), "-n", str(ranks), *command]
    with tempfile.TemporaryDirectory() as there:
        folder = Path(there)
        used = measure.run(command, folder, THREADS, limit, {"PYTHONPATH": paths()})
        printed = (folder / "stdout").read_text()
    values, note = used.values | {"ranks": float(ranks)}, ""
    try:
        values |= read(printed)
    except ValueError:
        said = printed.strip().splitlines()[-1:]
        values, note = {}, f"stopped after {used.wall:.0f} s: {''.join(said)[:200]}"
    case = kind if ranks == 1 and part == PART else f"{kind}, {ranks} rank{'s' * (ranks > 1)}"
    return Record(part, case, n, name, values, made() | {"threads": str(THREADS)}, note)


def mpirun() -> str:
    """What starts several processes: that beside this Python comes first; empty if none."""
    beside = f"{Path(sys.executable).parent}{os.pathsep}{os.environ.get('PATH', '')}"
    return shutil.which("mpirun", path=beside) or ""


def everything(limit: float, sizes: Sequence[int] = SIZES) -> Iterator[Record]:
    """All runs, the smallest first."""
    for n in sizes:
        for name, (_, kinds, _) in MODULES.items():
            for kind in kinds:
                yield one(name, kind, n, limit)


def share(record: Record, *phases: str) -> float:
    """Part of the time of solving that phases take."""
    return sum(record.values[f"{name} s"] for name in phases) / record.values["solving s"]


def on_ranks(limit: float, n: int = SIZES[-1]) -> Iterator[Record]:
    """This code on one process and on two."""
    if not mpirun():
        print("no mpirun: 2 ranks left out", file=sys.stderr)
    for kind in KINDS:
        for ranks in (1, 2) if mpirun() else (1,):
            yield one(OURS, kind, n, limit, ranks, RANKS)


def table(records: Sequence[Record], marks: Mapping[tuple[str, str, int, str], str]) -> str:
    """Seconds and shares of the phases.

    Args:
        records: Runs of this part.
        marks: By key of a record, the letter of what it was made with.
    """
    heads = ["solving s", "linear solver s", "UFL assembly s", "contact s", "contact"]
    heads += ["linear solver and assembly", "iterations", "normal force, pressed"]
    heads += ["tangential, end", "made"]
    lines = [f"| case | n | unknowns | code | {' | '.join(heads)} |", "|" + "---|" * 14]
    for r in records:
        head = f"| {r.case} | {r.n} |"
        if r.note:
            lines.append(f"{head} | {r.code} | {r.note} |" + " |" * 8 + f" {marks[r.key]} |")
            continue
        seconds = [f"{r.values[f'{name} s']:.2f}" for name in ("solving", *PHASES)]
        shares = [f"{100 * share(r, *of):.1f} %" for of in (PHASES[2:], PHASES[:2])]
        found = [f"{r.values['iterations']:.0f}", f"{r.values['normal force pressed']:.6f}"]
        found += [f"{r.values['tangential force at the end']:.6f}", marks[r.key]]
        cells = " | ".join(seconds + shares + found)
        lines.append(f"{head} {r.values['unknowns']:.0f} | {r.code} | {cells} |")
    return "\n".join(lines) + "\n"
