"""Several runs in one picture."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from anisocontact.base.array_types import Floats
from anisocontact.base.figure_style import new_figure
from anisocontact.point.balance import PointInterface
from anisocontact.point.history import History
from anisocontact.point.pictures.ellipse import yield_ellipse
from anisocontact.point.pictures.forces import limits
from anisocontact.point.pictures.style import INK, RUNS, UNITS, number


def compare(runs: dict[str, History], interface: PointInterface, *, title: str = "") -> Figure:
    """Draw the tangential traction of the first point of several runs.

    Args:
        runs: Histories by label.
        interface: Of the first run; its ellipse is drawn.
        title: Heading.

    Returns:
        The figure.
    """
    figure = new_figure(12.0, 5.8)
    panels: Any = figure.subplot_mosaic([["plane", "first"], ["plane", "second"]])
    plane = panels["plane"]
    for row, pressure, style in limits(next(iter(runs.values()))):
        ellipse = yield_ellipse(interface, row, pressure)
        if ellipse is not None:
            label = f"limit for N = {number(pressure)}"
            plane.plot(*ellipse.T, style, color=INK, linewidth=0.8, label=label)
    for i, (label, run) in enumerate(runs.items()):
        t = run.points["traction_principal"][:, 0]
        # Later curves are thinner, so that those beneath are seen where they coincide.
        look = {
            "color": RUNS[i % len(RUNS)],
            "linewidth": float(np.linspace(3.6, 1.0, len(runs))[i]),
        }
        plane.plot(*t.T, label=label, **look)
        for k, name in enumerate(("first", "second")):
            panels[name].plot(_length(run), t[:, k], **look)
    plane.set(xlabel="T along the first friction axis", ylabel="T along the second friction axis")
    plane.set_aspect("equal", adjustable="datalim")
    for name in ("first", "second"):
        panels[name].set_ylabel(f"T along the {name} axis")
        panels[name].xaxis.set_major_locator(MaxNLocator(6))
    panels["second"].set_xlabel("length of the path")
    for panel in panels.values():
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
