"""What a contact of a script is that is not told more than its sides and its law."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from tests.verification.laws_in_python import RadialReturn

from anisocontact import (
    Adhesion,
    AdhesionAndFriction,
    Augmentation,
    Contact,
    ContactLaw,
    Friction,
    NormalLaw,
    PlaneStrain,
    PythonLaw,
    RigidBody,
    make_material,
    make_surface,
)
from anisocontact.base.errors import InputError, ModelWarning
from anisocontact.mesh import Body, BoxSpec, Model, build_box, build_mesh, make_shape
from anisocontact.rigid import MovingSurface
from anisocontact.solver import Problem, Solver, Step

PLANE = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
STICK, SLIP = Adhesion(stiffness=50.0), Friction(coefficients=0.3)


def _model(below: int = 2) -> Model:
    upper = BoxSpec((0, 0, 0), (1, 1, 1), (3, 3, 1))
    return build_box({"block": upper, "base": BoxSpec((0, 0, -1), (1, 1, 1), (below, below, 1))})


def _pressed(contact: Contact, model: Model) -> Contact:
    """After a press by 0.01 and a drag by 0.001, which sticks."""
    materials = {
        name: make_material("linear-elastic", E=1e3, nu=0.0) for name in model.body_names()
    }
    held = {"base.bottom": dict.fromkeys("xyz", 0.0)} if "base" in materials else {}
    ways = ({"x": x, "y": 0.0, "z": -0.01} for x in (0.0, 1e-3))
    steps = [Step(name, 1, held | {"block.top": way}) for name, way in zip("pd", ways, strict=True)]
    list(Solver(Problem(model, materials, [contact]), steps).run())
    return contact


@pytest.mark.parametrize(
    "master", ["base.top", PLANE, MovingSurface(PLANE, RigidBody("p", (0, 0, 0)))]
)
def test_nodes_are_taken(master: Any) -> None:
    """Facets and surfaces: the nine or sixteen slave nodes; points where these are asked for."""
    model = _model()
    assert Contact(model, "block.bottom", master, SLIP).slave_points.at_nodes
    for options in ({"mortar": False}, {"degree": 2}):
        assert not Contact(model, "block.bottom", master, SLIP, **options).slave_points.at_nodes
    with pytest.raises(InputError, match="slave nodes have no quadrature"):
        Contact(model, "block.bottom", master, SLIP, degree=2, mortar=True)


def test_nodes_are_taken_in_the_plane() -> None:
    bodies = [Body("b", make_shape("rectangle", origin=(0, 0), size=(1, 1), cells=(3, 3)))]
    model = build_mesh(bodies, idealisation=PlaneStrain())
    below = make_surface("plane", point=(0, 0, 0), normal=(0, 1, 0))
    assert Contact(model, "b.bottom", below, SLIP).slave_points.at_nodes


@pytest.mark.parametrize(
    ("law", "creeps"),
    [
        (SLIP, 0.0),
        (AdhesionAndFriction(STICK, SLIP), 1.0),
        (PythonLaw(RadialReturn(stiffness=(50.0, 50.0), coefficients=(0.3, 0.3))), 1.0),
    ],
)
@pytest.mark.parametrize("master", ["base.top", PLANE])
def test_without_a_law_of_the_pressure_nothing_penetrates(
    master: Any, law: Any, creeps: float
) -> None:
    """Penetration below 1e-6 of a facet, the default tolerance; friction alone does not creep.

    Adhesion of 50 beside a shear stiffness of 500 over a height of one takes up most of the way.
    The drag tilts what presses a little, by some 1e-5 of the force.
    """
    model = _model()
    contact = _pressed(Contact(model, "block.bottom", master, law), model)
    assert (contact.last.status == 1).all()
    assert np.abs(contact.last.gap).max() < 1e-6 * contact.facet_size
    assert contact.resultant()[0][2] == pytest.approx(10.0 if master is PLANE else 5.0, rel=1e-4)
    slips = np.linalg.norm(contact.last.traction[:, :2], axis=1) / 50.0 * creeps
    stiff = 0.5 * 1e3 / (1.0 if master is PLANE else 2.0)
    expected = 1e-3 / (1.0 + 50.0 / stiff) if creeps else 0.0
    assert slips.mean() == pytest.approx(expected, rel=0.2, abs=1e-15)


def test_a_penalty_that_is_given_holds() -> None:
    """Springs in series, E / L and the penalty: the penetration is 0.01 / 11."""
    model = _model()
    law = ContactLaw(NormalLaw(penalty=1e4), STICK, Friction(coefficients=0))
    contact = _pressed(Contact(model, "block.bottom", PLANE, law), model)
    assert contact.last.gap == pytest.approx(np.full(16, -0.01 / 11.0), rel=1e-6)


def test_multipliers_that_are_given_are_kept() -> None:
    """A tolerance of their own, or cycles, in the place of the default."""
    own = Augmentation(multipliers="uzawa")
    model = _model()
    contact = _pressed(Contact(model, "block.bottom", PLANE, SLIP, augmentation=own), model)
    assert np.abs(contact.last.gap).max() < 1e-6 * contact.facet_size


def test_a_stiff_and_fine_slave_is_told() -> None:
    """A script that takes nodes there, as it does not know materials yet, hears of it."""
    model = _model()
    stiff = {
        name: make_material("linear-elastic", E=e, nu=0.3)
        for name, e in (("block", 1e5), ("base", 1e3))
    }
    contact = Contact(model, "block.bottom", "base.top", SLIP)
    held = {group: dict.fromkeys("xyz", 0.0) for group in ("base.bottom", "block.top")}
    with pytest.warns(ModelWarning, match="as stiff as the master and its facets are smaller"):
        Solver(Problem(model, stiff, [contact]), [Step("rest", 1, held)])
