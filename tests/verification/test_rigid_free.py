"""Free rigid bodies: forces, moments, springs, balance, and what holds them."""

import numpy as np
import pytest

TIGHT = {"snes_rtol": 1e-12}
ALL = ("x", "y", "z", "rx", "ry", "rz")


def on_sphere(coefficients=(0.3, 0.1), penalty=1e4):
    """Anisotropic adhesion and friction on a sphere that lies just under a block."""
    from anisocontact.anisotropy import make_directions
    from anisocontact.interface import Interface
    from anisocontact.laws import Adhesion, Friction, NormalLaw
    from anisocontact.surfaces import make_surface

    marks = make_directions("constant", vector=(1.0, 0.4, 0.0))
    return Interface(
        make_surface("sphere", centre=(0.5, 0.5, -1.0), radius=1.0),
        NormalLaw(penalty=penalty),
        Adhesion(stiffness=(4e3, 1e3), directions=marks),
        Friction(coefficients=coefficients, directions=marks),
    )


def clamped():
    return {"block.top": dict.fromkeys("xyz", 0.0)}


def test_a_force_does_what_its_motion_does(fe):
    """Sphere pressed with forces F: the same as moved by what F moves it.

    Requirement: displacement of the sphere and tractions of the run under force equal those of
    the run under prescribed displacement whose reactions F are, 1e-8. Source: both are the same
    equations. Every increment is one step with its own F, so that the paths are the same too
    (points slip, as the sphere also turns by prescribed angles). Tolerance: Newton to 1e-12.
    """
    from anisocontact.rigid import RigidBody
    from anisocontact.solver import Solver, Step

    depths = (0.005, 0.01, 0.015, 0.02)
    die = RigidBody("ball", (0.5, 0.5, -1.0))
    moved = fe.block(on_sphere(), body=die, cells=(4, 4, 2))
    ways = [{"z": z, "ry": 2.0 * (z - 0.005)} for z in depths]
    steps = [Step(f"{i}", 1, clamped(), motion={"ball": way}) for i, way in enumerate(ways)]
    forces = []
    for _ in Solver(moved.problem, steps, options=TIGHT).run():
        forces.append(moved.problem.rigid.support(die)[2])
    ball = RigidBody("ball", (0.5, 0.5, -1.0), free=True)
    pressed = fe.block(on_sphere(), body=ball, cells=(4, 4, 2))
    steps = [Step("touch", 1, clamped(), motion={"ball": ways[0]})]
    steps += [
        Step(f"{f}", 1, motion={"ball": way | {"z": None}}, load={"ball": {"z": f}})
        for way, f in zip(ways[1:], forces[1:], strict=True)
    ]
    pressed.run(*steps, **TIGHT)
    assert moved.contact.counts()["slip"] > 0
    assert ball.accepted.translation[2] == pytest.approx(depths[-1], rel=1e-8)
    expected = moved.contact.last.traction
    assert np.abs(pressed.contact.last.traction - expected).max() < 1e-8 * np.abs(expected).max()


def test_balance_of_forces_and_moments(fe):
    """Body free in all components under force, moment and springs: everything is in balance.

    Requirement: 1e-8. Source: Euler's laws for the body about its moved reference point, and for
    body and block together about the origin. Tolerance: Newton to 1e-12 of the forces at work.
    """
    from anisocontact.rigid import RigidBody
    from anisocontact.solver import Step

    springs = {"x": 20.0, "y": 30.0, "z": 10.0, "rx": 4.0, "ry": 5.0, "rz": 6.0}
    ball = RigidBody("ball", (0.4, 0.7, -0.9), free=True, springs=springs)
    block = fe.block(on_sphere(), body=ball, cells=(4, 4, 2))
    load = {"x": 0.3, "y": -0.2, "z": 6.0, "rx": 0.3, "ry": -0.2, "rz": 0.25}
    block.run(
        Step("touch", 1, clamped(), motion={"ball": {"z": 0.005}}),
        Step("load", 4, motion={"ball": dict.fromkeys(ALL)}, load={"ball": load}),
        **TIGHT,
    )
    applied = np.array(list(load.values()))
    spring = -np.array(list(springs.values())) * ball.accepted.values
    contact = -np.concatenate(block.contact.resultant(ball.position))
    assert np.abs(contact + applied + spring).max() < 1e-8 * np.abs(applied).max()
    assert np.linalg.norm(ball.accepted.turn) > 0.02
    reaction = block.problem.reactions()["block.top"]
    total = reaction + applied[:3] + spring[:3]
    assert np.abs(total).max() < 1e-8 * np.abs(applied[:3]).max()
    energies = block.problem.energies()
    assert energies["springs"] > 0.0
    assert abs(energies["residual"]) < 0.05 * energies["external"]


