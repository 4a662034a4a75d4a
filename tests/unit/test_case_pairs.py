"""Two meshed bodies in a case file: what it may say of them, and one line for each mistake."""

from __future__ import annotations

import json

import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.case import load
from anisocontact.case.build import build
from anisocontact.cli import main

CASE = """
[mesh.box.block]
origin = [0, 0, 0]
size = [1, 1, 1]
cells = [2, 2, 1]
[mesh.box.base]
origin = [-0.5, -0.5, -1]
size = [2, 2, 1]
cells = [3, 3, 1]
[material.block]
model = "linear-elastic"
E = 1000
nu = 0.3
[material.base]
model = "linear-elastic"
E = 100
nu = 0.3
[surface.plate]
shape = "plane"
point = [0, 0, -1]
normal = [0, 0, 1]
[[contact]]
slave = "block.bottom"
master = "base.top"
pass = "mortar"
normal = { penalty = "auto" }
adhesion = { stiffness = [1e3, 1e3] }
friction = { coefficients = [0.3, 0.3] }
[[step]]
name = "press"
increments = 1
[step.displacement]
"base.bottom" = { x = 0, y = 0, z = 0 }
"block.top" = { x = 0, y = 0, z = -0.01 }
[output]
pictures = false
"""

WRONG = [
    (
        'master = "base.top"',
        'master = "base.topp"',
        "contact[0].master",
        "did you mean 'base.top'?",
    ),
    ('master = "base.top"', 'master = "bas.top"', "contact[0].master", 'did you mean "base"?'),
    ('master = "base.top"', 'master = "block.bottom"', "contact[0].master", "same facets"),
    ("pass =", "apart = 0.3\npass =", "contact[0].apart", "self_contact = true"),
    ('pass = "mortar"', "self_contact = true", "contact[0].master", '"block.bottom" needed'),
    ('"mortar"', '"mortars"', "contact[0].pass", "mortar"),
    ("pass =", "degree = 31\npass =", "contact[0].degree", "31 given"),
    ("pass =", "degree = 0\npass =", "contact[0].degree", "0 given"),
    ("pass =", 'evolution = "total"\npass =', "contact[0].evolution", '"backward-euler" only'),
    ("coefficients = [0.3, 0.3]", "coefficients = [0.3, 0.1]", "contact[0].friction", "directions"),
]


def _built(tmp_path, text):
    path = tmp_path / "case.toml"
    path.write_text(text)
    return build(load(path))


@pytest.mark.parametrize(("old", "new", "field", "says"), WRONG)
def test_wrong_value(tmp_path, capsys, old, new, field, says):
    """One line: the field, what was given, what is allowed; nothing is written."""
    assert CASE.count(old) == 1
    case, out = tmp_path / "case.toml", tmp_path / "out"
    case.write_text(CASE.replace(old, new))
    assert main(["run", str(case), "-o", str(out)]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"error: {field}")
    assert says in line
    assert not out.exists()


def test_self_contact(tmp_path):
    """A group that is its own master is one contact of its own kind."""
    text = CASE.replace('master = "base.top"', 'master = "block.bottom"\napart = 0.2')
    text = text.replace('pass = "mortar"', "self_contact = true")
    (contact,) = _built(tmp_path, text).problem.contacts
    assert contact.groups == ("block.bottom", "block.bottom")
    assert contact.counts()["open"] == len(contact.points)


def test_same_pair_twice(tmp_path, capsys):
    """A pair given once more with swapped parts would act twice."""
    start, end = CASE.index("[[contact]]"), CASE.index("[[step]]")
    again = CASE[start:end].replace('slave = "block.bottom"\nmaster = "base.top"',
                                    'slave = "base.top"\nmaster = "block.bottom"')  # fmt: skip
    (tmp_path / "case.toml").write_text(CASE[:end] + again + CASE[end:])
    assert main(["check", str(tmp_path / "case.toml")]) == 2
    assert "error: contact[1]: same pair as contact[0]" in capsys.readouterr().err


