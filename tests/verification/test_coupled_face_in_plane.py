"""Faces that follow a reference point in the plane and in bodies of revolution."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from anisocontact.base.errors import InputError
from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.interface import ContactLaw
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import (
    Axisymmetric,
    Body,
    BoxSpec,
    Idealisation,
    PlaneStrain,
    PlaneStress,
    build_box,
    build_mesh,
    make_selector,
    make_shape,
)
from anisocontact.rigid import MovingSurface, RigidBody
from anisocontact.solver import CoupledFace, Problem, Solver, Step, Turn
from anisocontact.surfaces import make_surface

E = 1200.0
SLIM = make_material("linear-elastic", E=E, nu=0.0)
RUBBER = make_material("neo-hookean", E=10.0, nu=0.3)
CLAMP = {"b.bottom": {"x": 0.0, "y": 0.0, "z": 0.0}}


def strip(
    ideal: Idealisation,
    material: Any = SLIM,
    faces: tuple[str, ...] = ("top",),
    origin: tuple[float, float] = (1.0, 0.0),
    size: tuple[float, float] = (1.0, 8.0),
    cells: tuple[int, int] = (1, 4),
    order: int = 2,
    at: tuple[float, float, float] | None = None,
    springs: dict[str, float] | None = None,
) -> tuple[list[RigidBody], Problem]:
    """A strip along y whose ends follow reference points, and these."""
    shape = make_shape("rectangle", origin=origin, size=size, cells=cells, order=order)
    model = build_mesh([Body("b", shape)], idealisation=ideal)
    middle = 0.0 if isinstance(ideal, Axisymmetric) else origin[0] + size[0] / 2.0
    places = {"top": (middle, origin[1] + size[1], 0.0), "bottom": (middle, origin[1], 0.0)}
    heads = [RigidBody(face, at or places[face], free=True, springs=springs) for face in faces]
    coupled = [CoupledFace(f"b.{head.name}", head) for head in heads]
    return heads, Problem(model, {"b": material}, coupled=coupled)


def run(problem: Problem, *steps: Step, **options: Any) -> Any:
    """The last accepted increment."""
    return list(Solver(problem, list(steps), options={"snes_rtol": 1e-12}, **options).run())[-1]


@pytest.mark.parametrize("strategy", ["direct", "iterative"])
@pytest.mark.parametrize("ideal", [PlaneStrain(thickness=2.0), PlaneStress(thickness=2.0)])
def test_beam_in_the_plane(ideal, strategy):
    """A beam with E I = 200 and E A = 2400 is bent and pulled at its free end.

    Requirement: turn M L / (E I), deflection -M L^2 / (2 E I), elongation F L / (E A) to 1e-9; what
    acts does the work. Source: pure bending, which for nu = 0 leaves sections plane and which
    elements of order 2 hold exactly. Tolerance: factorisation and FGMRES.
    """
    (head,), problem = strip(ideal)
    moment, force, length = 0.5, 2.4, 8.0
    free = dict.fromkeys(("x", "y", "rz"))
    pull = Step("a", 2, CLAMP, motion={"top": free}, load={"top": {"rz": moment, "y": force}})
    last = run(problem, pull, strategy=strategy)
    angle = moment * length / (E * 2.0 / 12.0)
    exact = [-angle * length / 2.0, force * length / (2.0 * E), 0.0, 0.0, 0.0, angle]
    assert head.accepted.values == pytest.approx(exact, abs=1e-9)
    assert last.reactions["b.bottom"] == pytest.approx([0.0, -force, 0.0], abs=1e-9)
    outside = [0.0, -force, 0.0, 0.0, 0.0, -moment]
    assert problem.rigid.contact_force(head) == pytest.approx(outside, abs=1e-9)
    assert problem.rigid.support(head) == pytest.approx(0.0, abs=1e-12)
    work = 0.5 * (moment * angle + force * exact[1])
    assert last.energies["external"] == pytest.approx(work, rel=1e-9)
    assert last.energies["elastic"] == pytest.approx(work, rel=1e-9)


@pytest.mark.parametrize("strategy", ["direct", "iterative"])
@pytest.mark.parametrize("inner", [0.0, 1.0], ids=["shaft", "tube"])
def test_tube_pulled_and_twisted(inner, strategy):
    """A tube, and a shaft with its axis, under a force along and a torque about the axis.

    Requirement: elongation F L / (E A) and twist T L / (G J) to 1e-9, J = pi (b^4 - a^4) / 2; held
    at that, support with F and T. Source: Saint-Venant's torsion; nu = 0; both fields are in the
    span of the cells. Tolerance: factorisation and FGMRES.
    """
    ideal = Axisymmetric(lateral=True)
    (head,), problem = strip(ideal, origin=(inner, 0.0), cells=(2, 3), order=1)
    force, torque, length, outer = 5.0, 3.0, 8.0, inner + 1.0
    led = {"top": dict.fromkeys(("y", "ry"))}
    loaded = Step("a", 1, CLAMP, motion=led, load={"top": {"y": force, "ry": torque}})
    last = run(problem, loaded, strategy=strategy)
    long = force * length / (E * math.pi * (outer**2 - inner**2))
    twist = torque * length / (0.5 * E * math.pi / 2.0 * (outer**4 - inner**4))
    assert head.accepted.values == pytest.approx([0, long, 0, 0, twist, 0], abs=1e-9)
    assert last.energies["elastic"] == pytest.approx(0.5 * (force * long + torque * twist))
    run(problem, Step("b", 1, CLAMP, motion={"top": {"y": long, "ry": twist}}), strategy=strategy)
    assert problem.rigid.support(head) == pytest.approx([0, force, 0, 0, torque, 0], abs=1e-8)


@pytest.mark.parametrize(
    ("ideal", "turn"),
    [
        (PlaneStrain(), Turn((0, 0, 1), angle_deg=150.0, point=(3, 1, 0), move=(0.5, 1, 0))),
        (Axisymmetric(lateral=True), Turn((0, 1, 0), angle_deg=150.0, move=(0, 0.5, 0))),
    ],
    ids=["plane", "revolution"],
)
def test_a_rigid_motion_strains_nothing(ideal, turn):
    """Both ends of a strip of rubber are led through one rigid motion of 150 degrees.

    Requirement: places are the turned ones to 1e-8; no energy, no force. Source: invariance.
    Tolerance: Newton to 1e-12.
    """
    heads, problem = strip(ideal, RUBBER, ("top", "bottom"), size=(1.0, 2.0), cells=(1, 2))
    last = run(problem, Step("a", 5, rotation={head.name: turn for head in heads}))
    x = problem.model.space.tabulate_dof_coordinates()
    assert x + problem.u.x.array.reshape(-1, 3) == pytest.approx(turn.path(x, 1.0), abs=1e-8)
    assert last.energies["elastic"] < 1e-12
    assert max(np.abs(problem.rigid.support(head)).max() for head in heads) < 1e-7


def test_plane_strain_is_a_slice():
    """A strip of rubber is bent by 60 degrees and sheared by a force, plane and as a slice.

    Requirement: pose and supports of the reference point to 1e-9 of the largest. Source: a slice
    of one cell whose nodes stay in their planes has the same equations. Tolerance: Newton to 1e-12.
    """
    led = {"top": {"x": None, "y": None, "rz": math.radians(60.0)}}
    bend = {"motion": led, "load": {"top": {"x": 0.02, "y": -0.03}}}
    (flat,), problem = strip(PlaneStrain(thickness=0.5), RUBBER, cells=(2, 8), order=1)
    run(problem, Step("a", 4, CLAMP, **bend))
    box = BoxSpec((1, 0, 0), (1, 8, 0.5), (2, 8, 1), "hexahedron")
    model = build_box({"b": box})
    x = model.space.tabulate_dof_coordinates()
    model.name_nodes("b.between", np.flatnonzero(x[:, 1] < 7.9).astype(np.int32))
    model.name_nodes("b.low", np.flatnonzero(x[:, 1] < 0.1).astype(np.int32))
    head = RigidBody("top", (1.5, 8.0, 0.0), free=True)
    back = next(n for n in model.facet_names() if is_side(model, n, 8.0))
    slab = Problem(model, {"b": RUBBER}, coupled=[CoupledFace(back, head)])
    held = {"b.low": {"x": 0.0, "y": 0.0}, "b.between": {"z": 0.0}}
    run(slab, Step("a", 4, held, **bend))
    assert flat.accepted.values == pytest.approx(head.accepted.values, rel=1e-9, abs=1e-9)
    moment = slab.rigid.support(head)[5]
    assert abs(moment) > 0.01
    assert problem.rigid.support(flat)[5] == pytest.approx(moment, rel=1e-9)


def is_side(model: Any, group: str, height: float) -> bool:
    """Whether all nodes of a facet group are at a height y."""
    y = model.space.tabulate_dof_coordinates()[model.nodes(group), 1]
    return bool(np.all(np.abs(y - height) < 1e-9))


@pytest.mark.parametrize(
    ("ideal", "free"),
    [
        (PlaneStrain(lateral=True), ("x", "z", "rz")),
        (PlaneStrain(thickness=2.0), ("x", "rz")),
        (Axisymmetric(lateral=True), ("y", "ry")),
        (Axisymmetric(), ("y",)),
    ],
)
def test_tangent(fe, ideal, free):
    """Halving the step quarters the error of the central difference against the tangent.

    Requirement: exact tangent at a random state. Source: Taylor. Tolerance: 4 (1 + O(h^2)), 0.15.
    """
    origin = (0.0, 0.0) if isinstance(ideal, Axisymmetric) else (1.0, 0.0)
    _, problem = strip(
        ideal,
        RUBBER,
        origin=origin,
        size=(1.0, 2.0),
        cells=(2, 2),
        order=1,
        springs={"x": 1.0, "y": 2.0, "z": 3.0, "rx": 4.0, "ry": 5.0, "rz": 6.0},
    )
    motion, load = {"top": dict.fromkeys(free)}, {"top": dict.fromkeys(free, 1.0)}
    problem.begin(Step("a", 1, CLAMP, motion=motion, load=load))
    problem.set_load_factor(1.0, 1.0)
    errors = fe.tangent_errors(problem, np.random.default_rng(3), 0.05)
    assert np.all(np.abs(errors[:-1] / errors[1:] - 4.0) < 0.15)


@pytest.mark.parametrize(
    ("ideal", "at", "motion", "says"),
    [
        (PlaneStrain(), None, {"rx": 0.1}, "plane-strain without lateral has no such motion"),
        (PlaneStrain(), None, {"z": 0.1}, "allowed: x, y, rz"),
        (PlaneStress(), None, {"z": None}, "plane-stress without lateral has no such motion"),
        (Axisymmetric(), None, {"ry": 0.1}, "allowed: y"),
        (Axisymmetric(lateral=True), None, {"x": None}, "allowed: y, ry"),
        (Axisymmetric(), (1.0, 2.0, 0.0), {}, "(1, 2, 0) is beside the axis x = z = 0"),
        (PlaneStrain(), None, {"x": None}, "'b' is free to move: translation along x"),
    ],
)
def test_what_cannot_be_is_one_line(ideal, at, motion, says):
    """Requirement: found before anything is solved."""
    with pytest.raises(InputError) as caught:
        _, problem = strip(ideal, at=at)
        Solver(problem, [Step("a", 1, motion={"top": motion})])
    assert says in str(caught.value)


LAW = ContactLaw(
    NormalLaw(penalty=1e4), Adhesion(stiffness=(1e3, 1e3)), Friction(coefficients=(0.2, 0.2))
)


def pressed(ideal: Idealisation | None, surface: bool, start: float, mortar: bool) -> Any:
    """Force and moment of a rigid plate, or of a plane, that is pressed on a block and slid.

    Without an idealisation a slice 0.5 thick, with the plate wider.
    """
    tool = RigidBody("tool", (0.0, 1.0, 0.0), free=not surface)
    sizes = {"b": ((start, 0.0), (1.0, 1.0), (4, 3)), "plate": ((0.0, 1.0), (2.0, 0.5), (5, 1))}
    bodies, deep = [], {"b": (0.0, 0.5), "plate": (-0.2, 0.9)}
    for name, (origin, size, cells) in sizes.items():
        if ideal is None:
            low, high = deep[name]
            given = {"origin": (*origin, low), "size": (*size, high), "cells": (*cells, 1)}
            bodies.append(Body(name, make_shape("box", **given)))
        else:
            bodies.append(
                Body(name, make_shape("rectangle", origin=origin, size=size, cells=cells))
            )
    bodies = bodies[:1] if surface else bodies
    skin = {} if surface else {"plate.skin": [make_selector("all")]}
    model = build_mesh(bodies, skin, **({} if ideal is None else {"idealisation": ideal}))
    top, low, master, planes = "b.top", "b.bottom", "plate.bottom", {}
    if ideal is None:
        top, low, master, planes = "b.back", "b.front", "plate.front", {"b.top": {"z": 0.0}}
    plane = make_surface("plane", point=(0, 1, 0), normal=(0, -1, 0))
    other = MovingSurface(plane, tool) if surface else master
    contact = Contact(model, top, other, LAW, mortar=mortar, current_area=False)
    coupled = [] if surface else [CoupledFace("plate.skin", tool)]
    problem = Problem(model, dict.fromkeys(model.body_names(), SLIM), [contact], coupled=coupled)
    clamp = {low: {"x": 0.0, "y": 0.0, "z": 0.0}} | planes
    slid = Step("slide", 2, motion={"tool": {"x": 0.02} if start else {}})
    last = run(problem, Step("press", 1, clamp, motion={"tool": {"y": -0.01}}), slid)
    force, moment = contact.resultant((0.0, 1.0, 0.0))
    assert last.reactions[low][:2] == pytest.approx(-force[:2], rel=1e-8, abs=1e-8)
    assert problem.rigid.contact_force(tool)[:2] == pytest.approx(-force[:2], rel=1e-8, abs=1e-8)
    assert not start or contact.counts()["slip"] > 0
    return np.array([force[0], force[1], moment[2]]) if start else force[1:2]


@pytest.mark.parametrize(
    ("ideal", "start"),
    [(PlaneStrain(thickness=0.5), 0.3), (Axisymmetric(), 0.0)],
    ids=["plane", "revolution"],
)
def test_a_meshed_tool_is_rigid(ideal, start):
    """A plate whose skin follows a point is pressed on a block, and slid.

    Requirement: force and moment on the block are those of a rigid plane that moves alike, to 1e-8
    of the force. Source: the same motion; at points feet are those on the plane. Tolerance:
    Newton to 1e-12.
    """
    found = [pressed(ideal, surface, start, mortar=False) for surface in (False, True)]
    assert found[0] == pytest.approx(found[1], abs=1e-8 * np.abs(found[1]).max())


def test_a_meshed_tool_in_the_plane_is_that_of_a_slice():
    """The same with mortar weights, against a slice of one layer of cells in space.

    Requirement: force and moment to 1e-8. Source: the same equations, nu = 0. Tolerance: Newton to
    1e-12 and overlaps of facets in another order.
    """
    ideals = (PlaneStrain(thickness=0.5), None)
    found = [pressed(ideal, False, 0.3, mortar=True) for ideal in ideals]
    assert found[0] == pytest.approx(found[1], rel=1e-8)