def test_the_energy_balance_converges(fe):
    """Work of loads on a free body goes into block, contact, springs and friction.

    Requirement: what is left of the energy balance falls at first order or better with the
    increments. Source: trapezoidal rule along a path with dissipation. All points touch from the
    start, as a point that begins to touch within an increment makes the rest irregular. Tolerance:
    the ratio of the first order is 2.
    """
    from anisocontact.rigid import RigidBody
    from anisocontact.solver import Step

    left = []
    for increments in (5, 10, 20):
        die = RigidBody(
            "die", (0.4, 0.7, -0.9), free=True, springs={"x": 5.0, "ry": 5.0, "rz": 3.0}
        )
        block = fe.block(fe.interface(angle=0.4), body=die)
        block.run(
            Step("touch", increments, clamped(), motion={"die": {"z": 0.02}}),
            Step(
                "load",
                increments,
                motion={"die": dict.fromkeys(("x", "y", "ry", "rz"))},
                load={"die": {"x": 4.0, "y": -1.0, "ry": 1.5, "rz": 1.5}},
            ),
            **TIGHT,
        )
        energies = block.problem.energies()
        left.append(abs(energies["residual"]) / energies["external"])
    assert left[0] > 1.8 * left[1] > 1.8**2 * left[2]
    assert left[2] < 0.01


#: Height of the block, penalty, stiffness of adhesion; its material is that of `fe.block`.
HEIGHT, PENALTY, STIFFNESS, YOUNG, NU = 0.5, 500.0, 800.0, 1000.0, 0.3
SIDES = {"left": "x", "right": "x", "front": "y", "back": "y"}


def on_springs(fe, overlap, springs):
    """A block that sticks to a die with springs, and the die."""
    from anisocontact.rigid import RigidBody

    die = RigidBody("die", (0.5, 0.5, 0.0), free=True, springs=springs)
    law = fe.interface(
        stiffness=(STIFFNESS, STIFFNESS),
        coefficients=(50.0, 50.0),
        penalty=PENALTY,
        point=(0.0, 0.0, overlap),
    )
    return fe.block(law, body=die), die


def test_spring_penalty_and_block_in_series(fe):
    """Block in a stiff box on a die with a spring: three springs in series, closed form.

    Requirement: force and motion of the die within 1e-8. Source: with w only through the height,
    `F = d / (H/(M A) + 1/(eps A) + 1/k)`, M the oedometric modulus. Tolerance: the field is linear,
    exact in every element; Newton to 1e-12.
    """
    from anisocontact.solver import Step

    overlap, press, k = 1e-12, 0.01, 70.0
    block, die = on_springs(fe, overlap, {"z": k})
    held = {f"block.{side}": {axis: 0.0} for side, axis in SIDES.items()}
    held["block.top"] = {"z": -press}
    block.run(Step("press", 1, held, motion={"die": {"z": None}}), **TIGHT)
    oedometric = YOUNG * (1.0 - NU) / ((1.0 + NU) * (1.0 - 2.0 * NU))
    expected = (press + overlap) / (HEIGHT / oedometric + 1.0 / PENALTY + 1.0 / k)
    force, _ = block.contact.resultant()
    assert force[2] == pytest.approx(expected, rel=1e-8)
    assert die.accepted.translation[2] == pytest.approx(-expected / k, rel=1e-8)


