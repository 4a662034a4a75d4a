"""Decks with directions, temperatures, forces on nodes and sectors against closed forms."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.case import load
from anisocontact.case.build import build
from anisocontact.cli import main

CUBE = """*NODE, NSET=ALL
1, 0, 0, 0
2, 2, 0, 0
3, 2, 2, 0
4, 0, 2, 0
5, 0, 0, 2
6, 2, 0, 2
7, 2, 2, 2
8, 0, 2, 2
*ELEMENT, TYPE=C3D8, ELSET=CUBE
1, 1, 2, 3, 4, 5, 6, 7, 8
*NSET, NSET=CORNERS
6, 8
*MATERIAL, NAME=M
{material}
*SOLID SECTION, ELSET=CUBE, MATERIAL=M{orientation}
*BOUNDARY
1, 1, 3
2, 2, 3
3, 3, 3
4, 1, 1
4, 3, 3
5, 1, 2
6, 2, 2
8, 1, 1
*STEP
*STATIC
{loads}
*END STEP
"""
STEEL = "*ELASTIC\n1000., 0.3"
#: A force of 4 along z on the upper face, at its four nodes.
KINEMATIC = "*PLASTIC, HARDENING=KINEMATIC\n 2., 0.\n 8., 0.06"
NODES = "*CLOAD\n5, 3, 1.\n7, 3, 1.\nCORNERS, 3, 1."
E, NU, G = (1000.0, 500.0, 250.0), (0.3, 0.25, 0.2), (300.0, 200.0, 100.0)
ENGINEERING = "1000., 500., 250., .3, .25, .2, 300., 200.\n100."


def solved(path: Path, deck: str) -> tuple[dict, np.ndarray, np.ndarray]:
    """The case that is written of a deck, nodes and displacements of it."""
    (path / "deck.inp").write_text(deck)
    target = path / "deck.toml"
    assert main(["convert", str(path / "deck.inp"), str(target)]) == 0
    built = build(load(str(target)))
    list(built.solver.run())
    x = built.problem.model.space.tabulate_dof_coordinates()
    return tomllib.loads(target.read_text()), x, built.problem.u.x.array.reshape(-1, 3)


def compliance() -> np.ndarray:
    """Strain per stress along three axes."""
    s = np.diag(1.0 / np.array(E))
    for k, (i, j) in enumerate([(0, 1), (0, 2), (1, 2)]):
        s[i, j] = s[j, i] = -NU[k] / E[i]
    return s


def test_forces_on_nodes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Requirement: a force on nodes by their numbers and one on a set that is no facet are the
    forces on each of them; equal ones at the corners of a face make a uniform stress.
    Source: Hooke. Tolerance: 1e-9, Newton's."""
    case, x, u = solved(tmp_path, CUBE.format(material=STEEL, orientation="", loads=NODES))
    assert "left out" not in capsys.readouterr().out
    assert case["step"][0]["force"] == {
        "cube.node5": {"z": 1},
        "cube.node7": {"z": 1},
        "cube.corners": {"z": 2},
    }
    np.testing.assert_allclose(u[:, 2], 1e-3 * x[:, 2], atol=1e-9 * 2e-3)
    np.testing.assert_allclose(u[:, 0], -0.3e-3 * x[:, 0], atol=1e-9 * 2e-3)


def test_nodes_that_are_held_alike(tmp_path: Path) -> None:
    """Requirement: nodes that one *BOUNDARY holds alike by their numbers are one group, of facets
    where they are all corners of one; others have a name each. Source: the deck, by hand.
    Tolerance: none."""
    held = "*BOUNDARY\n1, 3, 3\n2, 3\n3, 3\n4, 3, 3\n5, 1, 2\n6, 2, 2\n8, 1, 1\n1, 2\n"
    head, rest = CUBE.split("*BOUNDARY")
    deck = head + held + rest[rest.index("*STEP") :]
    loads = "*CLOAD\nCORNERS, 3, 1."
    case, *_ = solved(tmp_path, deck.format(material=STEEL, orientation="", loads=loads))
    line = 1 + deck.format(material=STEEL, orientation="", loads="").splitlines().index("*BOUNDARY")
    assert case["step"][0]["displacement"] == {
        f"cube.held_{line}": {"z": 0},
        "cube.node1": {"z": 0, "y": 0},
        "cube.node5": {"x": 0, "y": 0},
        "cube.node6": {"y": 0},
        "cube.node8": {"x": 0},
    }


