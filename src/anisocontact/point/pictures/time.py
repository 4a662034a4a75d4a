"""Tractions, slip and energies over time."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from anisocontact.base.figure_style import new_figure
from anisocontact.interface import STATUS
from anisocontact.point.history import History
from anisocontact.point.pictures.style import AXES, COLOURS, INK, UNITS, runs

_ENERGIES = {
    "external": ("work of the load", INK, "-"),
    "spring": ("spring", "#7a7a7a", "--"),
    "adhesion": ("adhesion", COLOURS["stick"], "-"),
    "normal": ("normal", AXES[0], "-"),
    "friction": ("friction", COLOURS["slip"], "-"),
    "viscous": ("viscosity", AXES[1], "-"),
    "regularisation": ("dashpot of the load", "#b8860b", "--"),
    "residual": ("residual", "#c02020", ":"),
}


def over_time(history: History, *, title: str = "") -> Figure:
    """Draw N and T along the friction axes, accumulated slip, and energies over time.

    Tractions and slip are means over the areas of the points; bands show the status of the first.

    Args:
        history: What was driven.
        title: Heading.

    Returns:
        The figure.
    """
    figure = new_figure(8.5, 8.0)
    panels: Any = figure.subplots(3, 1, sharex=True, height_ratios=(3, 2, 3))
    t = history.steps["time"]
    weights = history.areas / history.areas.sum()
    points = history.points
    force, slip, energy = panels
    force.plot(t, points["pressure"] @ weights, color=INK, label="N")
    principal = np.tensordot(weights, points["traction_principal"], (0, 1))
    for i, name in enumerate(("first", "second")):
        force.plot(t, principal[:, i], color=AXES[i], label=f"T along the {name} friction axis")
    size = np.linalg.norm(history.traction_t, axis=2) @ weights
    force.plot(t, size, "--", color="#7a7a7a", linewidth=1.0, label="|T|")
    force.set_ylabel("traction on the slave")
    slip.plot(t, points["slip_accumulated"] @ weights, color=COLOURS["slip"], label="slip, total")
    elastic = np.linalg.norm(points["elastic"], axis=2) @ weights
    slip.plot(t, elastic, color=COLOURS["stick"], label="elastic slip")
    slip.set_ylabel("length")
    for name, (label, colour, style) in _ENERGIES.items():
        values = history.steps["energy"][name] - history.steps["energy"][name][0]
        if np.isnan(values).any():
            energy.plot([], [], style, color=colour, label=f"{label}: no energy")
        elif name in ("external", "residual") or np.abs(values).max() > 0.0:
            energy.plot(t, values, style, color=colour, label=label)
    energy.set(ylabel="energy since the first row", xlabel="time")
    for panel in panels:
        _bands(panel, history, legend=panel is slip)
        panel.legend(loc="center left", bbox_to_anchor=(1.01, 0.5), fontsize=8)
        panel.grid(linewidth=0.3)
    heading = f"Over time, {UNITS}"
    force.set_title("\n".join(filter(None, [title, heading])), fontsize=11)
    return figure


def _bands(ax: Any, history: History, *, legend: bool) -> None:
    """The status of the first point behind the curves."""
    t = history.steps["time"]
    if legend:
        for i in np.unique(history.points["status"][:, 0]):
            ax.plot([], [], color=COLOURS[STATUS[i]], alpha=0.2, linewidth=8, label=STATUS[i])
    for status, rows in runs(history.points["status"][:, 0]):
        if rows.stop - rows.start > 1:
            ax.axvspan(t[rows.start], t[rows.stop - 1], color=COLOURS[status], alpha=0.10, lw=0)
