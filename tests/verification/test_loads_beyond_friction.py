"""Loads that friction cannot hold are named."""

from __future__ import annotations

import re

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation
from tests.verification.test_sides_kept import ANGLE, CLAMP, MU, _laws

from anisocontact.base.limits import Limits
from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.interface import Augmentation, ContactLaw, Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import Body, BoxSpec, PlaneStrain, build_box, build_mesh, make_shape
from anisocontact.rigid import RigidBody
from anisocontact.solver import CoupledFace, Cut, Problem, Solver, Step, StoppedError
from anisocontact.solver.stepping.failures import Failures
from anisocontact.solver.stepping.run_position import RunPosition
from anisocontact.surfaces import make_surface


def _flat(master: str, law: str, tilt: float) -> tuple[Problem, Rotation]:
    """A flat free block on a plane or a plate, all of it turned about x."""
    turn = Rotation.from_rotvec([np.radians(tilt), 0.0, 0.0])
    boxes = {"block": BoxSpec((0, 0, 0), (1, 1, 0.25), (1, 1, 1))}
    if master == "plate":
        boxes["base"] = BoxSpec((-0.7, -0.7, -0.5), (2.4, 2.4, 0.5), (3, 3, 1))
    model = build_box(boxes)
    model.mesh.geometry.x[:] = turn.apply(model.mesh.geometry.x)
    if master == "plate":
        contact = Contact(model, "block.bottom", "base.top", law=ContactLaw(*_laws()), mortar=False)
    else:
        plane = make_surface("plane", point=(0, 0, 0), normal=turn.apply([0.0, 0.0, 1.0]))
        contact = Contact(model, "block.bottom", Interface(plane, *_laws()), mortar=False)
    material = make_material(law, E=1000.0, nu=0.3)
    return Problem(model, dict.fromkeys(boxes, material), [contact]), turn


@pytest.mark.parametrize(
    ("master", "tilt", "law"),
    [
        ("plane", 0.0, "neo-hookean"),
        ("plane", 60.0, "linear-elastic"),
        ("plate", 0.0, "linear-elastic"),
        ("plate", 0.0, "neo-hookean"),
        pytest.param("plane", 0.0, "linear-elastic", marks=pytest.mark.slow),
        pytest.param("plane", 60.0, "neo-hookean", marks=pytest.mark.slow),
    ],
)
def test_loads_beyond_friction_are_named(master: str, tilt: float, law: str) -> None:
    """A free block pressed by 1 and pulled along x by 2, where friction holds 0.22.

    Requirement: the line tells the load of the increment, the direction, and `mu N` along it.
    Source: `mu` of the friction ellipse along x. The four digits that are shown.
    """
    problem, turn = _flat(master, law, tilt)
    normal = turn.apply([0.0, 0.0, -1.0])
    press = dict(zip("xyz", normal.tolist(), strict=True))
    steps = [
        Step("press", 1, CLAMP if master == "plate" else {}, force={"block.top": press}),
        Step("pull", 1, force={"block.top": {"x": 2.0}}),
    ]
    mu = 1.0 / np.hypot(np.cos(ANGLE) / MU[0], np.sin(ANGLE) / MU[1])
    with pytest.raises(StoppedError) as error:
        list(Solver(problem, steps, limits=Limits(smallest=0.25), strategy="direct").run())
    text = str(error.value)
    assert "the loads on body 'block' come to 2 along (1, 0, 0), and friction holds " in text
    assert "no convergence" not in text
    if master == "plane":
        assert f"holds {mu:.4g} there at most, {mu:.4g} of the normal force 1:" in text


def test_loads_that_friction_holds_are_not_to_blame() -> None:
    """A run that stops for another reason says that reason."""
    problem, _ = _flat("plane", "linear-elastic", 0.0)
    steps = [Step("press", 1, force={"block.top": {"z": -1.0, "x": 0.1}})]
    with pytest.raises(StoppedError, match="no convergence in 0 Newton iterations"):
        options = {"snes_max_it": 0}
        list(Solver(problem, steps, options=options, limits=Limits(smallest=0.5)).run())


