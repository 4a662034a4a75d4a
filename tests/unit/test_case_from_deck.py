"""Decks of Abaqus and CalculiX as case files: what is taken over, what is left, a run."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.cli import main
from anisocontact.results import Results

DECK = """*HEADING
A cube on a cube
*NODE
 1, 0, 0, 0
 2, 10, 0, 0
 3, 10, 10, 0
 4, 0, 10, 0
 5, 0, 0, 1d1
 6, 10, 0, 10
 7, 10, 10, 10
 8, 0, 10, 10
 9, 0, 0, 10
 10, 10, 0, 10
 11, 10, 10, 10
 12, 0, 10, 10
 13, 0, 0, 20
 14, 10, 0, 20
 15, 10, 10, 20
 16, 0, 10, 20
*ELEMENT, TYPE=C3D8, ELSET=LOWER
 1, 1, 2, 3, 4, 5, 6, 7, 8
*ELEMENT, TYPE=C3D8, ELSET=UPPER
 2, 9, 10, 11, 12, 13, 14, 15, 16
*NSET, NSET=FOOT
 1, 2, 3, 4
*NSET, NSET=HEAD
 13, 14, 15, 16
*SURFACE, NAME=DECK
 LOWER, S2
*SURFACE, NAME=SOLE
 UPPER, S1
*MATERIAL, NAME=STEEL
*ELASTIC
 210000., 0.
*DENSITY
 7.8e-9
*SOLID SECTION, ELSET=LOWER, MATERIAL=STEEL
*SOLID SECTION, ELSET=UPPER, MATERIAL=STEEL
*SURFACE INTERACTION, NAME=DRY
*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR
 1e6
*FRICTION
 0.3
*CONTACT PAIR, INTERACTION=DRY, ADJUST=0.1
 SOLE, DECK
*AMPLITUDE, NAME=RAMP
 0., 0., 0.5, 0.75
 1., 1.
*BOUNDARY
 FOOT, PINNED
*STEP
Press
*STATIC
 0.25, 1.
*BOUNDARY
 HEAD, 1, 2
*DLOAD, AMPLITUDE=RAMP
 UPPER, P2, 20.
*NODE PRINT, NSET=FOOT
RF
*END STEP
*STEP
Pull
*STATIC
 0.5, 2.
*BOUNDARY, OP=NEW
 FOOT, 1, 3
 HEAD, 1, 1, 0.001
*CLOAD
 HEAD, 3, -25.
*DLOAD
 LOWER, GRAV, 9810., 0., , -2.
 UPPER, GRAV, 9810., 0., 0., -1.
