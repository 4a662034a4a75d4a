"""Ties in the case file: what is wrong in one line, and words of other codes."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.cli import main
from anisocontact.results import Results

CASE = """
[mesh.box]
lower = { origin = [0, 0, 0], size = [1, 1, 1], cells = [2, 2, 1] }
upper = { origin = [0, 0, 1], size = [1, 1, 1], cells = [3, 3, 1] }

[material]
lower = { model = "linear-elastic", E = 1000, nu = 0.3 }
upper = { model = "linear-elastic", E = 1000, nu = 0.3 }

[surface.floor]
shape = "plane"
point = [0, 0, 0]
normal = [0, 0, 1]

[[tie]]
slave = "upper.bottom"
master = "lower.top"

[[step]]
name = "lift"
increments = 2
displacement = { "lower.bottom" = { x = 0, y = 0, z = 0 } }
force = { "upper.top" = { z = 3.0 } }

[output]
pictures = false
resultant = { glue = { body = "upper", point = [0, 0, 1.1], normal = [0, 0, 1] } }
"""


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ('master = "lower.top"', 'master = "lower.bottom"', "tie[0].tolerance: no facet of"),
        ('master = "lower.top"', 'master = "upper.bottom"', "the slave itself"),
        ('master = "lower.top"', 'master = "floor"', 'faces = ["upper.bottom"]'),
        ('master = "lower.top"', 'master = "lover.top"', 'did you mean "lower"?'),
        ('master = "lower.top"', 'master = "lower.tip"', "tie[0].master: "),
        ('master = "lower.top"', 'target = "lower.top"', 'did you mean "master"?'),
        ('slave = "upper', 'tolerance = -1.0\nslave = "upper', "tie[0].tolerance: -1.0 given"),
        (
            "[[tie]]",
            '[[tie]]\nslave = "lower.top"\nmaster = "upper.bottom"\n[[tie]]',
            "error: tie: given in a circle",
        ),
        ("[[tie]]", "[[bonded]]", 'did you mean "tie"?'),
        ("[[tie]]", "[tie]", "[[tie]]"),
        (
            "[[step]]",
            '[[contact]]\nslave = "lower.top"\nmaster = "upper.bottom"\n'
            "friction = { coefficients = 0 }\n[[step]]",
            "tie[0]: same pair as contact[0]: what is glued cannot slide",
        ),
        ('"lower.bottom" = { x', '"upper.bottom" = { x', "tie[0]: its slave nodes are held"),
        (
            '"lower.bottom" = {',
            '"lower.top" = { z = 0.01 }, "upper.bottom" = { z = -0.01 }, "lower.bottom" = {',
            "step 'lift'.displacement: parts 'upper.bottom' from 'lower.top', to which tie[0] "
            "glues it, by 0.02 along z; prescribe one side, or the same of both",
        ),
    ],
)
def test_mistakes(refused: Callable[..., str], old: str, new: str, line: str):
    """Requirement: one line that says where, and what to do."""
    assert line in refused(CASE, old, new)


@pytest.mark.parametrize("both", ["z = -0.01", "x = 0.1, y = 0.1, z = 0.1"])
def test_both_sides_may_be_prescribed_alike(tmp_path: Path, both: str):
    """Requirement: supports of both sides that keep them together are none that part them."""
    given = f'"lower.top" = {{ {both} }}, "upper.bottom" = {{ {both} }}, "lower.bottom" = {{'
    path = tmp_path / "case.toml"
    path.write_text(CASE.replace('"lower.bottom" = {', given))
    assert main(["check", str(path)]) == 0


def test_run(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """Requirement: `check` says the tie; its resultant carries the load, and a run goes on."""
    path, out = tmp_path / "case.toml", tmp_path / "out"
    path.write_text(CASE)
    assert main(["check", str(path)]) == 0
    assert "tie       upper.bottom to lower.top: 9 slave facets" in capsys.readouterr().out
    assert main(["run", str(path), "-o", str(out)]) == 0
    force = Results(out).summary["resultants"]["glue"]["force"]
    assert abs(force[2]) == pytest.approx(3.0, rel=1e-9)


def test_gaps_are_closed_where_a_tie_asks_for_it(tmp_path: Path, capsys):
    """Requirement: `check` says how many nodes were moved, and how far; the rod has no gap then.

    Source: a rod of length 2 under the force 3 without lateral contraction, u = F L / (E A).
    """
    path, out = tmp_path / "case.toml", tmp_path / "out"
    text = CASE.replace("nu = 0.3", "nu = 0").replace("[0, 0, 1], size", "[0, 0, 1.02], size")
    path.write_text(text.replace("[[tie]]", "[[tie]]\nadjust = true"))
    assert main(["check", str(path)]) == 0
    said = "tie       16 nodes of upper.bottom moved onto lower.top, 0.02 at most"
    assert said in capsys.readouterr().out
    assert main(["run", str(path), "-o", str(out)]) == 0
    lifted = Results(out).summary["displacements"]["upper.top"]
    assert lifted[2] == pytest.approx(3.0 * 2.02 / 1000.0, rel=1e-9)
