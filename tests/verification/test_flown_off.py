"""Bodies that nothing can stop any more are given up, in flows and on springs that fade."""

from __future__ import annotations

from contextlib import nullcontext
from types import SimpleNamespace

import numpy as np
import pytest
from tests.verification.free_blocks import CLAMP, YOUNG, free_block, laws

from anisocontact.base.fenicsx import Vec
from anisocontact.bulk import make_material
from anisocontact.contact import Contact, NotHeldError
from anisocontact.interface import ContactLaw
from anisocontact.mesh import BoxSpec, build_box
from anisocontact.solver import Problem, Step
from anisocontact.solver.system.culprit import LostError
from anisocontact.solver.terms.flown_off import _may_come_back
from anisocontact.solver.terms.free_modes import bodies


def _thrown_up(
    problem: Problem,
    held: dict[str, dict[str, float]],
    way: float,
    load: float = -10.0,
    flows: bool = True,
    axis: int = 2,
) -> Vec:
    """All unknowns with the block as far up, in a flow or not, where nothing else has moved.

    Along another axis if that is given.
    """
    problem.begin(Step("press", 1, held, {"block.top": {"z": load}}))
    problem.set_load_factor(1.0, 1.0)
    if flows:
        problem.stabilisation.regularisation.start(problem.nodal)
    x = problem.new_vector()
    thrown = np.zeros((len(x.array_r) // 3, 3))
    (block,) = [one for one in bodies(problem.model) if one.name == "block"]
    thrown[block.nodes, axis] = way
    x.array[:] = thrown.ravel()
    return x


@pytest.mark.parametrize(("way", "gone"), [(0.5, False), (2.5, False), (50.0, True)])
@pytest.mark.parametrize("base", [None, 0.0, 1e3])
def test_a_body_that_flows_off_all_it_could_touch_is_given_up(
    base: float | None, way: float, gone: bool
) -> None:
    """A block is thrown up from a plane, which goes on for ever, and from a base, which does not.

    Requirement: a flow ends where a body is farther off than twice its size with no master below
    it, wherever the origin is, and says which and how far; nothing ends it where it can come back.
    Before, a nut that ran down its screw took thousands of corrections, a million of its lengths
    away.
    """
    problem, held = free_block(0.0), {}
    if base is not None:
        upper, lower = (
            BoxSpec((base, 0, 0), (1, 1, 0.5), (3, 3, 2)),
            BoxSpec((base - 1, -1, -1), (3, 3, 1), (5, 5, 1)),
        )
        model = build_box({"block": upper, "base": lower})
        contact = Contact(model, "block.bottom", "base.top", law=ContactLaw(*laws()))
        elastic = make_material("linear-elastic", E=YOUNG, nu=0.3)
        problem, held = Problem(model, dict.fromkeys(model.body_names(), elastic), [contact]), CLAMP
    x = _thrown_up(problem, held, way)
    if not gone or base is None:
        problem.evaluate_at(x)
        assert problem.stabilisation.flown_off(problem.nodal) is None
        return
    with pytest.raises(LostError, match="body 'block' has lost all contact, 50 from where it was"):
        problem.improve(x)


@pytest.mark.parametrize(("way", "gone"), [(0.5, False), (2.5, False), (50.0, True)])
@pytest.mark.parametrize("flows", [False, True])
def test_a_body_that_loads_pull_off_a_plane_is_given_up(flows, way, gone) -> None:
    """A plane without end is below it wherever it is, and the loads point away from it.

    Requirement: twice its size farther away it is given up, in a flow and on springs that fade; a
    block of 144 unknowns took 8000 corrections to be told that nothing holds it.
    """
    problem = free_block(0.1)
    problem.evaluate_at(_thrown_up(problem, {}, way, 10.0, flows))
    aid = problem.stabilisation
    if flows:
        found = aid.flown_off(problem.nodal)
        assert (None if found is None else found[0].body.name) == ("block" if gone else None)
        return
    said = "nothing holds body 'block': .*; it is 0.1 from what it may touch, bring it there"
    with pytest.raises(NotHeldError, match=said) if gone else nullcontext():
        assert aid.improve(problem.nodal, 1.0)


def test_a_body_that_slides_far_is_not_given_up() -> None:
    """Requirement: what has gone far along a plane without end is as near to it as before, and may
    meet it again whatever the loads of this attempt are."""
    problem = free_block(0.1)
    problem.evaluate_at(_thrown_up(problem, {}, 50.0, 10.0, axis=0))
    assert problem.stabilisation.flown_off(problem.nodal) is None


@pytest.mark.parametrize(("begun", "back"), [(0.0, False), (9.0, True)])
def test_how_near_a_body_began_is_known_on_all_processes(begun: float, back: bool) -> None:
    """Requirement: a body is given up in the same place on any number of processes.

    Here another process has all points that had a master below them at the start, at a gap.
    """
    comm = SimpleNamespace(allgather=lambda own: [own, begun])
    none, here = np.zeros(2, dtype=bool), np.ones(2, dtype=bool)
    contact = SimpleNamespace(
        space=SimpleNamespace(mesh=SimpleNamespace(comm=comm)),
        accepted=SimpleNamespace(response=SimpleNamespace(gap=np.zeros(2), state=None)),
        master=SimpleNamespace(located=lambda _: none),
        trial=SimpleNamespace(gap=np.full(2, 10.0), normal=np.array([[0.0, 0.0, 1.0]] * 2)),
        located=lambda: here,
    )
    free = SimpleNamespace(contacts=[contact], sides=[1.0], force=np.array([0.0, 0.0, 1.0]))
    assert _may_come_back(free, 3.0) == back


def test_a_small_body_is_given_up_by_its_own_size() -> None:
    """A block is thrown up by 50 of its lengths from a base, in a mesh that is 300 of them long.

    Requirement: what is far from all that the block can touch says nothing of where it can come
    back from. Source: twice its size beyond what it began on, which it left long ago.
    """
    lower, other = (
        BoxSpec((-1, -1, -1), (3, 3, 1), (5, 5, 1)),
        BoxSpec((300, 0, 0), (1, 1, 1), (1, 1, 1)),
    )
    block = BoxSpec((0, 0, 0), (1, 1, 0.5), (3, 3, 2))
    model = build_box({"block": block, "base": lower, "other": other})
    contact = Contact(model, "block.bottom", "base.top", law=ContactLaw(*laws()))
    elastic = make_material("linear-elastic", E=YOUNG, nu=0.3)
    problem = Problem(model, dict.fromkeys(model.body_names(), elastic), [contact])
    held = CLAMP | {"other.bottom": {"x": 0.0, "y": 0.0, "z": 0.0}}
    x = _thrown_up(problem, held, 50.0)
    problem.evaluate_at(x)
    gone = problem.stabilisation.flown_off(problem.nodal)
    assert gone is not None
    assert gone[0].body.name == "block"
    assert gone[1] == pytest.approx(50.0)
