"""Prescribed motion of rigid surfaces: relative motion counts, and nothing else."""

import numpy as np
import pytest

PRESS, DRAG = -0.01, np.array([0.02, 0.015])
TIGHT = {"snes_rtol": 1e-12}


def turned(angle, axis):
    from anisocontact.rigid import rotation

    return rotation(angle * np.asarray(axis) / np.linalg.norm(axis))


def test_moving_the_plane_is_moving_the_block(fe):
    """Plane moved by -u under a held block, block moved by u over a held plane: same tractions.

    Requirement: 1e-9 of the largest traction, stick and slip, anisotropic. Source: only relative
    motion enters a contact, and the block is elastic at small strain. Tolerance: that of Newton,
    1e-12 of the forces.
    """
    from anisocontact.rigid import RigidBody
    from anisocontact.solver import Step

    x, y = DRAG
    moved = fe.block(fe.interface(angle=0.5, adhesion_angle=0.2))
    moved.run(
        Step("press", 2, {"block.top": {"x": 0.0, "y": 0.0, "z": PRESS}}),
        Step("drag", 5, {"block.top": {"x": x, "y": y}}),
        **TIGHT,
    )
    die = RigidBody("die", (0.2, 0.1, 0.0))
    under = fe.block(fe.interface(angle=0.5, adhesion_angle=0.2), body=die)
    under.run(
        Step(
            "press", 2, {"block.top": {"x": 0.0, "y": 0.0, "z": 0.0}}, motion={"die": {"z": -PRESS}}
        ),
        Step("drag", 5, motion={"die": {"x": -x, "y": -y}}),
        **TIGHT,
    )
    expected = moved.contact.last.traction
    assert set(moved.contact.last.status.tolist()) == {1, 2} or moved.contact.counts()["slip"] > 0
    assert np.abs(under.contact.last.traction - expected).max() < 1e-9 * np.abs(expected).max()
    for name, value in moved.problem.energies().items():
        assert under.problem.energies()[name] == pytest.approx(
            value, rel=1e-8, abs=1e-10 * moved.problem.energies()["elastic"]
        )


def shift(block, motion, about):
    """Nodal displacements of a rigid motion of the whole mesh: x -> c + d + R (x - c)."""
    from anisocontact.contact.facet_mesh import node_positions

    rotation, translation = motion
    nodes = node_positions(block.model.space)

    def apply(u):
        return (nodes + u - about) @ rotation.T + about + translation - nodes

    return apply


@pytest.mark.parametrize("surface", ["plane", "sphere"])
def test_common_rigid_motion_changes_nothing(fe, surface):
    """Nodes and surface moved and turned as one: tractions turn with them, the history stays.

    Requirement: objectivity, 1e-9. Source: a common rigid motion is a change of the observer.
    Tolerance: round-off of the positions times the penalty, some 1e-13.
    """
    from anisocontact.anisotropy import make_directions
    from anisocontact.interface import Interface
    from anisocontact.laws import Adhesion, Friction, NormalLaw
    from anisocontact.rigid import RigidBody
    from anisocontact.surfaces import make_surface

    made = {
        "plane": {"point": (0, 0, 0), "normal": (0, 0, 1)},
        "sphere": {"centre": (0.5, 0.5, -2.0), "radius": 2.02},
    }
    marks = make_directions("constant", vector=(1, 0.3, 0))
    law = Interface(
        make_surface(surface, **made[surface]),
        NormalLaw(penalty=1e3),
        Adhesion(stiffness=(900.0, 300.0), directions=marks),
        Friction(coefficients=(0.4, 0.15), directions=marks),
    )
    c = np.array([0.3, -0.2, 0.4])
    vector, translation = 0.7 * np.array([1.0, -2.0, 0.5]), np.array([3.0, -2.0, 5.0])
    rng = np.random.default_rng(5)
    still, moving = RigidBody("die", c), RigidBody("die", c)
    contacts = [fe.block(law, body=body).contact for body in (still, moving)]
    block = fe.block(law)
    u = np.zeros((len(shift(block, (np.eye(3), 0.0), c)(0.0)), 3))
    for k in range(1, 5):
        u = u + 0.01 * rng.standard_normal(u.shape)
        moving.move(**dict(zip(("x", "y", "z"), k * translation, strict=True)))
        moving.move(**dict(zip(("rx", "ry", "rz"), k * vector, strict=True)))
        rotation = turned(k * np.linalg.norm(vector), vector)
        a = contacts[0].update(u, 1.0)
        b = contacts[1].update(shift(block, (rotation, k * translation), c)(u), 1.0)
        largest = np.abs(a.traction).max()
        assert np.array_equal(a.status, b.status)
        assert np.abs(b.traction - a.traction @ rotation.T).max() < 1e-9 * largest
        assert np.abs(b.state["elastic"] - a.state["elastic"]).max() < 1e-12
        assert np.abs(b.directions_friction - a.directions_friction @ rotation.T).max() < 1e-12
        tangent = rotation @ a.tangent @ rotation.T
        assert np.abs(b.tangent - tangent).max() < 1e-9 * np.abs(tangent).max()
        for contact in contacts:
            contact.commit()
        moving.commit()
        assert np.allclose(
            contacts[1].elastic_slip(), contacts[0].elastic_slip() @ rotation.T, atol=1e-12
        )


