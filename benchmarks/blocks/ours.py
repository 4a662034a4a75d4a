"""This code: a case file for `anisocontact run`."""

from __future__ import annotations

import csv
import subprocess
import sys
from pathlib import Path

from blocks.code import Increment
from blocks.problem import (
    ALONG,
    DOWN,
    DRAGS,
    FRICTION,
    KINDS,
    PENALTY,
    POISSON,
    PRESSES,
    YOUNG,
    lower,
    upper,
)

kinds = KINDS


def case_text(
    kind: str, n: int, strategy: str = "auto", degree: int = 2, drags: int = DRAGS
) -> str:
    """The case file.

    Args:
        kind: Which problem.
        n: Cells of an edge of the block.
        strategy: How the equations are solved.
        degree: Degree of the quadrature of the contact.
        drags: Increments of the drag.
    """
    boxes = [("block", (0, 0, 0), (1, 1, 0.5), upper(n))]
    if kind == KINDS[1]:
        boxes.append(("base", (-0.5, -0.5, -0.5), (2, 2, 0.5), lower(n)))
    bodies = "".join(
        f"[mesh.box.{name}]\norigin = {list(at)}\nsize = {list(size)}\ncells = {list(cells)}\n"
        f'[material.{name}]\nmodel = "linear-elastic"\nE = {YOUNG}\nnu = {POISSON}\n'
        for name, at, size, cells in boxes
    )
    plane = '[surface.plane]\nshape = "plane"\npoint = [0, 0, 0]\nnormal = [0, 0, 1]\n'
    clamp = ', "base.bottom" = { x = 0, y = 0, z = 0 }' if kind == KINDS[1] else ""
    return f"""{bodies}{plane if kind == KINDS[0] else ""}
[[contact]]
slave = "block.bottom"
master = "{"plane" if kind == KINDS[0] else "base.top"}"
degree = {degree}
normal = {{ penalty = {PENALTY} }}
adhesion = {{ stiffness = [{PENALTY}, {PENALTY}] }}
friction = {{ coefficients = [{FRICTION}, {FRICTION}] }}

[[step]]
name = "press"
increments = {PRESSES}
displacement = {{ "block.top" = {{ x = 0, y = 0, z = {-DOWN} }}{clamp} }}

[[step]]
name = "drag"
increments = {drags}
displacement = {{ "block.top" = {{ x = {ALONG} }} }}

[output]
every = {PRESSES + drags}
pictures = false

[solver]
strategy = "{strategy}"
"""


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
