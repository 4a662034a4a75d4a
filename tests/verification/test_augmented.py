"""Augmented Lagrangian: what does not depend on the penalty, exact contact, physical adhesion."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from anisocontact.anisotropy import make_directions
from anisocontact.base.errors import InputError
from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.interface import Augmentation, ContactLaw, Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import BoxSpec, Model, build_box
from anisocontact.solver import Accepted, Problem, Solver, Step
from anisocontact.surfaces import make_surface

YOUNG = 1000.0
SIZE = 0.25
SLIP, STICK = (0.3, 0.15), (50.0, 40.0)
#: Sides that slide along planes, and the axis across them.
SIDES = (("left", "x"), ("front", "y"))


def _boxes(meshed: bool, unit: float) -> tuple[Model, dict[str, Any]]:
    """A block, and if wanted a base whose mesh does not match, with its support."""
    boxes = {"block": BoxSpec((0, 0, 0), (unit, unit, 0.5 * unit), (4, 4, 2))}
    if not meshed:
        return build_box(boxes), {}
    size = (2 * unit, 2 * unit, 0.5 * unit)
    boxes["base"] = BoxSpec((-0.5 * unit, -0.5 * unit, -0.5 * unit), size, (6, 6, 1))
    return build_box(boxes), {"base.bottom": {"x": 0.0, "y": 0.0, "z": 0.0}}


def _contact(model: Model, meshed: bool, law: ContactLaw, augmentation: Augmentation) -> Contact:
    """The block on the base, or on a plane, at integration points."""
    how: dict[str, Any] = {"augmentation": augmentation, "mortar": False}
    if meshed:
        return Contact(model, "block.bottom", "base.top", law, current_area=False, **how)
    plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    return Contact(model, "block.bottom", plane, law, **how)


def _run(
    penalty: float,
    meshed: bool,
    coefficients: tuple[float, float],
    *,
    adhesion: float | None = None,
    unit: float = 1.0,
    multipliers: str = "auto",
    strategy: str = "direct",
) -> tuple[np.ndarray, Any, list[Accepted]]:
    """Press a block, then drag it; `penalty` in units of 10 E over the facet size.

    Returns the contact force after each increment, the contact and the increments.
    """
    stiffness = 10.0 * penalty * YOUNG / (SIZE * unit)
    marks = make_directions("constant", vector=(1, 0, 0), angle=np.pi / 6)
    law = ContactLaw(
        NormalLaw(penalty=stiffness),
        Adhesion(stiffness=(adhesion or stiffness,) * 2),
        Friction(coefficients=coefficients, directions=marks),
    )
    augmentation = Augmentation(tangential=adhesion is None, multipliers=multipliers)
    model, support = _boxes(meshed, unit)
    contact = _contact(model, meshed, law, augmentation)
    elastic = make_material("linear-elastic", E=YOUNG, nu=0.3)
    problem = Problem(model, dict.fromkeys(model.body_names(), elastic), [contact])
    press = {"block.top": {"x": 0.0, "y": 0.0, "z": -0.01 * unit}} | support
    steps = [
        Step("press", 2, press),
        Step("drag", 3, {"block.top": {"x": 0.015 * unit, "y": 0.0}}),
    ]
    forces, done = [], []
    for accepted in Solver(problem, steps, strategy=strategy).run():
        forces.append(contact.resultant()[0])
        done.append(accepted)
    return np.array(forces), contact, done


@pytest.mark.parametrize("multipliers", ["newton", "uzawa"])
@pytest.mark.parametrize("meshed", [False, True], ids=["plane", "block"])
@pytest.mark.parametrize("coefficients", [SLIP, STICK], ids=["slip", "stick"])
def test_resultants_do_not_depend_on_the_penalty(
    meshed: bool, coefficients: tuple[float, float], multipliers: str
) -> None:
    """Four decades of the penalty: the same force to 1e-4, penetration below 1e-6 of a facet.

    Requirement: the augmented Lagrangian; block on plane and on a block that does not
    match, pressed and dragged. Tolerances are those of the requirement; measured: 2e-8 and 1e-8.
    """
    forces = []
    for penalty in (1e-2, 1e2):
        found, contact, _ = _run(penalty, meshed, coefficients, multipliers=multipliers)
        forces.append(found)
        in_contact = contact.state["status"] != 0
        assert in_contact.any()
        assert np.abs(contact.state["gap"][in_contact]).max() < 1e-6 * SIZE
        assert np.abs(contact.elastic_slip()).max() < 5e-6 * SIZE
    difference = np.linalg.norm(forces[1] - forces[0], axis=1)
    assert np.all(difference < 1e-4 * np.linalg.norm(forces[0], axis=1))


@pytest.mark.parametrize("strategy", ["direct", "condensed"])
@pytest.mark.parametrize("meshed", [False, True], ids=["plane", "block"])
def test_both_ways_find_the_same(meshed: bool, strategy: str) -> None:
    """Multipliers that follow Newton's method, and those of nested cycles: the same forces, 1e-6.

    Requirement: nested Uzawa and a semismooth Newton method of Alart and Curnier (1991). Both hold
    to 1e-5 of the tractions; measured 3e-8 with both strategies. The semismooth one takes fewer
    than half of the iterations, 22 to 28 instead of 83 to 103.
    """
    nested, _, cycles = _run(1.0, meshed, SLIP, multipliers="uzawa", strategy=strategy)
    newton, _, steps = _run(1.0, meshed, SLIP, multipliers="newton", strategy=strategy)
    np.testing.assert_allclose(newton, nested, atol=1e-6 * np.abs(nested).max())
    assert 2 * sum(a.iterations for a in steps) < sum(a.iterations for a in cycles)


@pytest.mark.parametrize("meshed", [False, True], ids=["plane", "block"])
def test_multipliers_converge_quadratically(meshed: bool) -> None:
    """Once no point changes its status the residual is squared, until 1e-4 of it are left.

    Source: Newton's method; points slip, some stick. Below 1e-5 of the forces the square of a
    residual, times any constant below a thousand, and what the elimination of the multipliers
    leaves, k / (r eps) or 1e-4 with r = 1e4 and k up to ten times eps at single points, are less
    than a hundredth of it: so it has to fall in every correction of every increment, where a
    method of first order would leave a share. Before it some increment has the order
    log(r2 / r1) / log(r1 / r0) > 1.8 over three residuals: 2.1 in the median of all.
    """
    _, _, done = _run(1.0, meshed, SLIP, multipliers="newton")
    left, orders = [], []
    for accepted in done:
        known = accepted.residuals
        left += [b / a for a, b in pairwise(known) if a < 1e-5]
        found = [
            np.log(third / second) / np.log(second / first)
            for first, second, third in zip(known, known[1:], known[2:], strict=False)
            if first < 0.1 and third < second < first
        ]
        orders += [max(found)] if found else []
    assert len(left) >= 4
    assert max(left) < 1e-2
    assert len(orders) >= 3
    assert np.median(orders) > 1.8


def _ironed(friction: Friction, mortar: bool) -> list[Accepted]:
    """Press a soft slab from below onto a cylinder at rest, then draw it along."""
    model = build_box({"slab": BoxSpec((0, 0, 0), (4, 0.5, 1), (16, 1, 4))})
    die = make_surface("cylinder", point=(2.5, 0, 1.6), axis=(0, 1, 0), radius=0.6)
    laws = NormalLaw(penalty=16.0), Adhesion(stiffness=(16.0, 16.0)), friction
    contact = Contact(
        model, "slab.top", Interface(die, *laws), augmentation=Augmentation(), mortar=mortar
    )
    soft = make_material("neo-hookean", E=1.0, nu=0.4)
    problem = Problem(model, {"slab": soft}, [contact])
    press = Step("press", 5, {"slab.bottom": {"x": 0.0, "y": 0.0, "z": 0.33}})
    iron = Step("iron", 3, {"slab.bottom": {"x": 0.3, "y": 0.0, "z": 0.33}})
    return list(Solver(problem, [press, iron]).run())


@pytest.mark.parametrize(
    ("sliding", "mortar"),
    [
        ("isotropic", False),
        ("isotropic", True),
        ("maximum-dissipation", True),
        ("linear", True),
        ("coaxial", False),
    ],
)
def test_slip_on_a_curved_surface_converges_quadratically(sliding: str, mortar: bool) -> None:
    """Points that slide far along a cylinder: a small residual falls to a hundredth at once.

    Source: Newton's method: below 1e-3 of the forces a square is less than a hundredth of them,
    were its constant ten; the elimination of multipliers leaves 1e-4. A derivative that takes the
    way out of a violation for one along the surface, on which normal and axes of friction turn,
    leaves N / (R eps), here a quarter, with N the pressure, R the radius and eps the penalty that
    suits the body. Where axes are projections of two vectors the angle between them changes along
    the surface, and the ellipse with it.
    """
    friction = Friction(coefficients=0.3)
    if sliding != "isotropic":
        crossed = make_directions("from-vectors", first=(1, 1, 0), second=(-1, 1, 0))
        friction = Friction(coefficients=(0.3, 0.15), directions=crossed, sliding_rule=sliding)
    left = []
    for accepted in _ironed(friction, mortar):
        known = accepted.residuals
        left += [b / a for a, b in pairwise(known) if 1e-6 < a < 1e-3 and b < a]
    assert len(left) >= 3
    assert max(left) < 1e-2


def test_physical_adhesion_stays() -> None:
    """A block that sticks gives way by its adhesion, whatever the normal penalty.

    Source: with the sides free to shear, the tangential force of a block of low height on springs
    S per area is below A S u; the same S under a penalty contact four decades stiffer gives the
    force within 1e-4. The elastic slip is T / S at every point.
    """
    soft = 400.0
    ends = []
    for penalty in (1e-1, 1e2):
        forces, contact, _ = _run(penalty, False, (50.0, 40.0), adhesion=soft)
        ends.append(forces[-1])
        slip = contact.elastic_slip()
        traction = contact.last.traction_t
        np.testing.assert_allclose(traction, -soft * slip, atol=1e-9 * np.abs(traction).max())
        assert np.abs(slip).max() > 1e-2 * SIZE
    assert np.linalg.norm(ends[0] - ends[1]) < 1e-4 * np.linalg.norm(ends[0])


@pytest.mark.parametrize("multipliers", [None, "newton", "uzawa"])
@pytest.mark.parametrize("mortar", [False, True], ids=["points", "nodes"])
def test_adhesion_along_one_axis_alone(mortar: bool, multipliers: str | None) -> None:
    """A layer of fibres holds along them and not across: so does a block on it, pushed askew.

    Source: T = -S_1 (s . e_1) e_1 where nothing slips, S_2 = 0, to rounding at every point: across
    the fibres there is no force at all. Penalties, and multipliers of the pressure alone.
    """
    model = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 0.5), (3, 3, 2))})
    plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    angle, along = np.pi / 6, 400.0
    fibres = make_directions("constant", vector=(1, 0, 0), angle=angle)
    laws = (
        NormalLaw(penalty=1e5),
        Adhesion(stiffness=(along, 0.0), directions=fibres),
        Friction(coefficients=50.0),
    )
    way = Augmentation(tangential=False, multipliers=multipliers) if multipliers else None
    contact = Contact(
        model, "block.bottom", Interface(plane, *laws), augmentation=way, mortar=mortar
    )
    problem = Problem(model, {"block": make_material("linear-elastic", E=YOUNG, nu=0.3)}, [contact])
    press = Step("press", 1, {"block.top": {"x": 0.0, "y": 0.0, "z": -0.005}})
    push = Step("push", 2, {"block.top": {"x": 0.004, "y": 0.006}})
    for _ in Solver(problem, [press, push]).run():
        pass
    assert contact.counts()["slip"] == 0
    first = np.array([np.cos(angle), np.sin(angle), 0.0])
    traction = contact.last.traction_t
    expected = -along * np.outer(contact.elastic_slip() @ first, first)
    np.testing.assert_allclose(traction, expected, atol=1e-12 * np.abs(traction).max())
    assert np.abs(traction).max() > 0.5


@pytest.mark.parametrize("multipliers", ["newton", "uzawa"])
def test_no_multipliers_of_adhesion_along_one_axis(multipliers: str) -> None:
    """Multipliers would hold across the fibres too: such adhesion is refused as one of them."""
    model = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 0.5), (2, 2, 1))})
    plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    fibres = make_directions("constant", vector=(1, 0, 0))
    law = Interface(
        plane,
        NormalLaw(penalty=1e3),
        Adhesion(stiffness=(0.0, 1e3), directions=fibres),
        Friction(coefficients=0.3),
    )
    with pytest.raises(InputError, match=r"adhesion\.stiffness: 0 along an axis"):
        Contact(model, "block.bottom", law, augmentation=Augmentation(multipliers=multipliers))


def test_units() -> None:
    """Lengths a million times as large, the same stresses: forces 1e12 times as large, 1e-9."""
    metre, _, _ = _run(1.0, False, (0.3, 0.15))
    micro, _, _ = _run(1.0, False, (0.3, 0.15), unit=1e6)
    np.testing.assert_allclose(micro, 1e12 * metre, atol=1e-9 * np.abs(micro).max())


def test_patch() -> None:
    """Uniform pressure on a block that may spread: the stress of the load at every point.

    Source: equilibrium of a bar under pressure p, N = p, exact for every element that holds a
    linear field; the plane is met exactly, so the foot stays at z = 0 to 1e-6 of a facet.
    """
    model = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 0.5), (3, 3, 2))})
    plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    laws = (
        NormalLaw(penalty=1e3),
        Adhesion(stiffness=(1e-3, 1e-3)),
        Friction(coefficients=(1e-6, 1e-6)),
    )
    contact = Contact(
        model,
        "block.bottom",
        Interface(plane, *laws),
        augmentation=Augmentation(tangential=False),
        mortar=False,
    )
    problem = Problem(model, {"block": make_material("linear-elastic", E=YOUNG, nu=0.3)}, [contact])
    held = {"block.left": {"x": 0.0}, "block.front": {"y": 0.0}}
    down = Step("down", 1, held | {"block.top": {"z": -0.005}})
    for _ in Solver(problem, [down]).run():
        pass
    np.testing.assert_allclose(contact.last.pressure, 0.01 * YOUNG, rtol=1e-5)
    assert np.abs(contact.state["gap"]).max() < 1e-6 / 3.0