@pytest.mark.parametrize(("moment", "said"), [(20.0, True), (2.0, False), (0.5, False)])
def test_a_moment_far_beyond_friction_on_a_round_master_is_told(moment: float, said: bool) -> None:
    """A block whose head is pressed on a ball and turned by a moment, where a part fails.

    Requirement: the moment of the load, and what friction holds with the pressures of now, where
    it is less than a third; what presses elsewhere could hold a little more. Source: `mu` times the
    sum of forces and arms about the axis. Tolerance: four digits, and normals that lean by the
    share of the radius of contact, 1 %.
    """
    model = build_box({"block": BoxSpec((-0.5, -0.5, 0), (1, 1, 1), (4, 4, 2))})
    head = RigidBody("head", (0, 0, 1), free=True)
    ball = make_surface("sphere", centre=(0, 0, -5), radius=5.0)
    contact = Contact(model, "block.bottom", ball, Friction(coefficients=0.2))
    rubber = {"block": make_material("neo-hookean", E=1000.0, nu=0.3)}
    problem = Problem(model, rubber, [contact], coupled=[CoupledFace("block.top", head)])
    steps = [
        Step("press", 1, motion={"head": {"z": -0.02}}),
        Step("load", 1, motion={"head": {"z": None}}, load={"head": {"z": -20.0}}),
    ]
    for _ in Solver(problem, steps).run():
        pass
    turn = Step("turn", 1, motion={"head": {"rz": None}}, load={"head": {"rz": moment}})
    problem.begin(turn)
    told = Failures(problem, []).hint(turn, RunPosition.beginning(0, 0.0, Limits()), 1)
    if not said:
        assert told == ""
        return
    assert told.startswith("the loads on body 'block' come to a moment of 20 about (0, 0, 1) ")
    arms = np.linalg.norm(contact.points[:, :2], axis=1)
    held = 0.2 * (contact.areas * contact.last.pressure) @ arms
    (number,) = re.findall(r"friction holds ([\d.]+) there at most", told)
    assert float(number) == pytest.approx(held, rel=0.01)
    assert 0.5 < held < 2.0


TILT, WALL = np.radians(60.0), 10.0 * np.cos(np.radians(60.0))


def _ladder(friction: float) -> tuple[Problem, Step]:
    """A bar on a floor and against a wall with friction 0.2, and a step with its weight."""
    spec = make_shape("rectangle", origin=(0, 0), size=(10, 0.4), cells=(8, 1))
    model = build_mesh([Body("bar", spec)], idealisation=PlaneStrain())
    model.mesh.geometry.x[:] = Rotation.from_rotvec([0, 0, TILT]).apply(model.mesh.geometry.x)
    contacts = [
        Contact(model, group, make_surface("plane", point=at, normal=up), Friction(coefficients=mu))
        for group, at, up, mu in (
            ("bar.left", (0, 0, 0), (0, 1, 0), friction),
            ("bar.right", (WALL, 0, 0), (-1, 0, 0), 0.2),
        )
    ]
    steel = {"bar": make_material("linear-elastic", E=1e4, nu=0.3)}
    return Problem(model, steel, contacts), Step("weight", 1, body_force={"bar": {"y": -0.01}})


@pytest.mark.parametrize(("friction", "said"), [(0.2, True), (0.3, False)])
def test_a_ladder_that_nothing_can_hold_is_told_before_anything_presses(
    friction: float, said: bool
) -> None:
    """A bar that leans on a wall at 60 degrees, its weight in the first increment of a run.

    Requirement: it is told that no forces where it touches hold it, and how much friction would;
    nothing of one that is held. Source: balance of the bar with m times the friction at both ends,
    which slide. Tolerance: three digits as shown, and those of the search.
    """
    problem, step = _ladder(friction)
    problem.begin(step)
    told = Failures(problem, []).hint(step, RunPosition.beginning(0, 0.0, Limits()), 1)
    if not said:
        assert told == ""
        return
    (number,) = re.findall(r"it would take ([\d.]+) times the friction", told)
    middle = 5.0 * np.cos(TILT) - 0.2 * np.sin(TILT)

    def left(times: float) -> float:
        across = middle / (10.0 * np.sin(TILT) + times * 0.2 * WALL)
        return float(times * friction * (1.0 - times * 0.2 * across) - across)

    assert float(number) == pytest.approx(brentq(left, 0.5, 3.0), rel=5e-3)


