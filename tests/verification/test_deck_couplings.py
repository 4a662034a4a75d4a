"""Reference points of decks as rigid bodies with faces: what is taken over, and a closed form."""

from __future__ import annotations

import math
import tomllib
from pathlib import Path

import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.cli import main
from anisocontact.results import Results

#: A column of 10 by 10 by 40 without lateral contraction, a point beside its head.
DECK = """*NODE
 1, 0, 0, 0
 2, 10, 0, 0
 3, 10, 10, 0
 4, 0, 10, 0
 5, 0, 0, 40
 6, 10, 0, 40
 7, 10, 10, 40
 8, 0, 10, 40
 90, 15, 5, 50
 91, 15, 5, 50
*ELEMENT, TYPE=C3D8, ELSET=BAR
 1, 1, 2, 3, 4, 5, 6, 7, 8
*NSET, NSET=FOOT
 1, 2, 3, 4
*NSET, NSET=HEAD
 5, 6, 7, 8
*NSET, NSET=RP
 90
*SURFACE, NAME=ROOF
 BAR, S2
*MATERIAL, NAME=M
*ELASTIC
 1000., 0.
*SOLID SECTION, ELSET=BAR, MATERIAL=M
*AMPLITUDE, NAME=SLOW
 0., 0., 0.5, 0.2, 1., 1.
*COUPLING, CONSTRAINT NAME=Grip, REF NODE=RP, SURFACE=ROOF
*KINEMATIC
*BOUNDARY
 FOOT, 1, 3
 RP, 4, 6
*STEP
*STATIC
 0.5, 1.
*BOUNDARY
 RP, 1, 2
*CLOAD, AMPLITUDE=SLOW
 RP, 3, -50.
*END STEP
*STEP
*STATIC
 1., 1.
*BOUNDARY, OP=NEW
 FOOT, 1, 3
 90, 4, 5
 90, 6, 6, 0.01
 90, 3, 3, -0.2
*CLOAD, OP=NEW
 90, 2, 3.
*END STEP
"""
STEPS = [
    {
        "name": "step 1",
        "increments": 2,
        "displacement": {"bar.foot": {"x": 0, "y": 0, "z": 0}},
        "motion": {"grip": {"x": 0, "y": 0, "z": "free", "rx_deg": 0, "ry_deg": 0, "rz_deg": 0}},
        "load": {"grip": {"z": {"amplitude": "slow", "value": -50}}},
    },
    {
        "name": "step 2",
        "increments": 1,
        "displacement": {"bar.foot": {"x": 0, "y": 0, "z": 0}},
        "motion": {
            "grip": {
                "rx_deg": 0,
                "ry_deg": 0,
                "rz_deg": pytest.approx(0.5729577951),
                "x": "free",
                "y": "free",
                "z": -0.2,
            }
        },
        "load": {"grip": {"y": 3}},
    },
]


def converted(folder: Path, capsys: pytest.CaptureFixture[str], text: str) -> tuple[dict, list]:
    """The case of a deck, and the lines on what is left out."""
    (folder / "deck.inp").write_text(text)
    target = folder / "deck.toml"
    target.unlink(missing_ok=True)
    assert main(["convert", str(folder / "deck.inp"), str(target)]) == 0
    lines = capsys.readouterr().out.splitlines()
    left = [line for line in lines if line.startswith("left out")]
    return tomllib.loads(target.read_text()), left


#: The same as of CalculiX: rotations have a node of their own.
CCX = DECK.replace("*COUPLING, CONSTRAINT NAME=Grip, REF NODE=RP, SURFACE=ROOF\n*KINEMATIC\n", "")
for old, new in (
    ("*BOUNDARY\n FOOT", "*RIGID BODY, NSET=HEAD, REF NODE=90, ROT NODE=91\n*BOUNDARY\n FOOT"),
    (" RP, 4, 6", " 91, 1, 3"),
    (" 90, 4, 5", " 91, 1, 2"),
    (" 90, 6, 6", " 91, 3, 3"),
):
    CCX = CCX.replace(old, new, 1)


@pytest.mark.parametrize(("text", "name", "face"), [(DECK, "grip", "roof"), (CCX, "head", "head")])
def test_what_is_taken_over(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], text: str, name: str, face: str
) -> None:
    """Requirement: a face on a reference point is a rigid body; what its point is given is a motion
    or a load, with amplitudes, turns in degrees; what nothing holds is free, and what OP=NEW does
    not name any more is let go."""
    case, left = converted(tmp_path, capsys, text)
    assert not left
    assert case["rigid"] == {name: {"faces": [f"bar.{face}"], "reference": [15, 5, 50]}}
    renamed = [
        step | {key: {name: step[key]["grip"]} for key in ("motion", "load")} for step in STEPS
    ]
    assert case["step"] == renamed


