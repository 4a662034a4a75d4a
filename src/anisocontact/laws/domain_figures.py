"""Pictures of the adhesion domain."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from anisocontact.laws.domain import Ellipse, Strip, rotation
from anisocontact.surfaces import points

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Told apart also without red and green, and in grey.
_STICK, _AFTER, _POINT, _GREY = "#1f5fa8", "#2f7d4f", "#d9622b", "#777777"


def draw_force_plane(
    domain: Ellipse,
    *,
    trial: npt.ArrayLike | None = None,
    force: npt.ArrayLike | None = None,
    unit: str = "",
    axes: Axes | None = None,
) -> Axes:
    """Draws the domain in the plane of forces [Konyukhov Schweizerhof 2006, fig. 5, eq. (115)].

    Args:
        domain: From `force_domain`.
        trial: Trial forces, (n, 2), each joined to the force of the same row.
        force: Forces, (n, 2).
        unit: Unit of stress for the labels.
        axes: Where to draw; a new figure if left out.

    Returns:
        The matplotlib axes.

    Example:
        >>> from anisocontact.laws import force_domain
        >>> draw_force_plane(force_domain((0.3, 0.1), 0.5, 1.0), unit="MPa").get_xlabel()
        'T₁ [MPa]'
    """
    ax = _axes(axes)
    _draw_domain(ax, domain, "adhesion: T·FT ≤ N²", _STICK)
    if trial is not None:
        ax.plot(*points(trial, 2).T, "o", mfc="none", color=_GREY, ms=4, label="trial force")
    if trial is not None and force is not None:
        pairs = np.stack([points(trial, 2), points(force, 2)], axis=1)
        for pair in pairs:
            ax.plot(*pair.T, ":", color=_GREY, lw=0.8)
    if force is not None:
        ax.plot(*points(force, 2).T, "o-", color=_POINT, lw=1.2, ms=3, label="force T")
    return _finish(ax, "T₁", "T₂", unit)


def draw_tangent_plane(
    domain: Ellipse | Strip,
    *,
    path: npt.ArrayLike | None = None,
    centres: npt.ArrayLike | None = None,
    unit: str = "",
    axes: Axes | None = None,
) -> Axes:
    """Draws the domain on the tangent plane [Konyukhov Schweizerhof 2006, fig. 5, 6, eq. (116)].

    Args:
        domain: From `adhesion_domain`, about its centre.
        path: Positions of the contact point S, (n, 2).
        centres: Centres of the domain, (n, 2); it is drawn about the first and the last of them.
        unit: Unit of length for the labels.
        axes: Where to draw; a new figure if left out.

    Returns:
        The matplotlib axes.

    Example:
        >>> from anisocontact.laws import adhesion_domain
        >>> strip = adhesion_domain((0, 1e3), 0.2, (0.3, 0.1), 0.5, 1.0)
        >>> draw_tangent_plane(strip, unit="mm").get_ylabel()
        'ξ² [mm]'
    """
    ax = _axes(axes)
    if centres is None:
        _draw_domain(ax, domain, "adhesion domain", _STICK)
    else:
        c = points(centres, 2)
        _draw_domain(ax, domain.at(c[0]), "adhesion domain, first", _STICK)
        _draw_domain(ax, domain.at(c[-1]), "adhesion domain, last", _AFTER)
        ax.plot(*c.T, "x-", color=_AFTER, lw=1.2, ms=4, label="path of the centre")
    if path is not None:
        ax.plot(*points(path, 2).T, "o-", color=_POINT, lw=1.2, ms=3, label="path of the point S")
    return _finish(ax, "ξ¹", "ξ²", unit)


def _axes(axes: Axes | None) -> Axes:
    if axes is not None:
        return axes
    from matplotlib.figure import Figure

    return Figure(figsize=(5.0, 5.0), layout="constrained").add_subplot()


def _draw_domain(ax: Axes, domain: Ellipse | Strip, label: str, color: str) -> None:
    """Fills a domain and marks its centre and axes."""
    along, across = rotation(domain.angle).T
    centre = np.asarray(domain.centre)
    if isinstance(domain, Ellipse):
        sizes = domain.semi_axes
        lines = [domain.points()]
    else:
        sizes = (4.0 * domain.half_width, domain.half_width)  # as much of it as is drawn
        lines = list(domain.edges(2.0 * sizes[0]))
    outline = lines[0] if len(lines) == 1 else np.concatenate([lines[0], lines[1][::-1]])
    ax.fill(*outline.T, color=color, alpha=0.12, lw=0)
    for k, line in enumerate(lines):
        ax.plot(*line.T, color=color, lw=1.4, label=None if k else label)
    for direction, size in zip((along, across), sizes, strict=True):
        ends = centre + np.outer((-size, size), direction)
        ax.plot(*ends.T, "--", color=color, lw=0.7)
    ax.plot(*centre, "o", color=color, ms=4)


def _finish(ax: Axes, x: str, y: str, unit: str) -> Axes:
    suffix = f" [{unit}]" if unit else ""
    ax.set(xlabel=f"{x}{suffix}", ylabel=f"{y}{suffix}")
    ax.set_aspect("equal", adjustable="datalim")
    ax.grid(lw=0.4, alpha=0.5)
    # below the axes, where it hides nothing
    ax.legend(fontsize="small", loc="upper center", bbox_to_anchor=(0.5, -0.12), ncols=2)
    return ax
