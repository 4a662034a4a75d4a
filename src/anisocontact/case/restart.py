"""Going on with a run: its checkpoint, and whether the case file is still the same."""

from __future__ import annotations

import csv
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from anisocontact.base.difference import first_difference
from anisocontact.base.errors import InputError
from anisocontact.case.named_files import check_files
from anisocontact.results.files import MARKS

if TYPE_CHECKING:
    from anisocontact.case.read import CaseFile
    from anisocontact.results.checkpoint import Stored

#: Tables of a case file that may change: they say nothing of the state.
FREE_TO_CHANGE = ("title", "output", "solver")


def checkpoint_of(folder: Path, file: CaseFile) -> Stored | None:
    """The checkpoint of a results folder, if the case file fits it.

    Args:
        folder: Results folder of the run that is to go on.
        file: The case as it is now.

    Returns:
        The checkpoint; None if the run was killed before its first accepted increment.

    Raises:
        InputError: There is no run to go on with, or the case file does not fit it.
    """
    from anisocontact.results.checkpoint import load_checkpoint

    stored = load_checkpoint(folder)
    if stored is not None:
        before = tomllib.loads(stored.facts["case"])
        now = tomllib.loads(file.text)
        check_same(before, now, stored.facts["begun"])
        check_files(stored.facts["files"], file)
        return stored
    if not any((folder / mark).is_file() for mark in MARKS):
        raise InputError(f"--restart: '{folder}' holds no run to go on with")
    if _rows(folder / "history.csv") > 1:
        raise InputError(
            f"--restart: '{folder}' has results but no checkpoint: they would be lost; "
            "run without --restart into another folder"
        )
    return None


def check_same(before: Mapping[str, Any], now: Mapping[str, Any], begun: int) -> None:
    """Refuse a case file that has become another one.

    Title, output, solver and steps that have not begun may change.

    Args:
        before: Tables of the run that is to go on.
        now: Tables as they are now.
        begun: Number of steps that had begun.

    Raises:
        InputError: Names the first entry that is not the same.
    """
    if found := first_difference(_of_state(before, begun), _of_state(now, begun)):
        raise InputError(
            f"{found.new} given, the run that is to go on had {found.old}: run without --restart",
            field=found.place,
        )


def _of_state(tables: Mapping[str, Any], begun: int) -> dict[str, Any]:
    """What must stay the same."""
    kept = {key: value for key, value in tables.items() if key not in FREE_TO_CHANGE}
    return kept | {"step": tables["step"][:begun]}


def _rows(table: Path) -> int:
    if not table.is_file():
        return 0
    with table.open(encoding="utf-8", errors="replace", newline="") as file:
        return sum(1 for _ in csv.reader(file))
