"""Bodies that only contact can hold: they land, the springs leave nothing, motions are named."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.verification.free_blocks import CLAMP, YOUNG, free_block, laws

from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import Vec
from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.interface import ContactLaw, Interface
from anisocontact.interface.augmentation import Augmentation
from anisocontact.mesh import (
    Body,
    BoxSpec,
    Model,
    build_box,
)
from anisocontact.solver import Cut, Problem, Solver, Step, StoppedError
from anisocontact.solver.strategies.newton import Newton, NewtonResult
from anisocontact.solver.terms.free_modes import bodies, free_modes, named
from anisocontact.surfaces import make_surface


def _loads(stress: float = 1.0) -> list[Step]:
    return [
        Step("press", 2, traction={"block.top": {"z": -10.0 * stress}}),
        Step("shear", 2, traction={"block.top": {"x": 2.0 * stress}}),
    ]


@pytest.mark.parametrize("gap", [0.0, 0.1, 1.0])
def test_free_block_lands_and_carries_the_load(gap: float) -> None:
    """Pressed through a gap of up to two heights and sheared below the limit of friction.

    Requirement: first contact of an unsupported body. Source: equilibrium, the contact force is
    the load on the top, 10 and 2 on an area of 1. Tolerance 1e-6: the springs that are left carry
    1e-7 of the forces at work.
    """
    problem = free_block(gap)
    accepted = list(Solver(problem, _loads()).run())
    force, _ = problem.contacts[0].resultant()
    np.testing.assert_allclose(force, [-2.0, 0.0, 10.0], atol=1e-5)
    assert len(accepted) == 4
    assert (accepted[-1].energies["stabilisation"] > 0.0) is (gap > 0.0)


@pytest.mark.parametrize(("master", "most"), [("plane", 18), ("base.top", 22)])
def test_a_block_that_lands_slides_no_farther_than_it_fell(master: str, most: int) -> None:
    """A block falls on slave nodes with multipliers under a load that leans: friction catches it.

    Requirement: points that come to lie carry friction from there, on a body from the material
    below them, so that the springs are gone within few corrections; what the fall sets free is told
    as energy. Sources: equilibrium, the contact force is the load; the balance of energy.
    Tolerances: 1e-6 as above; corrections of both increments, of which 15 and 18 are needed, and
    more than 90 where nothing rubs against the fall; the balance within 1 % of the work, which
    stabilisation takes up but for the strain, in the increment of the fall alone.
    """
    boxes = {"block": BoxSpec((0, 0, 0.05), (1, 1, 1), (3, 3, 3))}
    held = {}
    normal, adhesion, friction = laws()
    below: Any = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    if master != "plane":
        boxes["base"] = BoxSpec((-0.55, -0.5, -0.5), (2, 2, 0.5), (5, 5, 2))
        below, held = master, CLAMP
    model = build_box(boxes)
    law, exactly = ContactLaw(normal, adhesion, friction), Augmentation()
    contact = Contact(model, "block.bottom", below, law, mortar=True, augmentation=exactly)
    elastic = make_material("linear-elastic", E=YOUNG, nu=0.3)
    problem = Problem(model, dict.fromkeys(boxes, elastic), [contact])
    force = {"block.top": {"x": 1.0, "z": -5.0}}
    first, second = Solver(problem, [Step("load", 2, held, force=force)]).run()
    np.testing.assert_allclose(contact.resultant()[0], [-1.0, 0.0, 5.0], atol=1e-5)
    assert first.iterations + second.iterations <= most
    for each in (first, second):
        energies = each.energies
        assert abs(energies["residual"]) < 0.01 * energies["external"]
    assert second.energies["stabilisation"] == first.energies["stabilisation"]


def test_a_block_that_touches_needs_no_energy() -> None:
    """Without a gap contact holds the block from the start: there are no springs."""
    problem = free_block(0.0)
    last = list(Solver(problem, _loads()).run())[-1].energies
    assert last["stabilisation"] == 0.0


@pytest.mark.parametrize("strategy", ["condensed", "iterative"])
def test_strategies_bring_a_body_to_rest_on_the_same_way(strategy: str) -> None:
    """A tall block falls on a plane, is pressed by its top, and then pushed along the plane.

    Requirement: what springs dissipate, and what friction does on the way over which they let go,
    does not depend on which unknowns a strategy keeps. Source: `direct`. Tolerance: that of
    Newton's method, 1e-8 of the work; springs on all nodes took up five times as much.
    """

    def energies(name: str) -> list[dict[str, float]]:
        boxes = {"block": BoxSpec((0, 0, 1e-3), (1, 1, 1.5), (3, 3, 4))}
        plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
        contact = Contact(
            model := build_box(boxes), "block.bottom", Interface(plane, *laws()), mortar=False
        )
        elastic = make_material("linear-elastic", E=YOUNG, nu=0.3)
        problem = Problem(model, {"block": elastic}, [contact])
        run = Solver(problem, _loads(), options={"snes_rtol": 1e-11}, strategy=name).run()
        return [dict(one.energies) for one in run]

    for ours, theirs in zip(energies(strategy), energies("direct"), strict=True):
        assert ours == pytest.approx(theirs, rel=0.0, abs=1e-8 * theirs["external"])
        assert ours["stabilisation"] > 1e-6 * ours["external"]


def test_same_answer_in_any_units() -> None:
    """In nm and GPa-like numbers the forces are those of m and N, 1e-7, gap and all."""
    problem = free_block(0.3)
    for _ in Solver(problem, _loads()).run():
        pass
    other = free_block(0.3, unit=1e6, stress=1e-3)
    for _ in Solver(other, _loads(1e-3)).run():
        pass
    force, scaled = (p.contacts[0].resultant()[0] for p in (problem, other))
    np.testing.assert_allclose(scaled, 1e9 * force, atol=1e2)


@pytest.mark.parametrize(
    ("gap", "strategy", "taken"),
    [(0.3, "auto", "direct"), (2.0, "auto", "direct"), (2.0, "condensed", "condensed")],
)
def test_block_falls_on_a_body(gap: float, strategy: str, taken: str) -> None:
    """The same on a meshed body: it meets the facets and sticks, also from so far away that no
    facet is in reach of it at the start. `auto` does not condense a linear body that does not touch
    what is to hold it, and who asks for that keeps the nodes with springs."""
    model = build_box(
        {
            "block": BoxSpec((0, 0, gap), (1, 1, 0.5), (3, 3, 2)),
            "base": BoxSpec((-0.5, -0.5, -0.5), (2, 2, 0.5), (5, 5, 1)),
        }
    )
    contact = Contact(
        model,
        "block.bottom",
        "base.top",
        law=ContactLaw(*laws()),
        current_area=False,
        mortar=False,
    )
    elastic = make_material("linear-elastic", E=YOUNG, nu=0.3)
    problem = Problem(model, {"block": elastic, "base": elastic}, [contact])
    step = Step("press", 1, CLAMP, {"block.top": {"z": -10.0}})
    solver = Solver(problem, [step], strategy=strategy)
    assert solver.choice.name == taken
    for _ in solver.run():
        pass
    np.testing.assert_allclose(contact.resultant()[0], [0.0, 0.0, 10.0], atol=1e-5)
    assert problem.stabilisation.notes[0].startswith("body 'block' is free to move: translation")


def test_body_that_flies_off_is_named() -> None:
    """Pulled away from the plane: one error that names the body and its motions."""
    problem = free_block(0.0)
    with pytest.raises(RuntimeError, match=r"body 'block' has lost all contact, .*: translation"):
        list(Solver(problem, [Step("pull", 1, traction={"block.top": {"z": 1.0}})]).run())


def _under_a_ram(stabilised: bool = True) -> Problem:
    """A block that touches a plane below and a meshed ram above; only the ram has supports."""
    model = build_box(
        {
            "block": BoxSpec((0, 0, -1e-4), (1, 1, 0.5), (2, 2, 1)),
            "ram": BoxSpec((-0.5, -0.5, 0.4998), (2, 2, 0.5), (3, 3, 1)),
        }
    )
    plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    below = Contact(model, "block.bottom", Interface(plane, *laws()), mortar=False)
    law = ContactLaw(*laws())
    above = Contact(model, "block.top", "ram.bottom", law=law, current_area=False, mortar=False)
    elastic = make_material("linear-elastic", E=YOUNG, nu=0.3)
    materials = {"block": elastic, "ram": elastic}
    return Problem(model, materials, [below, above], stabilised=stabilised)


def test_body_without_force_stays_where_it_was() -> None:
    """A ram presses a block, is lifted, moved aside and presses again.

    Requirement: a block that nothing pulls does not leave its place, although without force it is
    in balance anywhere (it was once found 14 lengths away). Source: release of the strain moves it
    by the 5e-3 that the ram presses. Tolerance of the second force: the block has moved by a
    hundredth of a facet under the ram.
    """
    problem = _under_a_ram()
    steps = [
        Step("press", 1, {"ram.top": {"x": 0.0, "y": 0.0, "z": -0.005}}),
        Step("lift", 1, {"ram.top": {"z": 0.2}}),
        Step("aside", 1, {"ram.top": {"x": 0.3}}),
        Step("again", 1, {"ram.top": {"z": -0.005}}),
    ]
    nodes = bodies(problem.model)[0].nodes
    forces = {}
    for accepted in Solver(problem, steps).run():
        assert np.abs(problem.u.x.array.reshape(-1, 3)[nodes]).max() < 6e-3
        forces[accepted.step] = problem.contacts[1].resultant()[0][2]
    assert forces["lift"] == forces["aside"] == 0.0
    assert forces["again"] == pytest.approx(forces["press"], rel=0.05)


def test_body_without_force_and_without_springs_is_refused() -> None:
    """The ram lets go of a block that nothing else is to hold: rounding would say where it is."""
    problem = _under_a_ram(stabilised=False)
    steps = [
        Step("press", 1, {"ram.top": {"x": 0.0, "y": 0.0, "z": -0.005}}),
        Step("lift", 1, {"ram.top": {"z": 0.2}}),
    ]
    run = Solver(problem, steps).run()
    assert next(run).step == "press"
    with pytest.raises(StoppedError, match="body 'block' has lost all contact: translation along"):
        list(run)


def test_a_state_off_everything_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """A Newton method that throws the block up by its length and calls that equilibrium."""
    problem = free_block(0.0)
    solve = Newton.solve
    throws = [False]

    def thrown(self: Newton, x: Vec, *options: Any, **named: Any) -> NewtonResult:
        if not throws[0]:
            return solve(self, x, *options, **named)
        x.array[:] += np.tile([0.0, 0.0, 1.0], len(x.array_r) // 3)
        return NewtonResult(1, [0.0], "")

    monkeypatch.setattr(Newton, "solve", thrown)
    press = _loads()[0]
    released = replace(press, name="release", traction={})
    run = Solver(problem, [press, released], strategy="direct").run()
    assert [next(run).increment for _ in range(2)] == [1, 2]
    before = problem.u.x.array.copy()
    throws[0] = True
    said = r"body 'block' has lost all contact: translation along x, y and z"
    with pytest.raises(StoppedError, match=said):
        next(run)
    assert np.array_equal(problem.u.x.array, before)


def test_a_body_goes_with_its_supports() -> None:
    """In the air, held along x and y and carried by three lengths: its supports explain the way."""
    problem = free_block(5.0)
    cuts: list[Cut] = []
    aside = {"x": 3.0, "y": 0.0}
    step = Step("aside", 1, {"block.top": aside, "block.bottom": aside})
    (accepted,) = Solver(problem, [step]).run(on_cut=cuts.append)
    counts = accepted.contacts["block.bottom"]
    assert counts["open"] == sum(counts.values())
    assert cuts == []


def test_no_springs_where_contact_holds() -> None:
    """What springs on a body that sticks cost, and that without them the answer is the same.

    Requirement: at least a third fewer iterations, resultants equal to 1e-5 of the load. The step
    is the linear one: a slip that turns with the slave takes a correction of its own either way.
    """
    iterations = []
    for careful in (False, True):
        problem, steps = free_block(0.0, evolution="backward-euler"), _loads()
        run = Solver(problem, steps).run()
        accepted = [next(run)]
        problem.stabilisation.trust.careful = careful
        accepted += run
        iterations.append(sum(one.iterations for one in accepted[1:]))
        assert (accepted[-1].energies["stabilisation"] > 0.0) is careful
        force, _ = problem.contacts[0].resultant()
        np.testing.assert_allclose(force, [-2.0, 0.0, 10.0], atol=1e-5)
    assert iterations[0] < iterations[1] / 1.5


def test_contact_is_trusted_again() -> None:
    """Two attempts fail in a step in which a block sticks: one on springs, one without later on.

    Requirement: springs take up energy in the increment after the first failure and in the two
    after the second one, as contact was trusted in vain in between, and in no other.
    """
    problem = free_block(0.0)
    stabilisation, taken = problem.stabilisation, [0.0]
    steps = [_loads()[0], Step("shear", 6, traction={"block.top": {"x": 2.0}})]
    for number, accepted in enumerate(Solver(problem, steps).run(), 1):
        taken.append(accepted.energies["stabilisation"])
        if number == 3:
            stabilisation.trust.careful = True
        if number == 5:
            stabilisation.distrust()
        if number == 6:  # a run that is restarted here goes on alike
            kept = stabilisation.persistent()
            stabilisation.distrust()
            stabilisation.restore(kept)
    assert (np.diff(taken)[3:] > 0.0).tolist() == [True, False, True, True, False]


def test_sticking_without_stiffness_holds_nothing() -> None:
    """Pressed by its face, with adhesion along x alone: points stick, but y meets no force.

    Requirement: such a body keeps its springs and is not moved along the plane, by 1e-6 of its
    length: a singular matrix would move it anywhere.
    """
    problem = free_block(0.0, along_y=0.0)
    accepted = list(Solver(problem, _loads()[:1]).run())
    assert accepted[-1].contacts["block.bottom"]["stick"] > 3
    assert accepted[-1].energies["stabilisation"] > 0.0
    block = problem.u.x.array.reshape(-1, 3)
    assert np.abs(block[:, :2].mean(axis=0)).max() < 1e-6


def test_body_in_no_contact_is_refused_before_the_run() -> None:
    """Held across x alone and in no contact: the free motions are named by step."""
    model = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1))})
    problem = Problem(model, {"block": make_material("linear-elastic", E=1.0, nu=0.3)}, [])
    step = Step("push", 1, {"block.left": {"x": 0.0}})
    said = r"step 'push': body 'block' is free to move: translation along y and z, rotation about x"
    with pytest.raises(InputError, match=said):
        Solver(problem, [step])


def test_without_stabilisation_a_body_has_to_touch() -> None:
    """Switched off, a body in the air is an error that names what is missing."""
    problem = free_block(0.1, stabilised=False)
    with pytest.raises(InputError, match=r"nothing touches it and stabilisation is off"):
        list(Solver(problem, _loads()).run())


def test_names_of_free_motions() -> None:
    """A point that is held leaves three rotations, a line one, a face none."""
    model = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 1), (2, 2, 2))})
    body = bodies(model)[0]
    places = model.space.tabulate_dof_coordinates().round(9)
    axes = list(np.eye(3))

    def left(where: np.ndarray) -> str:
        nodes = np.flatnonzero(where).astype(np.int64)
        return named(free_modes(body, [(nodes, e) for e in axes], model.mesh.comm))

    corner = (places == 0.0).all(axis=1)
    edge = (places[:, :2] == 0.0).all(axis=1)
    assert left(corner) == "rotation about x, y and z"
    assert left(edge) == "rotation about z"
    assert left(places[:, 2] == 0.0) == ""


def test_bodies_that_share_nodes_hold_each_other() -> None:
    """Three layers in one mesh, the lowest held, the highest pulled: nothing needs springs.

    Requirement: they stretch by `sum h p / E` without Poisson's ratio, to the tolerance of Newton.
    """
    column = Body("column", BoxSpec((0, 0, 0), (1, 1, 3), (1, 1, 3))).arrays()
    modulus = {"low": 100.0, "mid": 1000.0, "top": 200.0}
    layers = {name: np.array([cell]) for cell, name in enumerate(modulus)}
    ends = {"low.bottom": column.facets["column.bottom"], "top.top": column.facets["column.top"]}
    model = Model.from_arrays(replace(column, bodies=layers, facets=ends))
    materials = {n: make_material("linear-elastic", E=e, nu=0.0) for n, e in modulus.items()}
    problem = Problem(model, materials, [])
    pull = Step("pull", 1, {"low.bottom": dict.fromkeys("xyz", 0.0)}, {"top.top": {"z": 2.0}})
    (accepted,) = Solver(problem, [pull]).run()
    assert accepted.energies["stabilisation"] == 0.0
    stretch = problem.u.x.array.reshape(-1, 3)[:, 2].max()
    assert stretch == pytest.approx(sum(2.0 / e for e in modulus.values()), rel=1e-9)


def test_bodies_that_only_touch_each_other_are_refused_before_the_run() -> None:
    """A block on a base that stands on nothing: contact does not hold what both do together."""
    model = build_box(
        {
            "block": BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1)),
            "base": BoxSpec((0, 0, -1), (1, 1, 1), (2, 2, 1)),
        }
    )
    contact = Contact(model, "block.bottom", "base.top", law=ContactLaw(*laws()), mortar=False)
    elastic = make_material("linear-elastic", E=YOUNG, nu=0.3)
    problem = Problem(model, {"block": elastic, "base": elastic}, [contact])
    step = Step("press", 1, {"base.bottom": {"z": 0.0}}, {"block.top": {"z": -1.0}})
    said = (
        r"step 'press': body 'block \+ base' is free to move: translation along x and y, "
        r"rotation about z; its parts touch nothing but each other"
    )
    with pytest.raises(InputError, match=said):
        Solver(problem, [step])
