"""Curves of the report of a run: forces, moments, adhesion domain; what cancels is left out."""

import numpy as np
import pytest
from matplotlib.text import Text

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.cli.main import main
from anisocontact.results.report import curves
from anisocontact.results.report.run_data import RunData

AROUND = """
[idealisation]
kind = "KIND"
lateral = true
[mesh.rectangle.disc]
origin = [0.5, 0]
size = [1, 0.5]
cells = [4, 2]
[material.disc]
model = "linear-elastic"
E = 1000
nu = 0.3
[surface.floor]
shape = "plane"
point = [0, 0, 0]
normal = [0, 1, 0]
[[contact]]
slave = "disc.bottom"
master = "floor"
friction = { coefficients = 0.2 }
[[step]]
name = "press"
increments = 1
displacement."disc.top" = { x = 0, y = -0.01, z = 0.001 }
[output]
pictures = false
"""


@pytest.mark.parametrize(
    ("kind", "named"),
    [
        ("axisymmetric", ["along z", "magnitude"]),
        ("plane-strain", ["along x", "along z", "magnitude"]),
    ],
)
def test_radial_forces_have_no_resultant(tmp_path, kind, named):
    """Around an axis they balance each other, so the picture of the force leaves their sum out."""
    case = tmp_path / "case.toml"
    case.write_text(AROUND.replace("KIND", kind))
    assert main(["run", str(case), "-o", str(tmp_path / "out")]) == 0
    run = RunData(tmp_path / "out")
    upper = curves.force(run, 0).axes[0]
    shown = {line.get_label(): line.get_ydata() for line in upper.lines}
    assert [name for name in shown if not name.startswith("_")] == named
    across = np.linalg.norm([shown[name] for name in named[:-1]], axis=0)
    np.testing.assert_allclose(shown["magnitude"], across, rtol=1e-12)


@pytest.mark.parametrize(("kind", "cancel"), [("axisymmetric", True), ("plane-strain", False)])
def test_moments_that_cancel_are_zero(tmp_path, kind, cancel):
    """Around an axis the torque is left, on the contact and on the rigid surface that it meets."""
    case = tmp_path / "case.toml"
    rigid = "[rigid.floor]\nreference = [0, 0, 0]\n[[contact]]"
    case.write_text(AROUND.replace("KIND", kind).replace("[[contact]]", rigid))
    assert main(["run", str(case), "-o", str(tmp_path / "out")]) == 0
    run = RunData(tmp_path / "out")
    for what in ("contacts.0.moment", "rigid.floor.moment", "rigid.floor.support_moment"):
        about_x, torque, about_z = np.abs(run.vectors(what)[-1])
        assert torque > 0.1
        assert ((about_x, about_z) == (0.0, 0.0)) == cancel


@pytest.mark.parametrize("turn", [5.0, 0.0])
def test_the_moment_of_what_turns_is_drawn(tmp_path, turn):
    """A disc on a floor that turns: the report has the torque over the angle, else none.

    Requirement: the curve ends at the moment of the history, about the axis of the turn as it is
    named, over the angle in radian. Source: of a clutch the tangential force is rounding, and no
    picture had its torque. The axis is that of the turn, so that the moment of friction, which
    stands against it on the slave, is positive on what turns against it: it is negative here.
    """
    case = tmp_path / "case.toml"
    text = AROUND.replace("KIND", "axisymmetric")
    text = text.replace("pictures = false", "pictures = true") if turn else text
    text = text.replace("[[contact]]", "[rigid.floor]\nreference = [0, 0, 0]\n[[contact]]")
    text = text.replace("z = 0.001 }", f"z = 0 }}\nmotion.floor.ry_deg = {-turn}")
    case.write_text(text)
    assert main(["run", str(case), "-o", str(tmp_path / "out")]) == 0
    run = RunData(tmp_path / "out")
    assert list(run.turning) == (["floor"] if turn else [])
    if not turn:
        return
    assert "Moment over angle" in (tmp_path / "out" / "report.html").read_text()
    axes = curves.moment(run).axes[0]
    angle, about = axes.lines[0].get_data()
    torque = run.history["rigid.floor.moment.y"][-1]
    assert (angle[0], angle[-1]) == pytest.approx((0.0, np.radians(turn)))
    assert (about[0], about[-1]) == pytest.approx((0.0, -torque))
    assert torque > 0.1
    assert axes.lines[0].get_label() == "on floor about -y"


def test_what_cancels_is_drawn_as_nothing(tmp_path):
    """A disc pressed without friction: the tangential force is rounding, and no curve shows it."""
    case = tmp_path / "case.toml"
    text = AROUND.replace("KIND", "plane-strain").replace("coefficients = 0.2", "coefficients = 0")
    case.write_text(text)
    assert main(["run", str(case), "-o", str(tmp_path / "out")]) == 0
    run = RunData(tmp_path / "out")
    run.history["contacts.0.force.x"][:] = 1e-14
    upper, lower = curves.force(run, 0).axes
    sizes = [max(abs(line.get_ydata())) for axes in (upper, lower) for line in axes.lines]
    assert sizes[:-1] == [0.0] * (len(sizes) - 1)
    assert sizes[-1] > 1.0


@pytest.mark.parametrize("adhesion", ["", "adhesion = { stiffness = 50 }"])
def test_no_domain_of_a_stiffness_that_multipliers_stand_for(tmp_path, adhesion):
    """By default multipliers hold what sticks: there is no elastic slip that a domain could have.

    Requirement: picture, caption and the table of laws of the report have the stiffness of an
    adhesion that was given, and that of none other; the summary says which laws are exact.
    """
    case = tmp_path / "case.toml"
    text = AROUND.replace("KIND", "plane-strain").replace("pictures = false", "pictures = true")
    case.write_text(text.replace("friction =", f"{adhesion}\nfriction ="))
    assert main(["run", str(case), "-o", str(tmp_path / "out")]) == 0
    run = RunData(tmp_path / "out")
    exact = ["normal"] if adhesion else ["normal", "adhesion"]
    assert run.summary["contacts"][0]["multipliers"] == exact
    figure = curves.domain(run, 0)
    words = [text.get_text() for text in figure.findobj(Text)]
    assert len(figure.axes) == (2 if adhesion else 1)
    assert any("adhesion" in word for word in words) == bool(adhesion)
    # axes of both laws look alike, and stand once in the legend
    named = [word for word in words if " axis of " in word]
    laws = "friction and adhesion" if adhesion else "friction"
    assert named == [f"first axis of {laws}", f"second axis of {laws}"]
    report = (tmp_path / "out" / "report.html").read_text()
    assert report.count("exact, by multipliers") == len(exact)
    assert ("stiffness 50, 50" in report) == bool(adhesion)
    assert ("no adhesion domain" in report) == (not adhesion)
