"""What is called a jump, and what is not: increments that are found at once, arches that snap."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from tests.verification.test_energy_of_flows import only_flows

from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.interface import ContactLaw, Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import Body, BoxSpec, build_box, build_mesh
from anisocontact.rigid import MovingSurface, RigidBody
from anisocontact.solver import Problem, Solver, Step
from anisocontact.solver.stepping.energy_watch import Cause
from anisocontact.solver.system.imbalance import Imbalance
from anisocontact.surfaces import make_surface

LAWS = NormalLaw(penalty=1e4), Adhesion(stiffness=(1e4, 1e4))
YOUNG, HEIGHT, WEIGHT, LIFT = 1e4, 0.5, 0.02, 0.05
HOLD = {f"arch.{side}": dict.fromkeys("xyz", 0.0) for side in ("left", "right")}


def _lifted(pair: bool) -> tuple[Problem, Step]:
    """A strip of 20 by 0.5 on a plane or on a block, and the step in which it lies down."""
    bodies = [Body("strip", BoxSpec((0, 0, 0), (20, 1, HEIGHT), (20, 1, 1)))]
    if pair:
        bodies.append(Body("base", BoxSpec((-1, -1, -1), (22, 3, 1), (17, 1, 1))))
    model = build_mesh(bodies)
    master = "base.top" if pair else make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    law = ContactLaw(*LAWS, Friction(coefficients=(0.0, 0.0)))
    contact = Contact(model, "strip.bottom", master, law, mortar=False)
    elastic = make_material("linear-elastic", E=YOUNG, nu=0.0)
    problem = Problem(model, {body.name: elastic for body in bodies}, [contact])
    held = {"strip.left": {"x": 0.0}, "strip.front": {"y": 0.0}, "strip.back": {"y": 0.0}}
    if pair:
        held["base.bottom"] = dict.fromkeys("xyz", 0.0)
    return problem, Step("weight", 1, held, body_force={"strip": {"z": -WEIGHT}})


@pytest.mark.parametrize("pair", [False, True], ids=["plane", "block"])
@pytest.mark.parametrize(("increments", "tolerance"), [(1, 1e-8), (8, 0.01)])
def test_a_strip_is_lifted(pair: bool, increments: int, tolerance: float) -> None:
    """A heavy strip is lifted at its end, without friction, in one increment and in eight.

    Requirement: the work of support and weight is what is stored, and nothing is said. Source: a
    beam that is free over the length l and lifted by d, `d = w l^4 / (24 E I)`, stores
    `w^2 l^5 / (240 E I)`; cells of the length a lock in bending, `G h a^2 / 12` is added to E I. An
    elastic body on a plane has one equilibrium without friction: it cannot jump. The mean of both
    ends of the force that lifts was told as 150 % of the work left open. Tolerances: 1 % of the
    energy, l is known to a cell in fourteen; of its balance rounding in one increment, in eight the
    mean of both ends, which stays where it is no warning.
    """
    problem, weight = _lifted(pair)
    lift = Step("lift", increments, {"strip.right": {"z": LIFT}})
    said: list[str] = []
    *_, last = Solver(problem, [weight, lift]).run(on_warning=said.append)
    load, bending = WEIGHT * HEIGHT, YOUNG * HEIGHT**3 / 12.0 + 0.5 * YOUNG * HEIGHT / 12.0
    free = (24.0 * bending * LIFT / load) ** 0.25
    energies = last.energies
    assert energies["elastic"] == pytest.approx(load**2 * free**5 / (240.0 * bending), rel=0.01)
    assert abs(energies["residual"]) < tolerance * energies["elastic"]
    assert energies["regularisation"] == 0.0
    assert said == []


def _arch(die: bool) -> Problem:
    """An arch of 10 by 0.25 that rises by 1.5, and a die above it if there is one."""
    model = build_box({"arch": BoxSpec((-5, 0, 0), (10, 1, 0.25), (20, 1, 1))})
    x = model.mesh.geometry.x
    x[:, 2] += 1.5 * np.cos(np.pi * x[:, 0] / 10.0) ** 2
    contacts = []
    if die:
        body = RigidBody("die", (0.0, 0.0, 2.0))
        face = make_surface("cylinder", point=(0, 0, 2.75), axis=(0, 1, 0), radius=1.0)
        laws = Interface(face, *LAWS, Friction(coefficients=(0.1, 0.1)))
        contacts.append(Contact(model, "arch.top", MovingSurface(laws, body), mortar=False))
    return Problem(model, {"arch": make_material("st-venant-kirchhoff", E=1e3, nu=0.0)}, contacts)


@pytest.mark.parametrize("increments", [2, 8])
def test_an_arch_snaps_through_under_a_load(increments: int) -> None:
    """Newton's method leaps over the snap: what it sets free is left open, and that is said.

    Requirement: more than 40 % of the work at the snap. Source: the load works on all of the way,
    and what the arch stores falls on it.
    """
    push = Step("push", increments, HOLD, traction={"arch.top": {"z": -3.0}})
    worst = max((one.imbalance for one in Solver(_arch(die=False), [push]).run()), key=_share)
    assert worst.share > 0.4
    assert worst.cause == Cause.COARSE


def _share(imbalance: Imbalance) -> float:
    return imbalance.share


def test_an_arch_snaps_off_a_die(monkeypatch: pytest.MonkeyPatch) -> None:
    """An arch leaves the die that has pressed it, by a leap of Newton's method and by a flow.

    Requirement: the energy that is set free is left open after a leap, with a warning that says so
    of the snap, and that of a jump after a flow, which leaves nothing open: both the same. Source:
    both begin and end in the same states. Tolerance: 1e-6, that of the forces.
    """
    released = []
    for flows in (False, True):
        near = Step("near", 4, HOLD, motion={"die": {"z": -1.85}})
        snap = Step("snap", 1, motion={"die": {"z": -2.0}})
        run = Solver(_arch(die=True), [near, snap]).run()
        *_, before = (next(run) for _ in range(4))
        if flows:
            only_flows(monkeypatch)
        (after,) = run
        assert before.contacts["arch.top"]["open"] < after.contacts["arch.top"]["open"] == 80
        assert after.imbalance.large != flows
        assert flows or after.imbalance.cause == Cause.SNAPPED
        of = "regularisation" if flows else "residual"
        released.append(after.energies[of] - before.energies[of])
    assert released[0] == pytest.approx(released[1], rel=1e-6)
    assert released[1] > 0.15 * after.energies["external"]
