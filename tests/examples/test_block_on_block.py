"""The example of two meshed bodies through the command: its numbers against what must hold."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.cli import main
from anisocontact.results import Results

#: Ten seconds for the run and its pictures.
pytestmark = [pytest.mark.ci, pytest.mark.slow]

CASE = Path(__file__).parents[2] / "examples" / "block_on_block" / "case.toml"
MU = np.array([0.2, 0.4])  # along the grain and across
ANGLE = np.radians(30.0)
# Rows: directions of the axes.
AXES = np.array([[np.cos(ANGLE), np.sin(ANGLE)], [-np.sin(ANGLE), np.cos(ANGLE)]])


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """The results folder of the example."""
    folder = tmp_path_factory.mktemp("block_on_block") / "out"
    assert main(["run", str(CASE), "-o", str(folder)]) == 0
    return Results(folder)


def test_action_is_reaction(results):
    """What the pair exchanges is what the supports of both bodies carry.

    To 1e-6, a hundred times the tolerance of Newton.
    """
    history = results.history
    scale = 1e-6 * history["contacts.0.force.z"].max()
    for axis in "xyz":
        force = history[f"contacts.0.force.{axis}"]
        assert np.allclose(history[f"reactions.block.top.{axis}"], -force, atol=scale)
        assert np.allclose(history[f"reactions.mat.bottom.{axis}"], force, atol=scale)


def test_the_resultant_stays_in_the_ellipse(results):
    """The sum of forces inside equal ellipses is inside the ellipse of the sum of the pressures.

    The surfaces tilt by up to a degree or two, which changes tangential over normal force by as
    many percent: 3 % are allowed. Dragging goes up to it, to within 10 %: not all points slip in
    the same direction on a body that gives way sideways.
    """
    history = results.history
    force = np.column_stack([history[f"contacts.0.force.{axis}"] for axis in "xyz"])
    share = np.linalg.norm(force[:, :2] @ AXES.T / MU, axis=1) / force[:, 2]
    assert share.max() < 1.03
    assert share[-1] > 0.9


def test_directions_are_those_of_the_case(results):
    """The axes are those of the case, turned with bodies that deform a little.

    At the edges of the block the mat is sheared and turns its axes by 6.0 degrees; allowed are 10.
    """
    points = results.contact()
    touching = points.point_data["status"] > 0
    for name, axis in zip(("direction_friction_1", "direction_friction_2"), AXES, strict=True):
        cosine = points.point_data[name][touching][:, :2] @ axis
        assert cosine.min() > np.cos(np.radians(10.0))


def test_pictures_and_report(results):
    """The report has all pictures, with the ellipse drawn from the axes of both bodies."""
    names = {path.stem for path in (results.folder / "pictures").iterdir()}
    bodies = {"deformed", "von_mises", "principal_stress"}
    assert names == bodies | {"pressure", "status", "traction", "domain", "force"}
    assert "picture" not in (results.folder / "run.log").read_text()


def test_iterations(results):
    """Newton takes at most 7 corrections an increment on average."""
    assert results.history["newton_iterations"].mean() <= 7.0
