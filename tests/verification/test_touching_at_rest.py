"""Bodies that just touch and do not move: gaps of rounding, on planes that no axis lies in."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.contact.facet_mesh import facet_nodes
from anisocontact.interface import ContactLaw
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import Body, Placement, Rotation, build_mesh, make_shape
from anisocontact.solver import Accepted, Problem, Solver, Step

TURN = Rotation((0.3, 1.0, 0.2), angle_deg=20.0)
#: Where the blocks stand, and what is left of positions there: 16 roundings of the distance.
AWAY = (30.0, -20.0, 10.0)
ROUNDED = 16.0 * float(np.finfo(np.float64).eps) * float(np.linalg.norm(AWAY))


def _cubes(
    order: int, move: tuple[float, float, float], friction: float, pushed: float
) -> tuple[list[Accepted], float]:
    """What is accepted of two unit cubes on each other: a rest of two increments, then a push.

    Args:
        order: Of the cells.
        move: Where they stand, length.
        friction: Coefficient.
        pushed: How far the upper one is pushed towards the lower one, length.

    Returns:
        The accepted increments, and the force along the normal in the last.
    """
    place = Placement(rotate=TURN, move=move)
    cubes = {"lower": (0.0, (3, 3, 2)), "upper": (1.0, (4, 4, 2))}
    bodies = [
        Body(
            name,
            make_shape("box", origin=(0, 0, z), size=(1, 1, 1), cells=cells, order=order),
            place,
        )
        for name, (z, cells) in cubes.items()
    ]
    model = build_mesh(bodies)
    rubbing = Friction(coefficients=friction)
    contact = Contact(model, "upper.bottom", "lower.top", rubbing, name="between")
    steel = make_material("linear-elastic", E=1000.0, nu=0.3)
    problem = Problem(model, dict.fromkeys(cubes, steel), [contact])
    (normal,) = TURN.apply(np.array([[0.0, 0.0, 1.0]]))
    held = {"lower.bottom": dict.fromkeys("xyz", 0.0), "upper.top": dict.fromkeys("xyz", 0.0)}
    there = dict(zip("xyz", (-pushed * normal).tolist(), strict=True))
    steps = [Step("rest", 2, held), Step("push", 1, held | {"upper.top": there})]
    found: list[Accepted] = list(Solver(problem, steps).run())
    force, _ = found[-1].resultants["between"]
    return found, float(force @ normal)


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("friction", [0.2, 0.5])
@pytest.mark.parametrize("move", [(0.0, 0.0, 0.0), AWAY])
def test_where_nothing_moves_rounding_is_no_contact_force(order, friction, move):
    """Which points touch is a matter of rounding, and equilibrium is found in two or three.

    Source: a body at rest without loads. A residual that was held against the points in contact
    alone, and multipliers that did not know how far away they are, took 50 corrections, or the run
    ended with 7 cuts.
    """
    found, _ = _cubes(order, move, friction, pushed=1e-3)
    rest = [one for one in found if one.step == "rest"]
    assert [one.done for one in rest] == [1.0, 1.0]
    assert max(one.iterations for one in rest) <= 3
    assert not any(one.relaxed for one in rest)


@pytest.mark.parametrize("times", [1e3, 1e6])
def test_a_push_of_a_thousand_roundings_is_solved(times):
    """Source: linear bodies that stick, whose force is proportional to a push, here of 1e-3.

    Tolerance: two roundings of positions over the push.
    """
    pushed = times * ROUNDED
    found, force = _cubes(1, AWAY, 0.5, pushed)
    _, large = _cubes(1, AWAY, 0.5, 1e-3)
    assert found[-1].contacts["between"] == {"open": 0, "stick": 25, "slip": 0}
    assert force / pushed == pytest.approx(large / 1e-3, rel=2.0 / times)


@pytest.mark.parametrize(("gap", "share"), [(0.0, 1.0), (0.1, 0.0)])
def test_points_that_have_met_are_rounded_where_a_trial_opens_them(gap, share):
    """Forces that move points to the origin: penalty, area and distance of those that may touch.

    Nodes open by 1e-9 count with the normal penalty; those that were apart do not count at all.
    """
    low = make_shape("box", origin=(0, 0, 0), size=(1, 1, 1), cells=(1, 1, 1))
    high = make_shape("box", origin=(0, 0, 1 + gap), size=(1, 1, 1), cells=(1, 1, 1))
    model = build_mesh([Body("lower", low), Body("upper", high)])
    law = ContactLaw(NormalLaw(penalty=1e3), Adhesion(stiffness=10.0), Friction(coefficients=0.5))
    contact = Contact(model, "upper.bottom", "lower.top", law, mortar=True)
    u = np.zeros_like(model.positions)
    u[np.unique(facet_nodes(model.space, model.facets("upper.bottom"))), 2] = 1e-9
    assert not contact.update(u, 1.0).pressure.any()
    distances = np.sqrt([1.0, 2.0, 2.0, 3.0])
    expected = share * 1e3 * 0.25 * float(np.linalg.norm(distances))
    assert contact.lever() == pytest.approx(expected, rel=1e-6)