def test_one_surface_under_two_names(tmp_path, capsys):
    """Two tables that say the same plane are one master: forces would be shared, or act twice."""
    start, end = CASE.index("[[contact]]"), CASE.index("[[step]]")
    on_plate = CASE[start:end].replace('slave = "block.bottom"\nmaster = "base.top"',
                                       'slave = "base.bottom"\nmaster = "plate"')  # fmt: skip
    again = on_plate.replace('"plate"', '"same"')
    same = '[surface.same]\nshape = "plane"\npoint = [3, 1, -1]\nnormal = [0, 0, 2]\n'
    (tmp_path / "case.toml").write_text(CASE[:end] + on_plate + again + same + CASE[end:])
    assert main(["run", str(tmp_path / "case.toml"), "-o", str(tmp_path / "out")]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line == (
        "error: contact: contact 'base.bottom on same' is given twice: 9 of its facets meet the "
        "same master in contact 'base.bottom on plate'"
    )
    assert not (tmp_path / "out").exists()


def test_parts_that_are_swapped(tmp_path, capsys):
    """A part of the master that meets a part of the slave once more, as a slave, acts twice.

    Multipliers of both sides share the pressure at random: of blocks of one material, pressed
    straight down, contacts had tangential forces of 6 and 11 % of their normal ones.
    """
    start, end = CASE.index("[[contact]]"), CASE.index("[[step]]")
    again = CASE[start:end].replace('slave = "block.bottom"\nmaster = "base.top"',
                                    'slave = "base.part"\nmaster = "block.bottom"')  # fmt: skip
    part = '[group."base.part"]\nby = "box"\nlow = [-0.6, -1, -0.1]\nhigh = [0.9, 2, 0.1]\n'
    (tmp_path / "case.toml").write_text(CASE[:end] + again + part + CASE[end:])
    assert main(["check", str(tmp_path / "case.toml")]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line == (
        "error: contact: contact 'base.part on block.bottom' is given twice: 6 of its facets are "
        "the master of what its master is the slave in, contact 'block.bottom on base.top'; take "
        "one side as the slave"
    )


def test_what_is_built(tmp_path, capsys):
    """Points and slave nodes, the area of now at finite strain, the softer penalty."""
    contact = _built(tmp_path, CASE).problem.contacts[0]
    assert len(contact.areas) == 9
    # 10 E / h of the base: E = 100, facets of 2/3; the block has 1000 and 1/2
    assert contact.interface.normal.named[1]["penalty"][0] == pytest.approx(1500.0)
    assert contact.name == "block.bottom on base.top"
    finer = CASE.replace('pass = "mortar"', 'pass = "single"\ndegree = 6')
    assert len(_built(tmp_path, finer).problem.contacts[0].areas) == 4 * 16
    soft = CASE.replace('model = "linear-elastic"\nE = 100\n', 'model = "neo-hookean"\nE = 100\n')
    for text, current in ((CASE, False), (soft, True)):
        assert _built(tmp_path, text).problem.contacts[0].current_area is current
    assert main(["check", str(tmp_path / "case.toml")]) == 0
    assert "at slave nodes (mortar)" in capsys.readouterr().out


def test_initial_overlap_is_said(tmp_path, capsys):
    """Bodies that overlap before the first step: a warning with the size, in log and summary."""
    case, out = tmp_path / "case.toml", tmp_path / "out"
    text = CASE.replace('pass = "mortar"', 'pass = "single"')
    case.write_text(text.replace("origin = [0, 0, 0]", "origin = [0, 0, -0.005]"))
    assert main(["run", str(case), "-o", str(out)]) == 0
    said = "the bodies overlap by 0.005 at the start, 1% of the facet size"
    assert said in capsys.readouterr().err
    # before it that the slave is stiff and fine
    assert said in (out / "run.log").read_text().splitlines()[2]
    summary = json.loads((out / "summary.json").read_text())
    assert "swap slave and master" in summary["warnings"][1]
    assert said in summary["warnings"][2]
    # the worst is that of the only increment, not the overlap of the mesh
    contact = summary["contacts"][0]
    assert 0.0 < contact["worst_penetration"] == contact["max_penetration"] < 0.005
    case.write_text(text)
    assert main(["run", str(case), "-o", str(out), "--overwrite"]) == 0
    assert "overlap" not in capsys.readouterr().err


def test_points_that_run_off_the_end_are_said(tmp_path, capsys):
    """One line of the log and of the output for each increment in which points leave the base."""
    text = CASE.replace('pass = "mortar"', 'pass = "single"').replace(
        '"block.top" = { x = 0, y = 0, z = -0.01 }',
        '"block.top" = { x = 0, y = 0, z = -0.01 }\n[[step]]\nname = "off"\nincrements = 3\n'
        '[step.displacement]\n"block.top" = { x = 0.9 }',
    )
    case, out = tmp_path / "case.toml", tmp_path / "out"
    case.write_text(text)
    assert main(["run", str(case), "-o", str(out)]) == 0
    said = "ran off the end of the master, the first at ("
    for lines in ((out / "run.log").read_text(), capsys.readouterr().out):
        found = [line for line in lines.splitlines() if said in line]
        assert 1 <= len(found) <= 3
        assert found[0].strip().startswith("block.bottom on base.top: ")


def test_the_side_that_has_the_directions(tmp_path):
    """`directions_on` reaches the laws, and anything but a side is one line."""
    directed = (
        "friction = { coefficients = [0.3, 0.1], directions_on = 'slave', "
        "directions = { kind = 'constant', vector = [1, 0, 0] } }"
    )
    case = tmp_path / "case.toml"
    case.write_text(CASE.replace("friction = { coefficients = [0.3, 0.3] }", directed))
    (contact,) = build(load(case)).problem.contacts
    assert contact.interface.tangential.friction.directions_on == "slave"
    assert contact.interface.tangential.adhesion.directions_on == "master"


def test_directions_on_neither_side(tmp_path, capsys):
    case = tmp_path / "case.toml"
    wrong = 'friction = { coefficients = [0.3, 0.3], directions_on = "base" }'
    case.write_text(CASE.replace("friction = { coefficients = [0.3, 0.3] }", wrong))
    assert main(["check", str(case)]) == 2
    line = capsys.readouterr().err
    assert "contact[0].friction.directions_on" in line
    assert all(word in line for word in ("base", "slave", "master"))


def test_a_side_that_has_directions_which_are_not_given(tmp_path, capsys):
    """Requirement: what contradicts itself is one line: a body for directions, and none of them."""
    case = tmp_path / "case.toml"
    wrong = 'friction = { coefficients = 0.3, directions_on = "slave" }'
    case.write_text(CASE.replace("friction = { coefficients = [0.3, 0.3] }", wrong))
    assert main(["check", str(case)]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("error: contact[0].friction.directions_on: given without directions")
