"""What "auto" takes for the pass and the method of a contact, and that a run says it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.case import load
from anisocontact.case.build import build
from anisocontact.cli import main

PAIR = """
[mesh.box.block]
origin = [0, 0, 0]
size = [1, 1, 1]
cells = [{cells}, {cells}, 1]

[mesh.box.base]
origin = [-1, -1, -1]
size = [3, 3, 1]
cells = [3, 3, 1]

[material]
block = {{ model = "linear-elastic", E = {young}, nu = 0.3 }}
base = {{ model = "linear-elastic", E = 100, nu = 0.3 }}

[surface.plate]
shape = "plane"
point = [0, 0, 0]
normal = [0, 0, 1]

[[contact]]
slave = "block.bottom"
master = "{master}"
{more}

[[step]]
name = "press"
increments = 1
[step.displacement]
"block.top" = {{ x = 0, y = 0, z = -0.01 }}
"base.bottom" = {{ x = 0, y = 0, z = 0 }}
"""
FRICTION = "friction = { coefficients = 0.3 }\n"
EXPLICIT = 'friction = { coefficients = 0.3, sliding_rule = "explicit" }\n'


def text(more: str = FRICTION, **given: Any) -> str:
    values = {"cells": 3, "young": 100, "master": "base.top"} | given
    return PAIR.format(more=more, **values)


def taken(folder: Path, case: str) -> tuple[bool, bool]:
    """Whether the law is evaluated at slave nodes, and whether there are multipliers."""
    (folder / "case.toml").write_text(case)
    (contact,) = build(load(folder / "case.toml")).problem.contacts
    return contact.slave_points.at_nodes, contact.trials.augmented


@pytest.mark.parametrize("master", ["base.top", "plate"])
@pytest.mark.parametrize(
    ("more", "wanted"),
    [
        ("", (True, True)),
        ("adhesion = { stiffness = 100 }", (True, True)),
        ("adhesion = { stiffness = 100 }\ntolerance = 1e-4", (True, True)),
        ("normal = { penalty = 1000 }", (True, False)),
        ('normal = { penalty = 1000 }\nmethod = "augmented"', (True, True)),
        ('normal = { model = "kelvin-voigt", stiffness = 10, viscosity = 1 }', (True, False)),
        ('evolution = "backward-euler"', (True, True)),
        ('method = "penalty"', (True, False)),
        ('pass = "single"', (False, False)),
        ('pass = "single"\ntolerance = 1e-4', (False, True)),
        ('pass = "single"\nmethod = "augmented"', (False, True)),
        ("degree = 3", (False, False)),
    ],
)
def test_what_auto_takes(tmp_path: Path, master: str, more: str, wanted: tuple[bool, bool]) -> None:
    assert taken(tmp_path, text(f"{FRICTION}{more}", master=master)) == wanted


def test_a_rule_without_multipliers_that_follow_has_penalties(tmp_path: Path) -> None:
    assert taken(tmp_path, text(EXPLICIT)) == (True, False)
    assert taken(tmp_path, text(f'{EXPLICIT}multipliers = "uzawa"')) == (True, True)


def test_a_stiff_and_fine_slave_has_points(tmp_path: Path) -> None:
    """Its nodes would lose contact between those of the master, docs/verification/mortar.md."""
    assert taken(tmp_path, text(young=1000)) == (False, False)
    assert taken(tmp_path, text(young=200)) == (True, True)
    assert taken(tmp_path, text(young=1000, cells=1)) == (True, True)
    assert taken(tmp_path, text(young=1000, master="plate")) == (True, True)


def test_check_says_what_was_taken(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for more, said in {
        "": "at slave nodes (mortar), multipliers",
        'pass = "single"': "at integration points, penalties",
    }.items():
        (tmp_path / "case.toml").write_text(text(FRICTION + more))
        assert main(["check", str(tmp_path / "case.toml")]) == 0
        (line,) = (x for x in capsys.readouterr().out.splitlines() if x.startswith("contact "))
        assert line.endswith(f", maximum-dissipation, {said}")


@pytest.mark.parametrize(
    ("more", "wanted"),
    [
        ("", (True, True)),
        ("normal = { penalty = 1000 }", (True, False)),
        ("apart = 1", (True, True)),
    ],
)
def test_a_fold_has_slave_nodes(tmp_path: Path, more: str, wanted: tuple[bool, bool]) -> None:
    folded = f"{FRICTION}self_contact = true\n{more}"
    assert taken(tmp_path, text(folded, master="block.bottom")) == wanted


@pytest.mark.parametrize(
    ("name", "more", "master"),
    [("two-half", "", "base.top"), ("single", "self_contact = true", "block.bottom")],
)
def test_passes_of_before_are_mortar(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str, more: str, master: str
) -> None:
    """A line says so; the bodies are those for which "auto" takes points."""
    given = text(f'{FRICTION}pass = "{name}"\n{more}', master=master, young=1000)
    assert taken(tmp_path, given) == (True, True)
    assert main(["check", str(tmp_path / "case.toml")]) == 0
    assert (
        f'contact[0].pass: "{name}" is "mortar" from now on; name that' in capsys.readouterr().out
    )


def test_slave_nodes_have_no_degree(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A degree is for integration points: with slave nodes it would say nothing."""
    (tmp_path / "case.toml").write_text(text(f'{FRICTION}pass = "mortar"\ndegree = 3'))
    assert main(["check", str(tmp_path / "case.toml")]) == 2
    assert capsys.readouterr().err.startswith('error: contact[0].degree: given with pass "mortar"')
