"""Increments that fail: cut, grown again, told of; and the end of each met exactly."""

from __future__ import annotations

import dataclasses
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.base.errors import InputError
from anisocontact.base.limits import Limits
from anisocontact.solver import Solver, Step, StoppedError
from anisocontact.solver.stepping.acceptance import INVERTED
from anisocontact.solver.stepping.convergence_diagnostics import NAMED
from anisocontact.solver.stepping.failure_reasons import explained
from anisocontact.solver.stepping.increment_control import IncrementControl
from anisocontact.solver.stepping.status_watch import StatusWatch
from anisocontact.solver.stepping.turn_watch import TurnWatch
from anisocontact.solver.system.culprit import Culprit

PRESS = {"block.top": {"x": 0.0, "y": 0.0, "z": -0.01}}
DRAG = {"block.top": {"x": 0.02, "y": 0.01}}


def solved(block, *steps, limits=None, **options):
    """Accepted parts and cuts of a run."""
    cuts: list = []
    solver = Solver(block.problem, list(steps), options=options, limits=limits)
    return list(solver.run(on_cut=cuts.append)), cuts


@pytest.mark.parametrize(
    ("values", "line"),
    [
        ({"largest": 1.5}, "largest_increment: 1.5 given, must be > 0 and at most 1"),
        ({"smallest": 0.0}, "smallest_increment: 0.0 given, must be > 0 and at most the largest"),
        ({"smallest": 0.2, "largest": 0.1}, "smallest_increment: 0.2 given, must be > 0 and at"),
        ({"cuts": -1}, "cuts: -1 given, must be >= 0"),
    ],
)
def test_wrong_limits_are_one_line(values, line):
    with pytest.raises(InputError, match=line):
        Limits(**values)


@given(
    outcomes=st.lists(st.booleans(), max_size=60),
    largest=st.sampled_from([1.0, 0.3, 0.1]),
)
def test_every_end_is_met_exactly(outcomes, largest):
    """Whatever fails, parts add up to whole increments and none is below the smallest."""
    limits = Limits(smallest=1e-3, largest=largest)
    control = IncrementControl(limits, limits.largest)
    reached = 0.0
    for good in outcomes:
        before = control.increment
        if good:
            assert control.done < control.end <= 1.0
            # parts are of equal size up to the end: at least half of what was asked for
            assert 0.5 * limits.smallest < control.part <= largest * (1.0 + 1e-9)
            end = control.end
            control.advance(3)
            assert (control.increment == before + 1) == (end == 1.0)
        elif not control.cut():
            assert control.part <= limits.smallest or control.cuts == limits.cuts
        now = control.increment + control.done
        assert now >= reached
        reached = now


def test_parts_grow_back_after_a_cut():
    limits = Limits()
    control = IncrementControl(limits, limits.largest)
    assert control.cut()
    assert control.cut()
    sizes = []
    while control.increment == 1:
        sizes.append(control.part)
        control.advance(3)
    assert sizes[:3] == [1 / 16, 1 / 16, 1 / 8]
    assert sum(sizes) == 1.0
    assert control.part == 1.0


def test_what_fails_again_and_again_is_tried_more_and_more_seldom():
    """An increment in which nothing larger than a hundredth of it converges.

    Requirement: it is passed with the cuts that are allowed, failures are less than a tenth of all
    trials (a larger one after every two that converge would end at the 51st cut), and as soon as a
    larger one converges they grow again after two.
    """
    control = IncrementControl(Limits(), 1.0)
    failures = trials = 0
    while control.increment == 1:
        trials += 1
        if control.part > 0.01:
            failures += 1
            assert control.cut()
        else:
            control.advance(3)
    assert failures < 0.1 * trials
    sizes = []
    while control.increment == 2:
        sizes.append(control.part)
        control.advance(3)
    assert control.wait == 2
    assert len(sizes) < 30