def test_spring_adhesion_and_block_in_series(fe):
    """The same across, in stick, with sides that do not rise.

    Requirement: force and motion of the die within 1e-8. Source: `F = d / (H/(G A) + 1/(S A) +
    1/k)`. Tolerance: the field is linear, exact in every element; Newton to 1e-12.
    """
    from anisocontact.solver import Step

    across, k = 0.002, 50.0
    block, die = on_springs(fe, 0.005, {"x": k})
    held = {f"block.{side}": {"z": 0.0} for side in SIDES}
    held["block.top"] = {"x": 0.0, "y": 0.0, "z": 0.0}
    block.run(
        Step("press", 1, held),
        Step("shift", 2, {"block.top": {"x": across}}, motion={"die": {"x": None}}),
        **TIGHT,
    )
    shear = YOUNG / (2.0 * (1.0 + NU))
    expected = across / (HEIGHT / shear + 1.0 / STIFFNESS + 1.0 / k)
    force, _ = block.contact.resultant()
    assert force[0] == pytest.approx(-expected, rel=1e-8)
    assert die.accepted.translation[0] == pytest.approx(expected / k, rel=1e-8)


def test_springs_alone(fe):
    """A body away from the block under force and moment: displacement F/k, turn M/k, also beyond
    a full turn.

    Requirement: closed form, 1e-8. Source: Hooke. Turned about one axis, over two revolutions.
    """
    from anisocontact.rigid import RigidBody
    from anisocontact.solver import Step

    ball = RigidBody("ball", (0.5, 0.5, -5.0), free=True, springs={"x": 20.0, "rz": 4.0})
    law = fe.interface(point=(0.0, 0.0, -5.0))
    block = fe.block(law, body=ball)
    moment = 4.0 * 4.0 * np.pi * 1.1
    block.run(
        Step(
            "load",
            3,
            clamped(),
            motion={"ball": {"x": None, "rz": None}},
            load={"ball": {"x": 5.0, "rz": moment}},
        ),
        **TIGHT,
    )
    assert ball.accepted.values == pytest.approx([0.25, 0, 0, 0, 0, 4.4 * np.pi], rel=1e-8)
    half = 0.5 * (5.0 * 0.25 + moment * 4.4 * np.pi)
    assert block.problem.energies()["springs"] == pytest.approx(half, rel=1e-8)
    assert block.problem.energies()["external"] == pytest.approx(half, rel=1e-8)


def test_nothing_holds_the_body(fe):
    """Free, without contact and springs: the error names the body and its free directions."""
    from anisocontact.rigid import RigidBody
    from anisocontact.solver import Step, StoppedError

    ball = RigidBody("ball", (0.5, 0.5, -5.0), free=True, springs={"z": 1.0})
    block = fe.block(fe.interface(point=(0.0, 0.0, -5.0)), body=ball)
    step = Step("lift", 1, clamped(), motion={"ball": dict.fromkeys(("x", "z", "ry"))})
    with pytest.raises(StoppedError, match="the rigid body 'ball' along x, about y: it touches"):
        block.run(step, Step("b", 1, motion={"ball": {"x": None}}, load={"ball": {"x": 1.0}}))


def test_a_load_beyond_the_limit_of_friction(fe):
    """A die pulled by more than friction holds: stopped at the limit, and said what is wrong.

    Requirement: loads up to the limit are carried, and no body that flies off is accepted. Source:
    Coulomb, T = mu N when all points slip. Tolerance: parts are cut to quarters, so the last one
    that is tried is below 4e-3 of an increment of 4, or 5e-3 of the limit of 3.6.
    """
    from anisocontact.base.limits import Limits
    from anisocontact.rigid import RigidBody
    from anisocontact.solver import Solver, Step, StoppedError

    die = RigidBody("die", (0.5, 0.5, 0.0), free=True)
    law = fe.interface(coefficients=(0.2, 0.2), stiffness=(4e3, 4e3))
    block = fe.block(law, body=die, cells=(2, 2, 1))
    steps = [
        Step("touch", 1, clamped(), motion={"die": {"z": 0.01}}),
        Step("pull", 2, motion={"die": {"x": None}}, load={"die": {"x": 8.0}}),
    ]
    with pytest.raises(StoppedError, match=r"'die' come to 4 along \(1, 0, 0\), and friction"):
        list(Solver(block.problem, steps, limits=Limits(smallest=1e-3)).run())
    force, _ = block.contact.resultant()
    assert force[0] / force[2] == pytest.approx(0.2, rel=5e-3)
    assert die.accepted.translation[0] < 0.05


