"""Several runs in one picture."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from anisocontact.point.balance import PointInterface
from anisocontact.point.history import History
from anisocontact.point.pictures.ellipse import yield_ellipse
from anisocontact.point.pictures.style import INK, RUNS, UNITS, number
from anisocontact.results.report.style import new_figure
from anisocontact.surfaces import Floats


def compare(runs: dict[str, History], interface: PointInterface, *, title: str = "") -> Figure:
    """Draw the tangential traction of the first point of several runs.

    Args:
        runs: Histories by label.
        interface: Of the first run; its ellipse is drawn.
        title: Heading.

    Returns:
        The figure.
    """
    figure = new_figure(12.0, 5.4)
    panels: Any = figure.subplots(1, 2)
    plane, over = panels
    largest = max(float(run.points["pressure"].max(initial=0.0)) for run in runs.values())
    ellipse = yield_ellipse(interface, largest)
    if ellipse is not None:
        label = f"limit for N = {number(largest)}"
        plane.plot(*ellipse.T, color=INK, linewidth=1.0, label=label)
    for i, (label, run) in enumerate(runs.items()):
        t = run.points["traction_principal"][:, 0]
        colour = RUNS[i % len(RUNS)]
        dots = {"marker": "o", "markersize": 3.0, "markevery": max(1, len(t) // 60)}
        plane.plot(*t.T, color=colour, linewidth=1.2, label=label, **dots)
        length = _length(run)
        over.plot(length, t[:, 0], color=colour, label=label)
        over.plot(length, t[:, 1], "--", color=colour)
    plane.set(xlabel="T along the first friction axis", ylabel="T along the second friction axis")
    plane.set_aspect("equal", adjustable="datalim")
    over.set(xlabel="length of the path", ylabel="T along the axes: first solid, second dashed")
    for panel in panels:
        panel.grid(linewidth=0.3)
    figure.legend(
        *plane.get_legend_handles_labels(), loc="outside lower center", ncols=4, fontsize=8
    )
    heading = f"Tangential traction on the slave, {UNITS}"
    figure.suptitle("\n".join(filter(None, [title, heading])), fontsize=11)
    return figure


def _length(run: History) -> Floats:
    """Length of the path of the foot of the first point, (m,)."""
    steps = np.linalg.norm(np.diff(run.feet[:, 0], axis=0), axis=1)
    return np.concatenate([[0.0], np.cumsum(steps)])