@pytest.mark.slow
def test_an_increment_is_not_cut_on_and_on_where_nothing_could_hold_a_body() -> None:
    """The run of the bar that nothing holds.

    Requirement: it ends after two cuts with what is told above, and not at the smallest part.
    """
    problem, step = _ladder(0.2)
    cuts: list[Cut] = []
    with pytest.raises(StoppedError, match="no forces where body 'bar' touches"):
        list(Solver(problem, [step]).run(on_cut=cuts.append))
    assert len(cuts) == 2


STEEP = np.tan(np.radians(30.0))


def _keystone(friction: float, between: float) -> tuple[Problem, Step]:
    """A wedge on faces of two blocks on a floor, and a step with the weights of all."""
    left, wedge, right = (
        make_shape("rectangle", origin=at, size=size, cells=cells)
        for at, size, cells in (
            ((-3, 0), (2.5, 1), (4, 3)),
            ((-0.5, 0), (1, 1), (2, 3)),
            ((0.5, 0), (2.5, 1), (4, 3)),
        )
    )
    bodies = [Body("left", left), Body("wedge", wedge), Body("right", right)]
    model = build_mesh(bodies, idealisation=PlaneStrain())
    x = model.mesh.geometry.x
    away = np.minimum(np.abs(x[:, 0]) / 0.5, (3.0 - np.abs(x[:, 0])) / 2.5)
    x[:, 0] += np.sign(x[:, 0]) * away * STEEP * x[:, 1]
    floor = make_surface("plane", point=(0, 0, 0), normal=(0, 1, 0))
    rough, faces = Friction(coefficients=friction), Friction(coefficients=between)
    contacts = [
        Contact(model, "left.bottom", floor, rough),
        Contact(model, "right.bottom", floor, rough),
        Contact(model, "wedge.left", "left.right", faces),
        Contact(model, "right.left", "wedge.right", faces),
    ]
    names = ("left", "wedge", "right")
    steel = {name: make_material("linear-elastic", E=1e4, nu=0.3) for name in names}
    weight = {name: {"y": -0.01} for name in names}
    return Problem(model, steel, contacts), Step("weight", 1, body_force=weight)


@pytest.mark.parametrize(
    ("friction", "between", "said"), [(0.35, 0.0, True), (0.25, 0.1, True), (0.5, 0.0, False)]
)
def test_an_assemblage_that_nothing_can_hold_is_told_before_anything_presses(
    friction: float, between: float, said: bool
) -> None:
    """A wedge that drives two blocks apart, each of which could be held by itself.

    Requirement: it is told that no forces where they touch hold them, and how much friction would;
    nothing where friction is enough. Source: with m times the friction the weight W of the wedge
    drives each block with `W / (2 tan(a + b))`, `tan b` the friction between them, and the floor
    presses on it with its weight and W / 2. Tolerance: three digits as shown, and those of the
    search.
    """
    problem, step = _keystone(friction, between)
    problem.begin(step)
    told = Failures(problem, []).hint(step, RunPosition.beginning(0, 0.0, Limits()), 1)
    if not said:
        assert told == ""
        return
    named = told[: told.index(" touch balance the loads on them")]
    assert named.startswith("no forces where ") and "body 'wedge'" in named
    assert "body 'left'" in named or "body 'right'" in named  # one of them slides, or both
    (number,) = re.findall(r"it would take ([\d.]+) times the friction; hold them, or", told)
    wedge, block = 1.0 + STEEP, 2.5 - 0.5 * STEEP

    def left(times: float) -> float:
        lean = np.arctan(STEEP) + np.arctan(times * between)
        return float(times * friction * (block + 0.5 * wedge) - 0.5 * wedge / np.tan(lean))

    assert float(number) == pytest.approx(brentq(left, 0.5, 3.0), rel=3e-3)


