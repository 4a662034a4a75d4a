"""Growth of time and memory of block on block with mesh, points of the contact and increments.

Run: python benchmarks/growth.py [largest n]

Prints a table, one row for each whole process of `anisocontact run`, two threads, strategy `auto`.
"""

from __future__ import annotations

import json
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import measure
from about import paths
from blocks.ours import RUN, case_text
from blocks.problem import DRAGS, KINDS, PRESSES, lower, upper

THREADS, LIMIT = 2, 1800.0
MESHES, DEGREES, DRAGGED = (8, 12, 16, 24, 32), (2, 6, 10), (10, 20, 40)
#: Mesh on which points and increments vary.
N = 12


@dataclass(frozen=True)
class Row:
    """One run: what varies, how much there was of it, and what it took."""

    varies: str
    n: int
    unknowns: int
    contact: int
    points: int
    increments: int
    iterations: int
    used: measure.Use

    def __str__(self) -> str:
        """Cells of a table."""
        numbers = (self.n, self.unknowns, self.contact, self.points, self.increments)
        u = self.used
        each = 1e3 * u.processor / self.iterations
        taken = f"{u.wall:.1f} | {u.processor:.1f} | {u.memory:.0f} | {each:.0f}"
        return f"| {self.varies} | {' | '.join(map(str, numbers))} | {self.iterations} | {taken} |"


HEADS = (
    "varies",
    "n",
    "unknowns",
    "contact unknowns",
    "points",
    "increments",
    "iterations",
    "wall s",
    "processor s",
    "peak MB",
    "processor ms an iteration",
)


def contact_unknowns(n: int) -> int:
    """Three for every node of the two faces that can touch."""
    return 3 * sum((a + 1) * (b + 1) for a, b, _ in (upper(n), lower(n)))


def run(varies: str, n: int, degree: int = 2, drags: int = DRAGS) -> Row:
    """Run it once.

    Raises:
        RuntimeError: It failed.
    """
    with tempfile.TemporaryDirectory() as there:
        folder = Path(there)
        text = case_text(KINDS[1], n, degree=degree, drags=drags)
        (folder / "case.toml").write_text(text)
        command = [*RUN, "case.toml", "-o", "out"]
        used = measure.run(command, folder, THREADS, LIMIT, {"PYTHONPATH": paths()})
        if used.status != 0:
            raise RuntimeError((folder / "stdout").read_text()[-500:])
        found = json.loads((folder / "out" / "summary.json").read_text())
    points = sum(found["contacts"][0]["points"].values())
    counts = found["unknowns"], contact_unknowns(n), points, PRESSES + drags
    return Row(varies, n, *counts, found["newton_iterations"], used)


def rows(largest: int) -> Iterator[Row]:
    """All runs."""
    for n in MESHES:
        if n <= largest:
            yield run("mesh", n)
    for degree in DEGREES:
        yield run("points", N, degree=degree)
    for drags in DRAGGED:
        yield run("increments", N, drags=drags)


def main(largest: int = MESHES[-1]) -> None:
    """Print the table."""
    print(f"| {' | '.join(HEADS)} |")
    print("|" + "---|" * len(HEADS))
    for row in rows(largest):
        print(row, flush=True)


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
