"""Pictures of contacts that are no straight line and no plane, and of bodies that turn."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.cli.main import main
from anisocontact.results.report import curves, maps
from anisocontact.results.report.contour import Contour
from anisocontact.results.report.run_data import RunData

#: A ring of rubber in a groove, pressed against its floor and its outer wall.
RING = """
[idealisation]
kind = "axisymmetric"
[mesh.disc.ring]
radius = 1.5
cells = [16, 3]
move = [11.5, 1.5, 0]
[material.ring]
model = "neo-hookean"
E = 5
nu = 0.4
[surface.groove]
shape = "revolution"
point = [0, 0, 0]
axis = [0, 1, 0]
profile = [13.0, 6, 13.0, 0, 8, 0]
rounding = 0.3
[surface.lid]
shape = "plane"
point = [0, 3, 0]
normal = [0, -1, 0]
[rigid.lid]
reference = [0, 3, 0]
[[contact]]
slave = "ring.outer"
master = "groove"
friction = { coefficients = 0.1 }
[[contact]]
slave = "ring.outer"
master = "lid"
friction = { coefficients = 0.1 }
[[step]]
name = "squeeze"
increments = 2
motion.lid = { y = -0.5 }
[[step]]
name = "turn"
increments = 1
motion.lid = { ry_deg = 1 }
"""


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> RunData:
    """Results of the ring."""
    folder = tmp_path_factory.mktemp("ring")
    (folder / "case.toml").write_text(RING)
    assert main(["run", str(folder / "case.toml"), "-o", str(folder / "out")]) == 0
    return RunData(folder / "out")


def test_pressures_are_drawn_along_an_outline(run: RunData) -> None:
    """Points at the upper and the lower half of the ring have the same place along x.

    Requirement: the curve goes around the ring once, over distances along it, and contact with
    floor and wall is not parted by where it begins. Source: over x open points of the upper half
    stand between those in contact. Tolerance: chords for arcs, squeezed by a sixth.
    """
    view = run.view(run.moments[-1].index, 0)
    (axes,) = maps.pressure(run, 0).axes
    assert axes.get_xlabel() == "arc length along the slave [length]"
    for line in axes.lines:
        place, pressure = line.get_xdata(), line.get_ydata()
        assert len(place) == 16
        assert np.all(np.diff(place) > 0.0)
        assert 0.8 * 2.0 * np.pi * 1.5 < place[-1] < 1.1 * 2.0 * np.pi * 1.5
        assert pressure[0] == pressure[-1] == 0.0
    assert view.names()[0] == "arc length along the slave"
    assert view.flat[:, 1] == pytest.approx(0.0)


def test_no_ellipse_of_a_groove(run: RunData) -> None:
    """Floor and wall push in different directions: their resultant is in no friction ellipse."""
    pictures = {path.stem for path in (run.results.folder / "pictures").iterdir()}
    assert "domain-0" not in pictures
    assert "domain-1" in pictures


def test_radial_parts_of_a_normal_have_no_resultant(run: RunData) -> None:
    """Requirement: below is the force along the axis, equal and opposite on the lid."""
    lower, upper = (curves.force(run, i).axes[1] for i in (0, 1))
    assert lower.get_ylabel() == "force along y [force]"
    floor, lid = (axes.lines[0].get_ydata() for axes in (lower, upper))
    assert np.abs(floor) == pytest.approx(np.abs(lid), rel=1e-6, abs=1e-6)


def test_a_step_that_turns_has_its_room(run: RunData) -> None:
    """The lid comes no farther while it turns: forces are drawn over the time."""
    label, at = run.path_length()
    assert label == "time [time]"
    assert at.tolist() == [0.5, 1.0, 2.0]


def test_isotropic_friction_has_a_circle(run: RunData) -> None:
    """Whatever the axes are: those of isotropic friction differ from point to point."""
    left = curves.domain(run, 1).axes[0]
    circle = next(one for one in left.lines if "friction ellipse" in str(one.get_label()))
    assert np.hypot(*circle.get_data()) == pytest.approx(0.1)


def test_an_outline_begins_in_the_middle_of_what_is_open() -> None:
    ring = Contour(np.arange(8), closed=True)
    touching = np.isin(np.arange(8), [6, 7, 0])
    assert ring.opened(touching).order.tolist() == [3, 4, 5, 6, 7, 0, 1, 2]
    assert Contour(np.arange(8), closed=False).opened(touching).order.tolist() == list(range(8))
