"""Meshed tools whose skin follows a reference point: rigid, whatever they are made of."""

from __future__ import annotations

import shutil
from typing import Any

import numpy as np
import pytest
from tests.verification.test_coupled_face import NOTHING, on_processes, run


@pytest.fixture(autouse=True)
def _needs_dolfinx(fe: Any) -> None:
    """All tests here need DOLFINx."""


@pytest.mark.parametrize(("mortar", "bound"), [(True, 1e-4), (False, 1e-8)])
def test_a_meshed_tool_that_follows_a_point_is_rigid(mortar, bound):
    """A plate whose skin follows a reference point is pressed on a block, and turned.

    Requirement: force and moment on the block are those of a rigid plane that moves alike.
    Tolerance: of the force 1e-8 at points, whose feet are those on the plane; 1e-4 at nodes, whose
    slip is a mean over facets of the block that the pressure has bent.
    """
    from anisocontact.bulk import make_material
    from anisocontact.contact import Contact
    from anisocontact.interface import ContactLaw
    from anisocontact.laws import Adhesion, Friction, NormalLaw
    from anisocontact.mesh import Body, build_mesh, make_selector, make_shape
    from anisocontact.rigid import MovingSurface, RigidBody
    from anisocontact.solver import CoupledFace, Problem, Step
    from anisocontact.surfaces import make_surface

    block = make_shape("box", origin=(0, 0, 0), size=(1, 1, 1), cells=(3, 3, 2))
    plate = make_shape("box", origin=(-0.5, -0.5, 1), size=(2, 2, 0.5), cells=(4, 5, 1))
    law = ContactLaw(
        NormalLaw(penalty=1e4), Adhesion(stiffness=(1e3, 1e3)), Friction(coefficients=(0.2, 0.2))
    )
    # the plate turns by any angle
    kinds = {"block": "linear-elastic", "plate": "neo-hookean"}
    steps = (
        Step("press", 1, {"block.bottom": NOTHING}, motion={"tool": {"z": -0.01}}),
        Step("turn", 2, motion={"tool": {"rz": 0.02}}),
    )
    found = []
    for rigid in (False, True):
        tool = RigidBody("tool", (0.5, 0.5, 1.0), free=not rigid)
        bodies = [Body("block", block)] + ([] if rigid else [Body("plate", plate)])
        skin = {} if rigid else {"plate.skin": [make_selector("all")]}
        model = build_mesh(bodies, skin)
        surface = make_surface("plane", point=(0, 0, 1), normal=(0, 0, -1))
        master = MovingSurface(surface, tool) if rigid else "plate.bottom"
        contact = Contact(model, "block.top", master, law, mortar=mortar, current_area=False)
        materials = {b: make_material(kinds[b], E=1000.0, nu=0.3) for b in model.body_names()}
        coupled = [] if rigid else [CoupledFace("plate.skin", tool)]
        run(Problem(model, materials, [contact], coupled=coupled), *steps)
        assert contact.counts()["slip"] > 0
        found.append(np.concatenate(contact.resultant((0.5, 0.5, 1.0))))
    assert found[0] == pytest.approx(found[1], abs=bound * abs(found[1][2]))


def tool_on_block(kind: str, young: float, mortar: bool, order: int = 2):
    """A plate whose skin follows a point, on a block; the steps press, then let it go along z."""
    from anisocontact.bulk import make_material
    from anisocontact.contact import Contact
    from anisocontact.interface import ContactLaw
    from anisocontact.laws import Adhesion, Friction, NormalLaw
    from anisocontact.mesh import Body, build_mesh, make_selector, make_shape
    from anisocontact.rigid import RigidBody
    from anisocontact.solver import CoupledFace, Problem, Step

    block = make_shape("box", origin=(0, 0, 0), size=(1, 1, 1), cells=(2, 2, 2), order=2)
    size, cells = (2, 2, 0.5), (3, 3, 2)
    plate = make_shape("box", origin=(-0.5, -0.5, 1), size=size, cells=cells, order=order)
    law = ContactLaw(
        NormalLaw(penalty=1e4), Adhesion(stiffness=(1e3, 1e3)), Friction(coefficients=(0.2, 0.2))
    )
    more = {"yield_stress": 1e-3, "hardening": 0.1} if kind == "plastic" else {}
    free = {"tool": dict.fromkeys(("x", "y", "rx", "ry"), 0.0) | {"z": None, "rz": 0.05}}
    steps = (
        Step("press", 1, {"block.bottom": NOTHING}, motion={"tool": {"z": -0.01}}),
        Step("load", 2, motion=free, pressure={"plate.top": 2.0}),
    )
    bodies = [Body("block", block), Body("plate", plate)]
    model = build_mesh(bodies, {"plate.skin": [make_selector("all")]})
    tool = RigidBody("tool", (0.5, 0.5, 1.0), free=True)
    contact = Contact(model, "block.top", "plate.bottom", law, mortar=mortar)
    materials = {
        "block": make_material("neo-hookean", E=100.0, nu=0.3),
        "plate": make_material(kind, E=young, nu=0.3, **more),
    }
    problem = Problem(model, materials, [contact], coupled=[CoupledFace("plate.skin", tool)])
    return tool, contact, problem, steps


