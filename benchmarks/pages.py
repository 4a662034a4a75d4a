"""Tables and pictures of the records, for the documentation."""

from __future__ import annotations

from collections.abc import Sequence
from string import ascii_lowercase

from about import ROOT
from blocks import runs, show
from records import KEPT, Record, of

FIGURES = ROOT / "docs" / "figures"


def letters(records: Sequence[Record]) -> dict[str, str]:
    """A letter for everything that records were made with, oldest first."""
    texts = sorted({show.about(record) for record in records})
    return {text: ascii_lowercase[k % 26] * (1 + k // 26) for k, text in enumerate(texts)}


def legend(marks: dict[str, str]) -> str:
    """What the letters stand for."""
    return "\n".join(f"- {mark}: {text}" for text, mark in marks.items()) + "\n"


def write(records: Sequence[Record]) -> None:
    """Write everything beside the records and into the figures."""
    blocks = of(runs.PART, records)
    if blocks:
        marks = letters(blocks)
        said = f"{show.versions(blocks)}; {runs.THREADS} threads.\n\n{legend(marks)}"
        table = f"{show.table(blocks, marks)}\n{said}"
        (KEPT.parent / "blocks.md.in").write_text(table)
        show.picture(blocks, FIGURES / "benchmarks-blocks.png")
