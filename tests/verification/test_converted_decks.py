"""Decks of another code that are written as case files, and their contact force."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.cli import main
from anisocontact.results import Results

#: Cells of the base and of the die, along x and y.
BASE, DIE = (32, 16), (24, 12)
REST = """*SURFACE, NAME=SBASE
ETOP, S3
*SURFACE, NAME=SDIE
EBOT, S1
*MATERIAL, NAME=STEEL
*ELASTIC
210000., 0.3
*MATERIAL, NAME=ALU
*ELASTIC
70000., 0.33
*SOLID SECTION, ELSET=BASE, MATERIAL=ALU
*SOLID SECTION, ELSET=DIE, MATERIAL=STEEL
*SURFACE INTERACTION, NAME=SI
*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR
5.E6, 3.
*FRICTION
0.1, 1.E6
*CONTACT PAIR, INTERACTION=SI, TYPE=SURFACE TO SURFACE
SDIE, SBASE
*BOUNDARY
FOOT, 2, 2
MIDDLE, 1, 1
*STEP, INC=200
*STATIC
0.1, 1., 1.E-4, 0.1
*BOUNDARY
HEAD, 2, 2, -0.05
*NODE PRINT, NSET=FOOT, TOTALS=ONLY
RF
*END STEP
"""


def base(x: float, y: float) -> tuple[float, float]:
    return 8.0 * x, 4.0 * y


def die(x: float, y: float) -> tuple[float, float]:
    return 4.0 * x, 4.0 + 3.0 * y + (1.0 - y) * (4.0 * x) ** 2 / 40.0


def listed(keyword: str, numbers: np.ndarray) -> str:
    rows = np.array_split(numbers.ravel(), max(1, numbers.size // 10))
    return f"{keyword}\n" + "".join(", ".join(map(str, row)) + "\n" for row in rows)


def body(
    place: Callable[[float, float], tuple[float, float]], cells: tuple[int, int], first: int
) -> tuple[str, str, np.ndarray, np.ndarray]:
    """Lines of nodes and elements of a body, numbers of both."""
    nodes = first + np.arange((cells[0] + 1) * (cells[1] + 1)).reshape(cells[0] + 1, -1)
    elements = first + np.arange(cells[0] * cells[1]).reshape(cells)
    lines, rows = "", ""
    for i, j in np.ndindex(nodes.shape):
        x, y = place(i / cells[0], j / cells[1])
        lines += f"{nodes[i, j]}, {x:.6f}, {y:.6f}, 0.\n"
    for i, j in np.ndindex(cells):
        around = nodes[[i, i + 1, i + 1, i], [j, j, j + 1, j + 1]]
        rows += f"{elements[i, j]}, {', '.join(map(str, around))}\n"
    return lines, rows, nodes, elements


def deck(element: str) -> str:
    """A die with a parabolic sole on a base, half of them."""
    low, low_rows, n, e = body(base, BASE, 1)
    high, high_rows, m, f = body(die, DIE, 10001)
    parts = (
        "*NODE\n" + low + high,
        f"*ELEMENT, TYPE={element}, ELSET=BASE\n" + low_rows,
        f"*ELEMENT, TYPE={element}, ELSET=DIE\n" + high_rows,
        listed("*ELSET, ELSET=ETOP", e[:, -1]) + listed("*ELSET, ELSET=EBOT", f[:, 0]),
        listed("*NSET, NSET=FOOT", n[:, 0]) + listed("*NSET, NSET=HEAD", m[:, -1]),
        listed("*NSET, NSET=MIDDLE", np.append(n[0], m[0])),
    )
    return "".join(parts) + REST


@pytest.mark.slow
@pytest.mark.parametrize(
    ("element", "force"),
    [("CPE4", 1023.04), ("CAX4", 180.0 * 26.95165)],
    ids=["plane strain", "axisymmetric"],
)
def test_contact_force_of_a_deck(tmp_path: Path, element: str, force: float):
    """A steel die is pressed into a base of aluminium with friction, as the deck says.

    Requirement: the force on the foot to 2 %. Source: CalculiX 2.20, the same deck, surface to
    surface contact with a linear pressure; axisymmetric forces there are those of 2 degrees.
    Tolerance: another contact and other elements (B-bar); the difference falls with cells of half
    the size, from 0.7 to 0.4 % and from 3.5 to 1.2 %.
    """
    (tmp_path / "die.inp").write_text(deck(element))
    case = tmp_path / "die.toml"
    assert main(["convert", str(tmp_path / "die.inp"), str(case)]) == 0
    case.write_text(case.read_text() + "\n[output]\npictures = false\n")
    assert main(["run", str(case), "-o", str(tmp_path / "out")]) == 0
    found = Results(tmp_path / "out").summary["reactions"]["base.foot"][1]
    assert found == pytest.approx(force, rel=0.02)
