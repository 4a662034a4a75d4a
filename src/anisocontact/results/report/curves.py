"""Curves: force over displacement, moment over angle, path of the force against its ellipse."""

from __future__ import annotations

from itertools import cycle
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.ticker import MaxNLocator

from anisocontact.base.array_types import Floats
from anisocontact.base.figure_style import ACCENT, GREY, STEP_COLOURS, new_figure, plain
from anisocontact.results.report.frame import ContactView, Frame, axis_name
from anisocontact.results.report.run_data import RunData

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: Distance of names of steps above a curve that leaves room for both, over its length.
BESIDE = 0.04
#: How an ellipse is drawn that the path on it must not hide: a broad band below it.
_BEHIND: dict[str, Any] = {"lw": 7.0, "alpha": 0.3, "zorder": 1.5, "solid_capstyle": "butt"}
#: Component along x of a normal from which on forces along it are radial ones in part.
_RADIAL = 0.01
#: Dashes of the first and the second axis of a law.
_AXES = (0, (6, 3)), (0, (2, 3))
#: Share of pressure times area up to which a component of a resultant is rounding.
_ROUNDING = 1e-9
_DOMAIN = "adhesion domain at the end of each step"


def force(run: RunData, contact: int) -> Figure:
    """Force on the slave over the distance moved: tangential components and normal force."""
    view = run.view(-1, contact)
    frame, seen_along = view.frame, view.closed
    if run.around_an_axis and abs(frame.normal[0]) > _RADIAL:
        frame, seen_along = Frame.across(np.array([0.0, 1.0, 0.0])), True
    forces = np.vstack([np.zeros(3), _resultants(run, contact)])
    shown = [run.is_resultant(axis) for axis in frame.axes]
    tangential = frame.of(forces) * shown
    label, distance = run.path_length()
    at = np.append(0.0, distance)
    normal = forces @ frame.normal
    # around a closed slave, as a ring on a bar, normal forces balance each other
    alone = seen_along and not normal.any()
    figure = new_figure(9.0, 4.5 if alone else 6.0)
    rows = (1,) if alone else (2, 1)
    panels = figure.subplots(len(rows), sharex=True, squeeze=False, height_ratios=rows)[:, 0]
    upper = panels[0]
    for i, (line, colour) in enumerate((("-", "#1d4ed8"), ("--", "#c2410c"))):
        if shown[i]:
            name = f"along {frame.names()[i]}"
            upper.plot(at, tangential[:, i], line, color=colour, label=name)
    size = np.linalg.norm(tangential, axis=1)
    upper.plot(at, size, "-", color="black", lw=1.0, label="magnitude")
    kind = "" if seen_along else "tangential "
    upper.set_ylabel(f"{kind}force on the slave [force]")
    upper.legend(loc="best")
    for lower in panels[1:]:
        lower.plot(at, normal, color="black")
        along = f"force along {frame.normal_name}" if seen_along else "normal force"
        lower.set_ylabel(f"{along} [force]")
        lower.set_ylim(bottom=min(0.0, float(normal.min())))
    panels[-1].set_xlabel(label)
    for axes in panels:
        _shade(run, axes, at)
        axes.margins(x=0.0)
        axes.grid(alpha=0.3)
    _name_steps(run, upper, at)
    return figure


def moment(run: RunData) -> Figure:
    """Moments on the rigid bodies that turn, over the angle of the one that turns farthest."""
    angles = {body: run.angle(body) for body in run.turning}
    farthest = max(angles, key=lambda body: angles[body][-1])
    at = np.append(0.0, angles[farthest])
    figure = new_figure(9.0, 4.5)
    axes = figure.subplots()
    for (body, axis), colour in zip(run.turning.items(), cycle(STEP_COLOURS)):
        about = np.append(0.0, run.vectors(f"rigid.{body}.moment") @ axis)
        name = f"on {plain(body)} about {axis_name(axis)}"
        axes.plot(at, about, color=colour, label=name)
    axes.set_ylabel("moment of contacts and faces [force length]")
    axes.set_xlabel(f"rotation angle of {plain(farthest)} [rad]")
    axes.legend(loc="best")
    _shade(run, axes, at)
    axes.margins(x=0.0)
    axes.grid(alpha=0.3)
    _name_steps(run, axes, at)
    return figure