LEAN = np.radians(15.0)
MIDDLE = {"half.left": {"x": 0.0}}


def _wedge(friction: float, method: Augmentation | None, *loads: float) -> Problem:
    """Half a wedge that has been loaded so, one after the other, along its middle."""
    spec = make_shape("rectangle", origin=(0, 0), size=(1, 1), cells=(4, 4))
    model = build_mesh([Body("half", spec)], idealisation=PlaneStrain())
    x = model.mesh.geometry.x
    x[:, 0] *= 1.0 + np.tan(LEAN) * x[:, 1]
    wall = make_surface("plane", point=(1, 0, 0), normal=(-np.cos(LEAN), np.sin(LEAN), 0))
    rubs = Friction(coefficients=friction)
    law = ContactLaw(NormalLaw(penalty=1e5), Adhesion(stiffness=1e5), rubs)
    contact = Contact(model, "half.right", wall, law, mortar=True, augmentation=method)
    steel = {"half": make_material("linear-elastic", E=1000.0, nu=0.3)}
    problem = Problem(model, steel, [contact])
    steps = [Step(f"to {f}", 2, MIDDLE, force={"half.top": {"y": f}}) for f in loads]
    for _ in Solver(problem, steps).run():
        pass
    return problem


def _told(problem: Problem, force: float) -> str:
    """What is told where a part of a step to a force on the wedge fails."""
    step = Step("out", 1, MIDDLE, force={"half.top": {"y": force}})
    problem.begin(step)
    return Failures(problem, []).hint(step, RunPosition.beginning(0, 0.0, Limits()), 1)


@pytest.mark.parametrize("method", [None, Augmentation()], ids=["penalty", "multipliers"])
@pytest.mark.parametrize(
    ("reached", "asked", "said"), [(0.53, 6.0, True), (0.53, 0.535, False), (0.0, 6.0, False)]
)
def test_a_wedge_that_is_pulled_out_by_more_than_friction_holds_is_told(
    reached: float, asked: float, said: bool, method: Augmentation | None
) -> None:
    """Half a wedge that is pressed in by 5, let go, and pulled to 97 % of the limit.

    Requirement: a part that fails with a load beyond the limit tells what drives it out, and what
    friction holds, and nothing below 97 % or with a load that is held. Source: friction holds
    `mu N cos a` along the middle, loads and normal forces drive it with `F + N sin a`. Tolerance:
    the four digits that are told, and the polygon around the friction circle.
    """
    problem = _wedge(0.4, method, -5.0, 0.0, reached)
    told = _told(problem, asked)
    if not said:
        assert told == ""
        return
    force, _ = problem.contacts[0].resultant()
    pressed = force @ [-np.cos(LEAN), np.sin(LEAN), 0.0]
    pattern = r"come to ([\d.]+) along \(0, 1, 0\), and friction holds ([\d.]+) there at most"
    ((drives, holds),) = re.findall(pattern, told)
    assert float(drives) == pytest.approx(asked + pressed * np.sin(LEAN), rel=1e-3)
    assert float(holds) == pytest.approx(0.4 * pressed * np.cos(LEAN), rel=1e-3)
    assert "points that touch slip in 'half.right'" in told


@pytest.mark.parametrize("friction", [0.0, 0.1])
def test_a_wedge_that_is_let_go_is_not_said_to_be_pulled_out(friction: float) -> None:
    """One that comes out by itself as the load that presses it in is taken away.

    Requirement: nothing is told of friction. Source: normal forces fall with the load, and there is
    equilibrium all along; with those of now friction, less than tan 15 degrees, holds too little.
    """
    assert _told(_wedge(friction, None, -5.0, -2.0), -0.5) == ""
