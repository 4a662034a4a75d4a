"""Which corrections may close one point at a time."""

from __future__ import annotations

import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.bulk import make_material
from anisocontact.contact import Augmentation, Contact
from anisocontact.contact.multiplier_schemes import SINGLY, USUAL
from anisocontact.interface import ContactLaw
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import BoxSpec, build_box
from anisocontact.solver import Problem, Step
from anisocontact.solver.stepping.bending import bend
from anisocontact.surfaces import make_surface

HOOKE = {"E": 100.0, "nu": 0.3}
LAW = ContactLaw(NormalLaw(penalty=1e3), Adhesion(stiffness=1e2), Friction(coefficients=0.0))


@pytest.mark.parametrize(
    ("model", "given", "scheme", "sticks", "closes"),
    [
        ("neo-hookean", {}, USUAL, False, True),
        ("neo-hookean", {}, USUAL, True, False),
        ("neo-hookean", {}, SINGLY, True, True),
        ("plastic", {"yield_stress": 1.0}, USUAL, False, False),
        ("plastic", {"yield_stress": 1.0}, SINGLY, False, True),
    ],
)
def test_metal_closes_singly_as_a_last_way(
    model: str, given: dict[str, float], scheme: str, sticks: bool, closes: bool
) -> None:
    """Where bodies may yield it is left to the scheme of its own, as where points stick."""
    mesh = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1))})
    floor = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    contact = Contact(mesh, "block.bottom", floor, LAW, augmentation=Augmentation())
    problem = Problem(mesh, {"block": make_material(model, **HOOKE, **given)}, [contact])
    problem.begin(Step("press", 1, {"block.top": {"x": 0.0, "y": 0.0, "z": -0.01}}))
    bend(problem)
    problem.contact_term.take_way(scheme)
    assert problem.contact_term.close_singly(sticks) is closes