def test_a_problem_that_is_drawn_turned(fe):
    """Mesh, directions, reference point and motion turned in space: results turn with them.

    Requirement: rigid rotation of the whole problem changes nothing, 1e-9. Source: no direction of
    space is distinguished. Tolerance: 1e-12 of Newton, times the condition of the block.
    """
    from anisocontact.rigid import RigidBody
    from anisocontact.solver import Step

    c, travel, turn = np.array([0.4, 0.7, -0.3]), np.array([0.01, -0.02, 0.02]), 0.06
    results = []
    for q in (np.eye(3), turned(0.8, (1.0, -2.0, 0.7))):
        die = RigidBody("die", q @ c)
        law = fe.interface(
            angle=0.4, adhesion_angle=0.9, normal=q @ (0, 0, 1), vector=q @ (1, 0, 0)
        )
        block = fe.block(law, body=die, move=lambda x, q=q: x @ q.T)
        motion = dict(zip("xyz", q @ travel, strict=True))
        motion |= dict(zip(("rx", "ry", "rz"), q @ (0.0, 0.0, turn), strict=True))
        held = {"block.top": dict.fromkeys("xyz", 0.0)}
        block.run(Step("move", 4, held, motion={"die": motion}), **TIGHT)
        force, moment = block.contact.resultant(die.position)
        support = block.problem.rigid.support(die).reshape(2, 3)
        results.append(np.vstack([block.contact.last.traction, force, moment, support]) @ q)
    assert block.contact.counts()["slip"] > 0
    assert np.abs(results[0] - results[1]).max() < 1e-9 * np.abs(results[0]).max()


def test_turning_disc(fe):
    """Plane turned about the normal under a held block: every point slips, torque from friction.

    Requirement: torque about the reference point is `mu` times the sum of `N a r` over the slave
    points, isotropic. Source: steady slip along circles, T = mu N against it. Tolerance: 3e-4,
    four times what the yielding of the block leaves; the chord for the arc would leave 1e-3.
    """
    from anisocontact.rigid import RigidBody
    from anisocontact.solver import Step

    centre = np.array([0.5, 0.5, 0.0])
    die = RigidBody("die", centre)
    block = fe.block(
        fe.interface(coefficients=(0.2, 0.2), stiffness=(4e3, 4e3)), body=die, cells=(4, 4, 2)
    )
    held = {"block.top": {"x": 0.0, "y": 0.0, "z": -0.01}}
    block.run(Step("press", 1, held), Step("turn", 12, motion={"die": {"rz": np.radians(60.0)}}))
    contact = block.contact
    arm = np.linalg.norm((contact.points - centre)[:, :2], axis=1)
    expected = 0.2 * np.sum(contact.areas * contact.last.pressure * arm)
    _, moment = contact.resultant(die.position)
    assert contact.counts()["slip"] == contact.areas.size
    assert moment[2] == pytest.approx(expected, rel=3e-4)
    support = block.problem.rigid.support(die)
    assert np.allclose(support[3:], moment, atol=1e-12 * abs(expected))


