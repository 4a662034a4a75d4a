"""Amplitudes and paths: their own closed forms, and all that they lead follows them."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from anisocontact.base.amplitudes import make_amplitude
from anisocontact.base.errors import InputError
from anisocontact.base.load_curve import LoadCurve, load_curves
from anisocontact.base.paths import make_path

NOTHING = {"x": 0.0, "y": 0.0, "z": 0.0}
TIMES = np.linspace(0.0, 2.0, 81)
#: Share of the greatest number that factorisation leaves.
ROUND = 1e-11


@pytest.mark.parametrize(
    ("kind", "parameters", "exact"),
    [
        (
            "table",
            {"time": (0.5, 1, 1.5), "value": (2, 0, 4)},
            lambda t: np.interp(t, (0.5, 1, 1.5), (2, 0, 4)),
        ),
        ("ramp", {"end": 1.0}, lambda t: np.minimum(t, 1.0)),
        ("ramp", {"start": 0.5, "end": 1.5}, lambda t: np.clip(t - 0.5, 0.0, 1.0)),
        (
            "ramp",
            {"end": 2.0, "smooth": True},
            # the integral of the bump 30 s^2 (1 - s)^2
            lambda t: 30 * ((t / 2) ** 3 / 3 - (t / 2) ** 4 / 2 + (t / 2) ** 5 / 5),
        ),
        (
            "sine",
            {"period": 0.5, "phase_deg": 90, "offset": 2},
            lambda t: 2 + np.cos(4 * np.pi * t),
        ),
        ("cycles", {"period": 0.5}, lambda t: np.sin(2 * np.pi * t) ** 2),
        (
            "cycles",
            {"period": 0.8, "form": "triangle", "both_sides": True},
            lambda t: 2 / np.pi * np.arcsin(np.sin(2 * np.pi * t / 0.8)),
        ),
        (
            "cycles",
            {"period": 1.0, "both_sides": True},
            lambda t: np.sign(np.sin(2 * np.pi * t)) * np.sin(2 * np.pi * t) ** 2,
        ),
        ("cycles", {"period": 0.5, "count": 2}, lambda t: np.sin(2 * np.pi * t) ** 2 * (t < 1.0)),
    ],
)
def test_kinds_are_their_formulas(kind, parameters, exact):
    """Requirement: each kind is its formula, written once more. Tolerance: rounding."""
    amplitude = make_amplitude(kind, **parameters)
    found = [amplitude(float(t)) for t in TIMES]
    assert found == pytest.approx(exact(TIMES), abs=1e-12)


@pytest.mark.parametrize("axis", [(0, 0, 1), (1, 0, 0), (1, 2, -2)])
def test_circle_goes_round_its_axis(axis):
    """A circle of radius 3 about an axis through its middle, one turn in 2.

    Requirement: constant distance and speed, right-handed, in the plane; what begins anywhere goes
    the chord `R(a) r - r`. Source: Rodrigues. Tolerance: rounding.
    """
    way = load_curves(make_path("circle", radius=3.0, period=2.0, start_deg=30, axis=axis))
    n = np.array(axis) / np.linalg.norm(axis)
    begun = np.array([2.0, -1.0, 4.0])
    at = np.tile(begun, (len(TIMES), 1))
    for i, name in enumerate("xyz"):
        if name in way:
            at[:, i] = [way[name].at(t / 2.0, 2.0, begun[i]) for t in TIMES]
    middle = at[:80].mean(axis=0)  # 80 equal steps are one turn
    assert at[80] == pytest.approx(begun, abs=1e-12)
    assert np.linalg.norm(at - middle, axis=1) == pytest.approx(3.0, abs=1e-12)
    assert (at - begun) @ n == pytest.approx(0.0, abs=1e-12)
    r = begun - middle
    angle = np.pi * TIMES[:, None]
    turned = np.cos(angle) * r + np.sin(angle) * np.cross(n, r)
    assert at - middle == pytest.approx(turned, abs=1e-12)


def test_polyline_is_gone_along_at_one_speed():
    """Requirement: length of the way over the time is the same everywhere. Tolerance: rounding."""
    way = make_path("polyline", x=(1, 4, 4, 0), z=(0, 4, 6, 3), duration=1.2).components()
    times = np.linspace(0.0, 1.2, 1201)
    at = np.array([[way[axis](t) for axis in "xz"] for t in times])
    speed = np.linalg.norm(np.diff(at, axis=0), axis=1) / 1e-3
    corners = np.abs(np.median(speed) - speed) > 1e-9
    assert np.median(speed) == pytest.approx(12.0 / 1.2)
    assert corners.sum() <= 2
    assert at[-1] == pytest.approx([0.0, 3.0])


def bar(**held: Any) -> Any:
    """A bar along z of length 2 and area 1, E = 10000, nu = 0."""
    pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)
    from anisocontact.bulk import make_material
    from anisocontact.mesh import BoxSpec, build_box
    from anisocontact.solver import Problem

    model = build_box({"bar": BoxSpec((0, 0, 0), (1, 1, 2), (1, 1, 2))})
    return Problem(model, {"bar": make_material("linear-elastic", E=1e4, nu=0.0)}, **held)


def sway(time: float) -> float:
    """An amplitude that is no straight line anywhere, from 0 on."""
    return math.sin(3.0 * time) + time**2


LED = LoadCurve(sway, 0.6)


@pytest.mark.parametrize(
    ("given", "reaction"),
    [
        ({"force": {"bar.top": {"z": LED}}}, lambda a: [0, 0, -a]),
        ({"traction": {"bar.right": {"x": LED}}}, lambda a: [-2 * a, 0, 0]),
        ({"body_force": {"bar": {"y": LED}}}, lambda a: [0, -2 * a, 0]),
        ({"pressure": {"bar.top": LED}}, lambda a: [0, 0, a]),
        ({"displacement": {"bar.top": {"z": LED}}}, lambda a: [0, 0, -5000 * a]),
        ({"anchor": {"pull": {"z": LED}}}, lambda a: [0, 0, -a / (1 / 10 + 1 / 5000)]),
    ],
)
def test_all_that_is_led_follows(given, reaction):
    """A held bar under each load of a step along one amplitude, then held, then led on linearly.

    Requirement: at every increment the reaction of the closed form, duration 2; the next step
    holds; one with a number goes there linearly. Source: bar, and springs in series. Tolerance:
    1e-11 of the force, factorisation.
    """
    from anisocontact.solver import Solver, Spring, Step

    attached = [Spring("pull", "bar.top", (0.0, 0.0, 10.0))] if "anchor" in given else []
    problem = bar(attached=attached)
    held = {"bar.bottom": NOTHING}
    both = {k: v for k, v in given.items() if k != "displacement"}
    led = Step("a", 8, held | given.get("displacement", {}), duration=2.0, **both)
    ((kind, named),) = given.items()
    ((name, goal),) = named.items()
    number = 3.0 if kind == "pressure" else dict.fromkeys(goal, 3.0)
    back = Step("c", 2, **{kind: {name: number}})
    found = [a.reactions["bar.bottom"] for a in Solver(problem, [led, Step("b", 1), back]).run()]
    values = [0.6 * sway(2.0 * k / 8) for k in range(1, 9)]
    values += [values[-1], 0.5 * (values[-1] + 3.0), 3.0]
    exact = np.array([reaction(value) for value in values], dtype=float)
    assert np.abs(np.array(found) - exact).max() < ROUND * np.abs(exact).max()


def test_turn_follows_an_amplitude(fe):
    """A group is turned to and fro: its corners are on the circle at every increment.

    Requirement: the angle is that of the amplitude. Tolerance: rounding.
    """
    from anisocontact.solver import Solver, Step, Turn

    problem = bar()
    x = problem.model.space.tabulate_dof_coordinates()
    top = x[:, 2] == 2.0
    turn = Turn((0, 0, 1), angle_deg=4.0, amplitude=lambda t: math.sin(math.pi * t))
    step = Step("a", 8, {"bar.bottom": NOTHING}, rotation={"bar.top": turn}, duration=2.0)
    for k, _ in enumerate(Solver(problem, [step]).run(), start=1):
        angle = math.radians(4.0) * math.sin(math.pi * 2.0 * k / 8)
        c, s = math.cos(angle), math.sin(angle)
        moved = (x + problem.u.x.array.reshape(-1, 3))[top]
        assert moved[:, :2] == pytest.approx(x[top, :2] @ np.array([[c, s], [-s, c]]), abs=1e-13)


def on_die(free: bool = False) -> Any:
    """A block on a sphere that a rigid body carries."""
    pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)
    from anisocontact.bulk import make_material
    from anisocontact.contact import Contact
    from anisocontact.interface import Interface
    from anisocontact.laws import Adhesion, Friction, NormalLaw
    from anisocontact.mesh import BoxSpec, build_box
    from anisocontact.rigid import MovingSurface, RigidBody
    from anisocontact.solver import Problem
    from anisocontact.surfaces import make_surface

    model = build_box({"block": BoxSpec((-1, -1, -1), (2, 2, 1), (2, 2, 1))})
    laws = (
        NormalLaw(penalty=200.0),
        Adhesion(stiffness=(50.0, 50.0)),
        Friction(coefficients=(0.1, 0.1)),
    )
    plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, -1))
    die = RigidBody("die", (0, 0, 1), free=free)
    contact = Contact(model, "block.top", MovingSurface(Interface(plane, *laws), die), mortar=False)
    steel = make_material("linear-elastic", E=100.0, nu=0.3)
    return die, Problem(model, {"block": steel}, [contact])


def test_motion_of_a_rigid_body_follows_a_path():
    """A die goes round a circle at a constant depth, then on from where it is.

    Requirement: its translation at every increment, `r (cos a - 1, sin a)`. Tolerance: rounding.
    """
    from anisocontact.solver import Solver, Step

    die, problem = on_die()
    circle = load_curves(make_path("circle", radius=0.2, period=4.0))
    held = {"block.bottom": NOTHING}
    steps = [
        Step("press", 1, held, motion={"die": {"z": -0.05}}),
        Step("half", 8, motion={"die": circle}, duration=2.0),
        Step("rest", 4, motion={"die": {"x": LoadCurve(lambda t: t, 0.1, relative=True)}}),
    ]
    found = []
    for _ in Solver(problem, steps).run():
        found.append(die.accepted.translation.copy())
    angle = np.pi * np.arange(9) / 8
    round_ = np.column_stack([0.2 * (np.cos(angle) - 1), 0.2 * np.sin(angle), 0 * angle - 0.05])
    on = round_[-1] + np.outer(np.arange(1, 5) / 4, [0.1, 0, 0])
    assert np.array(found) == pytest.approx(np.vstack([round_, on]), abs=1e-14)


def test_a_load_on_a_free_body_follows_from_what_held_it():
    """A die that is let go under a force that pulses: what it presses the block with.

    Requirement: `F A(t)` and, in the step that frees it, the difference to what held it before,
    which goes to zero along the step. Tolerance: 1e-9 of the force, Newton's method.
    """
    from anisocontact.solver import Solver, Step

    die, problem = on_die(free=True)
    pulse = LoadCurve(make_amplitude("sine", period=1.0, offset=3.0), -2.0)
    steps = [
        Step("touch", 1, {"block.bottom": NOTHING}, motion={"die": {"z": -0.05}}),
        Step("let go", 4, motion={"die": {"z": None}}, load={"die": {"z": pulse}}),
    ]
    pressed = [
        problem.rigid.contact_force(die)[2]
        for _ in Solver(problem, steps, options={"snes_rtol": 1e-12}).run()
    ]
    share = np.arange(1, 5) / 4
    exact = 2.0 * (3.0 + np.sin(2 * np.pi * share)) + (1 - share) * (pressed[0] - 6.0)
    assert pressed[1:] == pytest.approx(exact, rel=1e-9)


def test_two_groups_that_part_on_shared_nodes_clash():
    """Requirement: equal at the end is not equal all along: one line says who clashes."""
    from anisocontact.solver import Solver, Step

    bump = LoadCurve(make_amplitude("cycles", period=1.0))
    step = Step("a", 4, {"bar.left": {"x": 0.0}, "bar.top": {"x": bump}})
    with pytest.raises(InputError, match=r"'bar.left' prescribes 0 and 'bar.top' .* for x on 2"):
        Solver(bar(), [step])


def test_a_course_out_of_a_symmetry_plane_is_refused():
    """Requirement: found although it comes back into the plane at the end."""
    from anisocontact.solver import Solver, Step

    circle = load_curves(make_path("circle", radius=0.1))
    step = Step("a", 8, {"bar.bottom": circle})
    with pytest.raises(InputError, match=r"out of the symmetry plane 'bar.left'"):
        Solver(bar(symmetry=["bar.left"]), [step])


@pytest.mark.parametrize(
    ("goal", "says"),
    [
        (
            LoadCurve(lambda t: 1.0),
            "begins at 1 where 0.25 is: prescribe that value in a step before",
        ),
        (LoadCurve(lambda t: math.nan), "amplitude at the time 0 is nan, a finite number needed"),
        (
            LoadCurve(lambda t: 0.125 + 1e300 * t, 2.0),
            r"amplitude at the time [\d.]+ is [\d.e+]+, which prescribes .*, less than 1e\+150",
        ),
        (LoadCurve(lambda t: 1 / 0), "amplitude at the time 0: .*ZeroDivisionError"),
        (LoadCurve(lambda t: "much"), "amplitude at the time 0: .*TypeError"),
    ],
)
def test_wrong_courses_are_one_line(goal, says):
    """Requirement: a jump, or no number, is found before anything is solved."""
    from anisocontact.solver import Solver, Step

    steps = [
        Step("a", 1, force={"bar.top": {"x": 0.25}}),
        Step("b", 1, force={"bar.top": {"x": goal}}),
    ]
    with pytest.raises(InputError, match=says) as caught:
        Solver(bar(), steps)
    assert caught.value.field == "step 'b'.force.bar.top.x"


@pytest.mark.parametrize(
    ("increments", "lost"), [(3, "3 increments cut off 10 % of the way"), (4, ""), (30, "")]
)
def test_corners_that_increments_cut_off_are_said(increments, lost):
    """Requirement: a path whose corner lies within an increment is shorter than it was drawn.

    Source: an L of two equal legs in three increments, 2/3 + sqrt(2)/6 of its length, 10 % less;
    in four they meet the corner, in thirty nothing is lost.
    """
    from anisocontact.solver import Solver, Step

    way = load_curves(make_path("polyline", x=(0, 0.01, 0.01), y=(0, 0, 0.01), duration=1.0))
    held = {"bar.bottom": NOTHING, "bar.top": way}
    said = Solver(bar(), [Step("a", increments, held)]).cautions
    assert [line for line in said if "cut off" in line] == said
    assert lost in "".join(said) and bool(said) == bool(lost)


def test_too_few_increments_are_said():
    """Requirement: ten cycles in ten increments look like nothing at all, and that is said."""
    from anisocontact.solver import Solver, Step

    held, wave = {"bar.bottom": NOTHING}, LoadCurve(make_amplitude("sine", period=0.1))
    few, enough = (
        Solver(bar(), [Step("a", n, held, force={"bar.top": {"x": wave}})]).cautions
        for n in (10, 80)
    )
    assert few == ["step 'a'.force.bar.top.x: 10 increments are too few to follow its amplitude"]
    assert enough == []


def test_strategies_follow_alike(fe):
    """A block on a plane is pressed by a force that pulses and led round a circle.

    Requirement: forces and elastic slips of `condensed` and `iterative` are those of `direct` in
    every increment. Tolerance: 1e-6 of the force, Newton's method to 1e-10 and FGMRES.
    """
    from anisocontact.solver import Solver, Step

    circle = load_curves(make_path("circle", radius=0.05))
    pulse = LoadCurve(make_amplitude("cycles", period=0.5), -0.02, relative=True)
    found = []
    for strategy in ("direct", "condensed", "iterative"):
        block = fe.block(fe.interface(), cells=(2, 2, 1))
        steps = [
            Step("press", 1, {"block.top": {"x": 0.0, "y": 0.0, "z": -0.02}}),
            Step("rub", 5, {"block.top": {**circle, "z": pulse}}),
        ]
        solver = Solver(block.problem, steps, strategy=strategy, options={"snes_rtol": 1e-10})
        contact = block.problem.contacts[0]
        found.append([contact.resultant()[0] for _ in solver.run()])
    direct, *others = np.array(found)
    assert np.abs(direct).max() > 0.0
    assert np.abs(np.array(others) - direct).max() < 1e-6 * np.abs(direct).max()
