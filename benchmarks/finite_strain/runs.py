"""The block of rubber in this code and, on the plane, in a plain DOLFINx script."""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import measure
from about import made, paths
from blocks.code import found
from records import Record

from finite_strain.problem import KINDS, PHASES, read

PART = "finite strain"
SIZES, THREADS = (12, 18, 24), 1
#: What a Python that has Pardiso prints: the folder of `pypardiso`, and the library of MKL.
_PARDISO = """
import pathlib, pypardiso
print(pathlib.Path(pypardiso.__file__).parents[1], pypardiso.ps.libmkl._name, sep="\\n")
"""
#: Runs a module with one more folder, after all others, in which packages are looked for.
_WITH = """
import runpy, sys
sys.path.append(sys.argv.pop(1))
runpy.run_module(sys.argv.pop(1), run_name="__main__", alter_sys=True)
"""


@dataclass(frozen=True)
class Way:
    """Who runs which kinds of the problem: module, its last argument, whether it needs Pardiso."""

    module: str
    kinds: Sequence[str]
    solver: str
    pardiso: bool = False

    @property
    def present(self) -> bool:
        """Whether what it needs is installed."""
        return not self.pardiso or bool(found(_PARDISO)[0])

    def command(self, kind: str, n: int) -> tuple[list[str], dict[str, str]]:
        """How to run it, and in which environment."""
        rest, where = [self.module, kind, str(n), self.solver], {"PYTHONPATH": paths()}
        if not self.pardiso:
            return [sys.executable, "-m", *rest], where
        folder, library = found(_PARDISO)[1].splitlines()
        return [sys.executable, "-c", _WITH, folder, *rest], where | {"PYPARDISO_MKL_RT": library}


_OURS, _SCRIPT = "finite_strain.ours", "finite_strain.penalty_script"
WAYS = {
    "anisocontact": Way(_OURS, KINDS, "direct"),
    "anisocontact, condensed": Way(_OURS, KINDS, "condensed"),
    "DOLFINx script": Way(_SCRIPT, KINDS[:1], "mumps"),
    "DOLFINx script, Pardiso": Way(_SCRIPT, KINDS[:1], "pardiso", pardiso=True),
}


def one(name: str, kind: str, n: int, limit: float) -> Record:
    """Run it once; a record without values says why.

    Args:
        name: Who.
        kind: The problem.
        n: Cells of an edge of the block.
        limit: Wall time after which it is killed, s.
    """
    command, where = WAYS[name].command(kind, n)
    with tempfile.TemporaryDirectory() as there:
        folder = Path(there)
        used = measure.run(command, folder, THREADS, limit, where)
        printed = (folder / "stdout").read_text()
    values, note = dict(used.values), ""
    try:
        values |= read(printed)
    except ValueError:
        said = printed.strip().splitlines()[-1:]
        values, note = {}, f"stopped after {used.wall:.0f} s: {''.join(said)[:200]}"
    return Record(PART, kind, n, name, values, made() | {"threads": str(THREADS)}, note)


def everything(limit: float, sizes: Sequence[int]) -> Iterator[Record]:
    """All runs, the smallest first."""
    for name, way in WAYS.items():
        if not way.present:
            print(f"{name}: no pypardiso, left out", file=sys.stderr)
    for n in sizes or SIZES:
        for name, way in WAYS.items():
            for kind in way.kinds if way.present else ():
                yield one(name, kind, n, limit)


def share(record: Record, *phases: str) -> float:
    """Part of the time of solving that phases take."""
    return sum(record.values[f"{name} s"] for name in phases) / record.values["solving s"]


def table(records: Sequence[Record], marks: Mapping[tuple[str, str, int, str], str]) -> str:
    """Seconds and shares of the phases.

    Args:
        records: Runs of this part.
        marks: By key of a record, the letter of what it was made with.
    """
    heads = ["processor s", "solving s", "linear solver s", "UFL assembly s", "contact s"]
    heads += ["contact", "linear solver and assembly", "iterations", "factorisations", "peak MB"]
    heads += ["normal force, pressed", "tangential, end", "made"]
    lines = [f"| case | n | unknowns | code | {' | '.join(heads)} |", "|" + "---|" * 17]
    for r in sorted(records, key=lambda r: (r.case, r.n, r.code)):
        head = f"| {r.case} | {r.n} |"
        if r.note:
            lines.append(f"{head} | {r.code} | {r.note} |" + " |" * 11 + f" {marks[r.key]} |")
            continue
        seconds = [f"{r.values['processor s']:.1f}"]
        seconds += [f"{r.values[f'{name} s']:.2f}" for name in ("solving", *PHASES)]
        shares = [f"{100 * share(r, *of):.1f} %" for of in (PHASES[2:], PHASES[:2])]
        # some records are older than the count
        counts = [f"{r.values['iterations']:.0f}"]
        counts += [f"{r.values['factorisations']:.0f}" if "factorisations" in r.values else ""]
        forces = [f"{r.values['peak MB']:.0f}", f"{r.values['normal force pressed']:.6f}"]
        forces += [f"{r.values['tangential force at the end']:.6f}", marks[r.key]]
        cells = " | ".join(seconds + shares + counts + forces)
        lines.append(f"{head} {r.values['unknowns']:.0f} | {r.code} | {cells} |")
    return "\n".join(lines) + "\n"
