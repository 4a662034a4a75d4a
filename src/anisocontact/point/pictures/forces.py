"""The path of the tangential force in the plane of the friction axes."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from anisocontact.base.figure_style import new_figure
from anisocontact.point.balance import PointInterface
from anisocontact.point.history import History, Records
from anisocontact.point.pictures.ellipse import yield_ellipse
from anisocontact.point.pictures.style import COLOURS, INK, UNITS, number, runs


def force_plane(history: History, interface: PointInterface, *, title: str = "") -> Figure:
    """Draw T along the friction axes with the yield ellipse of the smallest and largest N.

    Args:
        history: What was driven.
        interface: Through what.
        title: Heading.

    Returns:
        The figure.
    """
    figure = new_figure(6.8, 6.0)
    ax = figure.add_subplot()
    seen: dict[str, Line2D] = {}
    for p in range(history.points.shape[1]):
        t = history.points["traction_principal"][:, p]
        for status, rows in runs(history.points["status"][:, p]):
            (line,) = ax.plot(
                *t[rows].T, ".-", color=COLOURS[status], markersize=4, linewidth=1.2, zorder=3
            )
            line.set_label(status)
            seen.setdefault(status, line)
        ax.plot(*t[-1], "s", color=INK, markersize=5, zorder=4)
    handles = [seen[s] for s in COLOURS if s in seen]
    handles.append(Line2D([], [], color=INK, marker="s", linestyle="", markersize=5, label="end"))
    for row, pressure, style in limits(history):
        ellipse = yield_ellipse(interface, row, pressure)
        if ellipse is not None:
            label = f"limit for N = {number(pressure)}"
            handles += ax.plot(*ellipse.T, style, color=INK, linewidth=1.0, zorder=2, label=label)
    ax.axhline(0.0, color="#bbbbbb", linewidth=0.6, zorder=1)
    ax.axvline(0.0, color="#bbbbbb", linewidth=0.6, zorder=1)
    ax.set(xlabel="T along the first friction axis", ylabel="T along the second friction axis")
    ax.set_aspect("equal", adjustable="datalim")
    ax.legend(handles=handles, loc="best", fontsize=8)
    heading = f"Tangential traction on the slave, {UNITS}"
    ax.set_title("\n".join(filter(None, [title, heading])), fontsize=11)
    return figure


def limits(history: History) -> list[tuple[Records, float, str]]:
    """Row and pressure of the limits to be drawn: largest N, and the last one where it differs."""
    n = history.points["pressure"]
    largest, last = float(n.max()), float(n[-1].max())
    if largest == 0.0:
        return []
    row = history.points[np.unravel_index(np.argmax(n), n.shape)]
    found = [(row, largest, "-")]
    if 0.0 < last < 0.995 * largest:
        found.append((row, last, "--"))
    return found