@pytest.mark.parametrize("free", [False, True])
def test_rotation_about_any_axis_that_moves(fe, free):
    """A rotation about an axis away from the reference point, while the axis moves.

    Requirement: the same tractions as those of a body whose reference point lies on the axis, and
    that is moved and turned; 1e-9. Source: a motion of a rigid body does not depend on the point
    that describes it. Tolerance: Newton to 1e-12. The step after holds the body there.
    """
    from anisocontact.rigid import RigidBody
    from anisocontact.solver import Step, Turn

    angle, axis, point, move = 0.04, (0.6, 0.0, 0.8), (0.7, 0.2, -0.4), (0.01, 0.0, 0.02)
    about = RigidBody("die", (0.1, 0.9, 2.0), free=free)
    through = RigidBody("die", point)
    way = dict(zip("xyz", move, strict=True))
    way |= dict(zip(("rx", "ry", "rz"), angle * np.array(axis), strict=True))
    held = {"block.top": dict.fromkeys("xyz", 0.0)}
    blocks = []
    for body, load in (
        (about, {"rotation": {"die": Turn(axis, angle, point, move)}}),
        (through, {"motion": {"die": way}}),
    ):
        block = fe.block(fe.interface(angle=0.3, coefficients=(0.1, 0.2)), body=body)
        block.run(Step("turn", 4, held, **load), Step("hold", 1), **TIGHT)
        blocks.append(block)
    expected = blocks[1].contact.last.traction
    assert blocks[1].contact.state["slip_accumulated"].max() > 0.0
    difference = np.abs(blocks[0].contact.last.traction - expected).max()
    assert difference < 1e-9 * np.abs(expected).max()
    moments = [blocks[i].problem.rigid.support(b)[3:] for i, b in enumerate((about, through))]
    arm = about.accepted.translation + about.reference - through.accepted.translation - point
    force = blocks[0].problem.rigid.support(about)[:3]
    assert np.allclose(moments[1], moments[0] + np.cross(arm, force), atol=1e-9)


@pytest.mark.parametrize("increments", [1, 2])
def test_turntable_in_few_increments(fe, increments):
    """A whole turn of the plane under a held block far from its axis in one or two increments.

    Requirement: however few increments are asked for, the moment is mu N R and never nothing;
    parts in which points turn by more than 15 degrees are cut. Source: steady slip along circles.
    Tolerance: 3e-4, as of the turning disc; half an angle of 15 degrees would leave 9e-3.
    """
    from anisocontact.rigid import RigidBody
    from anisocontact.solver import Step

    die = RigidBody("die", np.array([-9.5, 0.5, 0.0]))
    block = fe.block(
        fe.interface(coefficients=(0.2, 0.2), stiffness=(4e3, 4e3)), body=die, cells=(2, 2, 1)
    )
    held = {"block.top": {"x": 0.0, "y": 0.0, "z": -0.01}}
    turn = Step("turn", increments, motion={"die": {"rz": 2.0 * np.pi}})
    block.run(Step("press", 1, held), turn)
    contact = block.contact
    arm = np.linalg.norm((contact.points - die.position)[:, :2], axis=1)
    expected = 0.2 * np.sum(contact.areas * contact.last.pressure * arm)
    assert contact.counts()["slip"] == contact.areas.size
    assert contact.resultant(die.position)[1][2] == pytest.approx(expected, rel=3e-4)
    assert contact.state["turn"].max() < 1.05 * np.radians(15.0)
    # 1e-3 of the way are the points at other radii and the elastic slip at the start
    assert contact.state["slip_accumulated"] == pytest.approx(2.0 * np.pi * arm, rel=1e-3)


@pytest.mark.parametrize("degrees", [180.0, 350.0, 360.0])
def test_half_a_turn_in_one_part_is_refused(fe, degrees):
    """Where parts may not be cut, friction would be none, or that of a turn the other way.

    Requirement: no force of the wrong sign, and the degrees are named; 170 of them are followed.
    """
    from anisocontact.base.limits import Limits
    from anisocontact.rigid import RigidBody
    from anisocontact.solver import Solver, Step, StoppedError

    def whole(turned: float) -> float:
        die = RigidBody("die", np.array([-9.5, 0.5, 0.0]))
        block = fe.block(
            fe.interface(coefficients=(0.2, 0.2), stiffness=(4e3, 4e3)), body=die, cells=(2, 2, 1)
        )
        held = {"block.top": {"x": 0.0, "y": 0.0, "z": -0.01}}
        steps = [Step("press", 1, held), Step("turn", 1, motion={"die": {"rz_deg": turned}})]
        for _ in Solver(block.problem, steps, limits=Limits(smallest=1.0)).run():
            pass
        return float(block.contact.resultant(die.position)[1][2])

    with pytest.raises(StoppedError, match=f"{degrees:.0f} degrees of rotation are prescribed"):
        whole(degrees)
    assert whole(170.0) > 0.0
