"""Decks as pre-processors and manuals write them: instances, names, generated meshes, tools.

Source: the keyword reference of Abaqus and of CalculiX.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from tests.unit.decks import CUBE, case_of, read

from anisocontact.mesh import GmshFile, build_mesh
from anisocontact.surfaces import make_surface

#: Two instances, the second two above the first; sets of the assembly have names of the part.
ASSEMBLY = """*PART, NAME=Cube
{part}*END PART
*ASSEMBLY, NAME=A
*INSTANCE, NAME=Low-1, PART=Cube
{low}*END INSTANCE
*INSTANCE, NAME=Up-1, PART=Cube
0., 0., 2.
{up}*END INSTANCE
*NSET, NSET=Set-1, INSTANCE=Low-1
1, 2, 3, 4
*NSET, NSET=Head
Up-1.5, Up-1.6, Up-1.7
 Up-1.8
*SURFACE, NAME=Sole
Up-1.Set-1, S1
*END ASSEMBLY
*MATERIAL, NAME=M
*ELASTIC
1000., 0.3
*SURFACE INTERACTION, NAME=I
*FRICTION, ANISOTROPIC
0.3, 0.1
*CONTACT PAIR, INTERACTION=I
Sole, Low-1.Top
*STEP
*STATIC
1., 1.
*BOUNDARY
Set-1, 1, 3
Head, 3, , -0.1
Up-1.5, 1, 2
*END STEP
"""


@pytest.mark.parametrize("independent", [False, True])
def test_parts_and_their_instances(tmp_path: Path, independent: bool) -> None:
    """Requirement: the mesh of a part may stand in its instances; a set of the assembly is not that
    of the same name in a part; nodes are named by instance and number; places may be left empty.
    Two coefficients of friction are along x and across it, as are the axes of a surface."""
    parts = {"part": "", "low": CUBE, "up": CUBE} if independent else {"part": CUBE}
    case, left = case_of(tmp_path, ASSEMBLY.format(**{"low": "", "up": "", **parts}))
    assert not left
    (contact,) = case["contact"]
    assert contact["slave"] == "up-1.sole"
    assert contact["master"] == "low-1.top"
    assert contact["friction"] == {
        "coefficients": [0.3, 0.1],
        "directions": {"kind": "constant", "vector": [1, 0, 0]},
        "directions_on": "slave",
    }
    held = case["step"][0]["displacement"]
    assert held["low-1.set-1"] == {"x": 0, "y": 0, "z": 0}
    assert held["up-1.head"] == {"z": -0.1}
    (corner,) = case["nodes"].values()
    assert corner["near"] == [0, 0, 4]
    model = build_mesh([GmshFile(tmp_path / "deck.inp")])
    assert len(model.facets("low-1.set-1")) == 1


def test_names_in_quotes_and_included_files(tmp_path: Path) -> None:
    """Requirement: names with blanks, in quotes, and paths as Windows writes them."""
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub" / "mesh.inp").write_text(CUBE.replace("Set-1", '"my cube (1)"'))
    deck = read(tmp_path, "*INCLUDE, INPUT=sub\\mesh.inp\n")
    assert deck.nodes_of("MY CUBE (1)") == list(range(1, 9))
    assert deck.surfaces["TOP"] == [("MY CUBE (1)", "S2")]


def test_generated_meshes(tmp_path: Path) -> None:
    """Requirement: nodes on lines and arcs and between sets, elements in rows and layers, as the
    manual has them. Source: a quarter of a ring of 4 by 3 cells: its nodes are on circles whose
    distances grow by 1/BIAS. Tolerance: rounding."""
    text = """*NODE, SYSTEM=C