@pytest.mark.parametrize("kind", ["neo-hookean", "plastic"])
def test_what_a_rigid_tool_is_made_of_changes_nothing(kind):
    """A plate whose skin follows a point, under a follower pressure on its top, free along z.

    Requirement: all of its nodes move rigidly, whatever it is made of; the block carries the
    pressure times the area, and a plate a million times as stiff gives the same. Tolerance:
    Newton's, 1e-8 of the force.
    """
    found = []
    for young in (1.0, 1e6):
        tool, contact, problem, steps = tool_on_block(kind, young, mortar=True)
        run(problem, *steps)
        space = problem.model.space
        own = np.unique(space.dofmap.list[problem.model.cells("plate")])
        arms = space.tabulate_dof_coordinates()[own] - tool.reference
        pose = tool.accepted
        at = pose.translation + arms @ pose.rotation.T - arms
        if kind == "plastic":  # at small strain
            at = pose.translation + np.cross(pose.turn, arms)
        assert problem.u.x.array.reshape(-1, 3)[own] == pytest.approx(at, abs=1e-12)
        force, _ = contact.resultant()
        assert force[2] == pytest.approx(-8.0, rel=1e-8)
        found.append(np.concatenate(contact.resultant((0.5, 0.5, 1.0))))
    assert found[0] == pytest.approx(found[1], abs=1e-8 * abs(found[1][2]))


@pytest.mark.parametrize("strategy", ["direct", "iterative"])
@pytest.mark.parametrize("mortar", [True, False])
def test_the_order_of_a_rigid_tool_changes_nothing(mortar, strategy):
    """A flat plate of order 1 and of order 2, on a block of order 2.

    Requirement: the block gets the same force and moment. Tolerance: Newton's, 1e-8 of the force.
    """
    found = []
    for order in (1, 2):
        _, contact, problem, steps = tool_on_block("neo-hookean", 1.0, mortar, order)
        run(problem, *steps, strategy=strategy)
        found.append(np.concatenate(contact.resultant((0.5, 0.5, 1.0))))
    assert found[0] == pytest.approx(found[1], abs=1e-8 * abs(found[1][2]))


@pytest.mark.parametrize("slave", ["block", "plate"])
def test_the_order_of_a_rigid_tool_changes_nothing_in_the_plane(slave):
    """The same in plane strain, as master at nodes and as slave at points; the tool drags."""
    from anisocontact.bulk import make_material
    from anisocontact.contact import Contact
    from anisocontact.laws import Friction
    from anisocontact.mesh import Body, build_mesh, make_idealisation, make_selector, make_shape
    from anisocontact.rigid import RigidBody
    from anisocontact.solver import CoupledFace, Problem, Step

    block = make_shape("rectangle", origin=(0, 0), size=(1, 1), cells=(4, 2), order=2)
    steps = (
        Step("press", 1, {"block.bottom": {"x": 0.0, "y": 0.0}}, motion={"tool": {"y": -0.05}}),
        Step("drag", 2, motion={"tool": {"x": 0.1}}),
    )
    found = []
    for order in (1, 2):
        plate = make_shape("rectangle", origin=(-1, 1), size=(3, 1), cells=(7, 2), order=order)
        bodies = [Body("block", block), Body("plate", plate)]
        skin = {"plate.skin": [make_selector("all")]}
        model = build_mesh(bodies, skin, make_idealisation("plane-strain"))
        tool = RigidBody("tool", (0.5, 1.0, 0.0), free=True)
        sides = {"block": "block.top", "plate": "plate.bottom"}
        other = next(group for body, group in sides.items() if body != slave)
        # at nodes, or at the same points
        how = {"mortar": True} if slave == "block" else {"mortar": False, "degree": 3}
        contact = Contact(model, sides[slave], other, Friction(coefficients=0.3), **how)
        rubber = make_material("neo-hookean", E=100.0, nu=0.3)
        materials = {"block": rubber, "plate": rubber}
        problem = Problem(model, materials, [contact], coupled=[CoupledFace("plate.skin", tool)])
        run(problem, *steps)
        found.append(contact.resultant()[0])
    assert found[0] == pytest.approx(found[1], abs=1e-8 * np.linalg.norm(found[1]))


TOOL = """
import numpy as np
from tests.verification.test_coupled_face import run
from tests.verification.test_rigid_tool import tool_on_block

for strategy in ("direct", "iterative"):
    tool, contact, problem, steps = tool_on_block("neo-hookean", 1.0, mortar=False)
    run(problem, *steps, strategy=strategy)
    found = np.concatenate([tool.accepted.values, problem.rigid.support(tool)])
    if problem.comm.rank == 0:
        print(*map(repr, found.tolist()))
"""


@pytest.mark.mpi
@pytest.mark.slow
def test_processes_change_nothing_of_a_rigid_tool():
    """Requirement, source, tolerance: as of a coupled face, on one and on two processes."""
    if shutil.which("mpirun") is None:
        pytest.skip("no mpirun")
    values = np.concatenate([on_processes(TOOL, count) for count in (1, 2)])
    assert np.abs(values - values[0]).max() < 1e-8 * np.abs(values).max()
