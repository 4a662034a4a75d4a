"""Forces of a deck on nodes: on faces of 20-node hexahedra, and where supports take them up."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.cli import main
from anisocontact.results import Results

CORNERS = np.array(
    [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2)]
)
EDGES = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6)]
EDGES.append((3, 7))
PLACES = np.vstack([CORNERS, [CORNERS[[a, b]].mean(axis=0) for a, b in EDGES]])
YOUNG, FORCE = 1000.0, 24.0


def deck(loads: str, more: str = "") -> str:
    """A cube of one 20-node hexahedron that stands on a plane, and sets of nodes of its top."""
    nodes = "\n".join(f"{n}, {x}, {y}, {z}" for n, (x, y, z) in enumerate(PLACES, 1))
    return f"""*NODE
{nodes}
*ELEMENT, TYPE=C3D20R, ELSET=CUBE
1, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15,
16, 17, 18, 19, 20
*NSET, NSET=FOOT
1, 2, 3, 4, 9, 10, 11, 12
*NSET, NSET=CORNERS
5, 6, 7, 8
*NSET, NSET=MIDDLES
13, 14, 15, 16
*NSET, NSET=TOP
CORNERS, MIDDLES
*MATERIAL, NAME=RUBBER
*ELASTIC
{YOUNG}, 0.
*SOLID SECTION, ELSET=CUBE, MATERIAL=RUBBER
*AMPLITUDE, NAME=RAMP
0., 0., 1., 1.
*BOUNDARY
FOOT, 3
1, 1, 2
2, 2
{more}*STEP
*STATIC
1., 1.
{loads}
*END STEP
"""


def converted(tmp_path: Path, capsys: pytest.CaptureFixture[str], text: str) -> tuple[dict, str]:
    """The case that a deck becomes, and what is said of it."""
    (tmp_path / "cube.inp").write_text(text)
    target = tmp_path / "cube.toml"
    target.unlink(missing_ok=True)
    assert main(["convert", str(tmp_path / "cube.inp"), str(target)]) == 0
    return tomllib.loads(target.read_text()), capsys.readouterr().out


@pytest.mark.parametrize("amplitude", ["", ", AMPLITUDE=RAMP"])
def test_forces_given_twice_in_a_step_add_up(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], amplitude: str
):
    """A force on a node that has one in the same step is added to it, in a later step it replaces.

    Source: CalculiX CrunchiX User's Manual, *CLOAD.
    """
    card = f"*CLOAD{amplitude}"
    first = f"{card}\n5, 3, 1.\n5, 3, 2.\n{card}\n5, 3, 4.\n5, 1, 8."
    case, _ = converted(
        tmp_path, capsys, deck(f"{first}\n*END STEP\n*STEP\n*STATIC\n1., 1.\n{card}\n5, 3, 3.")
    )
    one, two = (step["force"]["cube.node5"] for step in case["step"])
    ends = {"x": 8.0, "z": 7.0}, {"z": 3.0}
    if amplitude:
        ramps = ({k: {"amplitude": "ramp", "value": v} for k, v in end.items()} for end in ends)
        assert (one, two) == tuple(ramps)
    else:
        assert (one, two) == ends


@pytest.mark.parametrize("renewed", [False, True])
def test_forces_beside_those_of_an_earlier_step_are_said(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], renewed: bool
):
    """A force on a node of a set that had one before replaces it in CalculiX, and adds here."""
    later = f"*CLOAD{', OP=NEW' if renewed else ''}\n5, 3, 3."
    loads = f"*CLOAD\nCORNERS, 3, 1.\n*END STEP\n*STEP\n*STATIC\n1., 1.\n{later}"
    _, said = converted(tmp_path, capsys, deck(loads))
    line = "on cube.node5 along z replaces what nodes had by cube.corners in an earlier step"
    assert (line in said) is not renewed


def test_forces_with_two_amplitudes_are_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """One direction of a node follows one amplitude, as in CalculiX: the second one is left out."""
    loads = "*CLOAD\n5, 3, 1.\n*CLOAD, AMPLITUDE=RAMP\n5, 3, 2."
    case, said = converted(tmp_path, capsys, deck(loads))
    assert case["step"][0]["force"] == {"cube.node5": {"z": 1.0}}
    assert "two forces on cube.node5 along z in one step, with different amplitudes" in said


def test_pressures_given_twice_in_a_step_add_up(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """A pressure on a face that has one in the same step is added to it, in a later step it
    replaces, which is told where another set names the face.

    Source: CalculiX CrunchiX 2.11, loadadd.f.
    """
    loads = "*DLOAD\nCUBE, P2, 1.\nCUBE, P2, 2.\n*END STEP\n*STEP\n*STATIC\n1., 1.\n"
    case, said = converted(tmp_path, capsys, deck(f"{loads}*DLOAD\nCUBE, P2, 4."))
    assert [step["pressure"]["cube.cube_p2"] for step in case["step"]] == [3.0, 4.0]
    assert "replaces what faces had" not in said
    case, said = converted(tmp_path, capsys, deck(f"{loads}*DLOAD\n1, P2, 4."))
    assert "replaces what faces had by cube.cube_p2 in an earlier step: both are there now" in said
    _, said = converted(tmp_path, capsys, deck(f"{loads}*DLOAD, OP=NEW\n1, P2, 4."))
    assert "replaces what faces had" not in said


def test_an_entry_that_is_not_read_leaves_the_others(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    """Requirement: what is said to be left out is, and nothing else."""
    loads = "*CLOAD\n5, 3, 1.\n5, 4, 2.\n5, 1, 8.\n*DLOAD\nNONE, P1, 3.\nCUBE, BX, 2.\nCUBE, P2, 1."
    case, said = converted(tmp_path, capsys, deck(loads))
    assert case["step"][0]["force"] == {"cube.node5": {"x": 8.0, "z": 1.0}}
    assert case["step"][0]["pressure"] == {"cube.cube_p2": 1.0}
    assert "a moment on 5; faces on a reference point take them" in said
    assert "none_p1 has no facets, one facet group is needed; BX on cube; P1, P2" in said


@pytest.mark.parametrize("amplitude", ["", ", AMPLITUDE=RAMP"])
def test_even_shares_of_eight_nodes_are_the_force_of_the_face(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], amplitude: str
):
    """Shares of -1/12 and 1/3 [Zienkiewicz Taylor Zhu 2013, section 6.7] stretch a cube evenly.

    Requirement: u = F L / (E A) at every node of the top, by the closed form of a bar. The
    tolerance is that of Newton's method.
    """
    loads = f"*CLOAD{amplitude}\nCORNERS, 3, {-FORCE / 12}\nMIDDLES, 3, {FORCE / 3}"
    case, said = converted(tmp_path, capsys, deck(loads))
    value = {"amplitude": "ramp", "value": FORCE} if amplitude else FORCE
    assert case["step"][0]["force"] == {"cube.top": {"z": value}}
    assert "shares of forces" not in said
    if amplitude:
        return
    with (tmp_path / "cube.toml").open("a") as file:
        file.write("[output]\npictures = false\n")
    assert main(["run", str(tmp_path / "cube.toml"), "-o", str(tmp_path / "out")]) == 0
    grid = Results(tmp_path / "out").grid()
    risen = grid.point_data["displacement"][np.isclose(grid.points[:, 2], 2.0), 2]
    assert len(risen) == 9
    assert risen == pytest.approx(FORCE * 2.0 / (YOUNG * 4.0), rel=1e-8)


@pytest.mark.parametrize(
    ("corners", "more"),
    [
        (FORCE / 12, ""),
        (-FORCE / 12, f"\n*END STEP\n*STEP\n*STATIC\n*CLOAD\nCORNERS, 3, {-FORCE / 6}"),
    ],
    ids=["not even", "part of a face in a step"],
)
def test_shares_that_are_no_traction_are_said(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], corners: float, more: str
):
    """Forces that are no even traction stay in their groups, and one line says that they are none.

    A second step that changes some forces of a face alone would leave the sum of the first.
    """
    loads = f"*CLOAD\nCORNERS, 3, {corners}\nMIDDLES, 3, {FORCE / 3}{more}"
    case, said = converted(tmp_path, capsys, deck(loads))
    assert set(case["step"][0]["force"]) == {"cube.corners", "cube.middles"}
    assert said.count("shares of forces along z on faces of eight nodes (1 loaded)") == 1


def test_forces_that_supports_take_up_are_left_out(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    """A deck may load what it holds, to no effect; a case may not. Freed nodes are loaded again."""
    loads = f"""*CLOAD
