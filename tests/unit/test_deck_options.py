"""Options, elements and loads of a deck that a case has no words for: each is told."""

from __future__ import annotations

from pathlib import Path

import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from tests.unit.decks import CUBE, case_of, read

from anisocontact.base.errors import InputError
from anisocontact.mesh.readers import file_arrays

PLACES = [(x + 5, y, z) for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
PAIR = """*SURFACE INTERACTION, NAME=I
*FRICTION
0.3
*CONTACT PAIR, INTERACTION=I, SMALL SLIDING
TOP, TOP
"""
METAL = (
    "*MATERIAL, NAME=M\n*ELASTIC\n1., 0.\n*PLASTIC, RATE=0.\n2., 0.\n*PLASTIC, RATE=5.\n4., 0.\n"
)
LAST = '*AMPLITUDE, NAME=A\n0., 0., 1., 1.\n*STEP, NAME="C:\\Users"\n*STATIC\n1., 1.\n*GRAVITY\n'


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("SMALL SLIDING", "TIED", "*CONTACTPAIR of line 23: TIED: its faces do not come apart"),
        ("INTERACTION=I,", "INTERACTION=J,", "there is no *SURFACE INTERACTION j, its contact is"),
        ("INTERACTION=I,", "INTER=I,", "*CONTACTPAIR of line 23: INTER=I is not taken over"),
        (
            "*SURFACE INT",
            "*FRICTION\n0.2\n*SURFACE INT",
            "*FRICTION of line 20: it belongs to no *SURFACE",
        ),
        ("RATE=0.", "RATE=0.", "*PLASTIC of line 30: RATE=5.: yield stress is that of no rate"),
        ("*ELASTIC", "*ELASTIC, MODULI=LONG TERM", "MODULI=LONG TERM is not taken over"),
        ("NAME=A", "NAME=A, VALUE=ABSOLUTE", "VALUE=ABSOLUTE is not read; write shares"),
        ("NAME=A", "NAME=A, SMOOTH=.2", "SMOOTH=.2 is not taken over"),
        ("*STATIC", "*STATIC, RIKS", "RIKS is not taken over; loads go along the increments"),
        ("*STEP,", "*STEP, AMPLITUDE=STEP,", "AMPLITUDE=STEP is not taken over; what has no"),
        ("*GRAV", "*ELEMENT, TYPE=SPRINGA\n9, 1, 2\n*GRAV", "1 elements SPRINGA: they are no"),
        (
            "*GRAVITY\n",
            "*DLOAD\n1, GRAV, 1., 1.\n1, GRAV, 1., 0., 1.\n, GRAV, 1., 1.\n*GRAVITY\n",
            "",
        ),
    ],
)
def test_options_without_words_in_a_case_are_said(
    tmp_path: Path, old: str, new: str, line: str
) -> None:
    """Requirement: what would be computed as something else is told, each option by its name;
    options that change nothing are not."""
    text = CUBE + PAIR + METAL + LAST
    assert old in text
    case, left = case_of(tmp_path, text.replace(old, new))
    assert case["material"]["set-1"]["flow_curve"] == [0, 2]
    assert case["step"][0]["name"] == "c:\\users"
    assert any(line in one for one in left), left
    usual = {"*GRAVITY", "*PLASTIC", *(["*CONTACTPAIR"] if "CONTACTPAIR" in line else [])}
    others = [one for one in left if one.split(" of ")[0] not in usual and line not in one]
    assert not others
    if "DLOAD" in new:
        assert case["step"][0]["gravity"] == {"x": 2.0, "y": 1.0}


def test_gravity_of_some_bodies_is_said(tmp_path: Path) -> None:
    """Requirement: it acts on all bodies of a case, which is told where a deck loads some."""
    load = "*MATERIAL, NAME=M\n*STEP\n*STATIC\n1., 1.\n*DLOAD\n{}\n"
    one, other = "Low.Set-1, GRAV, 2., 1.", "Up.Set-1, GRAV, 2., 1."
    _, both = case_of(tmp_path, _two_instances() + load.format(f"{one}\n{other}"))
    assert not [line for line in both if "ravity" in line]
    case, left = case_of(tmp_path, _two_instances() + load.format(one))
    assert case["step"][0]["gravity"] == {"x": 2.0}
    assert "is on low alone: it acts on all bodies here, density = 0 takes it off up" in str(left)
    case, left = case_of(tmp_path, _two_instances() + load.format(f"{one}\n{other}, 1."))
    assert case["step"][0]["gravity"] == {"x": 2.0}
    assert any("GRAV on up.set-1 is not that of other bodies, one is for all" in x for x in left)