*VIEWFACTOR
*END STEP
"""
WANTED = {
    "title": "A cube on a cube",
    "mesh": {"file": "deck.inp"},
    "material": {
        name: {"model": "linear-elastic", "E": 210000, "nu": 0, "density": 7.8e-9}
        for name in ("lower", "upper")
    },
    "amplitude": {"ramp": {"kind": "table", "time": [0, 0.5, 1], "value": [0, 0.75, 1]}},
    "contact": [
        {
            "slave": "upper.sole",
            "master": "lower.deck",
            "adjust": True,
            "adjust_gap": 0.1,
            "friction": {"coefficients": 0.3},
        }
    ],
    "step": [
        {
            "name": "press",
            "increments": 4,
            "displacement": {
                "lower.foot": {"x": 0, "y": 0, "z": 0},
                "upper.head": {"x": 0, "y": 0},
            },
            "pressure": {"upper.upper_p2": {"amplitude": "ramp", "value": 20}},
        },
        {
            "name": "pull",
            "increments": 4,
            "duration": 2,
            "displacement": {
                "lower.foot": {"x": 0, "y": 0, "z": 0},
                "upper.head": {"x": 0.001, "y": "free"},
            },
            "force": {"upper.head": {"z": -100}},
            "gravity": {"z": -9810},
        },
    ],
}


@pytest.fixture
def deck(tmp_path: Path) -> Path:
    """The deck in a folder of its own."""
    path = tmp_path / "deck.inp"
    path.write_text(DECK)
    return path


def converted(deck: Path, capsys: pytest.CaptureFixture[str]) -> tuple[dict, list[str]]:
    """The case of a deck, and the lines that are said."""
    target = deck.with_suffix(".toml")
    target.unlink(missing_ok=True)
    assert main(["convert", str(deck), str(target)]) == 0
    return tomllib.loads(target.read_text()), capsys.readouterr().out.splitlines()


def test_what_is_taken_over(deck: Path, capsys: pytest.CaptureFixture[str]):
    """Requirement: mesh, materials, contact, amplitude, steps, supports and loads as the manuals
    have them; a force on nodes is that of all, OP=NEW releases; what is not known is said."""
    case, lines = converted(deck, capsys)
    assert case == WANTED
    assert lines[0] == "left out  *VIEWFACTOR of line 74"
    assert lines[1].startswith("written ")
    assert 'method = "penalty"' in deck.with_suffix(".toml").read_text()


@pytest.mark.parametrize(
    ("times", "increments", "duration"),
    [("0., 1.", 1, None), ("0., 0.", 1, None), (", 2.", 1, 2), ("0.25", 4, None), ("", 1, None)],
)
def test_times_of_a_step_that_are_zero_or_left_out(
    deck: Path, capsys: pytest.CaptureFixture[str], times, increments, duration
):
    """Requirement: a step takes 1, in one increment. Source: the manuals of both codes, where zero
    is the default. A first time of zero ended with an error of the program itself."""
    deck.write_text(DECK.replace(" 0.25, 1.\n", f" {times}\n"))
    case, _ = converted(deck, capsys)
    assert case["step"][0]["increments"] == increments
    assert case["step"][0].get("duration") == duration


@pytest.mark.usefixtures("no_pictures")
def test_the_case_runs(deck: Path, capsys: pytest.CaptureFixture[str]):
    """Requirement: foot and contact carry the pressure on the head, then the force and the weight
    besides, to 1e-6. Source: balance. Tolerance: Newton's."""
    converted(deck, capsys)
    assert main(["check", str(deck.with_suffix(".toml"))]) == 0
    out = deck.parent / "out"
    assert main(["run", str(deck.with_suffix(".toml")), "-o", str(out)]) == 0
    history = Results(out).history
    found = history["contacts.0.force.z"]
    assert found[1] == pytest.approx(0.75 * 2000.0, rel=1e-6)
    assert found[3] == pytest.approx(2000.0, rel=1e-6)
    weight = 9810.0 * 7.8e-9 * 1000.0
    assert found[-1] == pytest.approx(2100.0 + weight, rel=1e-6)
    assert history["reactions.lower.foot.z"][-1] == pytest.approx(2100.0 + 2 * weight, rel=1e-6)


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        (" SOLE, DECK", " SOLE, BASE", "*CONTACTPAIR of line 44: base is no facet group"),
        (" SOLE, DECK", " SOLE", "a surface with itself; see self_contact"),
        (" 0.25, 1.\n", " 0.25, 1e400\n", "*STATIC of line 53: its data are of another kind"),
        (" 210000., 0.\n", " 1e400, 0.\n", "*ELASTIC"),
        (" 210000., 0.\n", " 1.\n", "*ELASTIC of line 33: 1 numbers, 2 are needed"),
        ("*ELASTIC\n", "*ELASTIC, TYPE=ORTHO\n", "*ELASTIC of line 33: 2 numbers, 9 are needed"),
        ("*ELASTIC\n", "*ELASTIC, TYPE=ANISO\n", "TYPE=ANISO is not taken over; see a law"),
        ("*DENSITY", "*EXPANSION, TYPE=ORTHO\n 1.\n*DENSITY", "one coefficient is taken over"),
        ("*DENSITY", "*EXPANSION\n 1., 20.\n 2., 90.\n*DENSITY", "values at other temperatures"),
        ("*BOUNDARY, OP=NEW", "*BOUNDARY, FIXED", "FIXED holds nodes where they are"),
        (
            "*STEP\nPress",
            "*TRANSFORM, NSET=HEAD\n0, 1, 0, -1, 0, 0\n*STEP\nPress",
            "head has a *TR",
        ),
        ("*VIEWFACTOR", "*EQUATION", "components of single nodes are not tied; see faces"),
        ("*VIEWFACTOR", "*TEMPERATURE, FILE=hot\n", "temperatures of a file"),
        ("*STEP\nPress", "*INITIAL CONDITIONS, TYPE=STRESS\n*STEP\nPress", "TYPE=STRESS is not"),
        (
            "*STEP\nPress",
            "*CYCLIC SYMMETRY MODEL, N=4\n0,0,0,0,0,1\n*STEP\nPress",
            "no *TIE, CYCLIC",
        ),
        ("*FRICTION", "*FRICTION, ANISOTROPIC", "1 numbers, 2 are needed"),
        ("*FRICTION", "*FRICTION, ROUGH", "ROUGH is not taken over; no slip at all: see [[tie]]"),
        ("*FRICTION", "*FRICTION, TAUMAX=5", "its coefficient is taken over, not its limit of"),
        ("OVERCLOSURE=LINEAR", "OVERCLOSURE=TABULAR", "TABULAR: contact is exact here"),
        ("NAME=RAMP", "NAME=RAMP, DEFINITION=PERIODIC", "DEFINITION=PERIODIC is not read"),
        (" HEAD, 3, -25.", " 99, 3, -25.", "99 is on no body, a force is on one"),
        (" HEAD, 3, -25.", " HEAD, 5, -25.", "a moment on head; faces on a reference point"),
        ("*FRICTION", "*FRICTION, EXPONENTIAL DECAY", "a coefficient that falls with speed"),
        ("*FRICTION\n 0.3", "*FRICTION\n 0.3\n 0.2, , 9.", "is taken over, not other values"),
        ("OVERCLOSURE=LINEAR", "OVERCLOSURE=TIED", "its faces do not come apart, as [[tie]]"),
        ("*SURFACE BEHAVIOR", "*SURFACE BEHAVIOR, NO SEPARATION", "its faces do not come apart"),
        ("NAME=RAMP", "NAME=RAMP, USER", "USER is not read; see kind"),
        ("NAME=RAMP", "NAME=RAMP, SHIFTX=1.", "SHIFTX is not read; shift its times"),
        (" 1., 1.\n", " 1.\n", "*AMPLITUDE of line 46: 5 numbers, times and values are needed"),
        ("*DLOAD, AMP", "*DLOAD, TIME DELAY=1., AMP", "*DLOAD of line 57: TIME DELAY is not read"),
        ("*BOUNDARY, OP", "*BOUNDARY, TIME DELAY=1., OP", "line 66 is not read: TIME DELAY"),
        ("*BOUNDARY, OP", "*BOUNDARY, TYPE=VELOCITY, OP", "the option TYPE=VELOCITY is not read"),
        ("*BOUNDARY, OP", "*BOUNDARY, SUBMODEL, OP", "the option SUBMODEL is not read"),
        ("*CLOAD\n", "*CLOAD, FOLLOWER\n", "*CLOAD of line 69: the option FOLLOWER is not read"),
        ("*STEP\nPress", "*TIE, MULTISTAGE\nSOLE, DECK\n*STEP\nPress", "MULTISTAGE is no tie"),
        ("UPPER, P2", "UPPER, BX", "BX on upper; P1, P2 ... and GRAV are read"),
    ],
)
def test_what_is_left_out_is_said(
    deck: Path, capsys: pytest.CaptureFixture[str], old: str, new: str, line: str
):
    """Requirement: a line with keyword, place and reason; the rest is written all the same."""
    assert old in DECK
    deck.write_text(DECK.replace(old, new))
    case, lines = converted(deck, capsys)
    assert any(said.startswith("left out  ") and line in said for said in lines), lines
    assert len(case["step"]) == 2


