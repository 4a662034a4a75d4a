"""Every case file of the examples is valid, and its mesh has what it names."""

from __future__ import annotations

from pathlib import Path

import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.cli import main

FOLDER = Path(__file__).parents[2] / "examples"
#: Cases of the point driver have a test of their own.
CASES = sorted(set(FOLDER.glob("*/*.toml")) - set(FOLDER.glob("point/*.toml")))


@pytest.mark.parametrize("case", CASES, ids=lambda path: f"{path.parent.name}-{path.stem}")
def test_the_case_is_valid(case: Path) -> None:
    assert main(["check", str(case)]) == 0