1, 1., 90.
5, 1., 0.
301, 3., 90.
305, 3., 0.
*NGEN, NSET=INNER, LINE=C
1, 5, 1, , 0., 0., 0.
*NGEN, NSET=OUTER, LINE=C
301, 305, 1, , 0., 0., 0., 0., 0., -1.
*NFILL, NSET=ALL, BIAS=0.5
INNER, OUTER, 3, 100
*ELEMENT, TYPE=CPE4
1, 1, 101, 102, 2
*ELGEN, ELSET=RING
1, 4, 1, 1, 3, 100, 10
"""
    deck = read(tmp_path, text)
    radii = np.array([np.linalg.norm(deck.nodes[3 + 100 * k]) for k in range(4)])
    assert np.diff(radii) == pytest.approx(np.array([2, 4, 8]) / 7)
    assert deck.nodes[102] == pytest.approx(
        [radii[1] * np.sin(np.pi / 8), radii[1] * np.cos(np.pi / 8), 0], abs=1e-12
    )
    assert sorted(deck.members_of("RING")) == [10 * k + n for k in range(3) for n in range(1, 5)]
    assert deck.elements[24][1] == (204, 304, 305, 205)
    assert len(set(deck.nodes_of("ALL"))) == 20


#: Profile -> the surface that it is.
TOOLS = {
    "START, 3., 5.\nLINE, -3., 5.": {"shape": "plane", "point": [3, 5, 0], "normal": [0, -1, 0]},
    "START, 5., 7.\nCIRCL, 0., 2., 0., 7.": {
        "shape": "cylinder",
        "point": [0, 7, 0],
        "radius": 5,
        "axis": [0, 0, 1],
    },
    "START, -5., 7.\nCIRCL, 0., 2., 0., 7.": {
        "shape": "cylinder",
        "point": [0, 7, 0],
        "radius": 5,
        "axis": [0, 0, 1],
        "inside": True,
    },
}
#: A square of 2 by 2 in the plane, and a rigid tool.
SQUARE = """*NODE
1, 0., 0.
2, 2., 0.
3, 2., 2.
4, 0., 2.
90, 0., 9.
*ELEMENT, TYPE={kind}, ELSET=E
1, 1, 2, 3, 4
*SURFACE, NAME=LID
E, S3
*SOLID SECTION, ELSET=E, MATERIAL=M
*MATERIAL, NAME=M
*ELASTIC
1000., 0.3
*SURFACE, TYPE=SEGMENTS, NAME=TOOL{fillet}
{profile}
*RIGID BODY, REF NODE=90, ANALYTICAL SURFACE=TOOL
*CONTACT PAIR
LID, TOOL
*STEP
*STATIC
1., 1.
*BOUNDARY
90, 1
90, 2, 2, -0.1
90, 6
*END STEP
"""


@pytest.mark.parametrize("profile", TOOLS)
def test_tools_of_one_piece_in_the_plane(tmp_path: Path, profile: str) -> None:
    """Requirement: what touches is on the left of a profile as it goes; its point leads it."""
    case, left = case_of(tmp_path, SQUARE.format(kind="CPE4", profile=profile, fillet=""))
    assert not left
    assert case["surface"]["tool"] == TOOLS[profile]
    assert case["contact"][0]["master"] == "tool"
    assert case["rigid"]["tool"] == {"surfaces": ["tool"], "reference": [0, 9, 0]}
    assert case["step"][0]["motion"]["tool"] == {"x": 0, "y": -0.1, "rz_deg": 0}


def test_tools_of_several_pieces_in_the_plane(tmp_path: Path) -> None:
    """Requirement: a profile with rounded corners is a patch whose points lie on lines and arcs,
    with the normal on its left; with sharp corners it is told. Tolerance: rounding."""
    profile = "START, 2., 8.\nLINE, 2., 3.\nLINE, -2., 3.\nLINE, -2., 8."
    text = SQUARE.format(kind="CPE4", profile=profile, fillet=", FILLET RADIUS=1")
    case, left = case_of(tmp_path, text)
    assert not left
    table = dict(case["surface"]["tool"])
    surface = make_surface(table.pop("shape"), **table)
    end = table["knots_1"][-1]
    xi = np.array([[share * end, 0.5] for share in np.linspace(0, 1, 41)])
    places = surface.position(xi)
    x, y = np.abs(places[:, 0]), places[:, 1]
    off = np.where(y >= 4, x - 2, np.where(x <= 1, y - 3, np.hypot(x - 1, y - 4) - 1))
    assert off == pytest.approx(np.zeros(41), abs=1e-9)
    assert surface.geometry(xi).normal[20] == pytest.approx([0, -1, 0], abs=1e-12)
    _, left = case_of(tmp_path, SQUARE.format(kind="CPE4", profile=profile, fillet=""))
    assert "its corner at 2, 3 is sharp; give it a FILLET RADIUS" in left[0]


def test_tools_of_bodies_of_revolution(tmp_path: Path) -> None:
    """Requirement: profiles beside axisymmetric elements are turned about the axis."""
    profile = "START, 5., 7.\nCIRCL, 0., 2., 0., 7."
    case, left = case_of(tmp_path, SQUARE.format(kind="CAX4R", profile=profile, fillet=""))
    assert not left
    assert case["surface"]["tool"] == {
        "shape": "revolution",
        "point": [0, 0, 0],
        "axis": [0, 1, 0],
        "profile": [[5, 7], [0, 2]],
        "arcs_deg": [-90],
        "inside": True,
    }
    assert case["step"][0]["motion"]["tool"] == {"y": -0.1}


def test_a_tool_of_a_part_is_where_its_instance_is(tmp_path: Path) -> None:
    """Requirement: a surface of an instance is moved and turned with it, its axis too."""
    tool = """*PART, NAME=Tool