@pytest.mark.usefixtures("no_pictures")
def test_the_case_runs(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Requirement: the force on the point shortens the column by F L / (E A) = 0.02, a fifth of it
    half of the way, and holding its turn takes the moment of the arm to the middle of the head, 10
    times 50. Source: Hooke, balance. Tolerance: Newton's."""
    converted(tmp_path, capsys, DECK)
    out = tmp_path / "out"
    assert main(["run", str(tmp_path / "deck.toml"), "-o", str(out)]) == 0
    history = Results(out).history
    down, moment = history["rigid.grip.translation.z"], history["rigid.grip.support_moment.y"]
    assert down == pytest.approx([-0.004, -0.02, -0.2], rel=1e-6)
    assert abs(moment[:2]) == pytest.approx([100.0, 500.0], rel=1e-6)
    assert history["rigid.grip.support_force.z"][2] == pytest.approx(-500.0, rel=1e-6)


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("*KINEMATIC\n", "*DISTRIBUTING\n", "*DISTRIBUTING of line 29: its face may deform"),
        ("*KINEMATIC\n", "*KINEMATIC\n3, 3\n", "*KINEMATIC of line 29: single components are"),
        ("SURFACE=ROOF", "SURFACE=WALL", "*KINEMATIC of line 29: wall holds no faces"),
        ("SURFACE=ROOF", "INFLUENCE RADIUS=1", "or a node set that holds faces"),
        ("REF NODE=RP", "REF NODE=HEAD", "the reference point head is 4 nodes"),
        (" RP, 1, 2", " RP, XSYMM", "XSYMM of a reference point is not read; give its directions"),
        (" RP, 3, -50.", " RP, 3", "*CLOAD of line 38: rp has data of another kind"),
    ],
)
def test_what_is_left_out_is_said(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], old: str, new: str, line: str
) -> None:
    """Requirement: a line with keyword, place and reason; the rest is written all the same."""
    assert old in DECK
    case, left = converted(tmp_path, capsys, DECK.replace(old, new))
    assert any(line in said for said in left), left
    assert len(case["step"]) == 2


PLANE = """*NODE
 1, 0, 0
 2, 10, 0
 3, 10, 10
 4, 0, 10
 90, 0, 12
*ELEMENT, TYPE={element}, ELSET=BAR
 1, 1, 2, 3, 4
*NSET, NSET=FOOT
 1, 2
*SURFACE, NAME=ROOF
 BAR, S3
*MATERIAL, NAME=M
*ELASTIC
 1000., 0.
*SOLID SECTION, ELSET=BAR, MATERIAL=M
 2.
*COUPLING, CONSTRAINT NAME=Grip, REF NODE=90, SURFACE=ROOF
*KINEMATIC
 1, 2
*BOUNDARY
 FOOT, 1, 2
*STEP
*STATIC
*CLOAD
 90, 2, -50.
 90, 6, -250.
*END STEP
"""


@pytest.mark.usefixtures("no_pictures")
@pytest.mark.parametrize(
    ("element", "free", "area"),
    [("CPE4", {"x", "y", "rz_deg"}, 20.0), ("CAX4", {"y"}, 100.0 * math.pi)],
)
def test_in_the_plane(
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    element: str,
    free: set[str],
    area: float,
) -> None:
    """Requirement: a point has the directions that the plane leaves it, and couples with 1 and 2
    alone. Source: Hooke, F L / (E A) with the thickness or the whole face; the moment puts the
    force in the plane into the middle of the head. Tolerance: Newton's."""
    case, left = converted(tmp_path, capsys, PLANE.format(element=element))
    assert not left
    assert case["step"][0]["motion"] == {"grip": dict.fromkeys(free, "free")}
    assert main(["run", str(tmp_path / "deck.toml"), "-o", str(tmp_path / "out")]) == 0
    history = Results(tmp_path / "out").history
    down, turn = history["rigid.grip.translation.y"], history["rigid.grip.turn.z"]
    assert down == pytest.approx([-50.0 * 10.0 / (1000.0 * area)], rel=1e-6)
    assert turn == pytest.approx([0.0], abs=1e-9)