def test_a_ball_without_friction_may_spin(fe):
    """Pressed without adhesion and friction: free to turn about its centre, and only so."""
    from anisocontact.rigid import RigidBody
    from anisocontact.solver import Step, StoppedError

    ball = RigidBody("ball", (0.5, 0.5, -1.0), free=True)
    block = fe.block(on_sphere(coefficients=(1e-30, 1e-30)), body=ball, cells=(4, 4, 2))
    with pytest.raises(
        StoppedError, match="'ball' about x, about y, about z: what touches it slides"
    ):
        block.run(
            Step("touch", 1, clamped(), motion={"ball": {"z": 0.01}}),
            Step(
                "load",
                2,
                motion={"ball": dict.fromkeys(("z", "rx", "ry", "rz"))},
                load={"ball": {"z": 6.0, "rz": 0.1}},
            ),
        )


def test_augmented_contact_on_a_free_body(fe):
    """Block in a stiff box on a die with a spring, without penetration: block and spring alone.

    Requirement: force and motion of the closed form without penalty to 1e-5, and die and contact in
    balance to 1e-8. Source: `F = d / (H/(M A) + 1/k)`; the augmentation goes on until the gaps are
    1e-7 of a facet. Tolerance: that gap over the compression, some 3e-6.
    """
    from anisocontact.interface import Augmentation
    from anisocontact.rigid import RigidBody
    from anisocontact.solver import Step

    die = RigidBody("die", (0.5, 0.5, 0.0), free=True, springs={"z": 70.0})
    law = fe.interface(penalty=500.0, coefficients=(50.0, 50.0))
    block = fe.block(law, body=die, augmentation=Augmentation(tolerance=1e-7))
    sides = {
        "block.left": {"x": 0.0},
        "block.right": {"x": 0.0},
        "block.front": {"y": 0.0},
        "block.back": {"y": 0.0},
    }
    touch = sides | {"block.top": {"z": -0.001}}
    block.run(
        Step("touch", 1, touch, motion={"die": {"z": None}}),
        Step("press", 2, {"block.top": {"z": -0.01}}),
        **TIGHT,
    )
    oedometric = 1000.0 * 0.7 / (1.3 * 0.4)
    expected = 0.01 / (0.5 / oedometric + 1.0 / 70.0)
    force, _ = block.contact.resultant()
    assert force[2] == pytest.approx(expected, rel=1e-5)
    assert die.accepted.translation[2] == pytest.approx(-force[2] / 70.0, rel=1e-8)


@pytest.mark.parametrize("stop", range(1, 8))
def test_restart(fe, stop):
    """A run that goes on from the state of any increment ends as one without a break, bitwise.

    Requirement: history, poses, loads and supports of rigid bodies are part of what is kept.
    Source: the same numbers go the same way.
    """
    from anisocontact.rigid import RigidBody
    from anisocontact.solver import Solver, Step, Turn

    def make():
        ball = RigidBody("ball", (0.4, 0.7, -0.9), free=True, springs={"x": 20.0, "rz": 6.0})
        block = fe.block(on_sphere(), body=ball, cells=(3, 3, 1))
        steps = [
            Step("touch", 2, clamped(), motion={"ball": {"z": 0.03}}),
            Step("load", 3, motion={"ball": {"x": None, "rz": None}}, load={"ball": {"x": 0.5}}),
            Step("turn", 2, rotation={"ball": Turn((0, 1, 0), 0.05, (0.5, 0.5, -1.0))}),
            Step("go", 2, motion={"ball": {"x": None, "rx": 0.02}}, load={"ball": {"x": 0.1}}),
        ]
        return ball, block, Solver(block.problem, steps)

    ball, block, solver = make()
    for done, _ in enumerate(solver.run(), 1):
        if done == stop:
            kept = solver.persistent()
    again, other, rest = make()
    rest.restore(kept)
    assert len(list(rest.run())) == 9 - stop
    assert np.array_equal(again.accepted.values, ball.accepted.values)
    assert np.array_equal(again.accepted.rotation, ball.accepted.rotation)
    assert np.array_equal(other.contact.last.traction, block.contact.last.traction)
    assert other.problem.energies() == block.problem.energies()
    found = [
        problem.rigid.support(b) for problem, b in ((block.problem, ball), (other.problem, again))
    ]
    assert np.array_equal(*found)