CORNERS, 3, {FORCE}
CORNERS, 1, 1.
*END STEP
*STEP
*STATIC
*BOUNDARY, OP=NEW
FOOT, 1, 3
*CLOAD
CORNERS, 3, {FORCE}"""
    case, said = converted(tmp_path, capsys, deck(loads, "CORNERS, 3, 3, 0.01\n"))
    first, second = case["step"]
    assert first["force"] == {"cube.corners": {"x": 4.0}}
    assert second["force"] == {"cube.corners": {"z": 4 * FORCE}}
    assert "force of step 'step 1' on cube.corners along z: supports lead all" in said
    assert said.count("supports lead") == 1


def test_an_orthotropic_material_that_yields_is_elastic_and_said(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    """There is no such model: the case that is written can be read, a line says what it lacks."""
    text = deck("").replace(
        f"*ELASTIC\n{YOUNG}, 0.",
        "*ELASTIC, TYPE=ENGINEERING CONSTANTS\n1e3, 2e3, 3e3, 0., 0., 0., 400., 500.,\n600.\n"
        "*PLASTIC\n10., 0.\n12., 0.1",
    )
    case, said = converted(tmp_path, capsys, text)
    assert set(case["material"]["cube"]) == {"model", "E", "nu", "G"}
    assert "material of cube: *PLASTIC of an orthotropic one" in said
    assert main(["check", str(tmp_path / "cube.toml")]) == 0
