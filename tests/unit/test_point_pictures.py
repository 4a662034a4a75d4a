"""Pictures of the driver: what is in them, also where there is little to draw."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from anisocontact.anisotropy import make_directions
from anisocontact.interface import Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.point import Group, History, Load, PrescribedPath, drive
from anisocontact.point.pictures import compare, force_plane, over_time, path_on_surface
from anisocontact.point.pictures.ellipse import adhesion_domain, yield_ellipse
from anisocontact.surfaces import make_surface

PLANE = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1), tangent=(1, 0, 0))
MARKS = make_directions("constant", vector=(1, 0, 0), angle=0.3)
AXES = {"first friction axis", "second friction axis", "start"}
ALONG = [(0, 0, 0), (1e-3, 0, 0)]


def _interface(stiffness: tuple[float, float] = (2e5, 5e4)) -> Interface:
    return Interface(
        PLANE,
        NormalLaw(penalty=1e5),
        Adhesion(stiffness=stiffness, directions=MARKS),
        Friction(coefficients=(0.3, 0.1), directions=MARKS),
    )


LOADS: dict[str, tuple[Load, set[str]]] = {
    "slip": (PrescribedPath(ALONG, pressure=10.0, increments=8), {"slip"}),
    "open": (PrescribedPath(ALONG, gap=1e-4, increments=3), {"open"}),
    "rest": (PrescribedPath([(0, 0, 0)] * 2, pressure=10.0, increments=3), {"stick"}),
}


@pytest.mark.parametrize("name", LOADS)
def test_path_shows_the_status(name: str) -> None:
    load, status = LOADS[name]
    history = drive(_interface(), load)
    figure = path_on_surface(history, _interface(), title="a title")
    labels = {text.get_text() for text in figure.legends[0].get_texts()}
    assert labels >= AXES | status
    assert not labels & ({"open", "stick", "slip"} - status)
    assert any(label.startswith("T on the slave") for label in labels) == (name == "slip")
    assert any("adhesion domain" in label for label in labels) == (name != "open")
    (ax,) = figure.axes
    assert ax.get_title().startswith("a title\n")
    assert len(over_time(history).axes) == 3
    assert force_plane(history, _interface()).axes[0].get_legend() is not None


def test_one_row_alone() -> None:
    """A drive that stopped in its first step has a picture too."""
    full = drive(_interface(), LOADS["slip"][0])
    first = History(full.surface, full.steps[:1], full.points[:1], full.areas)
    for figure in (path_on_surface(first, _interface()), over_time(first)):
        figure.canvas.draw()


def test_limits_are_those_of_the_laws() -> None:
    """Points of the force limit are on T.FT = N^2, and those of the domain are taken there by S."""
    history = drive(_interface(), LOADS["slip"][0])
    row = history.points[-1, 0]
    limit = yield_ellipse(_interface(), row, 10.0)
    assert limit is not None
    assert np.allclose((limit / [3.0, 1.0]) ** 2 @ [1.0, 1.0], 1.0)
    found = adhesion_domain(_interface(), row)
    assert found is not None
    slip, domain = found
    force = domain @ row["adhesion_axes"].T * [2e5, 5e4]
    assert np.allclose((force / [3.0, 1.0]) ** 2 @ [1.0, 1.0], 1.0)
    assert slip.tolist() == row["elastic"].tolist()


def test_strip_has_two_edges() -> None:
    """No stiffness along the first axis: mu_2 N/eps_2 across, no end along it."""
    interface = _interface((0.0, 5e4))
    row = drive(interface, LOADS["slip"][0]).points[-1, 0]
    found = adhesion_domain(interface, row)
    assert found is not None
    slip, edges = found
    across = edges @ row["adhesion_axes"][1]
    assert np.allclose(np.abs(across[~np.isnan(across)]), 0.1 * 10.0 / 5e4)
    assert abs(slip @ row["adhesion_axes"][0]) < 1e-12 * np.linalg.norm(slip)


def test_group_and_comparison(tmp_path: Path) -> None:
    """Several points are joined; every run of a comparison has its label."""
    load = LOADS["slip"][0]
    history = drive(_interface(), load, Group([(0, 0), (1e-4, 0), (0, 1e-4)]))
    figure = path_on_surface(history, _interface())
    assert "the group" in {text.get_text() for text in figure.legends[0].get_texts()}
    runs = {"a": history, "b": drive(_interface(), load)}
    figure = compare(runs, _interface())
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels == ["limit for N = 10", "a", "b"]
    figure.savefig(tmp_path / "compare.png")
    assert (tmp_path / "compare.png").stat().st_size > 10_000