def test_an_increment_that_fails_is_solved_in_parts(fe, no_detours):
    """Four iterations are enough for a part of the drag, not for the whole, without detours.

    Requirement: cut back on failure, output times met exactly, each cut told with its reason. The
    path is the one of more increments: its end agrees with 32 of them to the error of the parts.
    """
    block = fe.block(fe.interface(), cells=(3, 3, 2))
    accepted, cuts = solved(block, Step("press", 2, PRESS), Step("drag", 2, DRAG), snes_max_it=4)
    assert len(cuts) > 0
    times = [a.time for a in accepted]
    assert times == sorted(times)
    assert [a.time for a in accepted if a.done == 1.0] == [0.5, 1.0, 1.5, 2.0]
    assert len(times) > 4
    first = cuts[0]
    assert (first.step, first.increment, first.size, first.next_size) == ("drag", 1, 1.0, 0.25)
    assert "no convergence in 4 Newton iterations" in first.reason
    assert str(first).startswith("drag 1  cut from 1 to 0.25 of the increment after ")
    fine = fe.block(fe.interface(), cells=(3, 3, 2))
    wanted, none = solved(fine, Step("press", 2, PRESS), Step("drag", 32, DRAG))
    assert none == []
    ends = [run[-1].resultants["block.bottom"][0] for run in (accepted, wanted)]
    assert np.linalg.norm(ends[0] - ends[1]) < 0.05 * np.linalg.norm(ends[1])


def test_iterations_of_failures_are_counted(fe):
    seen: list = []
    block = fe.block(fe.interface(), cells=(2, 2, 1))
    solver = Solver(
        block.problem, [Step("a", 1, PRESS), Step("b", 1, DRAG)], options={"snes_max_it": 5}
    )
    spent = [a.iterations for a in solver.run(seen.append)]
    assert sum(spent) == sum(p.iteration > 0 for p in seen)


def test_largest_increment_is_kept(fe):
    block = fe.block(fe.interface(), cells=(2, 2, 1))
    accepted, _ = solved(block, Step("press", 2, PRESS), limits=Limits(largest=0.3))
    assert [a.done for a in accepted] == pytest.approx([0.25, 0.5, 0.75, 1.0] * 2)
    assert [a.time for a in accepted] == pytest.approx(np.arange(1, 9) / 8)


def test_points_without_answer_are_named(fe):
    """Requirement: each cut names the points that caused it, with facet and status history."""
    interface = fe.interface()
    update = interface.update

    def partial(state, x, dt=1.0, *, tangent=True, **more_of_it):
        response = update(state, x, dt, tangent=tangent, **more_of_it)
        return dataclasses.replace(response, failure=(x[:, 0] > 1.001).astype(np.int8))

    interface.update = partial
    block = fe.block(interface, cells=(2, 2, 1))
    block.run(Step("press", 1, PRESS))
    cuts: list = []
    solver = Solver(block.problem, [Step("drag", 1, {"block.top": {"x": 0.8}})])
    with pytest.raises(StoppedError) as stopped:
        list(solver.run(on_cut=cuts.append))
    culprit = cuts[0].culprits[0]
    assert (culprit.kind, culprit.contact) == ("law", "block.bottom")
    assert culprit.why == "no closest point on the surface"
    assert culprit.position[0] > 1.001
    # four points on each of the four facets
    assert culprit.facet == culprit.point // 4
    assert cuts[0].count >= len(cuts[0].culprits)
    assert len(cuts[0].culprits) <= NAMED
    assert len(stopped.value.points) > 0
    assert "cuts, the last sub-increment was" in str(stopped.value)
    assert stopped.value.culprits[0].kind == "law"


