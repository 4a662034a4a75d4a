"""Sectors in the case file: a run, what is wrong in one line, and words of other codes."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.cli import main
from anisocontact.results import Results

CASE = """
[mesh.ring.disc]
inner = 1.0
outer = 2.0
length = 0.5
start_deg = 10
end_deg = 40
cells = [2, 2, 1]

[material.disc]
model = "neo-hookean"
E = 1000
nu = 0.3

[surface.floor]
shape = "plane"
point = [0, 0, 0]
normal = [0, 0, 1]

[[contact]]
slave = "disc.bottom"
master = "floor"
friction = { coefficients = 0.2 }

[[cyclic]]
slave = "disc.end"
master = "disc.start"
sectors = 12

[[step]]
name = "press"
increments = 1
displacement = { "disc.top" = { x = 0, y = 0, z = -0.01 } }

[[step]]
name = "turn"
increments = 3
rotation = { "disc.top" = { axis = [0, 0, 1], angle_deg = 2 } }

[output]
pictures = false
"""


def test_run(tmp_path: Path):
    """A sector that slides as a whole.

    Requirement: the torque about the axis is mu N 2/3 (b^3 - a^3)/(b^2 - a^2) to 2 %. Source:
    Coulomb under a uniform pressure. Tolerance: the pressure is uniform but for the edges.
    """
    path = tmp_path / "case.toml"
    path.write_text(CASE)
    assert main(["run", str(path), "-o", str(tmp_path / "out")]) == 0
    last = Results(tmp_path / "out").summary["contacts"][0]
    arm = 2.0 / 3.0 * (8.0 - 1.0) / (4.0 - 1.0)
    assert abs(last["moment"][2]) == pytest.approx(0.2 * last["force"][2] * arm, rel=0.02)


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("sectors = 12", "sectors = 11", "cyclic[0]"),
        ("sectors = 12", "sectors = 1", "cyclic[0].sectors: "),
        (
            "sectors = 12",
            "sectors = 12\naxis = [0, 1, 1]",
            "about the direction (0, 0.7071, 0.7071)",
        ),
        ("sectors = 12", "sectors = 12\naxis = [0, 0, 0]", "cyclic[0].axis: "),
        ("sectors = 12", "n = 12", 'did you mean "sectors"?'),
        ('master = "disc.start"', 'master = "disc.end"', "the slave itself"),
        ('master = "disc.start"', 'master = "disk.start"', 'did you mean "disc"?'),
        ('master = "disc.start"', 'master = "disc.begin"', "cyclic[0].master: "),
        ("[[cyclic]]", "[[cyclic_symmetry]]", 'did you mean "cyclic"?'),
        ("x = 0, y = 0, z", "x = 0, z", "only one component across the axis z is held"),
        ("x = 0, y = 0, z", "x = 1, y = 0, z", "give the same motion in every sector"),
    ],
)
def test_mistakes(refused: Callable[..., str], old: str, new: str, line: str):
    """Requirement: one line that says where, before the run."""
    assert line in refused(CASE, old, new)


def test_a_face_on_a_reference_point_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """Requirement: one line; a face that follows a rigid body would not move as in a sector."""
    path = tmp_path / "case.toml"
    head = '[rigid.head]\nreference = [0, 0, 1]\nfaces = ["disc.top"]\n\n[[step]]'
    given = CASE.partition("[[step]]")[0] + head
    path.write_text(given + '\nname = "press"\nincrements = 1\nmotion = { head = { z = -0.01 } }\n')
    assert main(["check", str(path)]) == 2
    line = "cyclic[0]: faces of a rigid body share nodes with the cut faces"
    assert line in capsys.readouterr().err