def test_steps_that_are_not_static(deck: Path, capsys: pytest.CaptureFixture[str]):
    """Requirement: a step that is not static is left out with its loads, in a line that says what
    it is; supports from the start go with the first that is left."""
    deck.write_text(DECK.replace("*STATIC\n 0.25, 1.", "*MODAL DYNAMIC\n 0.25, 1."))
    case, lines = converted(deck, capsys)
    text = "step 1 is *MODAL DYNAMIC, not *STATIC; steps behind it begin without what it does"
    assert lines[0] == f"left out  {text}"
    (step,) = case["step"]
    assert step["name"] == "pull"
    assert "pressure" not in step
    assert step["displacement"] == {
        "lower.foot": {"x": 0, "y": 0, "z": 0},
        "upper.head": {"x": 0.001},
    }
    deck.write_text(DECK.replace("*STATIC\n 0.5, 2.", "*FREQUENCY\n 10"))
    case, lines = converted(deck, capsys)
    assert lines[0] == "left out  step 2 is *FREQUENCY, not *STATIC"
    assert case["step"] == WANTED["step"][:1]
    deck.write_text(DECK.replace("*STEP\nPull", "*STEP, PERTURBATION\nPull"))
    case, lines = converted(deck, capsys)
    assert lines[0] == "left out  step 2 is a PERTURBATION of the steps before"
    deck.write_text(DECK.replace("*STEP\nPress", "*STEP, PERTURBATION\nPress"))
    assert converted(deck, capsys)[0]["step"] == WANTED["step"]


