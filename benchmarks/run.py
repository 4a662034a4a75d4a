"""All benchmarks with one command: `python benchmarks/run.py [n ...] [--only NAME ...] [--docs]`.

Runs block on plane and block on block in every code that is installed, then the parts that are
about this code, and prints the tables. The records of all runs are kept in
docs/verification/benchmarks/records.json; a run replaces the record of the same run, so that one
code or one part can be run again alone. `--docs` writes tables and pictures from the records into
the documentation. Other codes are looked for in the Pythons of `BENCH_PYTHON` (paths with colons
between), in this one and in that of the system; `ccx` on the PATH.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path

import records
from blocks import runs
from blocks.problem import KINDS
from pages import write
from parts import PARTS
from records import Record

SIZES = (12, 24, 36)


def parsed(arguments: list[str]) -> argparse.Namespace:
    """What the command line asks for."""
    doc = __doc__ or ""
    parser = argparse.ArgumentParser(description=doc.partition("\n")[0])
    parser.add_argument(
        "n", nargs="*", type=int, help=f"cells of an edge: {SIZES}, or a part's own"
    )
    names = [*runs.CODES, *PARTS]
    parser.add_argument("--only", nargs="+", default=names, choices=names, metavar="NAME")
    parser.add_argument("--problems", nargs="+", default=KINDS, choices=KINDS)
    parser.add_argument("--limit", type=float, default=runs.LIMIT, help="s for each process")
    parser.add_argument("--records", type=Path, default=records.KEPT, help="where they are kept")
    parser.add_argument("--docs", action="store_true", help="write tables and pictures")
    return parser.parse_args(arguments)


def everything(asked: argparse.Namespace) -> Iterator[Record]:
    """Run what is asked for."""
    codes = [name for name in asked.only if name in runs.CODES]
    yield from runs.everything(asked.n or SIZES, asked.problems, codes, asked.limit)
    for name in asked.only:
        if name in PARTS:
            yield from PARTS[name](asked.limit, asked.n)


def main(arguments: list[str]) -> None:
    """Run, keep and show."""
    asked = parsed(arguments)
    for record in everything(asked):
        records.store([record], asked.records)
        print(record.code, record.part, record.case, record.n, record.note or record.values)
        sys.stdout.flush()
    if asked.docs:
        write(records.load(asked.records))


if __name__ == "__main__":
    main(sys.argv[1:])
