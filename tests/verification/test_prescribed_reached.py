"""Prescribed displacements are met whatever forces are at work."""

import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

import numpy as np

from anisocontact import Adhesion, Friction, Interface, NormalLaw, make_surface
from anisocontact.base.fenicsx import MPI
from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.mesh import BoxSpec, build_box
from anisocontact.rigid import RigidBody
from anisocontact.solver import CoupledFace, Problem, Solver, Step
from anisocontact.solver.system.force_balance import Magnitudes, closed
from anisocontact.solver.system.prescribed_reached import prescribed_reached

HELD = dict.fromkeys("xyz", 0.0)
#: What lifts the top of a block, length, beside another one that is pressed by a tenth of a length.
LIFT = 1e-10


def top(strategy, *, displacement=None, coupled=(), motion=None):
    """How far the top of a block of E = 1 is lifted after one beside it was pressed by 0.1."""
    boxes = {name: BoxSpec((x, 0, 0), (1, 1, 1), (1, 1, 1)) for name, x in (("a", 0), ("b", 2))}
    material = make_material("linear-elastic", E=1.0, nu=0.0)
    problem = Problem(build_box(boxes), {"a": material, "b": material}, coupled=coupled)
    held = {"a.bottom": HELD, "b.bottom": HELD}
    rest = {name: dict.fromkeys(values, 0.0) for name, values in (motion or {}).items()}
    press = Step("press", 1, held, pressure={"b.top": 0.1}, motion=rest)
    lift = Step("lift", 1, displacement or {}, motion=motion or {})
    assert len(list(Solver(problem, [press, lift], strategy=strategy).run())) == 2
    x, u = problem.model.positions, problem.u.x.array.reshape(-1, 3)
    return u[(x[:, 0] < 1.5) & (x[:, 2] == 1.0), 2]


@pytest.mark.parametrize("strategy", ["direct", "iterative"])
def test_group_beside_a_large_force(strategy):
    """Requirement: what is prescribed is where it is prescribed when an increment is accepted.

    Beside the forces at work the top is where it is to be before it moves. Reference: the value
    that is given. Tolerance: 1e-5, rounding of the largest displacement, 0.1, over the one given.
    """
    lifted = {"a.top": HELD | {"z": LIFT}}
    assert top(strategy, displacement=lifted) == pytest.approx(LIFT, rel=1e-5)


def test_face_on_a_rigid_body_beside_a_large_force():
    """Requirement: the same of the motion of a rigid body, and of the nodes that follow it."""
    head = RigidBody("head", (0.5, 0.5, 1.0), free=True)
    motion = {"head": dict.fromkeys(("x", "y", "rx", "ry", "rz"), 0.0) | {"z": LIFT}}
    lifted = top("direct", coupled=[CoupledFace("a.top", head)], motion=motion)
    assert lifted == pytest.approx(LIFT, rel=1e-5)
    assert head.accepted.values[2] == pytest.approx(LIFT, rel=1e-5)


def iterations(strategy, scale):
    """Of a block let back to zero and kept there, after it was pressed on a floor.

    Args:
        strategy: How the equations are solved.
        scale: Edge of the block, length; the floor is a twentieth of it below.
    """
    model = build_box({"a": BoxSpec((0, 0, 0), (scale,) * 3, (3, 3, 3))})
    plane = make_surface("plane", point=(0, 0, -0.05 * scale), normal=(0, 0, 1))
    stick, slip = Adhesion(stiffness=(9.0, 9.0)), Friction(coefficients=(0.3, 0.3))
    floor = Interface(plane, NormalLaw(penalty=9.0), stick, slip)
    problem = Problem(
        model,
        {"a": make_material("linear-elastic", E=scale, nu=0.3)},
        [Contact(model, "a.bottom", floor)],
    )
    press = Step("press", 1, {"a.top": HELD | {"z": -0.1 * scale}})
    rest = Step("rest", 4, {"a.top": HELD})
    return [one.iterations for one in Solver(problem, [press, rest], strategy=strategy).run()]


@pytest.mark.parametrize("scale", [1.0, 1e-6])
@pytest.mark.parametrize("strategy", ["direct", "condensed", "iterative"])
def test_linear_body_let_back_to_zero(strategy, scale):
    """Requirement: where all forces go to zero, what rounding has left of them is in balance.

    The contact opens on the way, and the equations are linear then: one correction, of a Krylov
    method up to three. Compared with nothing but itself rounding would never be small. In two
    units.
    """
    _, *back = iterations(strategy, scale)
    assert len(back) == 4
    assert max(back) <= 3


@pytest.mark.parametrize(("off", "reached"), [(1e-16, True), (1e-13, False)])
def test_all_that_goes_back_to_zero(off, reached):
    """Requirement: where all displacements are rounding, that of a mesh of size 1 is near enough.

    There is nothing else to compare with: such a step would be cut again and again. Bound:
    3.6e-15, sixteen times the precision of a number.
    """
    there = np.array([off, 0.0])
    assert prescribed_reached(there, there, MPI.COMM_SELF, 1.0, there, there).prescribed is reached


@pytest.mark.parametrize(("away", "small"), [(1e4, True), (1e13, False)])
def test_rounding_of_bodies_that_are_gone(away, small):
    """Requirement: forces out of balance are none that bodies far beyond all that leads them round.

    A residual of 1 where Young's modulus makes forces of 1e16 of the displacements, which leaves as
    much to rounding: a body that is 1 long and led by 2 may be there, but not 1e13 away.
    """
    led, there = np.array([2.0]), np.array([away])
    reached = prescribed_reached(np.zeros(1), led, MPI.COMM_SELF, 1.0, there, np.zeros(1))
    sizes = Magnitudes(0.0, [1.0], 1e16)
    found = closed(np.ones(1), sizes, MPI.COMM_SELF, failed=False, correction=None, reached=reached)
    (field,) = found.of_fields(1.0)
    assert field.small(1e-8, 0.0) is small
    assert "more than all is long" in found.explained(1.0) or small
