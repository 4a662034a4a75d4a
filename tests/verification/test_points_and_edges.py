"""Displacements of points and edges, named by where they are."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.case import load
from anisocontact.case.build import build
from anisocontact.cli import main

CASE = """
[mesh.box.block]
origin = [0, 0, 0]
size = [SIZE]
cells = [CELLS]
order = 2

[material.block]
model = "linear-elastic"
E = 1000
nu = 0.25
"""
POINTS = """
[nodes."block.corner"]
near = [0, 0, 0]
[nodes."block.along"]
near = [2, 0, 0]
[nodes."block.across"]
near = [0, 3, 0]

[[step]]
name = "press"
increments = 1
[step.pressure]
"block.left" = 6
"block.right" = 6
"block.front" = 6
"block.back" = 6
"block.bottom" = 6
"block.top" = 6
[step.displacement]
"block.corner" = { x = 0, y = 0, z = 0 }
"block.along" = { y = 0, z = 0 }
"block.across" = { z = 0 }
"""
EDGES = """
[nodes."block.first"]
start = [0, 0, 0]
end = [0, 1, 0]
[nodes."block.second"]
start = [20, 0, 0]
end = [20, 1, 0]

[[step]]
name = "press"
increments = 1
pressure = { "block.top" = 0.01 }
displacement = { "block.first" = { x = 0, y = 0, z = 0 }, "block.second" = { z = 0 } }
"""


def case_of(tmp_path, text, size, cells):
    """A case file with a block."""
    path = tmp_path / "case.toml"
    path.write_text(CASE.replace("SIZE", size).replace("CELLS", cells) + text)
    return path


def test_a_block_under_pressure_on_three_points(tmp_path):
    """Six components at three corners hold a block that is pressed from all sides.

    Requirement: `u = -p / (3 K) x` everywhere, and no force at the points. Source: Hooke; 3-2-1
    supports hold nothing but the six rigid motions. Tolerance: 1e-10, factorisation.
    """
    built = build(load(case_of(tmp_path, POINTS, "2, 3, 1", "2, 2, 1")))
    last = list(built.solver.run())[-1]
    x = built.problem.model.space.tabulate_dof_coordinates()
    bulk = 1000.0 / (3.0 * (1.0 - 0.5))
    found = built.problem.u.x.array.reshape(-1, 3)
    assert np.abs(found + 6.0 / (3.0 * bulk) * x).max() < 1e-10
    assert (
        max(np.abs(last.reactions[f"block.{n}"]).max() for n in ("corner", "along", "across"))
        < 1e-9
    )


def test_a_beam_on_two_edges(tmp_path):
    """A beam that lies on two lower edges, under a uniform load.

    Requirement: deflection of the middle `5 w L^4 / (384 E I) (1 + 1.92 E h^2 ... )` with shear,
    `w L^2 / (8 k G A)`, k = 5/6, and half of the load on either edge. Source: Timoshenko's beam.
    Tolerance: 1 %, edges in the place of the middle plane and Poisson's ratio across.
    """
    built = build(load(case_of(tmp_path, EDGES, "20, 1, 1", "20, 1, 2")))
    last = list(built.solver.run())[-1]
    model = built.problem.model
    x = model.space.tabulate_dof_coordinates()
    middle = np.flatnonzero(np.abs(x - [10.0, 0.5, 0.5]).max(axis=1) < 1e-9)
    sag = -built.problem.u.x.array.reshape(-1, 3)[middle, 2]
    bent = 5.0 * 0.01 * 20.0**4 / (384.0 * 1000.0 / 12.0)
    sheared = 0.01 * 20.0**2 / (8.0 * 5.0 / 6.0 * 400.0)
    assert sag == pytest.approx(bent + sheared, rel=0.01)
    for edge in ("first", "second"):
        assert last.reactions[f"block.{edge}"][2] == pytest.approx(0.1, rel=1e-9)


def test_check_says_where_they_are(tmp_path, capsys):
    """Requirement: what was found for a name is told before anything is solved."""
    assert main(["check", str(case_of(tmp_path, POINTS, "2, 3, 1", "2, 2, 1"))]) == 0
    assert "nodes     block.along: 1 at (2, 0, 0)" in capsys.readouterr().out
    assert main(["check", str(case_of(tmp_path, EDGES, "20, 1, 1", "20, 1, 2"))]) == 0
    assert "nodes     block.first: 3 on a line" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("near = [2, 0, 0]", "near = [1.75, 0, 0]", "2 nodes of 'block' are 0.25 from it; give"),
        ("near = [2, 0, 0]", "", 'nodes."block.along": near, or start and end needed'),
        ("near = [2, 0, 0]", "start = [2, 0, 0]", 'nodes."block.along": near, or start and end'),
        (
            "near = [2, 0, 0]",
            "start = [3, 0, 0]\nend = [3, 1, 0]",
            "no node of 'block' is on the line, the nearest is 1 off",
        ),
        ("near = [2, 0, 0]", "start = [3, 0, 0]\nend = [3, 0, 0]", "start and end are one point"),
        ('[nodes."block.along"]', '[nodes."block.top"]', "there is a group of that name already"),
        (
            '[nodes."block.along"]',
            '[nodes."blok.along"]',
            'nodes: "blok.along" given, no such body',
        ),
        ('"block.across" = { z', '"block.acros" = { z', "step[0].displacement: no facet group"),
        (
            '"block.left" = 6',
            '"block.corner" = 6',
            "step[0].pressure: no facet group 'block.corner'",
        ),
    ],
)
def test_wrong_points_are_one_line(tmp_path, capsys, old, new, line):
    """Requirement: place, what was given, and what is allowed."""
    assert old in POINTS
    path = case_of(tmp_path, POINTS.replace(old, new, 1), "2, 3, 1", "2, 2, 1")
    assert main(["check", str(path)]) == 2
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 1, lines
    assert line in lines[0]
