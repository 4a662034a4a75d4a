"""Table and picture of block on plane and block on block."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from records import Record

from blocks.problem import KINDS
from blocks.runs import OURS

#: Values of a record that the table shows, with their format.
COLUMNS = {
    "wall s": ".1f",
    "processor s": ".1f",
    "peak MB": ".0f",
    "iterations": ".0f",
    "normal force pressed": ".3f",
    "tangential force partly": ".4f",
    "tangential force at the end": ".4f",
}
HEADS = (
    "wall s",
    "over ours",
    "processor s",
    "over ours",
    "peak MB",
    "iterations",
    "normal force, pressed",
    "tangential, drag 0.006",
    "tangential, end",
    "made",
)


def table(records: Sequence[Record], marks: Mapping[tuple[str, str, int, str], str]) -> str:
    """One table for each problem.

    Args:
        records: Runs of blocks.
        marks: By key of a record, the letter of what it was made with.
    """
    parts = []
    for kind in KINDS:
        lines = [
            f"**Block on {kind}**",
            "",
            f"| n | unknowns | code | {' | '.join(HEADS)} |",
            "|" + "---|" * (3 + len(HEADS)),
        ]
        for r in sorted((r for r in records if r.case == kind), key=lambda r: (r.n, _order(r))):
            mark = marks[r.key]
            code = f"{r.code}, {r.made['solver']}" if "solver" in r.made else r.code
            if r.note:
                lines.append(f"| {r.n} | | {code} | {r.note} |" + " |" * 8 + f" {mark} |")
                continue
            own = next((o for o in records if o.key == (r.part, kind, r.n, OURS)), None)
            cells = [format(r.values[name], form) for name, form in COLUMNS.items()]
            cells.insert(1, _ratio(r, own, "wall s"))
            cells.insert(3, _ratio(r, own, "processor s"))
            found = " | ".join(cells)
            lines.append(f"| {r.n} | {r.values['unknowns']:.0f} | {code} | {found} | {mark} |")
        parts.append("\n".join(lines))
    return "\n\n".join(parts) + "\n"


def versions(records: Sequence[Record]) -> str:
    """The codes and their versions."""
    found = {r.code: f"{r.code} {r.made['version'].removeprefix(r.code)}" for r in records}
    return ", ".join(" ".join(text.split()) for text in found.values())


def picture(records: Sequence[Record], path: Path) -> None:
    """Wall time and peak memory against the unknowns."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot, ticker

    figure, axes = pyplot.subplots(2, 2, figsize=(9.0, 7.0), layout="constrained", sharex="col")
    codes = sorted({r.code for r in records}, key=lambda code: (code != OURS, code))
    for column, kind in enumerate(KINDS):
        for row, (name, label) in enumerate((("wall s", "wall time, s"), ("peak MB", "peak, MB"))):
            ax = axes[row, column]
            for number, code in enumerate(codes):
                runs = [r for r in records if r.case == kind and r.code == code and not r.note]
                runs.sort(key=lambda r: r.n)
                x, y = [r.values["unknowns"] for r in runs], [r.values[name] for r in runs]
                if runs:
                    ax.loglog(x, y, "o-", color=f"C{number}", label=code, lw=2 - (number > 0))
            ax.grid(True, which="both", alpha=0.3)
            ax.set_ylabel(label)
        axes[0, column].set_title(f"block on {kind}")
        if axes[0, column].lines:
            axes[1, column].legend(loc="lower right")  # where no curve goes
        axes[1, column].set_xlabel("unknowns")
        axes[1, column].xaxis.set_minor_formatter(ticker.NullFormatter())
    figure.savefig(path, dpi=110)
    pyplot.close(figure)


def _order(record: Record) -> tuple[bool, str]:
    return record.code != OURS, record.code


def _ratio(record: Record, own: Record | None, name: str) -> str:
    return f"{record.values[name] / own.values[name]:.1f}" if own and own.values else ""