@pytest.mark.parametrize("kind", ["ENGINEERING CONSTANTS", "ORTHO"])
@pytest.mark.parametrize("turned", [False, True])
def test_orthotropic(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], kind: str, turned: bool
) -> None:
    """Requirement: engineering constants and the nine stiffnesses are the same material, along the
    axes of its *ORIENTATION; strains of a stress along z are a column of the compliance.
    Source: its definition, inverted in NumPy. Tolerance: 1e-9, Newton's, and ten digits in
    the case file."""
    d = np.linalg.inv(compliance())
    stiff = [d[0, 0], d[0, 1], d[1, 1], d[0, 2], d[1, 2], d[2, 2], *G]
    ortho = ",".join(f"{v:.15g}" for v in stiff[:8]) + f"\n{stiff[8]:.15g}, 294."
    numbers = ENGINEERING if kind.startswith("E") else ortho
    material = f"*ELASTIC, TYPE={kind}\n{numbers}"
    if turned:  # the first axis along y, the second along z
        material = "*ORIENTATION, NAME=OR\n0, 1, 0, 0, 0, 1\n" + material
    deck = CUBE.format(
        material=material, orientation=", ORIENTATION=OR" if turned else "", loads=NODES
    )
    case, x, u = solved(tmp_path, deck)
    assert "left out" not in capsys.readouterr().out
    found = case["material"]["cube"]
    for name, wanted in (("E", E), ("nu", NU), ("G", G)):
        assert found[name] == pytest.approx(wanted, rel=1e-9)
    strain = compliance()[:, 1 if turned else 2]
    strain = strain[[2, 0, 1]] if turned else strain
    np.testing.assert_allclose(u, x * strain, atol=1e-9 * 2.0 * np.abs(strain).max())


@pytest.mark.parametrize(
    ("given", "wanted"),
    [
        ("NEO HOOKE\n2., 0.01", {"model": "mooney-rivlin", "C10": 2, "C01": 0}),
        ("MOONEY-RIVLIN\n2., 0.5, 0.01", {"model": "mooney-rivlin", "C10": 2, "C01": 0.5}),
        ("YEOH\n2., .1, .02, 0.01", {"model": "yeoh", "C10": 2, "C20": 0.1, "C30": 0.02}),
        (
            "OGDEN, N=2\n3., 2., 1., -4., 0.01, 0.",
            {"model": "ogden", "mu": [3, -0.5], "alpha": [2, -4]},
        ),
    ],
    ids=["neo-hooke", "mooney-rivlin", "yeoh", "ogden"],
)
def test_rubber(tmp_path: Path, given: str, wanted: dict) -> None:
    """Requirement: the constants are those of the same energy, K = 2/D1, in Ogden's mu/alpha for
    2 mu/alpha^2; at rest it is Hooke's law with the shear modulus 2 (C10 + C01) or the sum of mu.
    Source: the keyword reference. Tolerance: 2e-3, the strain under a small force."""
    loads = "*CLOAD\n5, 3, 1e-3\n7, 3, 1e-3\nCORNERS, 3, 1e-3"
    deck = CUBE.format(material=f"*HYPERELASTIC, {given}", orientation="", loads=loads)
    case, x, u = solved(tmp_path, deck)
    found = case["material"]["cube"]
    assert found == wanted | {"bulk_modulus": 200}
    shear = 2.0 * (found["C10"] + found.get("C01", 0.0)) if "C10" in found else 3.0 + 1.0
    young = 9.0 * 200.0 * shear / (600.0 + shear)
    top = x[:, 2] > 1.0
    np.testing.assert_allclose(u[top, 2], 2.0 * 1e-3 / young, rtol=2e-3)


def test_cylindrical_axes(tmp_path: Path) -> None:
    """Requirement: *ORIENTATION, SYSTEM=CYLINDRICAL is `around`: a point and the direction of the
    axis. Source: the keyword reference, outwards, around, along. Tolerance: none."""
    axes = "*ORIENTATION, NAME=OR, SYSTEM=CYLINDRICAL\n5, 1, 0, 5, 1, 4\n"
    deck = CUBE.format(
        material=f"{axes}*ELASTIC, TYPE=ENGINEERING CONSTANTS\n{ENGINEERING}",
        orientation=", ORIENTATION=OR",
        loads=NODES,
    )
    case, _, u = solved(tmp_path, deck)
    assert case["material"]["cube"]["around"] == [[5, 1, 0], [0, 0, 4]]
    assert u[:, 2].max() > 0.0


