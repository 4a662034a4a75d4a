"""Contacts and rigid bodies have a history, which is that of one problem."""

from __future__ import annotations

import copy
import pickle

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.base.errors import InputError
from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.laws import Friction
from anisocontact.mesh import BoxSpec, build_box
from anisocontact.rigid import MovingSurface, RigidBody
from anisocontact.solver import Problem, Solver, Step
from anisocontact.surfaces import make_surface

STEPS = [
    Step("press", 1, {"block.top": {"x": 0.0, "y": 0.0, "z": -0.02}}),
    Step("drag", 1, {"block.top": {"x": 0.05}}),
]


def _problems(count: int, plate: RigidBody | None = None) -> tuple[Contact, list[Problem]]:
    model = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 0.5), (2, 2, 1))})
    plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    master = plane if plate is None else MovingSurface(plane, plate)
    contact = Contact(model, "block.bottom", master, Friction(coefficients=0.3))
    rubber = {"block": make_material("neo-hookean", E=10.0, nu=0.3)}
    return contact, [Problem(model, rubber, [contact]) for _ in range(count)]


def test_a_contact_goes_on_in_its_own_problem():
    """Requirement: a problem does not start from where another one has dragged the contact to.

    Its displacements are zero, but the slip of its contact was not: forces were off by 6e-5 of
    those of a contact of its own, without a word.
    """
    contact, (one, other) = _problems(2)
    for _ in Solver(one, STEPS).run():
        pass
    force = contact.resultant()[0]
    with pytest.raises(InputError, match=r"contact 'block\.bottom': it has the history of another"):
        list(Solver(other, STEPS).run())
    assert np.array_equal(contact.resultant()[0], force)
    list(Solver(one, [Step("lift", 1, {"block.top": {"z": 0.01}})]).run())
    assert not contact.last.pressure.any()


def test_a_problem_that_was_never_solved_leaves_the_contact_free():
    """Requirement: what is no history is none: the second of two problems may be the first."""
    contact, (_, other) = _problems(2)
    list(Solver(other, STEPS).run())
    assert contact.resultant()[0][2] > 0.0


def test_a_contact_of_another_mesh_is_refused():
    """Requirement: a contact is of the mesh of its problem, also where both have as many nodes.

    One of a block of a quarter of the area gave three quarters of the force, without a word.
    """
    models = [
        build_box({"block": BoxSpec((0, 0, 0), (size, size, 1), (2, 2, 1))}) for size in (1.0, 2.0)
    ]
    plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    rubber = {"block": make_material("neo-hookean", E=10.0, nu=0.3)}
    made = [Contact(model, "block.bottom", plane, Friction(coefficients=0.3)) for model in models]
    with pytest.raises(InputError, match=r"contact 'block\.bottom': it was made on another model"):
        Problem(models[1], rubber, made[:1])
    assert Problem(models[1], rubber, made[1:]).contacts == (made[1],)


def test_a_rigid_body_goes_on_in_its_own_problem():
    """Requirement: the same of its pose: a plate that had moved began where it was.

    Forces were off by 3e-3, without a word.
    """
    plate = RigidBody("plate", (0, 0, 0))
    (_, (one,)), (_, (other,)) = _problems(1, plate), _problems(1, plate)
    steps = [
        Step("press", 1, {"block.top": dict.fromkeys("xyz", 0.0)}, motion={"plate": {"z": 0.02}}),
        Step("drag", 1, motion={"plate": {"x": 0.05}}),
    ]
    list(Solver(one, steps).run())
    with pytest.raises(InputError, match="rigid body 'plate': it has the history of another"):
        list(Solver(other, steps).run())


@pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy, pickle.dumps])
def test_what_has_a_history_is_not_copied(copied):
    """Requirement: a branch of a run is no copy of it, which would go on with the same history.

    `copy.copy` of a problem moved the displacements and the contacts of the first one: what was
    solved with that afterwards was off by half, without a word. The others spoke of a mesh of C++.
    """
    contact, (problem, _) = _problems(2)
    for one in (contact, problem, Solver(problem, STEPS)):
        with pytest.raises(TypeError, match=f"{type(one).__name__} is not copied, as the"):
            copied(one)
