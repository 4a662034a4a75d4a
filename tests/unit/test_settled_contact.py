"""Contact that is settled within a correction, where bodies answer as their tangent says."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.base.fenicsx import PETSc
from anisocontact.bulk import make_material
from anisocontact.contact import Augmentation, Contact
from anisocontact.contact.multiplier_schemes import USUAL
from anisocontact.interface import ContactLaw
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import BoxSpec, build_box
from anisocontact.rigid import MovingSurface, RigidBody
from anisocontact.solver import Problem, Solver, Step
from anisocontact.solver.strategies.newton import Newton
from anisocontact.solver.strategies.settled_contact import SettledContact
from anisocontact.surfaces import make_surface

METAL = {"E": 1000.0, "nu": 0.3, "yield_stress": 1.0, "hardening": 20.0}
HELD = {"block.bottom": {"x": 0.0, "y": 0.0, "z": 0.0}}


def _pressed(material: str, method: Augmentation | None) -> Problem:
    """A block under a rigid plate that has pressed it beyond yield."""
    model = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 1), (2, 2, 2))})
    plate = RigidBody("plate", (0, 0, 1))
    law = ContactLaw(NormalLaw(penalty=1e5), Adhesion(stiffness=1e5), Friction(coefficients=0.1))
    top = MovingSurface(make_surface("plane", point=(0, 0, 1), normal=(0, 0, -1)), plate)
    contact = Contact(model, "block.top", top, law, augmentation=method)
    numbers = METAL if material == "plastic" else {name: METAL[name] for name in ("E", "nu")}
    problem = Problem(model, {"block": make_material(material, **numbers)}, [contact])
    list(Solver(problem, [Step("press", 2, HELD, motion={"plate": {"z": -0.01}})]).run())
    return problem


@pytest.fixture
def newton() -> Iterator[tuple[Problem, Newton]]:
    """The pressed block at the beginning of an increment in which the plate goes, and a solver."""
    problem = _pressed("plastic", Augmentation())
    problem.begin(Step("let go", 1, HELD, motion={"plate": {"z": 0.05}}))
    problem.set_load_factor(1.0, 1.0)
    solver = Newton(problem, "settled_", {}, lambda *_: None)
    yield problem, solver
    solver.close()


def _correction(problem: Problem, solver: Newton) -> tuple[PETSc.Vec, PETSc.Vec]:
    """The accepted state and what the tangent there asks to subtract."""
    problem.contact_term.take_way(USUAL)
    problem.contact_term.predict(0.0)
    x, right = problem.accepted(), problem.new_vector()
    right.array[:] = problem.evaluate(x)
    matrix, ksp = problem.new_tangent(), solver.snes.getKSP()
    problem.tangent(x, matrix)
    solver.snes.setJacobian(solver._iteration.jacobian, matrix)
    ksp.setOperators(matrix, matrix)
    correction = x.duplicate()
    ksp.solve(right, correction)
    return x, correction


def test_bodies_answer_by_their_last_tangent(newton: tuple[Problem, Newton]) -> None:
    """Requirement: internal forces `-f - K d` of metal that flows, as products with K have them."""
    problem, solver = newton
    _correction(problem, solver)
    bodies, u = problem.assembly.bodies, problem.nodal.copy()
    step = 0.01 * np.random.default_rng(3).normal(size=u.shape)
    change = bodies.bulk.stiffness.createVecRight()
    change.array[:] = step.reshape(-1)
    expected = bodies.internal_force(u) - bodies.bulk.times(change).array_r
    with problem.linearised():
        linear = bodies.internal_force(u + step).copy()
    np.testing.assert_allclose(linear, expected, rtol=0.0, atol=1e-12 * abs(expected).max())
    flows = bodies.internal_force(u + step)
    assert np.linalg.norm(flows - linear) > 0.1 * np.linalg.norm(linear)


def test_contact_that_is_let_go_is_settled(newton: tuple[Problem, Newton]) -> None:
    """All points leave the plate within a correction that the tangent would have them follow.

    Requirement: forces are in balance to rounding with the block as its tangent says, nothing
    touches, and it has sprung back by a small part of the way that the plate goes.
    """
    problem, solver = newton
    x, correction = _correction(problem, solver)
    pulled = correction.norm()
    settled = SettledContact(problem, solver.snes)
    assert settled.pays
    assert settled.settle(x, correction)
    assert not problem.contact_term.touch()
    assert problem.balance.norm < 1e-12
    assert correction.norm() < 0.1 * pulled


def test_points_that_keep_their_status_are_left_alone(newton: tuple[Problem, Newton]) -> None:
    """Nothing changes in a correction that leaves all points as they are."""
    problem, solver = newton
    problem.set_load_factor(0.003, 1.0)
    x, correction = _correction(problem, solver)
    before = correction.copy()
    assert not SettledContact(problem, solver.snes).settle(x, correction)
    before.axpy(-1.0, correction)
    assert before.norm() == 0.0


@pytest.mark.parametrize(
    ("material", "method", "pays"),
    [
        ("plastic", Augmentation(), True),
        ("plastic", None, False),
        ("neo-hookean", Augmentation(), False),
    ],
)
def test_where_it_pays(material: str, method: Augmentation | None, pays: bool) -> None:
    """Multipliers on metal; with penalties it costs more than it gains."""
    problem = _pressed(material, method)
    newton = Newton(problem, "pays_", {}, lambda *_: None)
    assert SettledContact(problem, newton.snes).pays is pays
    newton.close()


def test_trials_apart_leave_no_trace(newton: tuple[Problem, Newton]) -> None:
    """Multipliers, and which points slide to and fro, are as they were before trials apart."""
    problem, solver = newton
    x, correction = _correction(problem, solver)
    (trials,) = problem.contact_term._trials
    reversals = trials._changes.reversals
    known, marks = reversals._last, problem.contact_term.marks()
    assert known is not None
    with problem.contact_term.apart():
        assert reversals._last is None
        x.axpy(-1.0, correction)
        problem.evaluate(x)
        assert problem.contact_term.marks()[0][0] is not marks[0][0]
    assert reversals._last is known
    assert problem.contact_term.marks()[0][0] is marks[0][0]
