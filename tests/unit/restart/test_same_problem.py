"""A state of a script goes on in the problem that it is one of; of another one it says which."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.anisotropy import make_directions
from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import fem, ufl
from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.interface import ContactLaw, PythonLaw
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import BoxSpec, Model, build_box
from anisocontact.rigid import MovingSurface, RigidBody
from anisocontact.solver import ContactProblem, Problem, Solver, Step
from anisocontact.surfaces import make_surface


class Spring:
    """Adhesion without friction."""

    internal = 0

    def __init__(self, stiffness=1e2):
        self.stiffness, self.asked = stiffness, 0

    def update(self, state, kinematics):
        from anisocontact.interface import LawResult

        self.asked += 1
        n, one = len(kinematics.pressure), np.tile(np.eye(2), (len(kinematics.pressure), 1, 1))
        t = state.traction - self.stiffness * kinematics.increment
        return LawResult(
            traction=t, slip=np.zeros((n, 2)), d_increment=-self.stiffness * one,
            d_pressure=np.zeros((n, 2)), d_traction=one, d_elastic=0.0 * one,
            internal=state.internal, dissipation=np.zeros(n), energy=np.zeros(n))  # fmt: skip


PARTS = {
    "top": 1.0,
    "cells": (1, 1, 1),
    "order": 1,
    "radius": 9.0,
    "mu": (0.3, 0.1),
    "along": (1, 0, 0),
    "stiffness": 1e3,
    "mortar": False,
    "name": "sole",
    "springs": None,
}


def _of_order(model, order):
    groups = {name: model.facets(name) for name in model.facet_names()}
    return Model(model.mesh, {"pad": model.cells("pad")}, groups, order)


def _contact(parts):
    size = BoxSpec((0, 0, 0), (1, 1, parts["top"]), parts["cells"])
    model = _of_order(build_box({"pad": size}), parts["order"])
    along = make_directions("constant", vector=parts["along"])
    friction = Friction(coefficients=parts["mu"], directions=along)
    law = ContactLaw(NormalLaw(penalty=1e3), Adhesion(stiffness=parts["stiffness"]), friction)
    if parts["springs"] is not None:
        law = ContactLaw(NormalLaw(penalty=1e3), PythonLaw(Spring(parts["springs"])))
    ball = make_surface("sphere", centre=(0.5, 0.5, -9), radius=parts["radius"])
    body = RigidBody("ball", (0.5, 0.5, -9))
    master = MovingSurface(ball, body)
    options = {"mortar": parts["mortar"], "name": parts["name"]}
    return model, Contact(model, "pad.bottom", master, law, **options), body


def _script(parts):
    model, contact, body = _contact(parts)
    u, v = fem.Function(model.space), ufl.TestFunction(model.space)
    form = 100.0 * ufl.inner(ufl.sym(ufl.grad(u)), ufl.sym(ufl.grad(v))) * ufl.dx
    down = fem.Constant(model.mesh, (0.02, 0.0, -0.03))
    bc = fem.dirichletbc(down, model.nodes("pad.top"), model.space)
    return ContactProblem(form, u, bcs=[bc], contacts=[contact]), body, contact


CHANGES = {
    "law": (
        {"mu": (0.3, 0.2)},
        r"contact\[0\].law.adhesion.friction.coefficients\[1\]: 0.2 given, .* 0.1$",
    ),
    "axis": ({"along": (0, 1, 0)}, r"contact\[0\].law.*directions.vector\[0\]: 0.0 given, .*1.0$"),
    "adhesion": ({"stiffness": 9.0}, r"stiffness.*: 9.0 given, .*1000.0$"),
    "own law": ({"springs": 1e2}, r"contact\[0\].law.adhesion.*python law"),
    "surface": ({"radius": 8.9}, r"contact\[0\].master.surface.radius: 8.9 given, .* with 9.0$"),
    "where": ({"mortar": True}, r"contact\[0\].mortar: True given, .*False$"),
    "name": ({"name": "other"}, r"contacts\[0\]: 'other' given, .*'sole'$"),
    "place": ({"top": 1.5}, r"4 of 8 nodes are not where the state has them, as one at \(.*1.5\)"),
    "count": ({"cells": (2, 1, 1)}, r"a problem with 8 nodes, there are 12$"),
    "order": ({"order": 2}, r"a problem with 8 nodes, there are 27$"),
}


@pytest.mark.parametrize("change", CHANGES)
def test_a_state_of_another_problem_is_one_line(change, tmp_path):
    """Requirement: nothing of the state is taken, and the line names what differs."""
    new, said = CHANGES[change]
    path = tmp_path / "state.npz"
    _script(PARTS)[0].save(path)
    other, *_ = _script(PARTS | new)
    other.u.x.array[:] = 0.5
    with pytest.raises(InputError, match=rf"^path: '.*state.npz': .*{said}"):
        other.restore(path)
    assert (other.u.x.array == 0.5).all()


def test_an_own_law_is_the_one_it_was_made(tmp_path):
    """Requirement: its parameters count, what it counts does not."""
    path, parts = tmp_path / "state.npz", PARTS | {"springs": 1e2}
    first, _, contact = _script(parts)
    first.solve()
    first.save(path)
    again, _, slave = _script(parts)
    again.restore(path)
    assert np.array_equal(slave.resultant()[0], contact.resultant()[0])
    with pytest.raises(InputError, match=r"law.adhesion.law.stiffness: 50.0 given, .*100.0$"):
        _script(PARTS | {"springs": 50.0})[0].restore(path)


def test_rigid_bodies_are_where_they_were(tmp_path):
    """Requirement: a step after a state is that of a script which was not stopped.

    Source: the same steps in one go, the same bits.
    """
    path = tmp_path / "state.npz"
    found = []
    for stopped in (False, True):
        problem, body, contact = _script(PARTS)
        problem.solve()
        body.move(z=0.01, rz=0.1)
        problem.solve()
        if stopped:
            problem.save(path)
            problem, body, contact = _script(PARTS)
            problem.restore(path)
            assert body.accepted.values.tolist() == [0.0, 0.0, 0.01, 0.0, 0.0, 0.1]
        body.move(x=0.01)
        problem.solve()
        found.append(contact.resultant()[0])
    assert np.array_equal(*found)
    assert found[0][2] > 1.0


@pytest.mark.parametrize("free", [False, True])
def test_bodies_are_free_as_they_were(free):
    """Requirement: what later steps free, or free no more, is named with its body."""

    def solver(free):
        model, *_ = _contact(PARTS)
        ball = make_surface("sphere", centre=(0.5, 0.5, -9), radius=9.0)
        body = RigidBody("ball", (0.5, 0.5, -9), free=free)
        law = Friction(coefficients=0.3)
        slave = Contact(model, "pad.bottom", MovingSurface(ball, body), law)
        step = Step("press", 1, {"pad.top": {"x": 0.0, "y": 0.0, "z": -0.01}})
        material = make_material("linear-elastic", E=100.0, nu=0.3)
        return Solver(Problem(model, {"pad": material}, [slave]), [step])

    was, is_now = ("held in all steps", "free in a step")[:: -1 if free else 1]
    with pytest.raises(InputError, match=f"^rigid.ball: {is_now}, {was} of the run"):
        solver(not free).restore(solver(free).persistent())


def test_cells_are_those_of_the_state(tmp_path):
    """Requirement: nodes at the same places with other cells between them are another mesh."""
    path = tmp_path / "state.npz"
    _script(PARTS)[0].save(path)
    arrays = dict(np.load(path))
    np.savez(path, **arrays | {"numbering": arrays["numbering"][::-1]})
    with pytest.raises(InputError, match="a mesh with other cells, or on other processes"):
        _script(PARTS)[0].restore(path)
    np.savez(path, u=arrays["u"])
    with pytest.raises(InputError, match=r"of this version: it has no 'numbering'"):
        _script(PARTS)[0].restore(path)


def _run(parts=PARTS, young=1e3, last=-0.03, first=-0.02):
    model, contact, _ = _contact(parts)
    steps = [
        Step(name, 1, {"pad.top": {"x": 0.0, "y": 0.0, "z": down}})
        for name, down in (("press", first), ("further", last))
    ]
    steel = make_material("linear-elastic", E=young, nu=0.3)
    return Solver(Problem(model, {"pad": steel}, [contact]), steps)


RUNS = {
    "law": ({"parts": PARTS | {"mu": (0.3, 0.2)}}, r"friction.coefficients\[1\]: 0.2 given"),
    "mesh": ({"parts": PARTS | {"top": 1.5}}, "4 of 8 nodes are not where the state has them"),
    "material": ({"young": 2e3}, r"^materials\.pad\..*: 2000.0 given, .*1000.0$"),
    "step": ({"first": -0.01}, r"^steps\[0\]\.displacement\.pad\.top\.z: -0.01 given, .*-0.02$"),
}


@pytest.mark.parametrize("change", RUNS)
def test_a_run_of_another_problem_is_one_line(change):
    """Requirement: `Solver.restore` as well; steps that had not begun may be others."""
    solver = _run()
    next(iter(solver.run()))
    kept = solver.persistent()
    new, said = RUNS[change]
    with pytest.raises(InputError, match=said):
        _run(**new).restore(kept)
    for part in ("common", "nodal"):
        before = {n: v for n, v in getattr(kept, part).items() if n not in ("problem", "position")}
        with pytest.raises(InputError, match=r"^no state of this version"):
            _run().restore(replace(kept, **{part: before}))
    other = _run(last=-0.04)
    other.restore(replace(kept, common=dict(kept.common)))
    assert [accepted.step for accepted in other.run()] == ["further"]


def test_a_slave_of_one_point_is_where_it_was():
    """Requirement: what rounding is counts on the size of the mesh; one point has none itself.

    On another number of processes positions differ by rounding, and one of them was refused.
    """

    def made():
        model = _of_order(build_box({"pad": BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1))}), 1)
        floor = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
        law = ContactLaw(
            NormalLaw(penalty=1e3), Adhesion(stiffness=1e3), Friction(coefficients=0.3)
        )
        contact = Contact(model, "pad.bottom", floor, law, degree=1)
        steel = make_material("linear-elastic", E=1e3, nu=0.3)
        down = Step("press", 2, {"pad.top": {"x": 0.0, "y": 0.0, "z": -0.01}})
        return Solver(Problem(model, {"pad": steel}, [contact]), [down])

    solver = made()
    next(iter(solver.run()))
    kept = solver.persistent()
    (point,) = kept.points
    moved = [point | {"reference": point["reference"] + 1e-16}]
    made().restore(replace(kept, points=moved))
    moved = [point | {"reference": point["reference"] + 1e-6}]
    with pytest.raises(InputError, match="1 of 1 slave points are not where the state has them"):
        made().restore(replace(kept, points=moved))
