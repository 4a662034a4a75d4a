"""Rigid bodies: rotations, poses, and what is refused."""

import numpy as np
import pytest

from anisocontact.base.errors import InputError

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.rigid import MovingSurface, RigidBody, rotation, rotation_vector, skew, spin_of
from anisocontact.rigid.rotation import orthonormal
from anisocontact.solver import Problem, Solver, Step, Turn

TURN = Turn((0, 0, 1), 0.1)
VECTORS = [np.array(v) for v in ([0, 0, 0], [1e-9, 0, 2e-9], [6e-3, 8e-3, 0], [0.3, -1, 2])]


@pytest.mark.parametrize("v", VECTORS, ids=str)
def test_rotation_against_the_exponential(v):
    """exp([v]) by scipy; [v] w = v x w; the spin is the derivative of the exponential."""
    from scipy.linalg import expm

    assert np.allclose(skew(v) @ [1.0, 2.0, 3.0], np.cross(v, [1.0, 2.0, 3.0]), atol=1e-15)
    r = rotation(v)
    assert np.allclose(r, expm(skew(v)), atol=1e-14)
    h, direction = 1e-6, np.array([0.2, 0.5, -0.4])
    change = (rotation(v + h * direction) - rotation(v - h * direction)) / (2.0 * h)
    assert np.allclose(change @ r.T, skew(spin_of(v) @ direction), atol=1e-9)


@pytest.mark.parametrize("axis", [(1, 0, 0), (0, 0, -1), (1, -2, 3), (-1, -1e-3, 0)])
@pytest.mark.parametrize("angle", [0.0, 1e-8, 1.0, np.pi / 2, 3.0, np.pi - 1e-9, np.pi])
def test_rotation_vector_is_the_inverse(axis, angle):
    """Also near half a turn, where the axis can be reversed."""
    v = angle * np.array(axis, dtype=float) / np.linalg.norm(axis)
    found = rotation_vector(rotation(v))
    assert np.allclose(rotation(found), rotation(v), atol=1e-14)
    assert np.linalg.norm(found) <= np.pi + 1e-12
    if angle < 3.1:
        assert np.allclose(found, v, atol=1e-12)


def test_orthonormal_takes_rounding_away():
    noise = 1e-8 * np.random.default_rng(1).standard_normal((3, 3))
    r = orthonormal(rotation(VECTORS[3]) + noise)
    assert np.abs(r.T @ r - np.eye(3)).max() < 1e-15


def test_points_and_vectors():
    """A point of the body goes to c + d + R (X - c), and back."""
    body = RigidBody("die", (1, 2, 3))
    body.move(x=0.5, rz=np.pi / 2)
    there = np.array([[1.5, 3.0, 3.0]])
    assert np.allclose(body.to_body(there), [[2.0, 2.0, 3.0]])
    assert np.allclose(body.to_space(np.array([1.0, 0.0, 0.0])), [0.0, 1.0, 0.0])
    assert body.position.tolist() == [1.5, 2.0, 3.0]


def test_turns_add_up():
    """About x, then about the z axis of space: R = R_z R_x; the turn is the sum."""
    body = RigidBody("die", (0, 0, 0))
    body.move(rx=0.7)
    body.commit()
    body.move(rz=0.4)
    body.commit()
    expected = rotation(np.array([0, 0, 0.4])) @ rotation(np.array([0.7, 0, 0]))
    assert np.allclose(body.accepted.rotation, expected, atol=1e-15)
    assert body.accepted.turn.tolist() == [0.7, 0.0, 0.4]


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ({"name": ""}, "name: '' given, a name without a dot"),
        ({"name": "a.b"}, "name: 'a.b' given, a name without a dot"),
        ({"reference": (0, 1)}, "reference: .* needs three finite numbers"),
        ({"reference": (0, 1, np.nan)}, "reference: .* needs three finite numbers"),
        ({"springs": {"z": -1.0}}, "springs.z: -1.0 given, must be >= 0"),
        ({"springs": {"z": np.inf}}, "springs.z: inf given, must be >= 0"),
        ({"springs": {"u": 1.0}}, "springs.u: no component 'u', allowed: x, y, z, rx, ry, rz"),
        ({"springs": {"z": 1.0}, "free": False}, "springs: given for a body that is not free"),
    ],
)
def test_refused_bodies(arguments, text):
    given = {"name": "die", "reference": (0, 0, 0), "free": True} | arguments
    with pytest.raises(InputError, match=text):
        RigidBody(given.pop("name"), given.pop("reference"), **given)


def test_refused_motion():
    with pytest.raises(InputError, match="no component 'u', allowed: x, y"):
        RigidBody("die", (0, 0, 0)).move(u=1.0)


