"""Benchmarks of this code beside the blocks, by name."""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path

import finite_strain.runs
import measure
import processes
from about import made, paths
from records import Record

PRINTED = "printed"
#: Scripts that print tables: what they measure.
SCRIPTS = {
    "growth": "time and memory against contact unknowns, points and steps",
    "kernel_rates": "points per second and core of laws, projections and interfaces",
    "mortar_rates": "ms of an evaluation of a contact of two meshes, at points and mortar nodes",
    "pair_rates": "million slave points per second and core of two meshed sheets",
    "plane_rates": "processor time of plane and axisymmetric meshes against slices and sectors",
    "search": "closest points per second and core on a sheet of facets",
}


def printed(name: str, limit: float, _: Sequence[int]) -> Iterator[Record]:
    """Run a script beside this one and keep the tables that it prints; it has sizes of its own."""
    script = Path(__file__).with_name(f"{name}.py")
    if not script.exists():
        print(f"{script.name}: not there, left out", file=sys.stderr)
        return
    with tempfile.TemporaryDirectory() as there:
        folder = Path(there)
        command = [sys.executable, str(script)]
        used = measure.run(command, folder, 1, limit, {"PYTHONPATH": paths()})
        lines = (folder / "stdout").read_text().splitlines()
    table = tables(lines)
    note = "" if used.status == 0 and table else f"stopped: {' '.join(lines[-1:])}"
    yield Record(PRINTED, name, 0, "anisocontact", used.values, made(), note, table)


def tables(lines: list[str]) -> str:
    r"""The Markdown tables among lines, with an empty line between two.

    Example:
        >>> tables(["hello", "| a |", "|---|", "", "| b |"])
        '| a |\n|---|\n\n| b |'
    """
    kept = [line if line.startswith("|") else "" for line in lines]
    text = "\n".join(kept).strip("\n")
    while "\n\n\n" in text:
        text = text.replace("\n\n\n", "\n\n")
    return text


#: Runs a part, given the time that a process may take, s, and sizes; none for its own.
PARTS: dict[str, Callable[[float, Sequence[int]], Iterator[Record]]] = {
    "finite-strain": finite_strain.runs.everything,
    processes.RANKS: processes.on_ranks,
    processes.MILLION: processes.million,
    **{name: partial(printed, name) for name in SCRIPTS},
}
