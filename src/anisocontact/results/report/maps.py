"""Maps on the contact surface: pressure, status, traction along the principal axes."""

from __future__ import annotations

from collections.abc import Sequence
from textwrap import wrap
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.patches import Patch

from anisocontact.base.array_types import Floats, Ints
from anisocontact.base.figure_style import STATUS_COLOURS, new_figure, plain
from anisocontact.base.statuses import STATUS
from anisocontact.results.report.along import AROUND, CLOSE, FACETS, pressure_along, traction_along
from anisocontact.results.report.frame import ContactView
from anisocontact.results.report.run_data import Moment, RunData

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.cm import ScalarMappable
    from matplotlib.figure import Figure

#: Panels side by side; of more steps the last ones are shown.
MOST = 3
#: Height of a map over its width below which the scale of colours lies under it, to be long enough.
FLAT = 0.5
#: Share of the pressure below which a traction is rounding, which the colours do not show.
NOISE = 1e-6
#: Letters of a line of the title of a panel.
LETTERS = 34
#: Size of a map in which panels can share their axes, over that of the points.
ROOM = 1.5
#: Squares along the longer side of what touches, with an arrow each.
_SQUARES = 6.0
_BOTH = np.array([-1.0, 1.0])


def pressure(run: RunData, contact: int) -> Figure:
    """Pressure at the end of each step, or of the last ones, one scale for all."""
    moments = run.ends()[-MOST:]
    views = [run.view(moment.index, contact) for moment in moments]
    if views and all(view.one_curve for view in views):
        return pressure_along(list(zip(views, moments, strict=True)))
    figure, panels = _panels(run, contact, moments)
    top = max(float(view.data["pressure"][view.touching].max(initial=0.0)) for _, view, _ in panels)
    for axes, view, moment in panels:
        axes.set_title(_title(moment))
        image = view.draw_touching(
            axes, view.data["pressure"], cmap="viridis", vmin=0.0, vmax=top or 1.0
        )
    _close_up(panels)
    _scale(figure, [p[0] for p in panels], image, panels[0][1], "pressure [stress]")
    if len(run.steps) > MOST:
        figure.suptitle(f"at the end {_steps(run)}", fontsize=10)
    _legend_of_open(figure, [view for _, view, _ in panels])
    return figure


def status(run: RunData, contact: int) -> Figure:
    """Open, sticking and slipping points, of each step where stick and slip are most mixed."""
    figure, panels = _panels(run, contact, run.mixed(contact)[-MOST:])
    colours = ListedColormap(STATUS_COLOURS)
    for axes, view, moment in panels:
        view.draw(axes, view.data["status"], cmap=colours, norm=BoundaryNorm([0, 1, 2, 3], 3))
        axes.set_title(_title(moment))
    _close_up(panels)
    figure.suptitle(f"{_steps(run)} the state in which stick and slip are most mixed", fontsize=10)
    there = np.unique(np.concatenate([view.data["status"] for _, view, _ in panels]))
    _legend(figure, [int(code) for code in there])
    return figure


def traction(run: RunData, contact: int) -> Figure:
    """Tangential traction on the slave along the first and the second friction axis, at the end."""
    view = run.view(run.moments[-1].index, contact)
    values = view.data["traction_principal"]
    limit = float(np.abs(values[view.touching]).max(initial=0.0))
    limit = max(limit, NOISE * float(view.data["pressure"].max(initial=0.0))) or 1.0
    if view.one_curve:
        return traction_along(view, run.moments[-1], limit)
    figure = new_figure(10.0, 4.2 * view.aspect + _margin(view))
    left, right = figure.subplots(1, 2, sharex=True, sharey=True)
    for axes, i, name in ((left, 0, "first"), (right, 1, "second")):
        image = view.draw_touching(axes, values[:, i], cmap="RdBu_r", vmin=-limit, vmax=limit)
        axes.set_title(f"along the {name} axis of friction")
        _arrows(axes, view, i)
    _show(left, _window([view]))
    _scale(figure, [left, right], image, view, "tangential traction on the slave [stress]")
    figure.suptitle(f"{plain(run.moments[-1].title)}; arrows: direction of the axis")
    _legend_of_open(figure, [view])
    return figure


def _title(moment: Moment) -> str:
    """Title of a panel, in lines that are no wider than it."""
    return "\n".join(wrap(plain(moment.title), LETTERS))


def _steps(run: RunData) -> str:
    """Which steps have a panel."""
    count = len(run.steps)
    return "of each step" if count <= MOST else f"of each of the last {MOST} of {count} steps"