def test_a_deck_without_a_static_step(deck: Path, capsys: pytest.CaptureFixture[str]):
    """Requirement: it is refused in a line that names the steps, and no file is written."""
    deck.write_text(DECK.replace("*STATIC\n 0.25", "*BUCKLE\n 5").replace("*STATIC", "*DYNAMIC"))
    target = deck.with_suffix(".toml")
    assert main(["convert", str(deck), str(target)]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    text = "no step can be taken over: step 1 is *BUCKLE, not *STATIC, step 2 is *DYNAMIC, not"
    assert text in line
    assert not target.exists()


def test_a_deck_without_steps(deck: Path, capsys: pytest.CaptureFixture[str]):
    """Requirement: a mesh with materials alone is written, and a line says that steps are missing,
    which `check` would refuse. A deck with steps has no such line. Texts are compared."""
    deck.write_text(DECK[: DECK.index("*STEP")])
    case, lines = converted(deck, capsys)
    assert "step" not in case
    assert [line for line in lines if line.startswith("missing ")] == [
        "missing   [[step]]: the deck has no *STEP; supports and loads are to be written there"
    ]
    deck.write_text(DECK)
    assert not any(line.startswith("missing ") for line in converted(deck, capsys)[1])


@pytest.mark.parametrize(
    ("option", "given"), [("", {}), (", POSITION TOLERANCE=0.2", {"tolerance": 0.2})]
)
def test_a_tie(deck: Path, capsys: pytest.CaptureFixture[str], option: str, given: dict):
    """Requirement: faces that are tied, within the distance that the deck says."""
    pair = "*CONTACT PAIR, INTERACTION=DRY, ADJUST=0.1"
    deck.write_text(DECK.replace(pair, f"*TIE, NAME=T{option}"))
    case, _ = converted(deck, capsys)
    assert case["tie"] == [{"slave": "upper.sole", "master": "lower.deck"} | given]
    assert "contact" not in case


@pytest.mark.usefixtures("no_pictures")
def test_finite_strain_the_plane_and_nodes(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """Requirement: NLGEOM asks for a material at finite strain, CPE4 for plane strain with its
    thickness; a node that is held by its number gets a name."""
    deck = tmp_path / "plane.inp"
    deck.write_text(
        "*NODE\n1, 0, 0\n2, 1, 0\n3, 1, 1\n4, 0, 1\n*ELEMENT, TYPE=CPE4, ELSET=A\n1, 1, 2, 3, 4\n"
        "*MATERIAL, NAME=M\n*ELASTIC\n10, 0.3\n*SOLID SECTION, ELSET=A, MATERIAL=M\n0.5\n"
        "*BOUNDARY\n1, 1, 2\n2, 2\n*STEP, NLGEOM\n*STATIC\n*DLOAD\nA, P3, 0.1\n*END STEP\n"
    )
    case, lines = converted(deck, capsys)
    assert case["idealisation"] == {"kind": "plane-strain", "thickness": 0.5}
    assert case["material"]["a"] == {"model": "st-venant-kirchhoff", "E": 10, "nu": 0.3}
    assert case["nodes"] == {"a.node1": {"near": [0, 0, 0]}, "a.node2": {"near": [1, 0, 0]}}
    assert case["step"][0]["displacement"] == {"a.node1": {"x": 0, "y": 0}, "a.node2": {"y": 0}}
    assert not [line for line in lines if line.startswith("left out")]
    assert main(["run", str(tmp_path / "plane.toml"), "-o", str(tmp_path / "out")]) == 0


@pytest.mark.usefixtures("no_pictures")
def test_pressures_on_single_elements(deck: Path, capsys: pytest.CaptureFixture[str]):
    """Requirement: faces of elements by their numbers are a group for each pressure, named by the
    line of the keyword; a run carries them to 1e-6. Source: balance. Tolerance: Newton's."""
    given = DECK.replace(" UPPER, P2, 20.", " 2, P2, 20.\n 1, P3, 1.\n 1, P5, 1.")
    deck.write_text(given)
    case, _ = converted(deck, capsys)
    line = 1 + given.splitlines().index("*DLOAD, AMPLITUDE=RAMP")
    pressure = case["step"][0]["pressure"]
    assert pressure == {
        f"upper.pressed_{line}": {"amplitude": "ramp", "value": 20},
        f"lower.pressed_{line}_2": {"amplitude": "ramp", "value": 1},
    }
    out = deck.parent / "out"
    assert main(["run", str(deck.with_suffix(".toml")), "-o", str(out)]) == 0
    force = Results(out).history["contacts.0.force.z"]
    assert force[3] == pytest.approx(2000.0, rel=1e-6)


@pytest.mark.usefixtures("no_pictures")
def test_a_flow_curve(deck: Path, capsys: pytest.CaptureFixture[str]):
    """Requirement: yield stress over plastic strain, at finite strain where NLGEOM asks for it; the
    contact carries the pressure, which is beyond the first yield stress. Source: balance, the area
    of the head is held. Tolerance: Newton's."""
    rows = "*PLASTIC\n 15., 0.\n 30., 0.02\n"
    deck.write_text(DECK.replace("*DENSITY", f"{rows}*DENSITY"))
    case, _ = converted(deck, capsys)
    steel = case["material"]["lower"]
    assert steel["model"] == "plastic"
    assert steel["flow_curve"] == [0, 15, 0.02, 30]
    deck.write_text(DECK.replace("*DENSITY", f"{rows}*DENSITY").replace("*STEP", "*STEP, NLGEOM"))
    case, _ = converted(deck, capsys)
    assert case["material"]["upper"]["strain"] == "logarithmic"
    out = deck.parent / "out"
    assert main(["run", str(deck.with_suffix(".toml")), "-o", str(out)]) == 0
    assert Results(out).history["contacts.0.force.z"][3] == pytest.approx(2000.0, rel=1e-6)


def test_a_constant_amplitude_is_a_factor(deck: Path, capsys: pytest.CaptureFixture[str]):
    """Requirement: values times the number, reached along the step, and a line that says so."""
    deck.write_text(DECK.replace(" 0., 0., 0.5, 0.75\n 1., 1.", " 0., 0.5, 1., 0.5"))
    case, lines = converted(deck, capsys)
    assert case["step"][0]["pressure"] == {"upper.upper_p2": 10}
    assert "amplitude" not in case
    assert any("it is constant, values are reached at the end" in line for line in lines)


def test_what_cannot_be_written(deck: Path, capsys: pytest.CaptureFixture[str]):
    """Requirement: one line; a case file is never written over."""
    deck.with_suffix(".toml").write_text("mine")
    assert main(["convert", str(deck), str(deck.with_suffix(".toml"))]) == 2
    assert "exists already" in capsys.readouterr().err
    assert deck.with_suffix(".toml").read_text() == "mine"
    other = deck.with_suffix(".msh")
    assert main(["convert", str(other), str(deck.with_name("b.toml"))]) == 2
    assert "a case file is written of a deck .inp" in capsys.readouterr().err
    target = deck.with_name("b.toml")
    assert main(["convert", str(deck.with_name("none.inp")), str(target)]) == 2
    assert capsys.readouterr().err.rstrip().endswith("none.inp' does not exist")
    assert main(["convert", str(deck), str(deck.parent / "none" / "b.toml")]) == 2
    assert "b.toml' cannot be written: No such file or directory" in capsys.readouterr().err
