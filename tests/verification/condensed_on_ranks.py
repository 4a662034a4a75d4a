"""Solves pairs on the processes it is started on by one strategy, for `test_condensed_on_ranks`.

Usage: `mpirun -n N python -m tests.verification.condensed_on_ranks FOLDER STRATEGY CASE...`

It writes `FOLDER/CASE-N-STRATEGY.npz`: `numbers`, energies, resultants and reactions after every
increment; `factors` and `corrections` of the whole run where the strategy counts them.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

import numpy as np
from tests.verification.pairs_on_ranks import (
    CASES,
    FOLLOWING,
    TOLERANCE,
    WITH_MULTIPLIERS,
    totals,
)

from anisocontact.solver import Solver

#: What the log says in the end.
_COUNTS = re.compile(r"(\d+) factorisations for (\d+) corrections")


def run(name: str, folder: Path, strategy: str) -> None:
    """One of `CASES`."""
    problem, steps = CASES[name]()
    tolerance = FOLLOWING if name in WITH_MULTIPLIERS else TOLERANCE
    solver = Solver(problem, steps, options={"snes_rtol": tolerance}, strategy=strategy)
    notes: list[str] = []
    rows = []
    for accepted in solver.run(on_note=notes.append):
        rows.append(totals(accepted))
    found = [match for note in notes if (match := _COUNTS.match(note))]
    factors, corrections = map(int, found[-1].groups()) if found else (0, 0)
    if problem.comm.rank == 0:
        np.savez(
            folder / f"{name}-{problem.comm.size}-{strategy}.npz",
            numbers=np.array(rows),
            factors=factors,
            corrections=corrections,
        )


if __name__ == "__main__":
    for case in sys.argv[3:]:
        run(case, Path(sys.argv[1]), sys.argv[2])
