"""Nodes that supports hold on both sides of a contact: no equilibrium says what the pressure is."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

from anisocontact.base.array_types import Floats
from anisocontact.base.limits import Limits
from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.laws import Friction
from anisocontact.mesh import Body, Placement, PlaneStrain, Rotation, build_mesh, make_shape
from anisocontact.rigid import RigidBody
from anisocontact.solver import CoupledFace, Cylindrical, Problem, Solver, Step
from anisocontact.solver.stepping.increment_warnings import IncrementWarnings
from anisocontact.solver.stepping.level_nodes import level_nodes
from anisocontact.solver.stepping.report import Accepted, StoppedError
from anisocontact.surfaces import make_surface

WALL = {"low.left": {"x": 0.0, "y": 0.0}, "up.left": {"x": 0.0, "y": 0.0}}
CLAMPED = {"displacement": WALL}


def _run(
    strategy: str, columns: int = 4, gap: float = 0.0, wall: Mapping[str, Any] = CLAMPED
) -> tuple[list[Accepted], Contact]:
    """Two beams clamped at one wall, pressed together and bent to and fro; corners at one place."""
    low = make_shape("rectangle", origin=(0, -1), size=(4, 1), cells=(4, 2))
    up = make_shape("rectangle", origin=(0, gap), size=(4, 1), cells=(columns, 2))
    model = build_mesh([Body("low", low), Body("up", up)], idealisation=PlaneStrain())
    steel = make_material("linear-elastic", E=1e4, nu=0.0)
    contact = Contact(model, "up.bottom", "low.top", Friction(coefficients=0.2))
    problem = Problem(model, {"low": steel, "up": steel}, [contact])
    squeeze = {"low.bottom": 1.0, "up.top": 1.0}
    steps = [Step("press", 1, pressure=squeeze, **wall)]
    for y in (0.3, -0.3):
        ends = {"up.right": {"y": y}, "low.right": {"y": y}}
        steps.append(Step("bend", 1, traction=ends))
    return list(Solver(problem, steps, strategy=strategy).run()), contact


def test_strategies_agree_on_the_reactions_of_both_clamps() -> None:
    """The multiplier of the corner moved by rounding alone, and with it both reactions.

    Requirement: what no equilibrium determines is the same whatever solves for it: supports carry
    it, as they carry friction along directions that they hold. Tolerance: that of Newton's method.
    """
    (*_, one), contact = _run("direct")
    (*_, other), _ = _run("condensed")
    for group in WALL:
        assert one.reactions[group] == pytest.approx(other.reactions[group], abs=1e-7)
    corner = int(np.argmin(contact.points[:, 0]))
    assert contact.last.pressure[corner] == 0.0


def test_it_is_told_how_many_points_have_no_pressure() -> None:
    """One line for the contact, in the first increment and never again."""
    states, contact = _run("direct")
    warnings = IncrementWarnings()
    told = [text for accepted in states for text in warnings.of(accepted)]
    (line,) = [text for text in told if "both sides" in text]
    assert line.startswith(f"step 'press', increment 1: contact {contact.name!r}: 1 slave point")


@pytest.mark.parametrize(("columns", "gap"), [(3, 0.0), (4, 1e-3)])
def test_a_corner_that_moving_nodes_meet_or_none_has_its_pressure(columns: int, gap: float) -> None:
    """With 3 facets over 4 the corner is held against the next nodes of the master as well.

    Requirement: nothing is said where a node of the master that moves says what the pressure is,
    nor where the corner touches nothing, as in beams with a gap that they close farther out.
    """
    states, contact = _run("direct", columns, gap)
    assert contact.resultant()[0][1] > 0.0
    assert [one.undetermined for one in states] == [{}] * len(states)


@pytest.mark.parametrize("free", ["", "x", "rz"])
@pytest.mark.parametrize("material", ["linear-elastic", "neo-hookean"])
def test_a_face_on_a_rigid_body_is_held_as_by_supports(material: str, free: str) -> None:
    """A block is pressed into the corner of two planes by its upper face, whose edge is in one.

    What prescribes the motion of the edge says nothing of its pressure, be it a support or the body
    that the face follows; where a step lets that go, or turn, its balance does.

    Requirement: the forces of supports, in as many iterations, and the same is told; of a free body
    the pressure that holds it, and nothing is told. Tolerance: that of Newton's method.
    """
    model = build_mesh(
        [Body("block", make_shape("rectangle", origin=(0, 0), size=(1, 1), cells=(3, 3)))],
        idealisation=PlaneStrain(),
    )
    steel = {"block": make_material(material, E=1e3, nu=0.3)}
    wall = make_surface("plane", point=[0, 0, 0], normal=[1, 0, 0])
    down = {"block.bottom": {"y": 0.0}}
    into = {"x": -0.01, "y": -0.01}

    def run(step: Step, *coupled: CoupledFace) -> tuple[Accepted, Contact]:
        contact = Contact(model, "block.left", wall, Friction(coefficients=0.2))
        problem = Problem(model, steel, [contact], coupled=coupled)
        (accepted,) = Solver(problem, [step]).run()
        return accepted, contact

    by_supports, _ = run(Step("press", 1, {**down, "block.top": into}))
    body = RigidBody("head", (0.5, 2.0, 0.0), free=True)
    motion = {"head": {**into, free: None} if free else into}
    load = {"head": {"x": -5.0}} if free == "x" else {}
    step = Step("press", 1, down, motion=motion, load=load)
    by_body, contact = run(step, CoupledFace("block.top", body))
    edge = int(np.argmax(contact.points[:, 1]))
    assert not by_body.relaxed
    if free:
        assert by_body.undetermined == {}
        assert contact.last.pressure[edge] > 0.0
        assert contact.last.gap[edge] == pytest.approx(0.0, abs=1e-6)
        return
    assert by_body.undetermined == by_supports.undetermined == {contact.name: 1}
    assert by_body.iterations == by_supports.iterations
    (one,), (other,) = by_body.resultants.values(), by_supports.resultants.values()
    np.testing.assert_allclose(one, other, rtol=1e-7, atol=1e-7)


def test_an_edge_level_with_its_reference_point_is_held_while_the_body_is_free_to_turn() -> None:
    """The edge of a face does not move along its own plane where the face tilts.

    Requirement: it is told, as where supports hold the edge, and the increment is solved as it is,
    in as many iterations as with the turn held, or a few more. Source: at small strain a turn moves
    nodes across their distance from the reference point, which is along the plane. The multiplier
    there grew without bound, with nothing told, and soft penalties were the end.
    """
    block = make_shape("rectangle", origin=(0, 0), size=(1, 1), cells=(3, 3))
    model = build_mesh([Body("block", block)], idealisation=PlaneStrain())
    steel = {"block": make_material("linear-elastic", E=1e3, nu=0.3)}
    wall = make_surface("plane", point=[0, 0, 0], normal=[1, 0, 0])

    def run(motion: Mapping[str, float | None]) -> tuple[Accepted, Contact]:
        contact = Contact(model, "block.left", wall, Friction(coefficients=0.2))
        body = RigidBody("head", (0.5, 1.0, 0.0), free=True)
        face = CoupledFace("block.top", body)
        problem = Problem(model, steel, [contact], coupled=[face])
        step = Step("press", 1, {"block.bottom": {"y": 0.0}}, motion={"head": motion})
        (accepted,) = Solver(problem, [step]).run()
        return accepted, contact

    held, _ = run({"x": -0.01, "y": -0.01})
    tilted, contact = run({"x": -0.01, "y": -0.01, "rz": None})
    assert held.undetermined == tilted.undetermined == {contact.name: 1}
    assert not tilted.relaxed
    assert tilted.iterations <= held.iterations + 3
    assert contact.last.pressure.max() < 100.0


@pytest.mark.slow
def test_an_edge_that_a_large_turn_alone_takes_off_is_told_where_a_run_stops() -> None:
    """At finite strain a turn moves the edge off the plane by its square, and begins at once.

    Requirement: a run that finds no equilibrium there names the contact, the face and its body, and
    what to do. Source: the edge is level with the reference point along the plane, so that a way
    into it of 0.005 needs a turn of 8 degrees. A load on the body in the place of that way is no
    such case, whatever else is in the way.
    """
    block = make_shape("rectangle", origin=(0, 0), size=(1, 1), cells=(2, 2))
    model = build_mesh([Body("block", block)], idealisation=PlaneStrain())
    steel = {"block": make_material("neo-hookean", E=1e3, nu=0.3)}
    wall = make_surface("plane", point=[0, 0, 0], normal=[1, 0, 0])
    contact = Contact(model, "block.left", wall, Friction(coefficients=0.2))
    face = CoupledFace("block.top", RigidBody("head", (0.5, 1.0, 0.0), free=True))
    problem = Problem(model, steel, [contact], coupled=[face])
    motion = {"head": {"x": -0.005, "y": -0.01, "rz": None}}
    step = Step("press", 1, {"block.bottom": {"y": 0.0}}, motion=motion)
    with pytest.raises(StoppedError) as stopped:
        list(Solver(problem, [step], limits=Limits(smallest=1.0)).run())
    told = "1 slave point of 'block.top' can leave the master by nothing but a large turn of rigid"
    assert told in str(stopped.value)
    assert "'head'" in str(stopped.value)
    freed = {"head": {"x": None, "y": -0.01, "rz": None}}
    problem.begin(Step("press", 1, {"block.bottom": {"y": 0.0}}, motion=freed))
    assert level_nodes(problem) == ""


def _leaning(degrees: float, guided: bool) -> tuple[Accepted, Floats]:
    """A block that stands on a symmetry plane, with its upper edge led into the wall beside it.

    Returns:
        What was accepted, and the force of the wall along its normal and up.
    """
    angle = np.radians(degrees)
    away, up = frame = np.array(
        [[np.cos(angle), np.sin(angle), 0.0], [-np.sin(angle), np.cos(angle), 0.0]]
    )
    block = make_shape("rectangle", origin=(0, 0), size=(1, 1), cells=(3, 3))
    place = Placement(rotate=Rotation(axis=(0, 0, 1), angle=angle))
    model = build_mesh([Body("block", block, place)], idealisation=PlaneStrain())
    edge = np.argmin(np.linalg.norm(model.positions - up, axis=1), keepdims=True)
    model.name_nodes("block.edge", edge.astype(np.int32))
    wall = make_surface("plane", point=[0, 0, 0], normal=away)
    contact = Contact(model, "block.left", wall, Friction(coefficients=0.2))
    steel = {"block": make_material("linear-elastic", E=1e3, nu=0.3)}
    problem = Problem(model, steel, [contact], symmetry=["block.bottom"])
    support = Cylindrical({"radial": -0.01}, point=up - 4.0 * away)
    into: dict[str, Any] = {"displacement": {"block.edge": {"x": -0.01}}}
    if guided:
        into = {"cylindrical": {"block.edge": support}}
    step = Step("press", 1, pressure={"block.right": 2.0}, **into)
    (accepted,) = Solver(problem, [step]).run()
    return accepted, frame @ accepted.resultants[contact.name][0]


@pytest.mark.parametrize("angle", [0.0, 30.0, 45.0])
def test_an_inclined_support_along_the_normal_holds_as_a_displacement_along_an_axis(
    angle: float,
) -> None:
    """They said nothing of the pressure where they hold, and multipliers failed there.

    Requirement: all of it turned, with a cylindrical support for a displacement along x, has the
    forces turned, and the same is told. Tolerance: that of Newton's method.
    """
    by_axis, force = _leaning(0.0, False)
    by_cylinder, turned = _leaning(angle, True)
    assert not by_cylinder.relaxed
    assert len(by_cylinder.undetermined) == 1
    assert by_cylinder.undetermined == by_axis.undetermined
    np.testing.assert_allclose(turned, force, rtol=1e-7, atol=1e-7)


def test_walls_of_guides_are_those_of_displacements() -> None:
    """The two clamped beams, held at their wall along two directions that are no axes.

    Requirement: what holds a node along all directions is the same whatever the directions are.
    Tolerance: that of Newton's method.
    """
    still = Cylindrical({"radial": 0.0, "tangential": 0.0}, point=(3.0, -5.0, 0.0))
    by_axes, contact = _run("direct")
    by_cylinders, _ = _run("direct", wall={"cylindrical": dict.fromkeys(WALL, still)})
    assert [a.undetermined for a in by_cylinders] == [a.undetermined for a in by_axes]
    assert by_axes[-1].undetermined == {contact.name: 1}
    for group in WALL:
        assert by_cylinders[-1].reactions[group] == pytest.approx(
            by_axes[-1].reactions[group], abs=1e-7
        )
