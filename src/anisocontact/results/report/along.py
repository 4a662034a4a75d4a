"""Curves of pressure and traction along the contact of a mesh in the plane."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import cycle
from typing import TYPE_CHECKING, Any

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.figure_style import STEP_COLOURS, new_figure, plain
from anisocontact.results.report.frame import ALIKE, ContactView, axis_name
from anisocontact.results.report.run_data import Moment

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: Room around what touches in a close-up, over its size; in facets where that is more.
AROUND, FACETS = 0.3, 3.0
#: Size of a close-up over that of the whole slave up to which it is shown alone.
CLOSE = 0.6


def pressure_along(views: Sequence[tuple[ContactView, Moment]]) -> Figure:
    """Pressure over the place in the plane, a curve for each moment."""
    figure = new_figure(9.0, 4.8)
    axes = figure.subplots()
    for (view, moment), colour in zip(views, cycle(STEP_COLOURS), strict=False):
        _curve(axes, view, view.data["pressure"], label=plain(moment.title), color=colour)
    axes.set_ylim(bottom=0.0)
    _close_up(axes, [view for view, _ in views])
    return _finished(figure, axes, views[0][0], "pressure [stress]")


def traction_along(view: ContactView, moment: Moment, limit: float) -> Figure:
    """Tangential traction along both friction axes over the place in the plane.

    Args:
        view: The contact.
        moment: When.
        limit: Largest value that the scale has to show.
    """
    figure = new_figure(9.0, 4.8)
    axes = figure.subplots()
    values = view.data["traction_principal"]
    for i, (name, line, colour) in enumerate(
        (("first", "-", "#1d4ed8"), ("second", "--", "#c2410c"))
    ):
        label = f"along the {name} axis of friction{_direction(view, i)}"
        _curve(axes, view, values[:, i], line, label=label, color=colour)
    axes.set_ylim(-1.05 * limit, 1.05 * limit)
    axes.set_title(plain(moment.title))
    _close_up(axes, [view])
    return _finished(figure, axes, view, "tangential traction on the slave [stress]")


def _curve(axes: Axes, view: ContactView, values: Floats, line: str = "-", **style: Any) -> None:
    """Values over the place, zero where points are open."""
    order = np.argsort(view.flat[:, 0])
    shown = np.where(view.touching, values, 0.0)[order]
    axes.plot(view.flat[order, 0], shown, line, marker=".", **style)


def _close_up(axes: Axes, views: Sequence[ContactView]) -> None:
    """Show what touches alone where that is little of the slave."""
    places = np.concatenate([view.flat[:, 0] for view in views])
    touching = np.concatenate([view.flat[view.touching, 0] for view in views])
    if not touching.size:
        return
    first, last = places.min(), places.max()
    spacing = (last - first) / max(len(views[0].flat) - 1, 1)
    room = max(AROUND * np.ptp(touching), FACETS * spacing)
    low, high = max(touching.min() - room, first), min(touching.max() + room, last)
    if high - low < CLOSE * (last - first):
        axes.set_xlim(low, high)


def _direction(view: ContactView, which: int) -> str:
    """The direction of a friction axis, where it is the same at all points that touch."""
    found = view.data[f"direction_friction_{which + 1}"][view.touching]
    if not len(found) or np.linalg.norm(found.mean(axis=0)) < 1.0 - ALIKE:
        return ""
    return f", {axis_name(found.mean(axis=0))}"


def _finished(figure: Figure, axes: Axes, view: ContactView, label: str) -> Figure:
    axes.set_xlabel(f"{view.names()[0]} [length]")
    axes.set_ylabel(label)
    axes.grid(alpha=0.3)
    axes.legend(loc="best")
    return figure
