"""The path of the points on the surface, with directions, adhesion ellipses and forces."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FormatStrFormatter, MaxNLocator

from anisocontact.base.array_types import Floats
from anisocontact.base.figure_style import new_figure
from anisocontact.point.balance import PointInterface
from anisocontact.point.history import History
from anisocontact.point.pictures.ellipse import adhesion_domain
from anisocontact.point.pictures.style import (
    AXES,
    COLOURS,
    INK,
    UNITS,
    chosen,
    number,
    runs,
    size,
    tangential_law,
)
from anisocontact.surfaces import Surface

# An ellipse smaller than this share of the picture is drawn enlarged.
_SMALL = 0.04
_MARKS = 11


def path_on_surface(
    history: History, interface: PointInterface, *, title: str = "", forces: int = 7
) -> Figure:
    """Draw surface, friction axes, path by status, tangential forces and adhesion ellipses.

    Args:
        history: What was driven.
        interface: Through what.
        title: Heading.
        forces: How many forces are drawn along the path.

    Returns:
        The figure.
    """
    figure = new_figure(8.5, 6.8)
    ax: Any = figure.add_subplot(projection="3d", computed_zorder=False)
    extent = _extent(history)
    box, patch = _patch(interface.surface, history, extent)
    toward = _view(ax, history)
    ax.plot_surface(*patch, color="#f1eee7", alpha=0.6, linewidth=0, zorder=0, shade=False)
    ax.plot_wireframe(*patch, color="#c9c4b8", linewidth=0.4, rcount=12, ccount=12, zorder=1)
    lines = _directions(ax, interface, box, extent, toward)
    lines += _path(ax, history, toward)
    rows = chosen(history, forces)
    lines += _bodies(ax, history, rows, toward)
    lines += _forces(ax, history, rows, extent, toward)
    lines += _ellipses(ax, history, interface, rows, extent, toward)
    figure.legend(handles=lines, loc="outside lower center", ncols=3, fontsize=8)
    ax.set(xlabel="x", ylabel="y", zlabel="z")
    _limits(ax, np.stack(patch, axis=-1).reshape(-1, 3))
    ax.set_title(
        "\n".join(filter(None, [title, f"Path on the surface, lengths {UNITS}"])), fontsize=11
    )
    return figure


def _extent(history: History) -> float:
    """A length that fills the picture: of the path, or of a point at rest that of its gap."""
    feet, points = history.feet, history.points
    least = 1e-9 * float(np.abs(feet).max())
    lengths = (
        size(feet),
        10.0 * np.abs(points["elastic"]).max(),
        10.0 * np.abs(points["gap"]).max(),
    )
    return next((float(v) for v in lengths if v > least), max(least, 1.0))


def _patch(surface: Surface, history: History, extent: float) -> tuple[Floats, list[Floats]]:
    """Box of coordinates (2, 2) around the path, and the grid of positions in it."""
    xi = history.points["xi"].reshape(-1, 2).copy()
    low, high, periodic = surface.domain
    lengths = np.linalg.norm(surface.jet(xi).d1, axis=2).max(axis=0)
    margin = 0.35 * extent / np.maximum(lengths, 1e-300)
    box = np.empty((2, 2))
    for i in range(2):
        if periodic[i]:
            xi[:, i] = np.unwrap(xi[:, i], period=high[i] - low[i])
        box[i] = xi[:, i].min() - margin[i], xi[:, i].max() + margin[i]
        if periodic[i] and np.ptp(box[i]) > 0.4 * (high[i] - low[i]):
            box[i] = box[i].mean() + 0.5 * (high[i] - low[i]) * np.array([-1.0, 1.0])
        elif not periodic[i]:
            box[i] = np.clip(box[i], low[i], high[i])
    lines = [np.linspace(a, b, 61) for a, b in box.tolist()]
    u, v = np.meshgrid(*lines, indexing="ij")
    x = surface.position(np.stack([u.ravel(), v.ravel()], axis=1)).reshape(61, 61, 3)
    return box, [x[..., i] for i in range(3)]


def _view(ax: Any, history: History) -> Floats:
    """Turn the camera to the side of the slave, a little from aside; the direction to it, (3,)."""
    normal = history.points["normal"].reshape(-1, 3).sum(axis=0)
    normal /= max(float(np.linalg.norm(normal)), 1e-300)
    if np.linalg.norm(normal[:2]) > 0.3:
        azimuth = float(np.degrees(np.arctan2(normal[1], normal[0]))) - 25.0
        elevation = float(np.degrees(np.arcsin(normal[2]))) * 0.7 + 18.0
    else:
        azimuth, elevation = -65.0, float(np.sign(normal[2]) or 1.0) * 52.0
    ax.view_init(elev=elevation, azim=azimuth)
    a, e = np.radians([azimuth, elevation])
    return np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])


def _faded(normal: Floats, toward: Floats) -> Floats:
    """Opacity at normals (..., 3): what is on the far side is faint."""
    return np.where(normal @ toward > -0.05, 1.0, 0.15)


def _lines(ax: Any, ends: Floats, colour: str, alpha: Floats, **look: Any) -> None:
    """Straight lines (n, 2, 3), each with its opacity."""
    from mpl_toolkits.mplot3d.art3d import Line3DCollection  # type: ignore[import-untyped]

    ax.add_collection3d(Line3DCollection(ends, colors=[(colour, a) for a in alpha], **look))


def _directions(
    ax: Any, interface: PointInterface, box: Floats, extent: float, toward: Floats
) -> list[Line2D]:
    """Both friction axes on a grid of the patch."""
    law = tangential_law(interface)
    field = law.friction_directions if law else None
    if field is None:
        return []
    inner = [np.linspace(a, b, _MARKS + 2)[1:-1] for a, b in box.tolist()]
    xi = np.stack([m.ravel() for m in np.meshgrid(*inner, indexing="ij")], axis=1)
    axes, valid = field.axes(interface.surface, xi)
    at, n = interface.surface.position(xi), interface.surface.geometry(xi).normal
    half = 0.035 * extent
    alpha = _faded(n[valid], toward)
    for a, (length, width) in enumerate(((1.0, 1.3), (0.45, 0.8))):
        arm = half * length * axes[valid, a]
        ends = np.stack([at[valid] - arm, at[valid] + arm], axis=1)
        _lines(ax, ends, AXES[a], alpha, linewidth=width, zorder=2)
    return [
        Line2D([], [], color=AXES[0], linewidth=1.3, label="first friction axis"),
        Line2D([], [], color=AXES[1], linewidth=0.8, label="second friction axis"),
    ]


def _path(ax: Any, history: History, toward: Floats) -> list[Line2D]:
    """The paths of the feet in the colour of their status."""
    feet, normals = history.feet, history.points["normal"]
    seen = set()
    for p in range(feet.shape[1]):
        for status, rows in runs(history.points["status"][:, p]):
            seen.add(status)
            # In pieces, so that the far side can be faint.
            pieces = np.stack([feet[rows][:-1, p], feet[rows][1:, p]], axis=1)
            alpha = _faded(normals[rows][:-1, p], toward)
            _lines(ax, pieces, COLOURS[status], alpha, linewidth=3.2, zorder=4, capstyle="round")
        ax.plot(*feet[:1, p].T, "o", color=INK, markersize=5, zorder=6)
    lines = [Line2D([], [], color=COLOURS[s], linewidth=3.2, label=s) for s in COLOURS if s in seen]
    start = Line2D([], [], color=INK, marker="o", linestyle="", markersize=5, label="start")
    return [start, *lines]


def _bodies(ax: Any, history: History, rows: list[int], toward: Floats) -> list[Line2D]:
    """Where the group is, as a polygon through its points."""
    if history.points.shape[1] < 2:
        return []
    look: dict[str, Any] = {"color": "#444444", "linewidth": 1.0}
    for i in rows:
        feet = history.feet[i]
        alpha = float(_faded(history.points["normal"][i].mean(axis=0), toward))
        ax.plot(*np.concatenate([feet, feet[:1]]).T, zorder=6, alpha=alpha, **look)
    return [Line2D([], [], label="the group", **look)]


def _forces(
    ax: Any, history: History, rows: list[int], extent: float, toward: Floats
) -> list[Line2D]:
    """Tangential tractions as arrows."""
    t = history.traction_t
    longest = float(np.linalg.norm(t[rows], axis=2).max()) if rows else 0.0
    if longest == 0.0:
        return []
    scale = 0.22 * extent / longest
    for i in rows:
        for p in range(t.shape[1]):
            if np.linalg.norm(t[i, p]) > 1e-9 * longest:
                row = history.points[i, p]
                arrow = _arrow(history.feet[i, p], scale * t[i, p], row["normal"])
                alpha = float(_faded(row["normal"], toward))
                ax.plot(*arrow.T, color=INK, linewidth=1.1, zorder=5, alpha=alpha)
    label = f"T on the slave, longest {number(longest)}"
    return [Line2D([], [], color=INK, linewidth=1.5, marker=">", label=label)]


def _arrow(start: Floats, vector: Floats, normal: Floats) -> Floats:
    """An arrow as one line, its head in the tangent plane, (5, 3)."""
    side = 0.08 * np.cross(normal, vector)
    tip, neck = start + vector, start + 0.8 * vector
    return np.stack([start, tip, neck + side, tip, neck - side])


def _ellipses(
    ax: Any,
    history: History,
    interface: PointInterface,
    rows: list[int],
    extent: float,
    toward: Floats,
) -> list[Line2D]:
    """Adhesion ellipses about their centres, enlarged about the point where they are small."""
    found = {
        (i, p): domain
        for i in rows
        for p in range(history.points.shape[1])
        if (domain := adhesion_domain(interface, history.points[i, p])) is not None
    }
    if not found:
        return []
    largest = max(float(np.nanmax(np.linalg.norm(e, axis=1))) for _, e in found.values())
    factor = 1.0 if largest > _SMALL * extent else float(f"{0.08 * extent / largest:.1g}")
    for (i, p), (slip, limit) in found.items():
        centre = history.feet[i, p] - factor * slip
        alpha = float(_faded(history.points["normal"][i, p], toward))
        colour = COLOURS["stick"]
        ax.plot(*(centre + factor * limit).T, color=colour, linewidth=1.0, zorder=3, alpha=alpha)
        ax.plot(*centre[:, None], "+", color=colour, markersize=5, zorder=3, alpha=alpha)
    times = "" if factor == 1.0 else f", enlarged {factor:g} times"
    label = f"adhesion domain and its centre{times}"
    return [Line2D([], [], color=COLOURS["stick"], linewidth=1.0, marker="+", label=label)]


def _limits(ax: Any, points: Floats) -> None:
    """Equal scales; a flat direction gets a little height."""
    low, high = points.min(axis=0), points.max(axis=0)
    middle, span = 0.5 * (low + high), high - low
    span = np.maximum(span, 0.12 * span.max())
    ax.set(
        xlim=middle[0] + 0.5 * span[0] * np.array([-1, 1]),
        ylim=middle[1] + 0.5 * span[1] * np.array([-1, 1]),
        zlim=middle[2] + 0.5 * span[2] * np.array([-1, 1]),
    )
    # A tall box is as high as the figure; a flat one may fill its width.
    ax.set_box_aspect(span, zoom=0.86 if span[2] > 1.2 * span[:2].max() else 1.05)
    for axis, part in zip((ax.xaxis, ax.yaxis, ax.zaxis), span / span.max(), strict=True):
        axis.set_major_locator(MaxNLocator(6 if part > 0.5 else 1 if part < 0.2 else 3))
        axis.set_major_formatter(FormatStrFormatter("%.7g"))
        axis.pane.set_visible(False)
        axis.set_tick_params(labelsize=8)
