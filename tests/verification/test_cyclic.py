"""Sectors with cyclic symmetry: the whole ring and shaft, the axisymmetric model, other meshes."""

from __future__ import annotations

import math
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from anisocontact.bulk import ThermalExpansion, make_material
from anisocontact.contact import Contact
from anisocontact.interface import Augmentation, ContactLaw, Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import (
    Axisymmetric,
    Body,
    Model,
    Placement,
    PlaneStrain,
    build_mesh,
    make_shape,
    node_near,
)
from anisocontact.rigid import MovingSurface, RigidBody
from anisocontact.solver import CyclicSymmetry, Cylindrical, Problem, Solver, Step, Tie, Turn
from anisocontact.surfaces import make_surface

LAWS = NormalLaw(penalty=1e4), Adhesion(stiffness=1e4), Friction(coefficients=0.3)
FLOOR = Interface(make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1)), *LAWS)
PRESS = Step("press", 2, {"ring.top": {"x": 0.0, "y": 0.0, "z": -0.02}})
TURN = Step("turn", 3, rotation={"ring.top": Turn(axis=(0, 0, 1), angle=0.02)})
STEEL = make_material("linear-elastic", E=1000.0, nu=0.3)
RUBBER = make_material("neo-hookean", E=1000.0, nu=0.3)


