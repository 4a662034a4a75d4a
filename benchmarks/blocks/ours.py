"""This code: a case file for `anisocontact run`."""

from __future__ import annotations

import csv
import subprocess
import sys
from pathlib import Path

from case_text import PLANE, box, coulomb, press_and_drag

import blocks.problem as given
from blocks.code import Increment
from blocks.problem import DRAGS, KINDS, PRESSES

kinds, solver = KINDS, "auto"


def case_text(
    kind: str,
    n: int,
    strategy: str = "auto",
    degree: int = 2,
    presses: int = PRESSES,
    drags: int = DRAGS,
) -> str:
    """The case file.

    Args:
        kind: Which problem.
        n: Cells of an edge of the block.
        strategy: How the equations are solved.
        degree: Degree of the quadrature of the contact.
        presses: Increments on the way down.
        drags: Increments of the drag.
    """
    pair = kind == KINDS[1]
    material = f'model = "linear-elastic"\nE = {given.YOUNG}\nnu = {given.POISSON}'
    bodies = box("block", (0, 0, 0), (1, 1, 0.5), given.upper(n), material)
    if pair:
        bodies += box("base", (-0.5, -0.5, -0.5), (2, 2, 0.5), given.lower(n), material)
    surface = "" if pair else PLANE
    below = coulomb(pair, given.PENALTY, given.FRICTION, f"degree = {degree}\n")
    way = press_and_drag(pair, given.DOWN, given.ALONG, presses, drags)
    every = f"[output]\nevery = {presses + drags}\npictures = false\n"
    return f'{bodies}{surface}{below}{way}\n{every}\n[solver]\nstrategy = "{strategy}"\n'


#: The command as it is installed: it chooses the threads of OpenBLAS itself.
RUN = ("env", "-u", "OPENBLAS_NUM_THREADS", sys.executable, "-m", "anisocontact", "run")


def command(kind: str, n: int, folder: Path) -> list[str]:
    """Write the input and say how to run it."""
    (folder / "case.toml").write_text(case_text(kind, n))
    return [*RUN, "case.toml", "-o", "out", "--overwrite"]


def increments(folder: Path) -> list[Increment]:
    """Force of the contact and iterations from `history.csv`."""
    with (folder / "out" / "history.csv").open() as file:
        rows = list(csv.DictReader(file))
    force = "contacts.0.force."
    return [
        Increment(-float(r[force + "x"]), float(r[force + "z"]), int(r["newton_iterations"]))
        for r in rows
    ]


def version() -> str:
    """Its version."""
    found = subprocess.run(
        [sys.executable, "-m", "anisocontact", "--version"],
        capture_output=True,
        text=True,
        check=True,
    )
    return found.stdout.strip()