def test_gravity_that_is_given_twice_adds_up(tmp_path: Path) -> None:
    """Requirement: with what takes it away again, and not across amplitudes."""
    load = "*AMPLITUDE, NAME=A\n0., 0., 1., 1.\n*STEP\n*STATIC\n1., 1.\n*DLOAD\n"
    down, along = "Set-1, GRAV, 2., 0., 0., -1.", "Set-1, GRAV, 3., 1."
    text = f"{CUBE}*MATERIAL, NAME=M\n{load}{down}\n{along}\n"
    case, _ = case_of(tmp_path, f"{text}*DLOAD\n{down.replace('-1.', '1.')}\n")
    assert case["step"][0]["gravity"] == {"x": 3.0, "z": 0.0}
    case, left = case_of(tmp_path, f"{text}*DLOAD, AMPLITUDE=A\n{down}\n")
    assert case["step"][0]["gravity"] == {"x": 3.0, "z": -2.0}
    assert any("two accelerations along z in one step, with different" in one for one in left)


def test_sheets_of_two_thicknesses_are_said(tmp_path: Path) -> None:
    """Requirement: a mesh in the plane has one thickness, that of the first section."""
    text = """*NODE
1, 0, 0
2, 1, 0
3, 1, 1
4, 0, 1
5, 2, 0
6, 3, 0
7, 3, 1
8, 2, 1
*ELEMENT, TYPE=CPS4, ELSET=A
1, 1, 2, 3, 4
*ELEMENT, TYPE=CPS4, ELSET=B
2, 5, 6, 7, 8
*MATERIAL, NAME=M
*ELASTIC
1., 0.
*SOLID SECTION, ELSET=A, MATERIAL=M
0.5
*SOLID SECTION, ELSET=B, MATERIAL=M
{}
"""
    for given, said in (("0.5", ""), ("0.25", "b has 0.25"), ("", "b has 1")):
        case, left = case_of(tmp_path, text.format(given))
        assert case["idealisation"] == {"kind": "plane-stress", "thickness": 0.5}
        assert left == ([f"thickness: it is 0.5 of all bodies, {said}"] if said else [])


def test_elements_without_a_section_are_said(tmp_path: Path) -> None:
    """Requirement: what is no body of the case is told by `convert`, and by `check` of the deck;
    a second material of one name, too."""
    text = CUBE + "*ELEMENT, TYPE=C3D8R, ELSET=More\n7, 11, 12, 13, 14, 15, 16, 17, 18\n*NODE\n"
    text += "".join(f"{n + 10}, {x}, {y}, {z}\n" for n, (x, y, z) in enumerate(PLACES, 1))
    text += "*MATERIAL, NAME=M\n*ELASTIC\n1., 0.\n*MATERIAL, NAME=m\n*DENSITY\n3.\n"
    said = "1 elements, as 7, are in no *SOLID SECTION: left out"
    case, left = case_of(tmp_path, text)
    assert said in left
    assert case["material"] == {"set-1": {"model": "linear-elastic", "E": 1, "nu": 0, "density": 3}}
    assert sum("there is one of this name already" in one for one in left) == 1
    assert said in file_arrays(tmp_path / "deck.inp", field="").notes
    _, left = case_of(
        tmp_path,
        text.replace("*MATERIAL, NAME=M", "*SOLID SECTION, ELSET=More\n*MATERIAL, NAME=M", 1),
    )
    assert said not in left


def test_instances_of_one_name_are_refused(tmp_path: Path) -> None:
    """Requirement: two bodies of one name are no single body in two pieces."""
    with pytest.raises(InputError, match="there is an instance 'Low' already"):
        read(tmp_path, _two_instances().replace("NAME=Up", "NAME=Low"))


def _two_instances() -> str:
    """Two cubes, the second above the first."""
    ends = "*INSTANCE, NAME=Low, PART=P\n*END INSTANCE\n*INSTANCE, NAME=Up, PART=P\n0., 0., 2.\n"
    return (
        f"*PART, NAME=P\n{CUBE}*END PART\n*ASSEMBLY, NAME=A\n{ends}*END INSTANCE\n*END ASSEMBLY\n"
    )