def _resultants(run: RunData, contact: int) -> Floats:
    """Forces on the slave, (rows, 3); components that forces of points cancel in are zero."""
    forces, of_contact = run.vectors(f"contacts.{contact}.force"), f"contacts.{contact}"
    pressed = run.history[f"{of_contact}.max_pressure"] * run.history[f"{of_contact}.area"]
    return np.where(np.abs(forces) > _ROUNDING * np.max(pressed, initial=0.0), forces, 0.0)


def domain(run: RunData, contact: int) -> Figure:
    """Path of the force and of the mean elastic slip, each with the ellipse it stays in.

    As figure 5 of the paper: the friction ellipse `T.FT = N^2` in the plane of the force, and what
    it becomes on the tangent plane, the adhesion domain `e.(BFB)e = N^2` around its centre. Where
    multipliers hold there is no elastic slip, and the path of the force alone is drawn.
    """
    view = run.view(run.moments[-1].index, contact)
    frame = view.frame
    forces = run.vectors(f"contacts.{contact}.force")
    pressing = forces @ frame.normal
    pressed = pressing > 1e-9 * np.abs(pressing).max(initial=0.0)
    ratio = frame.of(forces) / np.where(pressed, pressing, np.inf)[:, None]
    ellipse = _friction_ellipse(run, contact)
    elastic = not run.exact(contact, "adhesion")
    figure = new_figure(11.0 if elastic else 6.4, 6.4)
    left, *right = figure.subplots(1, 2 if elastic else 1, squeeze=False)[0]
    if ellipse is not None:
        left.plot(*ellipse.T, color=ACCENT, label="friction ellipse T.FT = N²", **_BEHIND)
    _path(run, left, ratio)
    left.set_title("resultant tangential force over normal force")
    laws = "friction and adhesion" if elastic else "friction"
    _in_plane(left, view, "friction", "T/N", "1", laws)
    for axes in right:
        if ellipse is not None:
            _adhesion_domains(run, contact, axes, pressing, ellipse)
        _path(run, axes, frame.of(run.vectors(f"contacts.{contact}.elastic_slip")))
        axes.plot(0.0, 0.0, "+", color="black", ms=10, label="centre")
        axes.set_title("mean elastic slip of the points in contact")
        _in_plane(axes, view, "adhesion", "elastic slip", "length", laws)
    shown = {
        label: line
        for axes in (left, *right)
        for line, label in zip(*axes.get_legend_handles_labels(), strict=True)
    }
    columns = 3 if elastic else 2
    figure.legend(shown.values(), shown.keys(), loc="outside lower center", ncols=columns)
    return figure


def _in_plane(axes: Axes, view: ContactView, law: str, what: str, unit: str, laws: str) -> None:
    """Finish a picture of vectors in the tangent plane: its view, axes and the lines of a law."""
    first, second = view.frame.names()
    _centre_view(axes)
    _axis_lines(axes, view.mean_axes(law), laws)
    axes.set_xlabel(f"{what} along {first} [{unit}]")
    axes.set_ylabel(f"{what} along {second} [{unit}]")
    axes.set_aspect("equal")
    axes.grid(alpha=0.3)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(MaxNLocator(5))
        axis.set_major_formatter("{x:.3g}")


def _adhesion_domains(
    run: RunData, contact: int, axes: Axes, pressing: Floats, ellipse: Floats
) -> None:
    """The domain at the end of each step, where it is the same for all points."""
    softness = _softness(run, contact)
    if softness is None:
        return
    area = run.history[f"contacts.{contact}.area"]
    mean = pressing / np.where(area > 0.0, area, np.inf)
    for (_, rows), colour in zip(run.steps, cycle(STEP_COLOURS)):
        around = mean[rows[-1]] * ellipse @ softness
        axes.plot(*around.T, color=colour, lw=1.0, ls="-.", label=_DOMAIN)


