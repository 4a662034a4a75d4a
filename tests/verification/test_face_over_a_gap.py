"""A face that follows a reference point, whose load brings its body down onto a master."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.laws import Friction
from anisocontact.mesh import Axisymmetric, Body, BoxSpec, build_box, build_mesh, make_shape
from anisocontact.rigid import RigidBody
from anisocontact.solver import CoupledFace, Problem, Solver, Step
from anisocontact.solver.terms.face_loads import add_face_loads
from anisocontact.surfaces import make_surface

GAP, FORCE = 0.01, 1.8
DOWN = Step("load", 2, motion={"head": {"z": None}}, load={"head": {"z": -FORCE}})


def _head(material):
    """A block over a ball, whose upper face follows a reference point."""
    model = build_box({"block": BoxSpec((-0.5, -0.5, 0.0), (1, 1, 0.6), (2, 3, 2))})
    ball = make_surface("sphere", centre=(0, 0, -3 - GAP), radius=3)
    contact = Contact(model, "block.bottom", ball, Friction(coefficients=0.3))
    head = RigidBody("head", (0.0, 0.0, 0.6), free=True)
    materials = {"block": make_material(material, E=1000.0, nu=0.3)}
    coupled = [CoupledFace("block.top", head)]
    return contact, head, Problem(model, materials, [contact], coupled=coupled)


@pytest.mark.filterwarnings("ignore::anisocontact.base.errors.RunWarning")
@pytest.mark.parametrize("material", ["linear-elastic", "neo-hookean"])
def test_a_load_on_a_reference_point_closes_the_gap(material):
    """Requirement: the body comes down as under the same force on its face; the work of the load on
    the way is counted.

    Source: what keeps a body in reach goes by the loads on it, and knew none on reference points:
    the block was thrown through the ball, and came to rest on it after 1370 corrections and three
    cuts with a force of a sixtieth. Tolerance: 9 and 8 corrections in each increment and 2 on the
    way out; F times the gap is the work of the way through the air, the block itself gives way by
    less than a tenth of it.
    """
    contact, head, problem = _head(material)
    accepted = list(Solver(problem, [DOWN]).run())
    assert [one.done for one in accepted] == [1.0, 1.0]
    assert sum(one.iterations for one in accepted) <= 25
    assert contact.resultant()[0] == pytest.approx([0, 0, FORCE], abs=1e-6 * FORCE)
    assert head.accepted.values[2] < -GAP
    work = accepted[-1].energies["external"]
    assert 0.5 * FORCE * GAP < work < 1.5 * FORCE * GAP


def test_forces_on_the_nodes_are_the_load():
    """Requirement: together they are the force, and the moment about the reference point.

    Source: definition. Tolerance: rounding.
    """
    _, _, problem = _head("linear-elastic")
    (face,) = next(iter(problem.rigid.coupled.values()))
    wrench, out = np.array([1.0, -2.0, 3.0, 0.4, 0.5, -0.6]), np.zeros(problem.nodal.shape)
    add_face_loads([face], wrench, out, problem.comm)
    assert face.wrench(out[face.nodes]) == pytest.approx(wrench, abs=1e-12)
    assert np.count_nonzero(out.any(axis=1)) == len(face.nodes)


def test_nodes_take_what_they_can():
    """Requirement: of a body of revolution they take the force along its axis, and nothing else."""
    block = make_shape("rectangle", origin=(0, 0), size=(1, 1), cells=(2, 2))
    model = build_mesh([Body("block", block)], idealisation=Axisymmetric())
    head = RigidBody("head", (0.0, 1.0, 0.0), free=True)
    plane = make_surface("plane", point=(0, -GAP, 0), normal=(0, 1, 0))
    contact = Contact(model, "block.bottom", plane, Friction(coefficients=0.3))
    materials = {"block": make_material("linear-elastic", E=1000.0, nu=0.3)}
    coupled = [CoupledFace("block.top", head)]
    problem = Problem(model, materials, [contact], coupled=coupled)
    (face,) = next(iter(problem.rigid.coupled.values()))
    out = np.zeros(problem.nodal.shape)
    add_face_loads([face], np.array([0.0, -2.0, 0.0, 0.0, 0.0, 0.0]), out, problem.comm)
    assert face.wrench(out[face.nodes]) == pytest.approx([0, -2, 0, 0, 0, 0], abs=1e-12)
