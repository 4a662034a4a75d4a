"""The results folder of the point driver."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from anisocontact import __version__
from anisocontact.base.whole_files import replacing
from anisocontact.point import History
from anisocontact.point.balance import PointInterface
from anisocontact.results.files import clear, write_text
from anisocontact.results.no_energy import energies_by_name

_CAPTIONS = {
    "path": (
        "Path on the surface",
        "The path of the points in the colour of their status, the axes of friction, the "
        "tangential traction on the slave, and the adhesion ellipse about its centre.",
    ),
    "forces": (
        "Force plane",
        "Path of the tangential traction along the axes of friction; it cannot leave the ellipse.",
    ),
    "time": ("Over time", "Tractions, slip and energies; the bands show the status."),
    "compare": (
        "Comparison",
        "Left: the tangential traction of every run in the force plane. Right: its components "
        "over the length of the path.",
    ),
}


def write_trace(
    folder: str | Path,
    runs: Sequence[tuple[str, History]],
    interface: PointInterface,
    *,
    title: str = "",
    message: str = "",
    wall_time: float = 0.0,
    pictures: bool = True,
    case: str = "",
) -> dict[str, Any]:
    """Write table, summary, pictures and report of a drive.

    Args:
        folder: Where; what an earlier run left there is removed.
        runs: What was driven, with labels; the first is shown, others compared with it.
        interface: Through what the first went.
        title: Heading.
        message: Why the drive stopped before its end; empty if it did not.
        wall_time: How long it took, seconds.
        pictures: Whether pictures and `report.html` are wanted.
        case: Text of the case file, kept beside the results.

    Returns:
        What `summary.json` says.
    """
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    clear(folder)
    (label, history), *others = runs
    compared = dict(others)
    summary: dict[str, Any] = {
        "status": "stopped" if message else "done",
        "message": message,
        "title": title,
        "version": __version__,
        "wall_time_s": round(wall_time, 3),
        **_content(history),
        "compare": [{"label": name, **_content(run)} for name, run in compared.items()],
    }
    write_text(folder / "summary.json", json.dumps(summary, indent=2, allow_nan=False) + "\n")
    if case:
        write_text(folder / "case.toml", case)
    with replacing(folder / "trace.csv") as draft:
        history.to_csv(draft)
    if compared:
        write_text(folder / "compare.csv", _joined({label: history, **compared}))
    if pictures and len(history):
        _report(folder, history, interface, compared, label, summary)
    return summary


def _content(history: History) -> dict[str, Any]:
    summary = history.summary()
    return summary | (
        {"energy": energies_by_name(summary["energy"])} if "energy" in summary else {}
    )


def _joined(runs: dict[str, History]) -> str:
    """One table of all runs, the label in front."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    for i, (label, run) in enumerate(runs.items()):
        columns = run.to_dict()
        if i == 0:
            writer.writerow(["label", *columns])
        rows = zip(*(column.tolist() for column in columns.values()), strict=True)
        writer.writerows([label, *row] for row in rows)
    return out.getvalue()


def _report(
    folder: Path,
    history: History,
    interface: PointInterface,
    compared: dict[str, History],
    label: str,
    summary: dict[str, Any],
) -> None:
    from anisocontact.point.pictures import save
    from anisocontact.results.report.page import Picture, as_html, document, figure, table

    title = summary["title"]
    files = save(history, interface, folder / "pictures", title, compared, label)
    heading = as_html(title or "anisocontact")
    body = [f"<h1>{heading}</h1>"]
    if summary["message"]:
        text = as_html(summary["message"])
        body.append(f'<p class="stopped">{text}. What converged is shown.</p>')
    body += [
        table([_numbers(summary)]),
        f"<p>All numbers are in the units of the case. Made by anisocontact {__version__}.</p>",
        "<h2>Energies at the end</h2>",
        table([summary["energy"]]),
    ]
    if compared:
        body += ["<h2>Runs</h2>", table(_compared(label, summary))]
    body += [figure(Picture(file, *_CAPTIONS[file.stem])) for file in files]
    write_text(folder / "report.html", document(heading, body))


def _numbers(summary: dict[str, Any]) -> dict[str, Any]:
    x, f = summary["reference"], summary["force"]
    return {
        "steps": summary["steps"],
        "Newton iterations": summary["newton_iterations"],
        "time": summary["time"],
        **{f"position {axis}": value for axis, value in zip("xyz", x, strict=True)},
        **{f"force {axis}": value for axis, value in zip("xyz", f, strict=True)},
        "largest pressure": summary["max_pressure"],
        "largest penetration": summary["max_penetration"],
        **summary["points"],
    }


def _compared(label: str, summary: dict[str, Any]) -> list[dict[str, Any]]:
    first = {"label": label, **summary}
    return [
        {"run": run["label"], **_numbers(run), "friction": run["energy"]["friction"]}
        for run in (first, *summary["compare"])
    ]
