"""The page of the scoreboard: what every case came to, and the totals."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from itertools import product
from pathlib import Path

from scoreboard.case import METHODS, STRATEGIES, HardCase, Way
from scoreboard.outcome import Outcome

Found = Mapping[tuple[str, str, str], Outcome]

#: Share of the work beyond which the residual of the energies has to be told.
TOLD = 0.05
#: Word by which its warning is known.
ENERGY = "energ"


def fault(outcome: Outcome, case: HardCase) -> str:
    """What is wrong with an outcome; empty if it is as it should be.

    Args:
        outcome: What came of a run.
        case: The case.
    """
    if outcome.status in ("time", "error"):
        return f"{outcome.status}: {outcome.said}"
    if outcome.status == "stopped" and not (case.stops and case.stops in outcome.said):
        return f"stopped: {outcome.said}"
    if outcome.status == "done" and case.stops:
        return "done, where it should have stopped"
    told = any(ENERGY in warning for warning in outcome.warnings)
    if outcome.status == "done" and abs(outcome.energy) > TOLD and not told:
        return f"{100 * outcome.energy:.0f} % of the energy missing without a word"
    return ""


def cell(outcome: Outcome | None) -> str:
    """An outcome in a few signs."""
    if outcome is None:
        return ""
    if outcome.status == "refused":
        return "-"
    if outcome.status != "done":
        return f"**{outcome.status}**"
    cuts = f", {outcome.cuts} cut{'s' * (outcome.cuts > 1)}" if outcome.cuts else ""
    return f"{outcome.iterations}{cuts}"


def table(found: Found, cases: Iterable[HardCase]) -> str:
    """A row for each case: iterations and cuts of every way, the worst balance and energy."""
    there = {(one.method, one.strategy) for one in found.values()}
    ways = [Way(*both) for both in product(METHODS, STRATEGIES) if both in there]
    head = ["case", *map(str, ways), "balance", "energy"]
    rows = [head, ["---"] * len(head)]
    for case in cases:
        of_case = [found.get((case.name, way.method, way.strategy)) for way in ways]
        done = [one for one in of_case if one is not None and one.status == "done"]
        balance = max((one.balance for one in done), default=0.0)
        energy = max((abs(one.energy) for one in done), default=0.0)
        numbers = [f"{balance:.0e}", f"{100 * energy:.2g} %"] if done else ["", ""]
        rows.append([f"`{case.name}`", *map(cell, of_case), *numbers])
    return "\n".join(f"| {' | '.join(row)} |" for row in rows) + "\n"


def totals(found: Found, cases: Iterable[HardCase]) -> str:
    """How many cases end with each way, and iterations of augmented contact over the penalty's."""
    by_name = {case.name: case for case in cases}
    lines = [
        "| strategy | method | ended as they should | iterations | cuts |",
        "|---|---|---|---|---|",
    ]
    for strategy in STRATEGIES:
        both = {
            m: [o for o in found.values() if (o.method, o.strategy) == (m, strategy)]
            for m in METHODS
        }
        for method, outcomes in both.items():
            if not outcomes:
                continue
            applies = [o for o in outcomes if o.status != "refused" and o.case in by_name]
            right = [o for o in applies if not fault(o, by_name[o.case])]
            lines.append(
                f"| {strategy} | {method} | {len(right)} of {len(applies)} | "
                f"{sum(o.iterations for o in right)} | {sum(o.cuts for o in right)} |"
            )
    return "\n".join(lines) + "\n"


def about(cases: Iterable[HardCase]) -> str:
    """What is hard about each case."""
    return "\n".join(f"- `{case.name}`: {case.what}" for case in cases) + "\n"


def faults(found: Found, cases: Iterable[HardCase]) -> str:
    """Runs that did not end as their case asks, a line each."""
    by_name = {case.name: case for case in cases}
    known = [o for o in found.values() if o.case in by_name]
    wrong = [(o, fault(o, by_name[o.case])) for o in sorted(known, key=lambda o: o.key)]
    lines = [f"- `{o.case}`, {o.method}, {o.strategy}: {why}" for o, why in wrong if why]
    return "\n".join(lines or ["None."]) + "\n"


def write(found: Found, cases: list[HardCase], folder: Path) -> None:
    """Write the parts that the page includes."""
    parts = {"table": table, "totals": totals, "faults": faults}
    for name, part in parts.items():
        (folder / f"{name}.md.in").write_text(part(found, cases))
    (folder / "cases.md.in").write_text(about(cases))
