"""CalculiX: surface-to-surface penalty contact; Debian has it as `calculix-ccx`.

Its own tolerance of balance holds (0.5 % of the mean force), trilinear hexahedra C3D8, SPOOLES.
"""

from __future__ import annotations

import re
import shutil
import subprocess
from collections.abc import Iterable
from pathlib import Path

import numpy as np

import blocks.problem as given
from blocks.code import Increment
from blocks.problem import KINDS, grid

kinds, solver = KINDS, "SPOOLES"


def command(kind: str, n: int, folder: Path) -> list[str]:
    """Write the input and say how to run it."""
    (folder / "case.inp").write_text("\n".join(_lines(kind, n)) + "\n")
    return ["ccx", "case"]


def version() -> str:
    """Its version; empty where it is not installed."""
    if shutil.which("ccx") is None:
        return ""
    found = subprocess.run(["ccx", "-v"], capture_output=True, text=True, check=False)
    number = re.search(r"Version\s+(\S+)", found.stdout)
    return f"CalculiX {number.group(1)}" if number else "CalculiX"


def increments(folder: Path) -> list[Increment]:
    """Forces on the top from `case.dat`, iterations from `case.sta`."""
    forces, iterations = [], []
    for line in (folder / "case.dat").read_text().splitlines():
        numbers = line.split()
        if len(numbers) == 3 and all(re.fullmatch(r"-?\d\.\d+E[+-]\d+", v) for v in numbers):
            forces.append((float(numbers[0]), -float(numbers[2])))
    for line in (folder / "case.sta").read_text().splitlines():
        numbers = line.split()
        # step, increment, attempt, iterations, three times
        if len(numbers) == 7 and numbers[0].isdigit():
            iterations.append(int(numbers[3]))
    # a run that was stopped may have written one of the two only
    return [Increment(*force, k) for force, k in zip(forces, iterations, strict=False)]


def _lines(kind: str, n: int) -> Iterable[str]:
    block = grid((0, 0, 0), (1, 1, 0.5), given.upper(n))
    # the rigid plane is one cell whose nodes are all held
    cells = given.lower(n) if kind == KINDS[1] else (1, 1, 1)
    base = grid((-0.5, -0.5, -0.5), (2, 2, 0.5), cells)
    first_node, first_cell = len(block.points), len(block.cells)
    yield "*NODE"
    for i, x in enumerate(np.concatenate([block.points, base.points]), 1):
        yield f"{i}, {x[0]:.12g}, {x[1]:.12g}, {x[2]:.12g}"
    for name, mesh, node, cell in (
        ("BLOCK", block, 0, 0),
        ("BASE", base, first_node, first_cell),
    ):
        yield f"*ELEMENT, TYPE=C3D8, ELSET={name}"
        for i, nodes in enumerate(mesh.cells + node + 1, cell + 1):
            yield ", ".join(map(str, [i, *nodes]))
    held = base.bottom if kind == KINDS[1] else np.arange(len(base.points))
    yield from _set("TOP", block.top)
    yield from _set("HELD", held + first_node)
    per_layer = cells[0] * cells[1]
    yield "*SURFACE, NAME=SLAVE, TYPE=ELEMENT"
    yield from (f"{i + 1}, S1" for i in range(n * n))
    yield "*SURFACE, NAME=MASTER, TYPE=ELEMENT"
    last = first_cell + len(base.cells) - per_layer
    yield from (f"{last + i + 1}, S2" for i in range(per_layer))
    yield from _model()
    yield from _step(given.PRESSES, 0.0)
    yield from _step(given.DRAGS, given.ALONG)


def _set(name: str, nodes: np.ndarray) -> Iterable[str]:
    yield f"*NSET, NSET={name}"
    yield from (f"{node + 1}," for node in nodes)


def _model() -> Iterable[str]:
    yield f"*MATERIAL, NAME=SOLID\n*ELASTIC\n{given.YOUNG}, {given.POISSON}"
    yield from (f"*SOLID SECTION, ELSET={name}, MATERIAL=SOLID" for name in ("BLOCK", "BASE"))
    yield "*SURFACE INTERACTION, NAME=PAIR"
    yield f"*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n{given.PENALTY}, 1.e-3, 0.01"
    yield f"*FRICTION\n{given.FRICTION}, {given.PENALTY}"
    yield "*CONTACT PAIR, INTERACTION=PAIR, TYPE=SURFACE TO SURFACE\nSLAVE, MASTER"
    yield "*BOUNDARY\nHELD, 1, 3, 0."


def _step(increments: int, along: float) -> Iterable[str]:
    yield f"*STEP, INC=100\n*STATIC, DIRECT\n{1.0 / increments}, 1."
    yield f"*BOUNDARY\nTOP, 1, 1, {along}\nTOP, 2, 2, 0.\nTOP, 3, 3, {-given.DOWN}"
    yield "*NODE PRINT, NSET=TOP, TOTALS=ONLY\nRF\n*END STEP"
