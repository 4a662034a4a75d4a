"""Block on plane and block on block: time, memory and forces beside those of other codes.

    python benchmarks/run.py [n ...] [--without NAME ...] [--docs]

Runs everything that is installed, one after the other, on two threads each, and prints a Markdown
table; `--docs` writes it to docs/verification/benchmarks-table.md too. Wall time is that of the
whole process. What is not installed is named and left out.
"""

from __future__ import annotations

import argparse
import os
import platform
import re
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType

from blocks import calculix, ours, with_felupe
from blocks.problem import KINDS, PRESSES

CODES: dict[str, ModuleType] = {"anisocontact": ours, "CalculiX": calculix, "FElupe": with_felupe}
ROOT = Path(__file__).parent.parent
THREADS = "2"


@dataclass(frozen=True)
class Row:
    """One run.

    Attributes:
        code: Which code.
        kind: Which problem.
        n: Cells along the edge of the block.
        wall: Wall time, s.
        processor: Processor time of all threads, s: less moved by other work on the machine.
        memory: Peak resident memory, MB.
        normal: Normal force after pressing.
        tangential: Tangential force at the end.
        load: Other work on the machine when it began: its load average.
    """

    code: str
    kind: str
    n: int
    wall: float
    processor: float
    memory: float
    normal: float
    tangential: float
    load: float


def measure(name: str, kind: str, n: int) -> Row | None:
    """Run one code on one problem; None where it cannot."""
    code = CODES[name]
    with tempfile.TemporaryDirectory() as there:
        folder = Path(there)
        command = code.command(kind, n, folder)
        if command is None:
            return None
        threads = dict.fromkeys(("OMP_NUM_THREADS", "MKL_NUM_THREADS", "CCX_NPROC"), THREADS)
        load, start = os.getloadavg()[0], time.perf_counter()
        with (folder / "stdout").open("w") as out:
            done = subprocess.Popen(
                command, cwd=folder, stdout=out, stderr=out, env=os.environ | threads
            )
            _, status, used = os.wait4(done.pid, 0)
        wall = time.perf_counter() - start
        if status != 0:
            print((folder / "stdout").read_text()[-500:], file=sys.stderr)
            return None
        forces = code.forces(folder)
    normal, tangential = forces[PRESSES - 1][1], forces[-1][0]
    processor, memory = used.ru_utime + used.ru_stime, used.ru_maxrss / 1024.0
    return Row(name, kind, n, wall, processor, memory, normal, tangential, load)


def machine() -> str:
    """Commit, versions and machine, without its name."""
    commit = subprocess.run(
        ["git", "rev-parse", "--short", "HEAD"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    ).stdout.strip()
    found = re.search(r"model name\s*: (.*)", Path("/proc/cpuinfo").read_text())
    processor = found.group(1) if found else platform.processor()
    return (
        f"Commit {commit}, Python {platform.python_version()}, "
        f"{platform.python_compiler()}, {processor}, {os.cpu_count()} processors."
    )


def table(rows: list[Row]) -> str:
    """The rows as Markdown, with the time over ours."""
    own = {(r.kind, r.n): r.wall for r in rows if r.code == "anisocontact"}
    lines = [
        "| problem | n | code | wall s | over ours | processor s | MB | normal force pressed | "
        "tangential force at the end | load before |",
        "|---|---|---|---|---|---|---|---|---|---|",
    ]
    for r in rows:
        ratio = r.wall / own[r.kind, r.n] if (r.kind, r.n) in own else float("nan")
        lines.append(
            f"| block on {r.kind} | {r.n} | {r.code} | {r.wall:.1f} | {ratio:.1f} | "
            f"{r.processor:.1f} | "
            f"{r.memory:.0f} | {r.normal:.4f} | {abs(r.tangential):.4f} | {r.load:.1f} |"
        )
    return "\n".join(lines)


def main() -> None:
    """Run what is asked for and show it."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("n", nargs="*", type=int, default=[12])
    parser.add_argument("--without", nargs="*", default=[], choices=CODES)
    parser.add_argument("--docs", action="store_true")
    asked = parser.parse_args()
    versions = {name: code.available() for name, code in CODES.items() if name not in asked.without}
    missing = [name for name, version in versions.items() if not version]
    rows = []
    for n in asked.n:
        for kind in KINDS:
            for name in versions:
                if name not in missing and (row := measure(name, kind, n)) is not None:
                    rows.append(row)
                    print(row, flush=True)
    said = f"Not installed, left out: {', '.join(missing)}.\n" if missing else ""
    page = f"{machine()} {', '.join(v for v in versions.values() if v)}.\n{said}\n{table(rows)}\n"
    print(page)
    if asked.docs:
        target = ROOT / "docs" / "verification" / "benchmarks-table.md"
        target.write_text(f"# Benchmarks: the last run\n\n{page}")


if __name__ == "__main__":
    main()
