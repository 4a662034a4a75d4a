"""The pattern of the tangent has places for what contact will need, and is built a few times."""

from __future__ import annotations

import dataclasses
from functools import partial

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.interface import ContactLaw
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import BoxSpec, build_box
from anisocontact.solver import Problem, Solver, Step
from anisocontact.solver.system.coupled import MOST_LEFT
from anisocontact.solver.system.prediction import FARTHEST, SPACING, ContactPrediction
from anisocontact.solver.terms.turn import Turn

#: At slave nodes.
POINTS, MORTAR = (partial(Contact, mortar=nodes) for nodes in (False, True))


LAW = ContactLaw(
    NormalLaw(penalty=2e3), Adhesion(stiffness=(1e3, 1e3)), Friction(coefficients=(0.3, 0.3))
)
CLAMP = {"mat.bottom": dict.fromkeys("xyz", 0.0)}
#: Way of a block along a mat, length; its facets are as long as 0.25.
SHORT, LONG = 0.4, 1.5


def pair(kind=POINTS, length=2.0):
    """A block on a mat of facets that do not match."""
    facets = round(7 * length / 2)
    model = build_box(
        {
            "block": BoxSpec((0.05, 0.0, 0.0), (0.75, 0.75, 0.4), (3, 3, 2)),
            "mat": BoxSpec((-0.2, -0.2, -0.4), (length, 1.15, 0.4), (facets, 4, 2)),
        }
    )
    rubber = make_material("neo-hookean", E=100.0, nu=0.3)
    contact = kind(model, "block.bottom", "mat.top", law=LAW)
    return Problem(model, dict.fromkeys(("block", "mat"), rubber), [contact])


def pressed(way, increments, more=()):
    """Press the block down, then drag it along."""
    down = CLAMP | {"block.top": {"x": 0.0, "y": 0.0, "z": -0.03}}
    drag = {"block.top": {"x": way, "y": 0.1 * way}}
    return [Step("press", 2, down), Step("drag", increments, drag), *more]


def run(problem, steps, ahead=True):
    """Resultant of every increment, and number of couplings whenever the pattern was made."""
    coupled, count = problem._tangent.coupled, []
    preallocate = coupled._preallocate
    coupled._preallocate = lambda matrix: [count.append(len(coupled.pattern)), preallocate(matrix)]
    if not ahead:
        problem.predict_contact = lambda steps: None
    solver = Solver(problem, steps, strategy="direct")
    forces = [a.resultants["block.bottom"][0] for a in solver.run()]
    return np.array(forces), count


@pytest.mark.parametrize("kind", [POINTS, MORTAR])
def test_pressed_and_dragged_it_is_built_once(kind):
    """Requirement: sparsity built once and reused. What is grown into makes the same forces.

    Newton's tolerance is 1e-8 of the forces at work; another order of elimination changes the last
    digits only.
    """
    steps = pressed(SHORT, 4)
    forces, built = run(pair(kind), steps)
    grown, often = run(pair(kind), steps, ahead=False)
    assert len(built) == 1
    assert len(often) > 3
    np.testing.assert_allclose(forces, grown, atol=1e-7 * np.abs(grown).max())


def test_dragged_far_it_is_built_a_few_times_and_stays_small():
    """A window ahead is as long as FARTHEST facets; what is left behind goes in the end."""
    steps = pressed(LONG, 15)
    forces, built = run(pair(length=3.0), steps)
    assert 1 < len(built) <= 2 + LONG / (0.25 * (FARTHEST - 1.0))
    assert max(built) <= MOST_LEFT * 1.5 * built[0]
    grown, often = run(pair(length=3.0), steps, ahead=False)
    assert len(often) > 2 * len(built)
    np.testing.assert_allclose(forces, grown, atol=1e-6 * np.abs(grown).max())


def test_back_and_forth_it_is_built_once():
    back = Step("back", 4, {"block.top": {"x": -0.05, "y": 0.0}})
    _, built = run(pair(), pressed(SHORT, 4, [back]))
    assert len(built) == 1


def test_where_no_way_is_prescribed_points_are_taken_to_slide_on():
    """A block is turned about its axis: those at its corners go two facets far."""
    turn = Turn((0, 0, 1), 1.0, point=(0.425, 0.375, 0.0))
    steps = [pressed(0.0, 1)[0], Step("turn", 20, rotation={"block.top": turn})]
    forces, built = run(pair(), steps)
    grown, often = run(pair(), steps, ahead=False)
    assert len(built) <= len(often) / 3
    np.testing.assert_allclose(forces, grown, atol=1e-6 * np.abs(grown).max())


def test_the_way_is_that_of_the_slave_against_the_master():
    """Supports of both bodies count, from where the steps have come to, as far as the window."""
    contact = Contact(pair().model, "block.bottom", "mat.top", law=LAW, mortar=False)
    steps = pressed(0.3, 4)
    moving = {"mat.bottom": {"x": -0.1}}
    steps[1] = dataclasses.replace(steps[1], displacement=steps[1].displacement | moving)
    way, hops = ContactPrediction([contact], steps).way(contact, None, 0.0)
    np.testing.assert_allclose(way[[0, -1]], [[0.0, 0.0, 0.0], [0.4, 0.03, -0.03]], atol=1e-15)
    rest, _ = ContactPrediction([contact], steps).way(contact, steps[1], 0.5)
    np.testing.assert_allclose(rest[-1], [0.2, 0.015, 0.0], atol=1e-15)
    spacing = np.linalg.norm(np.diff(way, axis=0), axis=1)
    assert spacing.max() <= SPACING * contact.slave_points.size + 1e-15
    assert hops == 1
    far, _ = ContactPrediction([contact], pressed(9.0, 4)).way(contact, None, 0.0)
    reached = np.linalg.norm(far[-1]) / contact.slave_points.size
    assert FARTHEST - SPACING < reached <= FARTHEST