def test_a_cell_turned_inside_out_is_no_solution(fe):
    """Requirement: inverted elements are a failure; here the top is moved below the sole.

    A St. Venant-Kirchhoff body has an equilibrium with det F < 0, which has no meaning.
    """
    from anisocontact.bulk import make_material
    from anisocontact.mesh import BoxSpec, build_box
    from anisocontact.solver import Problem

    model = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1))})
    problem = Problem(model, {"block": make_material("st-venant-kirchhoff", E=1e3, nu=0.0)})
    hold = {"x": 0.0, "y": 0.0, "z": 0.0}
    step = Step("through", 1, {"block.bottom": hold, "block.top": hold | {"z": -1.5}})
    cuts: list = []
    with pytest.raises(StoppedError, match="cells are inverted") as stopped:
        list(Solver(problem, [step]).run(on_cut=cuts.append))
    assert cuts[0].culprits[0].kind == "inverted"
    assert stopped.value.culprits[0].position[:2] == pytest.approx((0.5, 0.5))
    top = model.space.tabulate_dof_coordinates()[:, 2] == 1.0
    assert -1.0 < problem.u.x.array.reshape(-1, 3)[top, 2].min() < -0.9


def test_corrections_that_invert_cells_are_no_equilibrium() -> None:
    """Requirement: what ended the attempt is told beside cells that a correction turned over.

    Such an iterate says nothing of how distorted the cells are; a state in equilibrium does.
    """
    found = [Culprit("inverted", (0.0, 0.0, 0.0), "the cell here is inverted")]
    told = explained("the residual is not a number", found, [])
    assert told == "the residual is not a number; cells are inverted (det F <= 0) by corrections"
    assert explained(INVERTED, found, []) == "cells are inverted (det F <= 0)"


def _touching(points: int) -> Any:
    """What is watched of a contact, with points that stay on the one facet of their master."""
    return SimpleNamespace(
        trial=SimpleNamespace(status=np.zeros(points, dtype=np.int8)),
        projected_facets=lambda: np.zeros(points, dtype=np.int64),
        located=lambda: np.ones(points, dtype=bool),
    )


def test_alternating_points_are_found():
    """Requirement: chattering is detected: points that flip, not those that change once."""
    contact = _touching(3)
    watch = StatusWatch([contact])
    assert not watch.unsettled()
    for i in range(6):
        contact.trial.status[:] = (1, 1 + i % 2, 0 if i < 3 else 1)
        watch.note(1.0)
    assert watch.chattering()[0].tolist() == [False, True, False]
    assert watch.unsettled()
    assert watch.history(0)[:, 1].tolist() == [1, 2, 1, 2, 1, 2]
    for _ in range(3):
        watch.note(1.0)
    assert not watch.unsettled()
    watch.clear()
    assert not watch.chattering()[0].any()


def test_points_at_the_border_of_the_master_are_named():
    """Requirement: a point that leaves its master and comes back is told from one that flips."""
    contact = _touching(2)
    watch = StatusWatch([contact])
    assert not watch.on_border(0).any()
    for i in range(6):
        contact.trial.status[:] = i % 2
        contact.located = lambda i=i: np.array([True, i % 2 == 1])
        watch.note(1.0)
    assert watch.chattering()[0].all()
    assert watch.on_border(0).tolist() == [False, True]
    found = [
        Culprit("chattering", (0.0, 0.0, 0.0), "", "sole", border=bool(b))
        for b in watch.on_border(0)
    ]
    told = explained("no convergence", found, [])
    assert "2 slave points alternates (chattering), 1 of them at the border" in told
    assert "border" not in explained("no convergence", found[:1], [])


@pytest.mark.parametrize(
    ("meshed", "nodes", "advice"),
    [
        (True, False, ": take the other side as the slave or take the pass mortar"),
        (True, True, ": take the other side as the slave"),
        (False, False, ": take the pass mortar"),
        (False, True, ""),
    ],
)
def test_advice_at_a_border_is_what_the_contact_can_have(meshed, nodes, advice):
    """Requirement: no other side where the master is a surface, no pass that it has already."""
    points = SimpleNamespace(at_nodes=nodes)
    contact = SimpleNamespace(name="sole", of_two_groups=meshed, slave_points=points)
    found = [Culprit("chattering", (0.0, 0.0, 0.0), "", "sole", border=True)]
    other = SimpleNamespace(name="lid", of_two_groups=False, slave_points=points)
    assert explained("gone", found, [contact, other]).endswith(f"border of the master{advice}")


