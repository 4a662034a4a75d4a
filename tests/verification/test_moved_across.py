"""Rigid bodies that move across a plane of symmetry where a body touches them are told of.

Requirement: a warning that names contact, body, plane and way where the mirror image of the motion
is another one, and none where it is the same. Source: the mirror image of a translation is itself
along the plane, that of a turn (an axial vector) about the normal of the plane.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.base.errors import RunWarning
from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.laws import Friction
from anisocontact.mesh import BoxSpec, build_box
from anisocontact.rigid import MovingSurface, RigidBody
from anisocontact.solver import Accepted, Problem, Solver, Step
from anisocontact.surfaces import make_surface

HELD = {"block.top": {"x": 0.0, "y": 0.0, "z": 0.0}}
FLOOR = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
JAW = make_surface("plane", point=(1, 0, 0), normal=(-1, 0, 0))


def _run(
    motion: Mapping[str, float], half: bool = True, jaw: bool = False, mortar: bool = True
) -> list[Accepted]:
    """A block, or its half, that a floor is pressed against and then moved, or a jaw."""
    start, cells = (0.0, 3) if half else (-1.0, 6)
    block = BoxSpec((start, -1, 0), (1 - start, 2, 2), (cells, 6, 3))
    model = build_box({"block": block})
    tool = RigidBody("tool", (0, 0, 0))
    slave, surface = ("block.right", JAW) if jaw else ("block.bottom", FLOOR)
    law = Friction(coefficients=0.5)
    contact = Contact(model, slave, MovingSurface(surface, tool), law, mortar=mortar)
    rubber = {"block": make_material("linear-elastic", E=100.0, nu=0.3)}
    problem = Problem(model, rubber, [contact], symmetry=["block.left"] if half else [])
    press = {"x": -0.1} if jaw else {"z": 0.1}
    steps = [Step("press", 1, HELD, motion={"tool": press})]
    steps.append(Step("move", 2, motion={"tool": motion}))
    return list(Solver(problem, steps, strategy="direct").run())


@pytest.mark.parametrize("mortar", [True, False])
@pytest.mark.parametrize("motion", [{"x": 0.02}, {"rz": 0.02}])
def test_a_half_that_is_not_the_half_of_the_whole(motion, mortar):
    """Told, and rightly so: two halves have not the force, or not the torque, of the whole."""
    with pytest.warns(RunWarning, match="rigid body 'tool' has moved by .* across the symmetry"):
        *_, last = _run(motion, mortar=mortar)
    (one,) = last.across["block.bottom"]
    assert (one.body, one.plane) == ("tool", "block.left")
    assert one.way == pytest.approx(0.02, rel=0.2)  # of a turn at the outermost point, at 0.85 to 1
    *_, whole = _run(motion, half=False, mortar=mortar)
    assert not whole.across
    force, moment = (part["block.bottom"] for part in (whole.resultants, last.resultants))
    component = 0 if "x" in motion else 5
    whole_one, half_one = (np.concatenate(part)[component] for part in (force, moment))
    assert abs(2.0 * half_one / whole_one - 1.0) > 0.05


@pytest.mark.parametrize("motion", [{"y": 0.02}, {"rx": 1e-3}, {"z": 0.12}])
def test_a_half_that_is_the_half_of_the_whole(motion):
    """Not told, and rightly so: a half has half the forces, to the tolerance of Newton's method."""
    *_, last = _run(motion)
    assert not last.across
    *_, whole = _run(motion, half=False)
    half_one, whole_one = (part.resultants["block.bottom"][0] for part in (last, whole))
    assert np.allclose(2.0 * half_one[1:], whole_one[1:], rtol=1e-6, atol=1e-6 * whole_one[2])


def test_a_jaw_is_meant():
    """Not told: one that closes on the side of a half does not touch on the plane."""
    *_, last = _run({"x": -0.12}, jaw=True)
    assert not last.across