def test_expansion(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Requirement: a free cube that is warmed from 20 to 70 expands by alpha times 50; a step with
    an amplitude from a start that is not 0, and a body that is not warmed alike, are said.
    Source: the definition of alpha. Tolerance: 1e-9, Newton's."""
    material = f"{STEEL}\n*EXPANSION\n1.2e-5\n*INITIAL CONDITIONS, TYPE=TEMPERATURE\nALL, 20."
    deck = CUBE.format(material=material, orientation="", loads="*TEMPERATURE\nALL, 70.")
    case, x, u = solved(tmp_path, deck)
    assert "left out" not in capsys.readouterr().out
    assert case["step"][0]["temperature"] == {"cube": 50}
    np.testing.assert_allclose(u, 6e-4 * x, atol=1e-9 * 1.2e-3)
    for loads, said in (
        ("*TEMPERATURE\n1, 70.", "cube is at 0 to 50 over its start"),
        ("*TEMPERATURE, AMPLITUDE=A\nALL, 70.", "an amplitude of temperatures"),
    ):
        (tmp_path / "deck.toml").unlink()
        deck = CUBE.format(material=material, orientation="", loads=loads)
        (tmp_path / "deck.inp").write_text(deck)
        assert main(["convert", str(tmp_path / "deck.inp"), str(tmp_path / "deck.toml")]) == 0
        assert said in capsys.readouterr().out


def sector(n: int, cells: int) -> str:
    """An n-th of a ring about an axis through (1, 0, 0), radii 1 and 2, inner pressure 10."""
    radii, angles = np.linspace(1.0, 2.0, cells + 1), np.linspace(0.0, 2.0 * np.pi / n, 3)
    number = 1 + np.arange(2 * 3 * (cells + 1)).reshape(2, 3, cells + 1)
    lines = ["*NODE, NSET=ALL"]
    for (k, j, i), node in np.ndenumerate(number):
        place = 1.0 + radii[i] * np.cos(angles[j]), radii[i] * np.sin(angles[j]), 0.2 * k
        lines.append(f"{node}, {', '.join(f'{v:.15g}' for v in place)}")
    lines.append("*ELEMENT, TYPE=C3D8, ELSET=RING")
    for j, i in np.ndindex(2, cells):
        flat = [number[0, j + b, i + a] for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
        above = [node + number[1, 0, 0] - 1 for node in flat]
        lines.append(f"{1 + j * cells + i}, {', '.join(map(str, flat + above))}")
    for name, nodes in (("START", number[:, 0]), ("CUT", number[:, -1])):
        lines += [f"*NSET, NSET={name}", *(f"{node}," for node in nodes.ravel())]
    lines += ["*ELSET, ELSET=INNER", f"1, {1 + cells}"]
    return "\n".join(lines)


REST = """
*SURFACE, NAME=FIRST, TYPE=NODE
START
*SURFACE, NAME=LAST, TYPE=NODE
CUT
*TIE, CYCLIC SYMMETRY, NAME=T1, POSITION TOLERANCE=0.1
{faces}
*CYCLIC SYMMETRY MODEL, N=12, TIE=T1, NGRAPH=12
1, 0, 0, 1, 0, 1
*MATERIAL, NAME=M
*ELASTIC
1000., 0.
*SOLID SECTION, ELSET=RING, MATERIAL=M
*BOUNDARY
ALL, 3, 3
{held}, 2, 2
*STEP
*STATIC
*DLOAD
INNER, P6, 10.
*END STEP
"""


@pytest.mark.parametrize("faces", ["LAST, FIRST", "FIRST, LAST"])
def test_sector(tmp_path: Path, capsys: pytest.CaptureFixture[str], faces: str) -> None:
    """Requirement: whichever cut face is the slave, the sector of a ring under inner pressure has
    Lame's radial displacements, p a^2/(E (b^2 - a^2)) (r + b^2/r) without contraction.
    Source: Lame. Tolerance: 1 %, cells of 1/16 along r and 15 degrees around; measured 0.5 %."""
    deck = sector(12, 16) + REST.format(faces=faces, held="18")
    case, x, u = solved(tmp_path, deck)
    assert "left out" not in capsys.readouterr().out
    (cut,) = case["cyclic"]
    assert cut["sectors"] == 12
    assert cut["point"] == [1, 0, 0]
    assert cut["axis"] == [0, 0, 1.0 if faces.startswith("LAST") else -1.0]
    out = x - [1.0, 0.0, 0.0]
    r = np.hypot(out[:, 0], out[:, 1])
    radial = (u[:, 0] * out[:, 0] + u[:, 1] * out[:, 1]) / r
    np.testing.assert_allclose(radial, 10.0 / 3000.0 * (r + 4.0 / r), rtol=1e-2)


def test_kinematic_hardening(tmp_path: Path) -> None:
    """Requirement: two points of kinematic hardening are Prager's, on a cube that is pulled by 3 %
    and pushed back; nodes that two steps lead by their numbers are one group.

    Source: of a bar with Y = 2, H = 6/0.06 = 100, E = 1000 the stress s = E (H e + Y)/(E + H), back
    by 2 Y with E and the rest of the way with E H/(E + H). Tolerance: Newton's.
    """
    lead = "*BOUNDARY\n5, 3, 3, {0}\n6, 3, 3, {0}\n7, 3, 3, {0}\n8, 3, 3, {0}"
    steps = lead.format(0.06) + "\n*END STEP\n*STEP\n*STATIC\n0.5, 1.\n" + lead.format(0.0)
    deck = CUBE.format(material=f"{STEEL}\n{KINEMATIC}", orientation="", loads=steps)
    (tmp_path / "deck.inp").write_text(deck)
    target = tmp_path / "deck.toml"
    assert main(["convert", str(tmp_path / "deck.inp"), str(target)]) == 0
    material = tomllib.loads(target.read_text())["material"]["cube"]
    assert (material["yield_stress"], material["kinematic"]) == (2, 100)
    built = build(load(str(target)))
    stress = [built.problem.reactions()["cube.held_32"][2] / 4.0 for _ in built.solver.run()]
    pulled, slope = 1000.0 * (100.0 * 0.03 + 2.0) / 1100.0, 1000.0 * 100.0 / 1100.0
    turned = pulled - 4.0, 0.03 - 0.004
    back = [turned[0] - slope * (turned[1] - strain) for strain in (0.015, 0.0)]
    assert stress == pytest.approx([pulled, *back], rel=1e-7)
