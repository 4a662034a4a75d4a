"""A deck of another code: its bodies, sets, material and contact give its contact force."""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.cli.main import main

#: Cells of the slab, and of the arched block on it.
SLAB, ARCH = (15, 3, 4), (12, 3, 4)
CASE = """
title = "An arched block is pressed on a slab and dragged"

[mesh]
file = "arch.inp"

[material.slab]
model = "linear-elastic"
E = 210e3
nu = 0.3

[material.arch]
model = "linear-elastic"
E = 210e3
nu = 0.3

[[contact]]
slave = "arch.sole"
master = "slab.deck"
friction = { coefficients = 0.3 }

[[step]]
name = "press"
increments = 4

[step.displacement]
"slab.foot" = { x = 0, y = 0, z = 0 }
"arch.head" = { x = 0, y = 0, z = -0.03 }

[[step]]
name = "drag"
increments = 10
displacement = { "arch.head" = { x = 0.02 } }

[output]
pictures = false
"""


def slab(x: float, y: float, z: float) -> tuple[float, float, float]:
    return 10.0 * x - 5.0, 4.0 * y - 2.0, 3.0 * z - 3.0


def arch(x: float, y: float, z: float) -> tuple[float, float, float]:
    """Its lower side is a cylinder of the radius 8."""
    along = 6.0 * x - 3.0
    return along, 3.0 * y - 1.5, (8.0 - np.sqrt(64.0 - along**2)) * (1.0 - z) + 3.0 * z


def places(n: tuple[int, int, int], put: Callable) -> list[tuple[float, float, float]]:
    x, y, z = (np.arange(k + 1) / k for k in n)
    return [put(a, b, c) for c in z for b in y for a in x]


def cells(n: tuple[int, int, int], first: int) -> Iterator[list[int]]:
    def node(a: int, b: int, c: int) -> int:
        return first + a + (n[0] + 1) * (b + (n[1] + 1) * c)

    square = ((0, 0), (1, 0), (1, 1), (0, 1))
    for c, b, a in np.ndindex(n[2], n[1], n[0]):
        yield [node(a + i, b + j, c + k) for k in (0, 1) for i, j in square]


def deck() -> str:
    """What is read of the deck; its steps, contact and material are in `CASE`."""
    below, above = places(SLAB, slab), places(ARCH, arch)
    lines = ["*NODE, NSET=ALL"]
    lines += [f"{k}, {x:.9g}, {y:.9g}, {z:.9g}" for k, (x, y, z) in enumerate(below + above, 1)]
    number = 1
    for name, n, first in (("SLAB", SLAB, 1), ("ARCH", ARCH, 1 + len(below))):
        lines.append(f"*ELEMENT, TYPE=C3D8, ELSET={name}")
        for row in cells(n, first):
            lines.append(f"{number}, {', '.join(map(str, row))}")
            number += 1
    layer, count = SLAB[0] * SLAB[1], int(np.prod(SLAB))
    lines += ["*ELSET, ELSET=UPPER, GENERATE", f"{count - layer + 1}, {count}"]
    lines += ["*ELSET, ELSET=LOWER, GENERATE", f"{count + 1}, {count + ARCH[0] * ARCH[1]}"]
    lines += ["*SURFACE, NAME=DECK", "UPPER, S2", "*SURFACE, NAME=SOLE", "LOWER, S1"]
    nodes, foot, head = (
        len(below + above),
        (SLAB[0] + 1) * (SLAB[1] + 1),
        (ARCH[0] + 1) * (ARCH[1] + 1),
    )
    lines += ["*NSET, NSET=FOOT, GENERATE", f"1, {foot}"]
    lines += ["*NSET, NSET=HEAD, GENERATE", f"{nodes - head + 1}, {nodes}"]
    lines += ["*SOLID SECTION, ELSET=SLAB, MATERIAL=STEEL"]
    lines += ["*SOLID SECTION, ELSET=ARCH, MATERIAL=STEEL"]
    return "\n".join(lines) + "\n"


def test_its_contact_force(tmp_path: Path) -> None:
    """An arched block on a slab, pressed by 0.03 and dragged by 0.02.

    Requirement: the forces on its head are those of the same deck in CalculiX 2.20 (surface to
    surface, `LINEAR` 1e7, `*FRICTION` 0.3 with a stick slope of 1e6, NLGEOM, C3D8): 6183.6 pressed,
    6160.6 and 1822.0 dragged. Tolerance: 1 %; that code has a penalty and integrates over facets,
    a contact here has multipliers at nodes, and both meet the arch as 12 chords.
    """
    (tmp_path / "arch.inp").write_text(deck())
    (tmp_path / "case.toml").write_text(CASE)
    assert main(["run", str(tmp_path / "case.toml"), "-o", str(tmp_path / "out")]) == 0
    with (tmp_path / "out" / "history.csv").open() as file:
        rows = list(csv.DictReader(file))
    pressed, dragged = (
        next(r for r in reversed(rows) if r["step"] == s) for s in ("press", "drag")
    )
    assert float(pressed["reactions.arch.head.z"]) == pytest.approx(-6183.6, rel=0.01)
    assert float(dragged["reactions.arch.head.z"]) == pytest.approx(-6160.6, rel=0.01)
    assert float(dragged["reactions.arch.head.x"]) == pytest.approx(1822.0, rel=0.01)