def ring(sectors: int, order: int = 1, cell: str = "hexahedron", around: int = 12) -> Model:
    """A ring, or one of so many sectors of it, that begins at no axis."""
    turn = {} if sectors == 1 else {"start": 0.2, "end": 0.2 + 2.0 * math.pi / sectors}
    cells = (2, around // sectors, 2)
    shape = make_shape(
        "ring", inner=1.0, outer=2.0, length=1.0, cells=cells, order=order, cell=cell, **turn
    )
    return build_mesh([Body("ring", shape)])


def solved(problem: Problem, *steps: Step, strategy: str = "direct") -> Problem:
    """A problem after these steps."""
    for _ in Solver(problem, list(steps), options={"snes_rtol": 1e-11}, strategy=strategy).run():
        pass
    return problem


def faces(sectors: int) -> list[CyclicSymmetry]:
    """Cut faces of a sector of the ring; none of a whole."""
    return [] if sectors == 1 else [CyclicSymmetry("ring.start", "ring.end", sectors)]


def pressed(
    sectors: int, material: Any = STEEL, strategy: str = "direct", order: int = 1
) -> np.ndarray:
    """Force and moment along the axis of a ring that is pressed on a plane and turned, of all."""
    model = ring(sectors, order)
    contact = Contact(model, "ring.bottom", FLOOR, mortar=False)
    problem = Problem(model, {"ring": material}, [contact], cyclic=faces(sectors))
    solved(problem, PRESS, TURN, strategy=strategy)
    force, moment = contact.resultant()
    return sectors * np.array([force[2], moment[2]])


@pytest.mark.parametrize(
    ("material", "strategy", "order"),
    [
        (STEEL, "direct", 1),
        (STEEL, "condensed", 1),
        (STEEL, "iterative", 1),
        (STEEL, "direct", 2),
        (RUBBER, "direct", 1),
    ],
)
def test_sector_of_a_ring(material: Any, strategy: str, order: int):
    """A ring pressed on a plane and turned, stick and slip below it; sectors of 180 and 30 degrees.

    Requirement: force and moment of all sectors are those of the whole ring, whose mesh has the
    same cells. Source: the solution of the whole is the same in every sector. Tolerance: 1e-9 of
    Newton to 1e-11.
    """
    whole = pressed(1, material, order=order)
    assert abs(whole[1]) > 1.0, "friction acts"
    for sectors in (2, 12):
        assert pressed(sectors, material, strategy, order) == pytest.approx(whole, rel=1e-9)


def test_displacements_on_the_cut_faces():
    """Requirement: those of the slave are those of the master turned, at every node, to rounding.

    Source: the constraint. A node's partner is found by its place.
    """
    model = ring(6)
    contact = Contact(model, "ring.bottom", FLOOR, mortar=False)
    problem = solved(Problem(model, {"ring": STEEL}, [contact], cyclic=faces(6)), PRESS, TURN)
    x, u = model.space.tabulate_dof_coordinates(), problem.u.x.array.reshape(-1, 3)
    c, s = math.cos(math.pi / 3.0), math.sin(math.pi / 3.0)
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    apart = np.linalg.norm((x @ turn.T)[:, None] - x[None], axis=2)
    start, end = np.nonzero(apart < 1e-9)
    assert len(start) == 9
    assert np.abs(u[end] - u[start] @ turn.T).max() < 1e-14
    assert np.abs(u[start]).max() > 1e-3


def shaft(sectors: int) -> tuple[Problem, Contact]:
    """A shaft, or a quarter of it with the axis, whose foot is pressed on a ball."""
    part = {} if sectors == 1 else {"part": "quarter"}
    shape = make_shape("cylinder", radius=1.0, length=1.5, cells=(16, 2, 3), **part)
    model = build_mesh([Body("shaft", shape)])
    ball = make_surface("sphere", centre=(0, 0, -5), radius=5)
    die = RigidBody("die", reference=(0, 0, 0))
    contact = Contact(
        model, "shaft.bottom", MovingSurface(Interface(ball, *LAWS), die), mortar=False
    )
    cut = [] if sectors == 1 else [CyclicSymmetry("shaft.left", "shaft.front", 4)]
    return Problem(model, {"shaft": STEEL}, [contact], cyclic=cut), contact


def test_sector_with_the_axis():
    """A quarter of a shaft with nodes on the axis, pressed on a ball that turns.

    Requirement: force and torque are those of the whole shaft; the axis stays where it is. Source,
    tolerance: as of the ring.
    """
    found = []
    for sectors in (1, 4):
        problem, contact = shaft(sectors)
        held = {"shaft.top": {"x": 0.0, "y": 0.0, "z": -0.02}}
        turn = Step("turn", 2, motion={"die": {"rz": 0.05}})
        solved(problem, Step("press", 1, held), turn)
        force, moment = contact.resultant()
        found.append(sectors * np.array([force[2], moment[2]]))
    assert abs(found[0]).min() > 1e-3
    assert found[1] == pytest.approx(found[0], rel=1e-9)
    x, u = problem.model.space.tabulate_dof_coordinates(), problem.u.x.array.reshape(-1, 3)
    assert np.abs(u[np.hypot(x[:, 0], x[:, 1]) < 1e-9, :2]).max() < 1e-12 * np.abs(u).max()


def test_sector_against_the_axisymmetric_model():
    """The ring pressed and turned, of a sector of 5 degrees and as a section with twist.

    Requirement: 0.2 % in force and torque. Source: `Axisymmetric(lateral=True)`, another
    discretisation of the same body. Tolerance: one cell of order 1 around is a chord, whose area is
    less by 1 - sin(5 deg)/(5 deg) = 0.13 %. Moments about other axes cancel over the whole ring.
    """
    plane = make_shape("rectangle", origin=(1, 0), size=(1, 1), cells=(4, 4))
    model = build_mesh([Body("ring", plane)], idealisation=Axisymmetric(lateral=True))
    floor = Interface(make_surface("plane", point=(0, 0, 0), normal=(0, 1, 0)), *LAWS)
    flat = Contact(model, "ring.bottom", floor, mortar=False)
    steps = [
        Step("press", 2, {"ring.top": {"x": 0.0, "y": -0.02, "z": 0.0}}),
        Step("turn", 3, rotation={"ring.top": Turn(axis=(0, 1, 0), angle=0.02)}),
    ]
    solved(Problem(model, {"ring": STEEL}, [flat]), *steps)
    force, moment = flat.resultant()
    shape = make_shape(
        "ring", inner=1.0, outer=2.0, length=1.0, cells=(4, 1, 4), end=math.radians(5)
    )
    model = build_mesh([Body("ring", shape)])
    contact = Contact(model, "ring.bottom", FLOOR, mortar=False)
    solved(Problem(model, {"ring": STEEL}, [contact], cyclic=faces(72)), PRESS, TURN)
    sector_force, sector_moment = contact.resultant()
    assert 72 * sector_force[2] == pytest.approx(force[1], rel=2e-3)
    assert 72 * sector_moment[2] == pytest.approx(moment[1], rel=2e-3)
    assert moment[[0, 2]].tolist() == [0.0, 0.0]


def pair(sectors: int) -> np.ndarray:
    """Force and torque between a ring with a pad that is tied on it and a wider ring below."""
    turn = {} if sectors == 1 else {"start": 0.2, "end": 0.2 + 2.0 * math.pi / sectors}
    around = 12 // sectors

    def body(name: str, radii: tuple[float, float], low: float, cells: tuple[int, ...]) -> Body:
        sizes = dict(zip(("inner", "outer"), radii, strict=True), length=0.5, cells=cells)
        return Body(name, make_shape("ring", **sizes, **turn), Placement(move=(0.0, 0.0, low)))

    bodies = [
        body("base", (0.8, 2.2), -0.5, (2, around, 1)),
        body("pad", (1.0, 2.0), 0.0, (2, around, 1)),
        body("ring", (1.0, 2.0), 0.5, (3, 2 * around, 1)),
    ]
    model = build_mesh(bodies)
    law = ContactLaw(*LAWS)
    contact = Contact(
        model, "pad.bottom", "base.top", law, mortar=True, augmentation=Augmentation()
    )
    names = [one.name for one in bodies]
    cuts = [
        CyclicSymmetry(f"{name}.start", f"{name}.end", sectors) for name in names if sectors > 1
    ]
    problem = Problem(
        model,
        dict.fromkeys(names, STEEL),
        [contact],
        ties=[Tie("ring.bottom", "pad.top")],
        cyclic=cuts,
    )
    clamp = {"base.bottom": {"x": 0.0, "y": 0.0, "z": 0.0}}
    press = Step("press", 1, {"ring.top": {"x": 0.0, "y": 0.0, "z": -0.01}} | clamp)
    twist = Step("turn", 2, rotation={"ring.top": Turn(axis=(0, 0, 1), angle=0.002)})
    solved(problem, press, twist)
    force, moment = contact.resultant()
    return sectors * np.array([force[2], moment[2]])


def test_pair_of_sectors_with_a_tie():
    """Mortar contact with multipliers between rings, one of them glued on a third, of sectors.

    Requirement: force and torque of the whole to 1e-5. Source: as of one ring; cut faces, ties and
    contact meet in lines. Tolerance: slave nodes of tie and contact at a cut are one node of the
    whole, whose dual function the nodes beside it have here: another discretisation; measured 3e-6.
    """
    whole, sector = pair(1), pair(6)
    assert abs(whole).min() > 0.1
    assert sector == pytest.approx(whole, rel=1e-5)


def test_faces_whose_meshes_do_not_match():
    """A ring of two bodies that are glued, with four cells on one cut face and nine on the other.

    Requirement: heated, it expands freely, `u = a T x`, to 1e-10. Source: that displacement has no
    stress, and turns into itself. Tolerance: Newton to 1e-11.
    """
    angles = (-0.2, 0.2, 2.0 * math.pi / 10.0 - 0.2)
    bodies = [
        Body(name, make_shape("ring", inner=1.0, outer=2.0, length=1.0, cells=cells, **turn))
        for name, cells, turn in (
            ("one", (2, 2, 2), {"start": angles[0], "end": angles[1]}),
            ("two", (3, 2, 3), {"start": angles[1], "end": angles[2]}),
        )
    ]
    model = build_mesh(bodies)
    model.name_nodes("one.foot", node_near(model, "one", (1.0, 0.0, 0.0)))
    problem = Problem(
        model,
        dict.fromkeys(("one", "two"), ThermalExpansion(STEEL, 1e-3)),
        ties=[Tie("two.start", "one.end")],
        cyclic=[CyclicSymmetry("one.start", "two.end", 10)],
    )
    held = {"one.foot": {"y": 0.0}, "one.bottom": {"z": 0.0}, "two.bottom": {"z": 0.0}}
    solved(problem, Step("heat", 1, held, temperature={"one": 10.0, "two": 10.0}))
    x, u = model.space.tabulate_dof_coordinates(), problem.u.x.array.reshape(-1, 3)
    assert np.abs(u - 0.01 * x).max() < 1e-10 * 0.02


def test_a_sector_in_the_plane():
    """A quarter of a disc in plane strain under pressure, with the axis; no plane of symmetry.

    Requirement: `u = -(1 + nu)(1 - 2 nu) p x / E` to 1e-10 of the largest. Source: a uniform
    stress -p. Tolerance: Newton to 1e-11.
    """
    shape = make_shape("disc", radius=1.0, cells=(16, 2), part="quarter")
    model = build_mesh([Body("disc", shape)], idealisation=PlaneStrain())
    x = model.space.tabulate_dof_coordinates()
    inside = x[np.argmin(np.linalg.norm(x - (0.6, -0.4, 0.0), axis=1))]
    model.name_nodes("disc.inside", node_near(model, "disc", inside))
    problem = Problem(model, {"disc": STEEL}, cyclic=[CyclicSymmetry("disc.left", "disc.top", 4)])
    factor = -1.3 * 0.4 * 10.0 / 1000.0
    held = {"disc.inside": {"y": factor * inside[1]}}
    solved(problem, Step("press", 1, held, pressure={"disc.outer": 10.0}))
    assert np.abs(problem.u.x.array.reshape(-1, 3) - factor * x).max() < -1e-10 * factor


def two_rings(*cut: str) -> Problem:
    """A sector of 30 degrees of two rings that touch at r = 0.75, nu = 0, one cell along z.

    Args:
        *cut: Rings that are tied at their cut faces; both if left out.
    """
    shape: Any = {"length": 0.25, "cells": (8, 8, 1), "end": math.pi / 6.0}
    bodies = [
        Body(name, make_shape("ring", inner=inner, outer=outer, **shape))
        for name, inner, outer in (("inner", 0.5, 0.75), ("outer", 0.75, 1.0))
    ]
    model = build_mesh(bodies)
    free = ContactLaw(LAWS[0], LAWS[1], Friction(coefficients=0.0))
    contact = Contact(
        model, "inner.outer", "outer.inner", free, mortar=True, augmentation=Augmentation()
    )
    names = ("inner", "outer")
    return Problem(
        model,
        dict.fromkeys(names, make_material("linear-elastic", E=1000.0, nu=0.0)),
        [contact],
        cyclic=[CyclicSymmetry(f"{name}.end", f"{name}.start", 12) for name in cut or names],
    )


def test_slaves_past_the_end_of_their_master():
    """Requirement: of slave nodes at a cut face that their master has left by a share s of a facet
    the share 1 - (1 - s)^2 of the weight that is lost is told, once as a warning; none before.

    A master that is no sector, with faces held where cut faces would be, ends there. Source: the
    integral of the linear function of a node over what is covered. Tolerance: a ring pressed in by
    0.3 % moves its facets by as much of their size, 2 % of the share.
    """
    pressed = Cylindrical({"radial": -0.002, "tangential": 0.0, "axial": 0.0})
    clamp = {"inner.inner": {"x": 0.0, "y": 0.0, "z": 0.0}}
    turn = Turn(axis=(0, 0, 1), angle=0.2 * math.pi / 48.0)
    ends = ("outer.start", "outer.end")
    led = dict.fromkeys(ends, Cylindrical({"tangential": 0.0})) | {"outer.outer": pressed}
    steps = [
        Step("press", 1, clamp, cylindrical=led),
        Step("turn", 2, rotation=dict.fromkeys(("outer.outer", *ends), turn)),
    ]
    told: list[str] = []
    runs = Solver(two_rings("inner"), steps, strategy="direct").run(on_warning=told.append)
    before, half, whole = (list(accepted.past_cuts.values()) for accepted in runs)
    assert not before
    assert [*half, *whole] == pytest.approx([0.19, 0.36], rel=0.02)
    (line,) = (text for text in told if "past the end of the master by up to 19%" in text)
    assert line.startswith("step 'turn', increment 1: contact 'inner.outer': slave nodes")


def test_supports_on_the_master_alone():
    """Two rings under pressure, the inner one held inside but for its nodes on the slave.

    Requirement: the displacement outside is that of a ring without a joint to 0.3 %, the slave's
    nodes stay with those of the master, which are held. Source: Lame with nu = 0, that is
    u = A (r - a^2/r). Tolerance: order 1, 16 cells through the wall, chords of 3.75 degrees: 0.2 %.
    """
    problem = two_rings()
    model = problem.model
    x = model.space.tabulate_dof_coordinates()
    radius, angle = np.hypot(x[:, 0], x[:, 1]), np.arctan2(x[:, 1], x[:, 0])
    held = np.flatnonzero((radius < 0.5 + 1e-9) & (angle < math.pi / 6.0 - 1e-9))
    model.name_nodes("inner.held", held.astype(np.int32))
    flat = {
        f"{name}.{side}": {"z": 0.0} for name in ("inner", "outer") for side in ("bottom", "top")
    }
    step = Step(
        "press", 1, {"inner.held": {"x": 0.0, "y": 0.0}} | flat, pressure={"outer.outer": 1.0}
    )
    solved(problem, step)
    u = problem.u.x.array.reshape(-1, 3)
    out = np.einsum("ni,ni->n", x, u) / radius
    assert np.abs(out[radius < 0.5 + 1e-9]).max() < 1e-14
    exact = -1.0 / (1000.0 * 1.25) * (1.0 - 0.25)
    assert out[radius > 1.0 - 1e-9] == pytest.approx(exact, rel=3e-3)


SCRIPT = """
from tests.verification.test_cyclic import *
from anisocontact.base.fenicsx import MPI
found = [pressed(3, RUBBER, strategy) for strategy in ("direct", "iterative")]
if MPI.COMM_WORLD.rank == 0:
    print(*map(repr, np.concatenate(found).tolist()))
"""


@pytest.mark.mpi
@pytest.mark.slow
def test_processes_change_nothing():
    """A sector of a ring on one and on two processes.

    Requirement: force and torque to 1e-9. Source: the same equations. Tolerance: Newton to 1e-11.
    """
    if shutil.which("mpirun") is None:
        pytest.skip("no mpirun")
    root = Path(__file__).parents[2]
    found = []
    for count in (1, 2):
        command = ["mpirun", "-n", str(count), sys.executable, "-c", SCRIPT]
        done = subprocess.run(command, cwd=root, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        found.append(np.array(done.stdout.split(), dtype=float))
    assert np.abs(found[0] - found[1]).max() < 1e-9 * np.abs(found[0]).max()
