"""The scoreboard: `python benchmarks/scoreboard/run.py [NAME ...] [--ways WORD ...] [--docs]`.

Runs the hard cases of this folder with every method and strategy that applies, each as a process of
its own with the command that a user has, and keeps what came of it. `NAME` is the beginning of the
names of some cases, `--ways` picks methods or strategies, `--docs` writes the page's tables from
all that is kept. The exit code is 1 where a run ended otherwise than the case asks.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from about import ROOT, made

from scoreboard.case import METHODS, STRATEGIES, WAYS, HardCase, Way, all_cases
from scoreboard.outcome import Outcome, load, run, store
from scoreboard.page import fault, write

KEPT = ROOT / "docs" / "verification" / "scoreboard" / "outcomes.json"
#: Wall time that a run may take, s.
LIMIT = 300.0


def parsed(arguments: list[str]) -> argparse.Namespace:
    """What the command line asks for."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help="how names of cases begin")
    words = [*METHODS, *STRATEGIES]
    parser.add_argument("--ways", nargs="+", default=words, choices=words, metavar="WORD")
    parser.add_argument("--limit", type=float, default=LIMIT, help="s for each run")
    parser.add_argument("--jobs", type=int, default=2, help="runs side by side")
    parser.add_argument("--records", type=Path, default=KEPT, help="where outcomes are kept")
    parser.add_argument("--docs", action="store_true", help="write the tables of the page")
    return parser.parse_args(arguments)


def chosen(words: list[str]) -> list[Way]:
    """The ways that some words allow: of methods and of strategies, all where none is named."""
    methods = [word for word in METHODS if word in words] or [*METHODS]
    strategies = [word for word in STRATEGIES if word in words] or STRATEGIES
    return [way for way in WAYS if way.method in methods and way.strategy in strategies]


def everything(
    cases: list[HardCase], ways: list[Way], limit: float, jobs: int
) -> Iterator[Outcome]:
    """Run the cases; outcomes as they come."""

    def one(case: HardCase, way: Way) -> Outcome:
        with tempfile.TemporaryDirectory() as folder:
            return run(case, way, Path(folder), limit)

    with ThreadPoolExecutor(jobs) as pool:
        runs = [pool.submit(one, case, way) for case in cases for way in ways]
        for done in as_completed(runs):
            yield done.result()


def main(arguments: list[str]) -> int:
    """Run, keep and show."""
    asked = parsed(arguments)
    cases = {case.name: case for case in all_cases(asked.names)}
    found, faults = load(asked.records), 0
    for outcome in everything([*cases.values()], chosen(asked.ways), asked.limit, asked.jobs):
        found[outcome.key] = outcome
        wrong = fault(outcome, cases[outcome.case])
        faults += bool(wrong)
        print(
            f"{outcome.case:28} {outcome.method:16} {outcome.strategy:9} {outcome.status:8}"
            f"{outcome.iterations:5} iterations {outcome.cuts:3} cuts  "
            f"balance {outcome.balance:.0e}  energy {outcome.energy:+.1e}  "
            f"{outcome.seconds:.0f} s  {wrong or outcome.said}",
            flush=True,
        )
        store(found, made(), asked.records)
    if asked.docs:
        write(found, all_cases(), asked.records.parent)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
