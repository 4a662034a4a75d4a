"""`report.html`: one file with everything in it."""

from __future__ import annotations

import base64
import html
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from anisocontact.base.errors import printable
from anisocontact.results.report.labels import in_units

_STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; color: #111827; max-width: 72rem; margin: 2rem auto;
  padding: 0 1rem; }
h1 { font-size: 1.6rem; } h2 { font-size: 1.2rem; margin-top: 2.5rem; }
table { border-collapse: collapse; margin: 0.5rem 0; font-size: 0.9rem; }
th, td { padding: 0.25rem 0.7rem; border-bottom: 1px solid #e5e7eb; text-align: right; }
th:first-child, td:first-child { text-align: left; }
figure { margin: 1rem 0; } figure img { max-width: 100%; height: auto; }
figcaption { color: #4b5563; font-size: 0.9rem; }
.wide { overflow-x: auto; }
.stopped, .warning { background: #fef3c7; padding: 0.5rem 1rem; border-left: 4px solid #d97706; }
"""


@dataclass(frozen=True)
class Picture:
    """A picture of the report.

    Args:
        path: The PNG.
        title: Heading.
        caption: What is to be seen.
    """

    path: Path
    title: str
    caption: str


def page(
    summary: dict[str, Any], steps: Sequence[dict[str, Any]], pictures: Sequence[Picture]
) -> str:
    """The report as one HTML text without anything outside of it.

    Args:
        summary: Content of `summary.json`.
        steps: A row of numbers for each step.
        pictures: The pictures, in order.

    Returns:
        The page.
    """
    title = as_html(summary["title"] or "anisocontact")
    body = [f"<h1>{title}</h1>", *_state(summary), *_overview(summary)]
    if steps:
        body += ["<h2>Steps</h2>", table(steps)]
    body += ["<h2>Contacts at the end</h2>", table(_contacts(summary))]
    body += ["<h2>Laws</h2>", table(_laws(summary))]
    body += ["<h2>Supports at the end</h2>", table(_reactions(summary))]
    if summary.get("resultants"):
        body += ["<h2>Resultants at the end</h2>", table(_resultants(summary))]
    if summary.get("stress"):
        body += ["<h2>Stresses at the end</h2>", table(_stresses(summary))]
    if summary.get("rigid"):
        body += ["<h2>Rigid bodies at the end</h2>", table(_rigid(summary))]
    body += ["<h2>Energies at the end [force length]</h2>", table([summary["energy"]])]
    units = summary.get("units", {})
    body = [in_units(part, units) for part in body]
    return document(title, [*body, *(figure(picture) for picture in pictures)])


def as_html(text: str) -> str:
    """A text as HTML shows it; what does not print in it is written as an escape."""
    return html.escape(printable(text))


def document(title: str, body: Sequence[str]) -> str:
    """A page with our style.

    Args:
        title: Title, as HTML.
        body: Its parts, as HTML.
    """
    return (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
        f"<title>{title}</title><style>{_STYLE}</style></head>\n<body>\n"
        + "\n".join(body)
        + "\n</body></html>\n"
    )


def _state(summary: dict[str, Any]) -> list[str]:
    lines = []
    if summary["status"] != "done":
        text = as_html(summary["message"])
        lines.append(
            f'<p class="stopped">Stopped before the end: {text}. What converged is shown.</p>'
        )
    lines += [f'<p class="warning">{as_html(text)}</p>' for text in summary["warnings"]]
    return lines


def _overview(summary: dict[str, Any]) -> list[str]:
    increments = max(summary["steps"], 1)
    row = {
        "bodies": ", ".join(summary["bodies"]),
        "nodes": summary["nodes"],
        "cells": summary["cells"],
        "unknowns": summary["unknowns"],
        "increments": summary["steps"],
        "Newton iterations": summary["newton_iterations"],
        "per increment": round(summary["newton_iterations"] / increments, 2),
        "wall time [s]": summary["wall_time_s"],
    }
    note = "All numbers are in the units of the case"
    if not summary.get("units"):
        note += ": [length], [force], [stress] and so on stand for whatever it was written in"
    note += f". Made by anisocontact {summary['version']}."
    return [table([row]), f"<p>{as_html(note)}</p>"]


def _contacts(summary: dict[str, Any]) -> list[dict[str, Any]]:
    rows = []
    for contact in summary["contacts"]:
        row = {"slave": contact["slave"], "master": contact["master"]}
        row |= _vector("force", contact["force"], "force")
        row |= _vector("moment", contact["moment"], "force length")
        row |= {
            "largest pressure [stress]": contact["max_pressure"],
            **_vector("at", contact["max_pressure_at"], "length"),
            "area [length^2]": contact["area"],
            "radius if round [length]": contact["radius"],
            "largest penetration [length]": contact["max_penetration"],
            "worst penetration over facet size": _share(contact, "penetration"),
            "worst elastic slip over facet size": _share(contact, "elastic_slip"),
            **contact["points"],
        }
        rows.append(row)
    return rows


def _share(contact: dict[str, Any], name: str) -> float:
    """Largest value of the run over the facet size."""
    return float(contact[f"worst_{name}"] / contact["facet_size"])


# Of what has no displacement of its own, such as a spring.
_NONE = ("", "", "")


def _reactions(summary: dict[str, Any]) -> list[dict[str, Any]]:
    moved = summary["displacements"]
    return [
        {
            "facets or spring": group,
            **_vector("force", force, "force"),
            **_vector("displacement", moved.get(group, _NONE), "length"),
        }
        for group, force in summary["reactions"].items()
    ]


def _resultants(summary: dict[str, Any]) -> list[dict[str, Any]]:
    return [
        {
            "name": name,
            **_vector("force", found["force"], "force"),
            **_vector("moment", found["moment"], "force length"),
        }
        for name, found in summary["resultants"].items()
    ]


def _stresses(summary: dict[str, Any]) -> list[dict[str, Any]]:
    return [
        {
            "body": name,
            "largest equivalent stress (von Mises) [stress]": found["von_mises"],
            "largest principal [stress]": found["largest_principal"],
            "least principal [stress]": found["least_principal"],
        }
        for name, found in summary["stress"].items()
    ]


def _rigid(summary: dict[str, Any]) -> list[dict[str, Any]]:
    return [
        {
            "body": name,
            **_vector("position", body["position"], "length"),
            **_vector("rotation", body["rotation"], "rad"),
            **_vector("force of contact", body["force"], "force"),
            **_vector("moment of contact", body["moment"], "force length"),
        }
        for name, body in summary["rigid"].items()
    ]


def _vector(name: str, values: Iterable[float | str], unit: str) -> dict[str, float | str]:
    return {f"{name} {axis} [{unit}]": value for axis, value in zip("xyz", values, strict=True)}


def _laws(summary: dict[str, Any]) -> list[dict[str, Any]]:
    return [
        {"slave": contact["slave"], "law": what.replace("_", " ")}
        | (_EXACT if what in contact.get("multipliers", ()) else _numbered(law))
        for contact in summary["contacts"]
        for what, law in contact["laws"].items()
    ]


#: Of a law whose stiffness multipliers stand for.
_EXACT = {"model": "exact, by multipliers", "numbers": ""}


def _numbered(law: dict[str, Any]) -> dict[str, Any]:
    numbers = {name: values for name, values in law.items() if name != "name"}
    texts = [f"{name} {', '.join(f'{v:.5g}' for v in values)}" for name, values in numbers.items()]
    return {"model": law["name"], "numbers": "; ".join(texts)}


def table(rows: Sequence[dict[str, Any]]) -> str:
    """Rows of numbers as a table."""
    if not rows:
        return "<p>None.</p>"
    head = "".join(f"<th>{as_html(str(key))}</th>" for key in rows[0])
    body = "".join(
        "<tr>" + "".join(f"<td>{_cell(value)}</td>" for value in row.values()) + "</tr>"
        for row in rows
    )
    return f'<div class="wide"><table><tr>{head}</tr>{body}</table></div>'


def _cell(value: Any) -> str:
    return f"{value:.5g}" if isinstance(value, float) else as_html(str(value))


def figure(picture: Picture) -> str:
    """A picture with heading and caption, inside the page."""
    data = base64.b64encode(picture.path.read_bytes()).decode("ascii")
    title, caption = as_html(picture.title), as_html(picture.caption)
    return (
        f'<h2>{title}</h2>\n<figure><img alt="{title}" src="data:image/png;base64,{data}">'
        f"<figcaption>{caption}</figcaption></figure>"
    )
