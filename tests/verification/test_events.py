"""Steps that end on an event: sliding, forces, gaps, displacements; what comes after; restart."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from tests.verification.block_of_events import MU, NU, PENALTY, PRESS, E, block, run, stiffness

from anisocontact.base.errors import InputError
from anisocontact.bulk import make_material
from anisocontact.mesh import BoxSpec, build_box, node_near
from anisocontact.results.probes import Peak, Probe
from anisocontact.rigid import RigidBody
from anisocontact.solver import Problem, Solver, Step, Until


@pytest.mark.parametrize("strategy", ["direct", "condensed", "iterative"])
def test_sliding_begins_at_mu_n(strategy: str):
    """A block pressed by a uniform pressure and dragged until all of it slides.

    Requirement: the step ends where Q = mu N, the drag at most a thousandth of an increment
    further: 1 %; the next step goes on from there. Source: Coulomb. Tolerance: points do not
    begin to slide at once, as the drag at the top turns the block.
    """
    press = Step(
        "press", 1, {"block.top": {"x": 0.0, "y": 0.0}}, traction={"block.top": {"z": -20.0}}
    )
    drag = Step(
        "drag",
        3,
        {"block.top": {"x": 0.05}},
        until=Until(contact="block.bottom", event="sliding"),
    )
    found = run(block(), press, drag, Step("rest", 1), strategy=strategy)
    ends = [a for a in found if a.event]
    assert len(ends) == 1
    force = ends[0].resultants["block.bottom"][0]
    assert abs(force[0]) == pytest.approx(MU * 20.0, rel=1e-9)
    before = found[found.index(ends[0]) - 1]
    assert before.contacts["block.bottom"]["stick"] > 0
    assert ends[0].time - before.time <= 1.01e-3 / 3.0
    assert 1.0 < ends[0].time < 2.0
    assert found[-1].step == "rest"
    assert found[-1].time == pytest.approx(ends[0].time + 1.0, rel=1e-12)
    assert found[-1].resultants["block.bottom"][0] == pytest.approx(force, rel=1e-6)


@pytest.mark.parametrize("strategy", ["direct", "condensed", "iterative"])
@pytest.mark.parametrize("what", ["contact", "reaction"])
def test_force_is_reached(what: str, strategy: str):
    """A block pressed by its top until a force is reached, in a linear contact.

    Requirement: the displacement is force over stiffness, 1e-3 of the force; what is led stays
    there in the next step, and is led on from there in the one after. Source: springs in series.
    Tolerance: that of the event.
    """
    name = {"contact": "block.bottom", "reaction": "block.top"}[what]
    sign = {"contact": 1.0, "reaction": -1.0}[what]
    until = Until(**{what: name}, value=4.0 * sign, along=(0, 0, 1))
    problem = block()
    steps = [
        Step("press", 2, PRESS, until=until),
        Step("rest", 1),
        Step("lift", 1, {"block.top": {"z": -0.001}}),
    ]
    found = run(problem, *steps, strategy=strategy)
    press, rest, lift = ([a for a in found if a.step == s.name][-1] for s in steps)
    assert press.event == f"{until.text}"
    force = press.reactions["block.top"][2]
    assert force == pytest.approx(-4.0, rel=1e-3)
    assert press.time == pytest.approx(-force / stiffness() / 0.01, rel=1e-9)
    assert rest.reactions["block.top"][2] == pytest.approx(force, rel=1e-9)
    assert rest.time == pytest.approx(press.time + 1.0, rel=1e-12)
    assert lift.reactions["block.top"][2] == pytest.approx(-0.001 * stiffness(), rel=1e-9)


@pytest.mark.parametrize("strategy", ["direct", "condensed", "iterative"])
def test_displacement_of_a_point_is_reached(strategy: str):
    """A block pressed by its top until a corner of its lower side has moved by a distance.

    Requirement: 0.0002 to a thousandth, and the force that makes it, penalty times area times the
    distance. Source: springs in series. Tolerance: that of the event.
    """
    problem = block()
    corner = node_near(problem.model, "block", (1, 0, 0))
    problem.model.name_nodes("block.corner", corner)
    until = Until(displacement="block.corner", value=-2e-4, along=(0, 0, 1))
    last = run(problem, Step("press", 2, PRESS, until=until), strategy=strategy)[-1]
    assert last.event == until.text
    assert last.resultants["block.bottom"][0][2] == pytest.approx(2e-4 * PENALTY, rel=1e-3)


@pytest.mark.parametrize("strategy", ["direct", "iterative", "auto"])
def test_stress_at_a_point_is_reached(strategy: str):
    """A block with nu = 0 pressed by its top until the stress in its middle is reached.

    Requirement: force and time are those of the stress, a thousandth. Source: springs in series; a
    uniform stress. Tolerance: that of the event.
    """
    middle = Probe(((0.5, 0.5, 0.25),))
    until = Until(measure=Peak(middle, "stress", "ZZ"), value=-10.0, name="stress ZZ")
    last = run(block(), Step("press", 2, PRESS, until=until), strategy=strategy)[-1]
    assert last.event == "stress ZZ reaches -10"
    assert last.resultants["block.bottom"][0][2] == pytest.approx(10.0, rel=1e-3)
    assert last.time == pytest.approx(10.0 / stiffness() / 0.01, rel=1e-3)


def test_strategy_that_does_not_know_all_displacements():
    """Requirement: one line."""
    until = Until(measure=Peak(Probe(((0.5, 0.5, 0.25),)), "von_mises"), value=10.0)
    with pytest.raises(InputError, match="needs all displacements"):
        run(block(), Step("press", 2, PRESS, until=until), strategy="condensed")


@pytest.mark.parametrize("component", ["ZZ", None])
def test_stress_with_a_history_is_reached(component: str | None):
    """A bar that yields, pulled until its stress is beyond the yield stress, in three increments.

    Requirement: strain s/E + (s - Y)/H to 1e-5 at s = 8, Y = 5, whose trials see the stress of now
    and not the one accepted before. Source: uniaxial plasticity with linear hardening. Tolerance:
    1e-6 of the event over the slope of the stress.
    """
    model = build_box({"bar": BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1))})
    metal = make_material("plastic", E=E, nu=NU, yield_stress=5.0, hardening=100.0)
    planes = ["bar.left", "bar.front", "bar.bottom"]
    problem = Problem(model, {"bar": metal}, symmetry=planes)
    quantity = "von_mises" if component is None else "stress"
    peak = Peak(Probe(group="bar.top"), quantity, component)
    until = Until(measure=peak, value=8.0, tolerance=1e-6)
    last = run(problem, Step("pull", 3, {"bar.top": {"z": 0.1}}, until=until))[-1]
    assert last.event
    assert 0.1 * last.time == pytest.approx(8.0 / E + 3.0 / 100.0, rel=1e-5)


def test_any_function_of_the_problem():
    """The mean of a displacement, written by a script, of a bar that is pulled.

    Requirement: half the way of the top, a thousandth. Source: a linear displacement. Tolerance:
    that of the event.
    """
    model = build_box({"bar": BoxSpec((0, 0, 0), (1, 1, 1), (2, 2, 2))})
    elastic = make_material("linear-elastic", E=E, nu=0.0)
    problem = Problem(model, {"bar": elastic}, symmetry=["bar.left", "bar.front", "bar.bottom"])

    def mean(of: Problem, trial: bool) -> float:
        return float(of.u.x.array.reshape(-1, 3)[:, 2].mean())

    until = Until(measure=mean, value=0.02, name="mean of w")
    last = run(problem, Step("pull", 2, {"bar.top": {"z": 0.1}}, until=until))[-1]
    assert last.event == "mean of w reaches 0.02"
    assert last.time == pytest.approx(0.4, rel=1e-3)


@pytest.mark.parametrize("of", ["reactions", "support_forces", "internal_forces"])
def test_forces_of_a_function_are_those_of_the_trial(of: str):
    """The force of a bar that yields, asked of the problem by a script, in three increments.

    Requirement: strain s/E + (s - Y)/H to 1e-5 at s = 8, Y = 5. Source: uniaxial plasticity with
    linear hardening. Tolerance: 1e-6 of the event over the slope of the stress. Forces of the state
    accepted before ended the step an increment late, at another force than was said.
    """
    model = build_box({"bar": BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1))})
    metal = make_material("plastic", E=E, nu=NU, yield_stress=5.0, hardening=100.0)
    planes = ["bar.left", "bar.front", "bar.bottom"]
    problem = Problem(model, {"bar": metal}, symmetry=planes)
    top = model.nodes("bar.top")

    def force(of_bar: Problem, trial: bool) -> float:
        if of == "reactions":
            return float(of_bar.reactions().get("bar.top", np.zeros(3))[2])
        return abs(float(getattr(of_bar, of)()[top, 2].sum()))

    until = Until(measure=force, value=8.0, tolerance=1e-6)
    last = run(problem, Step("pull", 3, {"bar.top": {"z": 0.1}}, until=until))[-1]
    assert last.event
    assert last.reactions["bar.top"][2] == pytest.approx(8.0, rel=1e-5)
    assert 0.1 * last.time == pytest.approx(8.0 / E + 3.0 / 100.0, rel=1e-5)


def test_a_trial_has_no_energies():
    """Requirement: one line."""
    until = Until(measure=lambda of, trial: of.energies()["elastic"], value=0.1, name="energy")
    with pytest.raises(InputError, match=r"Until\.measure: a trial has no energies yet"):
        run(block(), Step("press", 2, PRESS, until=until))


def test_loads_stay_where_the_event_found_them():
    """A traction that presses until the top has moved by a distance, released after that.

    Requirement: the load of the event acts on in the next step, and goes to zero from there.
    Source: springs in series. Tolerance: that of the event; Newton.
    """
    problem = block()
    until = Until(displacement="block.top", value=0.003)
    held = {"block.top": {"x": 0.0, "y": 0.0}}
    found = run(
        problem,
        Step("press", 2, held, traction={"block.top": {"z": -20.0}}, until=until),
        Step("rest", 1),
        Step("release", 2, traction={"block.top": {"z": 0.0}}),
    )
    press, rest, half, free = (
        next(a for a in reversed(found) if a.step == "press"),
        *[a for a in found if a.step != "press"],
    )
    forces = [a.resultants["block.bottom"][0][2] for a in (press, rest, half, free)]
    assert forces[0] == pytest.approx(0.003 * stiffness(), rel=1e-3)
    assert press.time == pytest.approx(forces[0] / 20.0, rel=1e-9)
    assert forces[1:] == pytest.approx([forces[0], 0.5 * forces[0], 0.0], rel=1e-8, abs=1e-9)


def test_contact_begins_and_is_lost():
    """A rigid plane comes to a block, presses it and leaves it.

    Requirement: steps end within a thousandth of an increment of the contact that begins and
    ends. Source: the gap, 0.02. Tolerance: that of the event.
    """
    die = RigidBody("die", (0.5, 0.5, 0.0))
    problem = block(height=0.02, body=die)
    clamp = {"block.top": dict.fromkeys("xyz", 0.0)}
    closed, lost = (Until(contact="block.bottom", event=e) for e in ("closed", "lost"))
    found = run(
        problem,
        Step("come", 2, clamp, motion={"die": {"z": 0.05}}, until=closed),
        Step("press", 1, motion={"die": {"z": 0.03}}),
        Step("leave", 3, motion={"die": {"z": 0.0}}, until=lost),
    )
    come, leave = (a for a in found if a.event)
    assert 0.4 < come.time < 0.4 + 1.01e-3 / 2.0
    press = next(a for a in found if a.step == "press")
    assert press.time == pytest.approx(come.time + 1.0)
    left = leave.time - press.time
    assert 1.0 / 3.0 < left < 1.0 / 3.0 + 1.01e-3 / 3.0


def test_finite_strain_force_with_course_and_rigid_load():
    """A free die loaded until the block has given way; loads on rigid bodies stay as well.

    Requirement: the displacement to the tolerance, the load of the event after it. Source: balance.
    Tolerance: 1e-4 as asked for; Newton.
    """
    die = RigidBody("die", (0.5, 0.5, 0.0), free=True)
    problem = block(body=die, material="neo-hookean")
    clamp = {"block.top": dict.fromkeys("xyz", 0.0)}
    until = Until(displacement="block.bottom", value=0.01, along=(0, 0, 2), tolerance=1e-4)
    found = run(
        problem,
        Step("touch", 1, clamp, motion={"die": {"z": 0.001}}),
        Step("push", 3, motion={"die": {"z": None}}, load={"die": {"z": 60.0}}, until=until),
        Step("rest", 1),
    )
    push = next(a for a in found if a.event)
    force = push.resultants["block.bottom"][0][2]
    x = problem.model.space.tabulate_dof_coordinates()
    u = problem.u.x.array.reshape(-1, 3)[np.isclose(x[:, 2], 0.0), 2]
    assert u == pytest.approx(0.01, rel=1e-4)
    assert found[-1].resultants["block.bottom"][0][2] == pytest.approx(force, rel=1e-8)


def test_an_event_that_never_comes():
    """Requirement: the step takes all its increments and says so, as a warning too."""
    said: list[str] = []
    until = Until(contact="block.bottom", event="lost")
    solver = Solver(block(), [Step("press", 2, PRESS, until=until), Step("rest", 1)])
    found = list(solver.run(on_warning=said.append))
    assert [a.missed for a in found] == ["", until.text, ""]
    assert found[-1].time == 2.0
    assert any("ends without its event, contact is lost" in text for text in said)


@pytest.mark.parametrize(
    ("given", "text"),
    [
        ({}, "nothing given, one of contact, reaction, displacement"),
        ({"contact": "a", "reaction": "b", "value": 1.0}, "contact and reaction given"),
        ({"contact": "a"}, "one of event, value"),
        ({"reaction": "a", "event": "lost"}, "one of value"),
        ({"contact": "a", "event": "open"}, "'open' given, must be one of closed"),
        ({"reaction": "a", "value": 1.0, "along": (0, 0, 0)}, "not all 0"),
        ({"reaction": "a", "value": -1.0}, "must be >= 0"),
        ({"reaction": "a", "value": 1.0, "tolerance": 0.0}, "must be > 0"),
    ],
)
def test_mistakes(given: dict[str, Any], text: str):
    """Requirement: one line."""
    with pytest.raises(InputError, match=text):
        Until(**given)


@pytest.mark.parametrize(
    ("until", "text"),
    [
        (Until(contact="block.side", event="lost"), "allowed: block.bottom$"),
        (Until(displacement="block.side", value=1.0), "block.side"),
        (Until(reaction="block.left", value=1.0), "what holds the bodies: block.top"),
    ],
)
def test_unknown_places(until: Until, text: str):
    """Requirement: one line before the run begins."""
    with pytest.raises(InputError, match=text):
        Solver(block(), [Step("press", 2, PRESS, until=until)])
