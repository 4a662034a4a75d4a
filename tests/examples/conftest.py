"""Examples through the command."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import pytest


@pytest.fixture(scope="session")
def solved() -> Callable[[Path, Path], Any]:
    """Runs a case file into a folder, without pictures, which take as long as a small case."""
    from anisocontact.cli import main
    from anisocontact.results import Results

    def solve(case: Path, folder: Path) -> Results:
        with pytest.MonkeyPatch.context() as patch:
            none = nullcontext(lambda folder: [])
            patch.setattr("anisocontact.results.report_process.report_beside", lambda wanted: none)
            assert main(["run", str(case), "-o", str(folder)]) == 0
        return Results(folder)

    return solve