def _panels(
    run: RunData, contact: int, moments: list[Moment]
) -> tuple[Figure, list[tuple[Axes, ContactView, Moment]]]:
    views = [run.view(moment.index, contact) for moment in moments]
    figure = new_figure(3.9 * len(moments) + 1.0, 3.6 * views[0].aspect + _margin(views[0]))
    shared = _in_one_place(views)
    row = figure.subplots(1, len(moments), sharex=shared, sharey=shared, squeeze=False)[0]
    if shared:
        (left, bottom), (right, top) = (
            np.min([view.box[0] for view in views], axis=0),
            np.max([view.box[1] for view in views], axis=0),
        )
        for axes in row:  # a picture would set them to its own size otherwise
            axes.set_xlim(left, right)
            axes.set_ylim(bottom, top)
    return figure, list(zip(row, views, moments, strict=True))


def _close_up(panels: list[tuple[Axes, ContactView, Moment]]) -> None:
    """Show what touches alone where that is little of the slave, the same in panels that share."""
    views = [view for _, view, _ in panels]
    shared = _in_one_place(views)
    for axes, view, _ in panels:
        _show(axes, _window(views if shared else [view]))


def _window(views: list[ContactView]) -> Floats | None:
    """Box around what touches, (2, 2); None where the whole slave is little more."""
    if any(view.on_line for view in views) or not any(view.touching.any() for view in views):
        return None
    places = np.concatenate([view.flat[view.touching] for view in views])
    low, high = places.min(axis=0), places.max(axis=0)
    facet = max(np.sqrt(view.data["area"][view.touching].max(initial=0.0)) for view in views)
    room = max(AROUND * (high - low).max(), FACETS * facet)
    window = np.stack([low - room, high + room])
    whole = max((view.box[1] - view.box[0]).max() for view in views)
    return window if (high - low).max() + 2.0 * room < CLOSE * whole else None


def _show(axes: Axes, window: Floats | None) -> None:
    """Limit a map to a window, if there is one, without another shape of the panel."""
    if window is None:
        return
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    middle, size = window.mean(axis=0), window[1] - window[0]
    share = max(size[0] / (right - left), size[1] / (top - bottom))
    half = 0.5 * share * np.array([right - left, top - bottom])
    axes.set(xlim=middle[0] + half[0] * _BOTH, ylim=middle[1] + half[1] * _BOTH)


def _margin(view: ContactView) -> float:
    """Height of all that is no map, inches."""
    return 2.4 if view.aspect < FLAT else 1.7


def _scale(
    figure: Figure, panels: list[Axes], image: ScalarMappable, view: ContactView, label: str
) -> None:
    """A scale of colours beside the maps, or under those that are too flat for its label."""
    if view.aspect < FLAT:
        place: dict[str, Any] = {"location": "bottom", "shrink": 0.6, "aspect": 40}
        figure.colorbar(image, ax=panels, label=label, **place)
    else:
        figure.colorbar(image, ax=panels, label=label)


def _in_one_place(views: list[ContactView]) -> bool:
    """Whether the points of all views fit in one map, not much larger than that of one of them."""
    boxes = np.stack([view.box for view in views])
    together = boxes[:, 1].max(axis=0) - boxes[:, 0].min(axis=0)
    largest = (boxes[:, 1] - boxes[:, 0]).max(axis=0)
    return bool(np.all(together < ROOM * largest))


def _legend(figure: Figure, statuses: Sequence[int]) -> None:
    """Names of the statuses that are there."""
    handles = [
        Patch(facecolor=STATUS_COLOURS[code], edgecolor="black", label=STATUS[code])
        for code in statuses
    ]
    if handles:
        figure.legend(handles=handles, loc="outside lower center", ncols=len(handles))


def _legend_of_open(figure: Figure, views: Sequence[ContactView]) -> None:
    """Name what is grey in maps of values, where anything is."""
    _legend(figure, [] if all(view.touching.all() for view in views) else [0])


def _arrows(axes: Axes, view: ContactView, which: int) -> None:
    """Some arrows along a friction axis, spread over the touching points."""
    touching = np.flatnonzero(view.touching)
    if not touching.size:
        return
    at = touching[_spread(view.flat[touching])]
    arrow = view.frame.of(view.data[f"direction_friction_{which + 1}"][at])
    axes.quiver(*view.flat[at].T, *arrow.T, color="black", width=0.004, scale=16.0, pivot="mid")


def _spread(places: Floats) -> Ints:
    """Some places (n, 2), the one nearest to the middle of each of the squares that cover them."""
    low, high = places.min(axis=0), places.max(axis=0)
    square = (high - low).max() / _SQUARES or 1.0
    count = np.maximum(np.ceil((high - low) / square - 1e-9), 1.0)
    first = 0.5 * (low + high - count * square)
    within = np.clip((places - first) // square, 0.0, count - 1.0)
    away = np.linalg.norm(places - first - (within + 0.5) * square, axis=1)
    order = np.argsort(away, kind="stable")
    return np.asarray(order[np.unique(within[order], axis=0, return_index=True)[1]])
