"""A pile of discs whose facets do not quite touch, and which friction cannot hold."""

from __future__ import annotations

import re
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from anisocontact.base.limits import Limits
from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.laws import Friction
from anisocontact.mesh import Body, Placement, PlaneStrain, Rotation, build_mesh, make_shape
from anisocontact.solver import Problem, Step
from anisocontact.solver.stepping.failures import Failures
from anisocontact.solver.stepping.run_position import RunPosition
from anisocontact.solver.strategies.newton import NewtonResult
from anisocontact.solver.system.culprit import Culprit
from anisocontact.surfaces import make_surface

APART = 1.1
TOP = 1.0 + np.sqrt(4.0 - APART**2)
#: Friction between any two of three equal discs, one on two, that holds them.
HOLDS = np.tan(0.5 * np.arcsin(0.5 * APART))


def _pile(facets: int, friction: float, above: float = 0.0) -> tuple[Problem, Step]:
    """A disc on two others on a floor, turned by shares of a facet, and a step with their weights.

    Args:
        facets: Around each disc.
        friction: Between any two, and on the floor.
        above: How far all are from the floor, the upper one from the lower ones, radii.
    """
    disc = make_shape("disc", radius=1.0, cells=(facets, 1))
    places = {"a": (-APART, 1, 0.4), "b": (APART, 1, -0.4), "top": (0, TOP, 0)}
    bodies = []
    for name, (x, y, turn) in places.items():
        turned = Rotation((0, 0, 1), turn * 2.0 * np.pi / facets)
        at = (x, y + above * (1 + (name == "top")), 0)
        bodies.append(Body(name, disc, Placement(rotate=turned, move=at)))
    model = build_mesh(bodies, idealisation=PlaneStrain())
    floor = make_surface("plane", point=(0, 0, 0), normal=(0, 1, 0))
    rubs = Friction(coefficients=friction)
    pairs = [("a.outer", floor), ("b.outer", floor), ("top.outer", "a.outer")]
    pairs.append(("top.outer", "b.outer"))
    contacts = [Contact(model, *pair, rubs, name=str(i)) for i, pair in enumerate(pairs)]
    steel = {name: make_material("linear-elastic", E=1e4, nu=0.3) for name in places}
    weight = {name: {"y": -0.01} for name in places}
    return Problem(model, steel, contacts), Step("weight", 1, body_force=weight)


def _hint(problem: Problem, step: Step) -> str:
    problem.begin(step)
    return Failures(problem, []).hint(step, RunPosition.beginning(0, 0.0, Limits()), 1)


def test_a_pile_below_whose_arcs_nothing_holds_is_told_before_anything_presses() -> None:
    """A tenth of what the pile of round discs needs, in the first increment of a run.

    Requirement: it is told that no forces where the discs touch hold them; the friction that would
    is never more than that of round discs, as flat facets resist rolling, and comes to it at first
    order with finer facets. Source: at the upper contacts the force leans by half the angle of the
    normal, as that on a lower disc meets the one on it from the floor there. Tolerance: the error
    of the coarsest mesh shown, halved with each twice as fine, and half as much again.
    """
    errors = []
    for facets in (96, 192, 384):
        told = _hint(*_pile(facets, 0.1 * HOLDS))
        assert told.startswith("no forces where ")
        (number,) = re.findall(r"it would take ([\d.]+) times the friction; hold them", told)
        errors.append(1.0 - float(number) / 10.0)
    assert all(error > 0.0 for error in errors)
    assert errors[0] < 0.6
    assert all(later < 0.75 * before for before, later in pairwise(errors))


@pytest.mark.parametrize(
    ("friction", "above"), [(1.1 * HOLDS, 0.0), (0.1 * HOLDS, 0.05)], ids=["holds", "apart"]
)
def test_a_pile_that_may_stand_is_not_told(friction: float, above: float) -> None:
    """Friction that holds the round discs; discs that are apart by more than their arcs.

    Requirement: nothing is told. Source: as above, and discs that are apart may come to touch
    anywhere.
    """
    assert _hint(*_pile(48, friction, above)) == ""


@pytest.mark.parametrize("led", [False, True])
def test_a_fall_from_rest_ends_the_run(led: bool) -> None:
    """Bodies at rest that small loads have carried through each other.

    Requirement: there is no smaller part then, and there is where motion is prescribed, something
    has been accepted before, or the body is held by more than contact. Source: loads that grow
    together point where they do from the first, so that smaller ones move the bodies along the same
    path.
    """
    problem, step = _pile(24, 1.1 * HOLDS)
    if led:
        step = replace(step, displacement={"top.outer": {"y": -0.01}})
    problem.begin(step)
    failures, place = Failures(problem, []), RunPosition.beginning(0, 0.0, Limits())
    through = Culprit("behind", (0.0, 0.0, 0.0), "body 'top' has gone through its master", "2")
    other = replace(through, contact="of another body")
    stuck = NewtonResult(iterations=1, residuals=[1.0, 1.0], reason="the line search got stuck")
    lost = replace(stuck, culprits=(through,))
    assert not failures.hopeless(step, place, 2, stuck)
    assert failures.hopeless(step, place, 2, lost) is not led
    assert not failures.hopeless(step, place, 1, lost)
    assert not failures.hopeless(step, place, 2, replace(stuck, culprits=(other,)))
    place.control.done = 0.5
    assert not failures.hopeless(step, place, 2, lost)
