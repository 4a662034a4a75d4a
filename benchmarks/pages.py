"""Tables and pictures of the records, for the documentation."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from string import ascii_lowercase

import finite_strain.runs as finite
import processes
from about import ROOT
from blocks import runs, show
from parts import PRINTED, SCRIPTS
from records import KEPT, Record, of

ABSENT = "No record yet.\n"
FIGURES = ROOT / "docs" / "figures"


def about(record: Record) -> str:
    """What a record was made with, in a line."""
    made = record.made
    return (
        f"{made['date']}, commit {made['commit']}, core compiled by {made['compiler']}, "
        f"Python {made['python']}, {made['processor']}, {made['cores']} cores"
    )


def letters(records: Sequence[Record]) -> dict[str, str]:
    """A letter for everything that records were made with, oldest first."""
    texts = sorted({about(record) for record in records})
    return {text: ascii_lowercase[k % 26] * (1 + k // 26) for k, text in enumerate(texts)}


def legend(marks: dict[str, str], records: Sequence[Record]) -> str:
    """What the letters of some records stand for."""
    used = {about(record) for record in records}
    return "\n".join(f"- {mark}: {text}" for text, mark in marks.items() if text in used) + "\n"


def write(records: Sequence[Record], tables: Path = KEPT.parent, figures: Path = FIGURES) -> None:
    """Write everything: tables as `*.md.in`, which the page includes.

    Args:
        records: All that is known.
        tables: Folder of the tables.
        figures: Folder of the pictures.
    """
    marks = letters(records)
    marked = {record.key: marks[about(record)] for record in records}
    blocks = of(runs.PART, records)
    if blocks:
        said = f"{show.versions(blocks)}; {runs.SAID}.\n\n{legend(marks, blocks)}"
        (tables / "blocks.md.in").write_text(f"{show.table(blocks, marked)}\n{said}")
        show.picture(blocks, figures / "benchmarks-blocks.png")
    tables_of = dict.fromkeys((processes.RANKS, processes.MILLION), processes.table)
    for part, table in {finite.PART: finite.table, **tables_of}.items():
        found = of(part, records)
        text = f"{table(found, marked)}\n{legend(marks, found)}" if found else ABSENT
        (tables / f"{part.replace(' ', '-')}.md.in").write_text(text)
    run = {record.case: record for record in of(PRINTED, records)}
    for name, what in SCRIPTS.items():
        text = f"`python benchmarks/{name}.py`: {what}."
        text += (
            f" {about(run[name])}.\n\n{run[name].note or run[name].table}\n" if name in run else ""
        )
        (tables / f"{name.replace('_', '-')}.md.in").write_text(text or ABSENT)
