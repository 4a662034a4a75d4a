"""Every case file of the examples is valid, and its mesh has what it names."""

from __future__ import annotations

from pathlib import Path

import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.case import load
from anisocontact.cli import main

FOLDER = Path(__file__).parents[2] / "examples"
#: Cases of the point driver have a test of their own.
CASES = sorted(set(FOLDER.glob("*/*.toml")) - set(FOLDER.glob("point/*.toml")))


@pytest.mark.parametrize("case", CASES, ids=lambda path: f"{path.parent.name}-{path.stem}")
def test_the_case_is_valid(case: Path) -> None:
    assert main(["check", str(case)]) == 0


def test_the_main_example_is_a_part(capsys: pytest.CaptureFixture[str]) -> None:
    """A part, not a cube: at least 5,000 nodes, and a body with the named faces of the case."""
    case = FOLDER / "milled_block" / "case.toml"
    assert main(["check", str(case)]) == 0
    lines = dict(line.split(None, 1) for line in capsys.readouterr().out.splitlines())
    assert int(lines["mesh"].split()[0]) >= 5000
    assert "block.bottom on plate" in lines["contact"]
    assert load(case).name == "milled_block"
