"""What a run says on its way also stands in its summary, in its report and at its end."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.cli import main

CASE = """
units = { length = "mm", force = "N" }

[mesh.box.block]
origin = [0, 0, 0]
size = [1, 1, 1]
cells = [2, 2, 2]

[material.block]
model = "linear-elastic"
E = 1e-9
nu = 0.499

[surface.table]
shape = "plane"
point = [0, 0, 0]
normal = [0, 0, 1]

[[contact]]
slave = "block.bottom"
master = "table"
friction = { coefficients = 0.3 }

[[step]]
name = "press"
increments = 2
displacement = { "block.top" = { x = 0, y = 0, z = -0.01 }, "block.bottom" = { z = 0 } }

[solver]
strategy = "iterative"
options = { coarse_ksp_gmres_restart = 7 }

[output]
pictures = false
"""


def _ended(folder: Path) -> list[str]:
    return json.loads((folder / "summary.json").read_text())["warnings"]


def test_what_is_said_on_the_way_is_said_at_the_end(tmp_path, capsys) -> None:
    """Requirement: all that a run warns of is in `warnings` of its summary, of any source.

    Source: results-folder.md, `warnings`: what the user should look at. A modulus that no body
    has in these units, cells that lock, points that supports hold on both sides and an option
    that nothing reads were told on the terminal alone, while the run went on. Each is said once,
    also by a run that goes on. Texts are compared, so there is no tolerance.
    """
    case, out = tmp_path / "case.toml", tmp_path / "out"
    case.write_text(CASE)
    assert main(["run", str(case), "-o", str(out)]) == 0
    at_end, log = capsys.readouterr().err, (out / "run.log").read_text()
    told = _ended(out)
    for said in ("E of block is", "order 1 lock", "supports hold both sides", "gmres_restart"):
        (found,) = [line for line in told if said in line]
        assert f"warning: {found}\n" in at_end
        assert f"warning: {found}\n" in log
    more = '\n[[step]]\nname = "more"\nincrements = 1\ndisplacement."block.top".z = -0.02\n'
    case.write_text(CASE.replace("\n[solver]", f"{more}\n[solver]"))
    assert main(["run", str(case), "-o", str(out), "--restart"]) == 0
    assert sorted(_ended(out)) == sorted(told)


@pytest.mark.parametrize("strategy", ["direct", "condensed"])
@pytest.mark.parametrize(("pressed", "told"), [(0.09, False), (0.12, True)])
def test_small_strain_that_is_not_small(tmp_path, capsys, pressed, told, strategy) -> None:
    """Requirement: a body at small strain that is strained by more than a tenth is a warning.

    Source: a model that leaves its range says so. A block squeezed to a hundredth of its height
    had a force, and not a word. Its mean strain is the way of its head over its height, to 1e-6,
    the tolerance of the multipliers below it.
    """
    text = CASE.replace("E = 1e-9", "E = 1000").replace("nu = 0.499", "nu = 0.3")
    text = text.replace(', "block.bottom" = { z = 0 }', "").replace("-0.01", f"-{pressed}")
    text = text.replace('"iterative"', f'"{strategy}"').replace(
        "coarse_ksp_gmres_restart", "snes_max_it"
    )
    case, out = tmp_path / "case.toml", tmp_path / "out"
    case.write_text(text.replace("snes_max_it = 7", "snes_max_it = 25"))
    assert main(["run", str(case), "-o", str(out)]) == 0
    about = "body 'block', at small strain, is strained by 0.12 as a whole"
    for said in capsys.readouterr():
        assert sum(about in line for line in said.splitlines()) == told
    assert sum(about in line for line in _ended(out)) == told
    strained = json.loads((out / "summary.json").read_text())["strained"]
    assert set(strained) == {"block"} if told else not strained
    if told:
        assert strained["block"]["strain"] == pytest.approx(pressed, rel=1e-6)