*END PART
*INSTANCE, NAME=Tool-1, PART=Tool
0., 0., 10.
0., 0., 10., 1., 0., 10., 90.
*NODE
1, 0., 5., 0.
*NSET, NSET=Tool-1-RefPt_, INTERNAL
1,
*SURFACE, TYPE=REVOLUTION, NAME=Nose
START, 5., 5.
CIRCL, 0., 0., 0., 5.
*RIGID BODY, REF NODE=Tool-1-RefPt_, ANALYTICAL SURFACE=Nose
*END INSTANCE
*NSET, NSET=Head"""
    text = ASSEMBLY.format(part=CUBE, low="", up="").replace("*NSET, NSET=Head", tool, 1)
    text = text.replace("Sole, Low-1.Top", "Up-1.Top, Tool-1.Nose")
    case, left = case_of(tmp_path, text)
    assert not left
    surface = case["surface"]["tool-1_nose"]
    assert (surface["point"], surface["axis"]) == ([0, 0, 10], [0, 0, 1])
    assert case["rigid"]["tool-1_nose"]["reference"] == pytest.approx([0, 0, 15])
    assert "directions_on" not in case["contact"][0]["friction"]


def test_general_contact_and_rigid_elements(tmp_path: Path) -> None:
    """Requirement: contact of everything is a pair of skins of bodies that are near each other, the
    finer one the slave, and is said; a rigid body of elements follows its point with its skin."""
    text = ASSEMBLY.format(part=CUBE, low="", up="").replace(
        "*CONTACT PAIR, INTERACTION=I\nSole, Low-1.Top\n",
        "*CONTACT\n*CONTACT INCLUSIONS, ALL EXTERIOR\n*CONTACT PROPERTY ASSIGNMENT\n , , I\n"
        "*NODE, NSET=RP\n90, 1., 1., 9.\n*RIGID BODY, ELSET=Up-1.Set-1, REF NODE=RP\n",
    )
    case, left = case_of(tmp_path, text.replace("Head, 3, ,", "RP, 3, ,"))
    assert [line for line in left if "CONTACT" in line] == [
        "*CONTACTINCLUSIONS of line 43: ALL EXTERIOR is one pair of skins for low-1 and up-1; none "
        "with itself"
    ]
    assert case["group"] == {"up-1.skin": {"by": "all"}, "low-1.skin": {"by": "all"}}
    assert case["contact"][0]["friction"]["coefficients"] == [0.3, 0.1]
    (body,) = case["rigid"].values()
    assert body == {"faces": ["up-1.skin"], "reference": [1, 1, 9]}


def test_amplitudes(tmp_path: Path) -> None:
    """Requirement: values at equal times, and steps without kinks. Source: t^3 (10 - 15 t + 6 t^2),
    exact at the points that are written."""
    more = """*AMPLITUDE, NAME=EVEN, DEFINITION=EQUALLY SPACED, FIXED INTERVAL=0.5
0., 0.6, 1.
*AMPLITUDE, NAME=SOFT, DEFINITION=SMOOTH STEP
0., 0., 2., 3.
*STEP
"""
    case, left = case_of(
        tmp_path, CUBE + more + "*STATIC\n*BOUNDARY, AMPLITUDE=SOFT\n1, 1, 1, 1.\n"
    )
    assert left == ['material of set-1: [material."set-1"] has to be written']
    assert case["amplitude"]["even"] == {"kind": "table", "time": [0, 0.5, 1], "value": [0, 0.6, 1]}
    soft = case["amplitude"]["soft"]
    t = np.array(soft["time"]) / 2
    assert soft["value"] == pytest.approx(3 * t**3 * (10 - 15 * t + 6 * t**2))


def test_turned_axes_and_unions(tmp_path: Path) -> None:
    """Requirement: axes of a material that are turned about one of them; a union of surfaces."""
    text = CUBE.replace("MATERIAL=M", "MATERIAL=M, ORIENTATION=O")
    text += """*ORIENTATION, NAME=O
1., 0., 0., 0., 1., 0.
3, 30.
*MATERIAL, NAME=M
*ELASTIC, TYPE=ENGINEERING CONSTANTS
10., 5., 5., .2, .2, .2, 3., 3.,
3.
*SURFACE, NAME=SIDE
Set-1, S3
*SURFACE, NAME=BOTH, COMBINE=UNION
SIDE, Top
*STEP
*DYNAMIC, APPLICATION=QUASI-STATIC
0.25, 1.
*DSLOAD
BOTH, TRVEC, 2., 0., 0., 5.
"""
    case, left = case_of(tmp_path, text)
    assert not left
    assert case["material"]["set-1"]["first"] == pytest.approx([np.sqrt(0.75), 0.5, 0])
    assert case["material"]["set-1"]["second"] == pytest.approx([-0.5, np.sqrt(0.75), 0])
    assert case["step"][0]["traction"] == {"set-1.both": {"x": 0, "y": 0, "z": 2}}
    assert case["step"][0]["increments"] == 4
