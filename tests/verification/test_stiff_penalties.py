"""Penalties far beyond the stiffness of the bodies are as easy to solve with as multipliers."""

import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

import numpy as np
from tests.verification.slid_blocks import offset_pair

from anisocontact import Adhesion, Friction, NormalLaw
from anisocontact.anisotropy import make_directions
from anisocontact.base.statuses import OPEN, SLIP, STICK
from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.interface import ContactLaw
from anisocontact.solver import Problem, Solver, Step

HELD = dict.fromkeys("xyz", 0.0)
#: Penalties over Young's modulus, length^-1: 1e5 times the stiffness of the bodies.
STIFF = 1e6
#: Not far beyond that from which on they count as stiff, 120 times the stiffness of the bodies.
LEAST_STIFF = 1.2e3


def run(unit, penalty, tangential, strategy):
    """A block that is pressed and then dragged: iterations of the increments, and the contact.

    Args:
        unit: Young's modulus of the blocks, stress.
        penalty: Normal penalty over it, length^-1.
        tangential: Stiffness of adhesion over it along and across 30 degrees to x, length^-1.
        strategy: How the equations are solved.
    """
    model = offset_pair("hexahedron", 1)
    stiffness = tuple(unit * np.array(tangential))
    axes = make_directions("constant", vector=(1.0, 0.0, 0.0), angle=np.radians(30.0))
    stick = Adhesion(stiffness=stiffness, directions=axes)
    law = ContactLaw(NormalLaw(penalty=unit * penalty), stick, Friction(coefficients=(0.4, 0.4)))
    contact = Contact(model, "upper.bottom", "lower.top", law, mortar=True)
    steel = make_material("linear-elastic", E=unit, nu=0.3)
    held, top = {"lower.bottom": HELD}, {"z": -0.01, "y": 0.0}
    press = Step("press", 1, held | {"upper.top": top | {"x": 0.0}})
    drag = Step("drag", 2, held | {"upper.top": top | {"x": 0.01}})
    problem = Problem(model, dict.fromkeys(("upper", "lower"), steel), [contact])
    found = Solver(problem, [press, drag], strategy=strategy).run()
    return [one.iterations for one in found], contact


@pytest.mark.parametrize(
    ("unit", "penalty", "tangential", "strategy"),
    [
        (1.0, STIFF, (STIFF, 2.0 * STIFF), "direct"),
        (1e9, STIFF, (STIFF, STIFF), "condensed"),
        (1.0, STIFF, (10.0, 10.0), "direct"),
        (1.0, LEAST_STIFF, (LEAST_STIFF, 2.0 * LEAST_STIFF), "condensed"),
    ],
)
def test_a_few_iterations(unit, penalty, tangential, strategy):
    """Requirement: stiff penalties take a few corrections, and hold as the law says.

    Points stick and slip. Multipliers take as many corrections; without the way over them the first
    increment is cut again and again. Reference: the pressure is the penalty times the overlap.
    Tolerance: rounding of positions, 1e-16, is 1e-7 of overlaps of 1e-9.
    """
    iterations, contact = run(unit, penalty, tangential, strategy)
    assert len(iterations) == 3
    assert max(iterations) <= 6
    touching = contact.last.status != OPEN
    assert {STICK, SLIP} <= set(contact.last.status[touching])
    expected = -unit * penalty * contact.last.gap[touching]
    np.testing.assert_allclose(contact.last.pressure[touching], expected, rtol=1e-6)
