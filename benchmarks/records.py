"""Results of benchmarks, one line each in a file that is kept.

A part of a benchmark can be run again alone: the tables take the last record of each run and say
with what it was made.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import asdict, dataclass, field
from pathlib import Path

from about import ROOT

KEPT = ROOT / "docs" / "verification" / "benchmarks" / "records.json"


@dataclass(frozen=True)
class Record:
    """One run of one code on one case.

    Attributes:
        part: Which benchmark.
        case: Which of its cases.
        n: Size of the mesh.
        code: Who ran it.
        values: What was measured, by name with unit.
        made: Commit, versions and machine, see `about.made`.
        note: Why there are no values, if there are none.
        table: Lines of Markdown, where a benchmark makes a table of its own.
    """

    part: str
    case: str
    n: int
    code: str
    values: dict[str, float]
    made: dict[str, str] = field(default_factory=dict)
    note: str = ""
    table: str = ""

    @property
    def key(self) -> tuple[str, str, int, str]:
        """What a later record of the same run has in common with this one."""
        return self.part, self.case, self.n, self.code


def load(path: Path = KEPT) -> list[Record]:
    """The records of a file, none if there is no file."""
    return [Record(**one) for one in json.loads(path.read_text())] if path.exists() else []


def store(new: Iterable[Record], path: Path = KEPT) -> None:
    """Put records into a file; those of the same run are replaced, the others stay."""
    last = {record.key: record for record in [*load(path), *new]}
    lines = (json.dumps(asdict(record)) for record in sorted(last.values(), key=lambda r: r.key))
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("[\n" + ",\n".join(lines) + "\n]\n")


def of(part: str, records: Iterable[Record]) -> list[Record]:
    """Those of a part."""
    return [record for record in records if record.part == part]
