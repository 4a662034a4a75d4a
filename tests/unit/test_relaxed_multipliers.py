"""Increments in which no multipliers are found: penalties hold there, unless they are asked for."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.cli import main
from anisocontact.contact.multipliers import NotHeldError
from anisocontact.contact.nested_uzawa import NestedUzawa
from anisocontact.contact.semismooth import Semismooth

PRESSED = """
[mesh.box.block]
origin = [0, 0, 0]
size = [1, 1, 1]
cells = [2, 2, 2]

[material.block]
model = "linear-elastic"
E = 1000
nu = 0

[surface.table]
shape = "plane"
point = [0, 0, 0]
normal = [0, 0, 1]

[[contact]]
slave = "block.bottom"
master = "table"
friction = { coefficients = 0 }
METHOD

[[step]]
name = "press"
increments = 1
[step.displacement]
"block.top" = { y = 0, z = -0.02 }

[solver]
strategy = "direct"
cuts = 1
[output]
pictures = false
"""


def run(folder: Path, method: str) -> int:
    (folder / "case.toml").write_text(PRESSED.replace("METHOD", method))
    return main(["run", str(folder / "case.toml"), "-o", str(folder / "out")])


@pytest.fixture
def never_held(monkeypatch: pytest.MonkeyPatch) -> None:
    """Multipliers that are never what the trial answers to them, in cycles either."""

    def improve(*_: object) -> None:
        raise NotHeldError("never")

    monkeypatch.setattr(Semismooth, "consistent", lambda *_: False)
    monkeypatch.setattr(NestedUzawa, "improve", improve)


@pytest.mark.usefixtures("never_held")
def test_penalties_hold_where_no_multipliers_are_found(tmp_path: Path) -> None:
    """Bar and penalty in series.

    The bar of length 1 gives `E (d - overlap)` for the travel `d`; the penalty is ten times as
    stiff as the cells below, or more, so that the overlap is at most a tenth of `d`. To ten times
    the tolerance of Newton's method.
    """
    assert run(tmp_path, "") == 0
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert any("as multipliers did not converge" in line for line in summary["warnings"])
    assert summary["relaxed"] == pytest.approx([0.25, 0.5, 1.0])
    contact = summary["contacts"][0]
    assert 0.0 < contact["worst_penetration"] < 0.1 * 0.02
    assert not any('method = "augmented" takes' in line for line in summary["warnings"])
    force = 1000.0 * (0.02 - contact["worst_penetration"])
    assert contact["force"][2] == pytest.approx(force, rel=1e-7)


@pytest.mark.usefixtures("never_held")
def test_a_run_goes_on_within_a_part_that_penalties_hold(tmp_path: Path, gone_on: Any) -> None:
    """Requirement: bit by bit, with the increments told in which penalties held."""
    (tmp_path / "case.toml").write_text(
        PRESSED.replace("METHOD", "").replace("z = -", "x = 0.01, z = -")
    )
    whole, out = gone_on(tmp_path / "case.toml", 2)
    assert (whole / "history.csv").read_bytes() == (out / "history.csv").read_bytes()
    ours, theirs = (json.loads((f / "summary.json").read_text()) for f in (whole, out))
    assert ours["relaxed"] == theirs["relaxed"] and len(ours["relaxed"]) > 2


OVER_THE_END = """
[mesh.box.block]
origin = [0, 0, 0]
size = [END, 1, 0.5]
cells = [2, 1, 1]
[mesh.box.base]
origin = [0, 0, -1]
size = [1, 1, 1]
cells = [2, 1, 1]
[material.block]
model = "linear-elastic"
E = 1000
nu = 0
[material.base]
model = "linear-elastic"
E = 100
nu = 0
[[contact]]
slave = "base.top"
master = "block.bottom"
friction = { coefficients = 0 }
[[step]]
name = "press"
increments = 1
[step.displacement]
"block.top" = { x = 0, y = 0, z = -0.05 }
"base.bottom" = { x = 0, y = 0, z = 0 }
[solver]
strategy = "direct"
cuts = 1
[output]
pictures = false
"""


@pytest.mark.usefixtures("never_held")
@pytest.mark.parametrize(("end", "told"), [(0.645, True), (0.9, False)])
def test_ends_of_a_master_that_reach_nodes_are_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], end: float, told: bool
) -> None:
    """Of the last facets of the base 29 % are covered, and next to nothing of its end nodes.

    Where 80 % are these have more than half of their weight.
    """
    (tmp_path / "case.toml").write_text(OVER_THE_END.replace("END", str(end)))
    assert main(["run", str(tmp_path / "case.toml"), "-o", str(tmp_path / "out")]) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert "have penalties instead" in said
    line = "2 slave nodes touch with less than 5% of the weight of a node opposite to the end of"
    assert (line in said) == told


@pytest.mark.usefixtures("never_held")
@pytest.mark.parametrize("method", ['method = "augmented"', "tolerance = 1e-5"])
def test_multipliers_that_are_asked_for_are_required(tmp_path: Path, method: str) -> None:
    assert run(tmp_path, method) == 3


def test_multipliers_are_exact(tmp_path: Path) -> None:
    """The bar alone, to ten times the tolerance of Newton's method."""
    assert run(tmp_path, "") == 0
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert not summary["warnings"]
    assert summary["contacts"][0]["force"][2] == pytest.approx(20.0, rel=1e-7)