def _friction_ellipse(run: RunData, contact: int) -> Floats | None:
    """Points of `T.FT = N^2` for N = 1 in the frame, (n, 2); None without one for all points."""
    law = run.summary["contacts"][contact]["laws"]["friction"]
    axes = run.view(run.moments[-1].index, contact).mean_axes("friction")
    if "coefficients" in law and len(set(law["coefficients"])) == 1:
        axes = np.eye(2)  # a circle, whatever the axes are
    if axes is None or "coefficients" not in law:
        return None
    turn = np.linspace(0.0, 2.0 * np.pi, 361)
    circle = np.column_stack([np.cos(turn), np.sin(turn)])
    return np.asarray((circle * law["coefficients"]) @ axes)


def _softness(run: RunData, contact: int) -> Floats | None:
    """Inverse of S = -B in the frame, (2, 2): elastic slip `e = -S^-1 T`."""
    law = run.summary["contacts"][contact]["laws"]["adhesion"]
    axes = run.view(run.moments[-1].index, contact).mean_axes("adhesion")
    if axes is None or law["name"] != "elastic" or min(law["stiffness"]) <= 0.0:
        return None
    return np.asarray(axes.T @ np.diag(1.0 / np.array(law["stiffness"])) @ axes)


def _path(run: RunData, axes: Axes, points: Floats) -> None:
    start = np.zeros((1, 2))
    for (name, rows), colour in zip(run.steps, cycle(STEP_COLOURS)):
        path = np.vstack([start, points[rows]])
        axes.plot(*path.T, "o-", color=colour, ms=2.5, lw=1.2, label=plain(name))
        axes.plot(*path[-1], "s", color=colour, ms=6)
        start = path[-1:]


def _centre_view(axes: Axes) -> None:
    """Limits around the origin that hold what has been drawn."""
    drawn = np.concatenate([line.get_xydata() for line in axes.lines])
    reach = 1.15 * float(np.abs(drawn).max()) or 1.0
    axes.set(xlim=(-reach, reach), ylim=(-reach, reach))


def _axis_lines(axes: Axes, directions: Floats | None, laws: str) -> None:
    """Axes of a law; those of all laws of a picture have one style and one name in its legend."""
    if directions is None:
        return
    for direction, which, style in zip(directions, ("first", "second"), _AXES, strict=True):
        label, way = f"{which} axis of {laws}", tuple(direction)
        axes.axline((0.0, 0.0), way, color=GREY, lw=0.8, ls=style, label=label)


def _spans(run: RunData, at: Floats) -> list[tuple[str, float, float, str]]:
    spans = []
    for (name, rows), colour in zip(run.steps, cycle(STEP_COLOURS)):
        spans.append((name, float(at[rows[0]]), float(at[rows[-1] + 1]), colour))
    return spans


def _shade(run: RunData, axes: Axes, at: Floats) -> None:
    for _, start, end, colour in _spans(run, at):
        axes.axvspan(start, end, color=colour, alpha=0.08, lw=0.0)


def _name_steps(run: RunData, axes: Axes, at: Floats) -> None:
    """Names above their spans; those of narrow ones at nearly one place in one label."""
    labels: list[tuple[str, float, str]] = []
    size = float(at[-1] - at[0])
    for name, start, end, colour in _spans(run, at):
        middle = 0.5 * (start + end)
        if end - start >= 0.1 * size:
            _name(axes, plain(name), middle, colour)
        elif labels and middle - labels[-1][1] < BESIDE * size:
            labels[-1] = (f"{labels[-1][0]}, {plain(name)}", *labels[-1][1:])
        else:
            labels.append((plain(name), middle, colour))
    for name, middle, colour in labels:
        _name(axes, name, middle, colour, ha="left", rotation=45.0)


def _name(axes: Axes, name: str, place: float, colour: str, **style: Any) -> None:
    axes.annotate(
        name,
        (place, 1.0),
        xycoords=("data", "axes fraction"),
        xytext=(0, 4),
        textcoords="offset points",
        color=colour,
        **{"ha": "center"} | style,
    )