@pytest.mark.parametrize(
    ("step", "text"),
    [
        ({"motion": {"punch": {"z": 1.0}}}, r"motion: no contact has a rigid body 'punch', .* die"),
        ({"rotation": {"punch": TURN}}, r"rotation: no contact has a rigid body 'punch', .* die"),
        ({"load": {"punch": {"z": 1.0}}}, r"load: no contact has a rigid body 'punch', .* die"),
        (
            {"motion": {"die": {"u": 1.0}}},
            r"motion.die.u: 1.0 given, .* no such motion; allowed: x, y, z, rx",
        ),
        ({"load": {"die": {"z": 1.0}}}, r"load.die.z: z is fixed; a load acts on a component"),
        ({"motion": {"fixed": {"z": None}}}, r"motion.fixed.z: the rigid body was not made free"),
        (
            {"motion": {"die": {"z": 1.0}}, "load": {"die": {"z": 1.0}}},
            r"load.die.z: z is fixed; a load acts on a component that motion frees",
        ),
    ],
)
def test_refused_steps(fe, step, text):
    """Before anything is solved."""
    from anisocontact.contact import Contact

    die, fixed = RigidBody("die", (0, 0, 0), free=True), RigidBody("fixed", (0, 0, 0))
    block = fe.block(fe.interface(), body=die)
    above = fe.interface(point=(0, 0, 0.6), normal=(0, 0, -1))
    other = Contact(block.model, "block.top", MovingSurface(above, fixed), mortar=False)
    problem = Problem(block.model, {"block": block.material}, [block.contact, other])
    with pytest.raises(InputError, match=text):
        Solver(problem, [Step("s", 1, **step)])


@pytest.mark.parametrize(
    ("step", "text"),
    [
        ({"motion": {"die": {"z": "down"}}}, r"step 's'.motion.die.z: 'down' given"),
        ({"load": {"die": {"z": None}}}, r"step 's'.load.die.z: None given, needs a finite number"),
        ({"load": {"die": {"z": np.inf}}}, r"step 's'.load.die.z: inf given"),
        (
            {"rotation": {"die": TURN}, "motion": {"die": {"z": 0.0}}},
            r"rotation.die: given with a m",
        ),
    ],
)
def test_refused_values(step, text):
    with pytest.raises(InputError, match=text):
        Step("s", 1, **step)


def test_two_bodies_of_one_name(fe):
    from anisocontact.contact import Contact

    block = fe.block(fe.interface(), body=RigidBody("die", (0, 0, 0)))
    above = fe.interface(point=(0, 0, 0.6), normal=(0, 0, -1))
    other = Contact(
        block.model, "block.top", MovingSurface(above, RigidBody("die", (0, 0, 1))), mortar=False
    )
    with pytest.raises(InputError, match="two rigid bodies have the name 'die'"):
        Problem(block.model, {"block": block.material}, [block.contact, other])


def test_one_body_for_two_contacts(fe):
    """A body with two surfaces: resultants add up, one motion moves both."""
    from anisocontact.contact import Contact

    die = RigidBody("die", (0.5, 0.5, 0.25))
    block = fe.block(fe.interface(point=(0, 0, 0.01)), body=die)
    above = fe.interface(point=(0, 0, 0.45), normal=(0, 0, -1))
    other = Contact(block.model, "block.top", MovingSurface(above, die), mortar=False)
    problem = Problem(block.model, {"block": block.material}, [block.contact, other])
    sides = {f"block.{side}": {"x": 0.0, "y": 0.0} for side in ("left", "right", "front", "back")}
    solver = Solver(problem, [Step("s", 2, sides, motion={"die": {"x": 0.001, "z": 0.02}})])
    list(solver.run())
    forces = [contact.resultant(die.position) for contact in (block.contact, other)]
    total = np.concatenate(forces[0]) + np.concatenate(forces[1])
    assert np.allclose(problem.rigid.support(die), total, atol=1e-12)
    assert forces[0][0][2] > 0.0 > forces[1][0][2]


def test_a_script_moves_bodies_and_frees_none(fe):
    from anisocontact.base.fenicsx import fem, ufl
    from anisocontact.solver import ContactProblem

    die = RigidBody("die", (0.5, 0.5, 0.0))
    block = fe.block(fe.interface(), body=die)
    space = block.model.space
    u, v = fem.Function(space), ufl.TestFunction(space)
    form = ufl.inner(block.material.stress(u), ufl.sym(ufl.grad(v))) * ufl.dx
    top = fem.locate_dofs_topological(space, 2, block.model.facets("block.top"))
    bcs = [fem.dirichletbc(np.zeros(3), top, space)]
    problem = ContactProblem(form, u, bcs=bcs, contacts=[block.contact])
    die.move(z=0.01)
    problem.solve()
    problem.close()
    assert die.accepted.translation[2] == 0.01
    assert block.contact.resultant()[0][2] > 0.0
    loose = fe.block(fe.interface(), body=RigidBody("die", (0, 0, 0), free=True))
    with pytest.raises(InputError, match="rigid body 'die' is free; a script can only move it"):
        ContactProblem(form, u, bcs=bcs, contacts=[_on(loose, space)])


def _on(block, space):
    """The contact as one of another space, whose body is checked all the same."""
    from anisocontact.mesh.node_unknowns import NodeUnknowns

    vars(block.contact)["unknowns"] = NodeUnknowns(space)
    return block.contact