def sticky(interface, most=10.0, width=1e-5):
    """The interface with a traction `-most tanh(gap / width)` along z more, and its tangent.

    Far stiffer near a gap of zero than away from it: corrections from there leap over it.
    """
    update = interface.update

    def more(state, x, dt=1.0, *, tangent=True, **more_of_it):
        response = update(state, x, dt, tangent=tangent, **more_of_it)
        traction, slope = response.traction.copy(), response.tangent.copy()
        level = np.tanh(response.gap / width)
        traction[:, 2] -= most * level
        if tangent:
            slope[:, 2, 2] -= most / width * (1.0 - level**2)
        return dataclasses.replace(response, traction=traction, tangent=slope)

    interface.update = more
    return interface


def test_chattering_is_named_and_damped(fe, monkeypatch):
    """Points that leap to and fro over a gap of zero from one iteration to the next.

    Requirement: chattering is detected, named and treated. With full steps it goes on for ever;
    with a share of them the increment converges without a cut, after three attempts that are given
    up once they repeat. Without the treatment, and without flow, it is cut, and the reason names
    the points.
    """
    from anisocontact.solver.stepping.attempts import Attempts
    from anisocontact.solver.strategies.residual_history import CYCLE, PATIENCE

    step = Step("hold", 1, {"block.top": {"x": 0.0, "y": 0.0, "z": 0.0}})
    basic = {"snes_linesearch_type": "basic"}

    def run(cuts, smallest):
        interface = sticky(fe.interface(point=(0.0, 0.0, -0.003)))
        problem = fe.block(interface, cells=(2, 2, 1)).problem
        problem.stabilisation.enabled = False
        solver = Solver(problem, [step], options=basic, limits=Limits(smallest=smallest))
        return list(solver.run(on_cut=cuts.append))

    cuts: list = []
    accepted = run(cuts, 0.1)
    assert cuts == []
    assert 2 * CYCLE <= accepted[-1].iterations < 2 * PATIENCE
    monkeypatch.setattr(Attempts, "_damping", lambda self: 1.0)
    with pytest.raises(StoppedError):
        run(cuts, 0.1)
    assert "slave points alternates (chattering)" in cuts[0].reason
    culprit = cuts[0].culprits[0]
    assert culprit.kind == "chattering"
    assert set(culprit.statuses) > {"open"}
    assert "the status alternates between" in str(culprit)


def _refuses(watch, size, degrees):
    """Whether a part in which a contact turns by an angle is to be cut."""
    contact = SimpleNamespace(turn=lambda: np.radians(degrees), name="touch", meshed=True)
    return watch.objection(SimpleNamespace(contacts=[contact], dt=size)) is not None


def test_an_angle_between_facets_is_cut_once():
    """Requirement: what does not get smaller in smaller parts is no reason to cut another time.

    A point passes an edge of the master in the last quarter of a part that was cut, where it turns
    by as much as in the whole part: each part that had it in was cut, nine times in an increment
    of a block on coarser facets. A turn that goes on along the way still is.
    """
    watch = TurnWatch()
    assert [_refuses(watch, *part) for part in ((1.0, 29.0), (0.25, 7.0), (0.25, 22.0))] == [
        True,
        False,
        False,
    ]
    watch.begin()
    assert [_refuses(watch, *part) for part in ((1.0, 29.0), (0.25, 7.0), (0.5, 16.0))] == [
        True,
        False,
        True,
    ]


def test_parts_stay_as_large_as_a_refusal_lets_them():
    """Requirement: what was refused in a part of this size is not tried again while points turn on.

    A wheel that rolls over facets turns by less in each of two parts than by half of what it turns
    in one: every increment was tried as a whole, refused and cut. Once points turn by much less in
    a part, whole increments are.
    """
    watch = TurnWatch()
    assert _refuses(watch, 1.0, 18.0)
    assert not _refuses(watch, 0.5, 7.0)
    assert watch.allowed(0.5) == pytest.approx(15.0 / 18.0)
    assert not _refuses(watch, 0.5, 4.0)
    assert watch.allowed(0.5) == 1.0
