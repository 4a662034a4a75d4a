"""Whole runs of this code on one process and on two, up to a million unknowns.

Block on block in two increments down and one along, as a user runs it without pictures, one thread
for each process. Processor time counts what a process waits for the others; memory is that of the
process that needs most.
"""

from __future__ import annotations

import json
import os
import shutil
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import measure
from about import made, paths
from blocks.ours import case_text
from blocks.problem import KINDS
from records import Record

RANKS, MILLION = "ranks", "million"
STRATEGIES = ("direct", "condensed", "iterative")
SIZES = {RANKS: (24, 36), MILLION: (24, 36, 48, 62)}
PRESSES, DRAGS, THREADS = 2, 1, 1


def mpirun() -> str:
    """What starts several processes: that beside this Python comes first; empty if none."""
    beside = f"{Path(sys.executable).parent}{os.pathsep}{os.environ.get('PATH', '')}"
    return shutil.which("mpirun", path=beside) or ""


def one(part: str, strategy: str, n: int, processes: int, limit: float) -> Record:
    """Run it once; a record without values says why.

    Args:
        part: Part of the benchmarks that the record is for.
        strategy: How the equations are solved.
        n: Cells of an edge of the block.
        processes: Their number.
        limit: Wall time after which it is killed, s.
    """
    command = [sys.executable, "-m", "anisocontact", "run", "case.toml", "-o", "out"]
    if processes > 1:
        command = [mpirun(), "-n", str(processes), *command]
    with tempfile.TemporaryDirectory() as there:
        folder = Path(there)
        text = case_text(KINDS[1], n, strategy, presses=PRESSES, drags=DRAGS)
        (folder / "case.toml").write_text(text)
        used = measure.run(command, folder, THREADS, limit, {"PYTHONPATH": paths()})
        values, note = used.values | {"processes": float(processes)}, ""
        if used.status == 0:
            values |= _found(folder / "out" / "summary.json")
        else:
            said = (folder / "stdout").read_text().strip().splitlines()[-1:]
            values, note = {}, f"stopped after {used.wall:.0f} s: {''.join(said)[:200]}"
    case = f"{processes} process{'es' * (processes > 1)}"
    return Record(part, case, n, strategy, values, made() | {"threads": str(THREADS)}, note)


def _found(summary: Path) -> dict[str, float]:
    kept = json.loads(summary.read_text())
    force = kept["contacts"][0]["force"]
    return {
        "unknowns": float(kept["unknowns"]),
        "iterations": float(kept["newton_iterations"]),
        "normal force": float(force[2]),
        "tangential force": abs(float(force[0])),
    }


def on_ranks(limit: float, sizes: Sequence[int]) -> Iterator[Record]:
    """Every strategy on one process and on two, the smallest first."""
    if not mpirun():
        print("no mpirun: 2 processes left out", file=sys.stderr)
    for n in sizes or SIZES[RANKS]:
        for strategy in STRATEGIES:
            for processes in (1, 2) if mpirun() else (1,):
                yield one(RANKS, strategy, n, processes, limit)


def million(limit: float, sizes: Sequence[int]) -> Iterator[Record]:
    """`iterative` on one process up to a million unknowns."""
    for n in sizes or SIZES[MILLION]:
        yield one(MILLION, "iterative", n, 1, limit)


HEADS = (
    "n",
    "unknowns",
    "strategy",
    "processes",
    "wall s",
    "speed-up",
    "processor s of each",
    "peak MB",
    "iterations",
    "us an unknown and iteration",
    "normal force",
    "tangential force",
    "made",
)


def table(records: Sequence[Record], marks: Mapping[tuple[str, str, int, str], str]) -> str:
    """Time, memory and what was found.

    Args:
        records: Runs of one part.
        marks: By key of a record, the letter of what it was made with.
    """
    lines = [f"| {' | '.join(HEADS)} |", "|" + "---|" * len(HEADS)]
    alone = {(r.n, r.code): r for r in records if r.values.get("processes") == 1.0}
    for r in sorted(records, key=lambda r: (r.n, r.code, r.case)):
        if r.note:
            gap = " |" * (len(HEADS) - 5)
            lines.append(f"| {r.n} | | {r.code} | {r.case}: {r.note} |{gap} {marks[r.key]} |")
            continue
        v, own = r.values, alone.get((r.n, r.code))
        each = v["processor s"] / v["processes"]
        micro = 1e6 * v["processor s"] / v["unknowns"] / v["iterations"]
        cells = [f"{r.n}", f"{v['unknowns']:.0f}", r.code, f"{v['processes']:.0f}"]
        cells += [f"{v['wall s']:.1f}", f"{own.values['wall s'] / v['wall s']:.2f}" if own else ""]
        cells += [f"{each:.1f}", f"{v['peak MB']:.0f}", f"{v['iterations']:.0f}", f"{micro:.1f}"]
        cells += [f"{v['normal force']:.5f}", f"{v['tangential force']:.5f}", marks[r.key]]
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines) + "\n"
