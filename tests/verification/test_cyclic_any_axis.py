"""Sectors about any axis: cases that are drawn turned in space."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import scipy
from tests.verification.test_cyclic import LAWS, RUBBER, STEEL, solved

from anisocontact.base.errors import InputError
from anisocontact.contact import Contact
from anisocontact.interface import Interface
from anisocontact.mesh import Body, Placement, Rotation, build_mesh, make_shape
from anisocontact.solver import CyclicSymmetry, Cylindrical, Problem, Solver, Step, Turn
from anisocontact.surfaces import make_surface

VECTOR = (0.7, -1.1, 0.4)
TURNED = Rotation(VECTOR, angle=float(np.linalg.norm(VECTOR)))
MOVED = np.array([0.3, -2.0, 1.1])


class Drawn:
    """Space as a case is drawn in it: turned by Q and moved, or as it is."""

    def __init__(self, turned: bool) -> None:
        self.q = scipy.spatial.transform.Rotation.from_rotvec(VECTOR).as_matrix()
        self.q = self.q if turned else np.eye(3)
        self.move = MOVED if turned else np.zeros(3)
        self.place = Placement(rotate=TURNED, move=tuple(MOVED)) if turned else Placement()

    def way(self, *v: float) -> tuple[float, ...]:
        """A vector."""
        return tuple((self.q @ v).tolist())

    def at(self, *x: float) -> tuple[float, ...]:
        """A point."""
        return tuple((self.q @ x + self.move).tolist())

    def led(self, *v: float) -> dict[str, float]:
        """A displacement."""
        return dict(zip("xyz", self.way(*v), strict=True))


def ring(space: Drawn, material: Any, strategy: str) -> tuple[np.ndarray, ...]:
    """Places, displacements, force and moment of a sector pressed on a plane and turned."""
    shape: dict[str, Any] = {"inner": 1.0, "outer": 2.0, "length": 1.0, "cells": (2, 2, 2)}
    shape |= {"start": 0.2, "end": 0.2 + math.pi / 3.0}
    model = build_mesh([Body("ring", make_shape("ring", **shape), space.place)])
    plane = make_surface("plane", point=space.at(0, 0, 0), normal=space.way(0, 0, 1))
    contact = Contact(model, "ring.bottom", Interface(plane, *LAWS), mortar=False)
    sector = CyclicSymmetry(
        "ring.start", "ring.end", 6, axis=space.way(0, 0, 3), point=space.at(0, 0, 7)
    )
    problem = Problem(model, {"ring": material}, [contact], cyclic=[sector])
    axis, point = space.way(0, 0, 1), space.at(0, 0, 0)
    steps = (
        Step("press", 2, {"ring.top": space.led(0.0, 0.0, -0.02)}),
        Step("turn", 3, rotation={"ring.top": Turn(axis=axis, angle=0.02, point=point)}),
    )
    solved(problem, *steps, strategy=strategy)
    assert contact.counts()["slip"] > 0
    x, u = model.space.tabulate_dof_coordinates(), problem.u.x.array.reshape(-1, 3)
    return (x, u, *contact.resultant(point))


@pytest.mark.parametrize(
    ("material", "strategy"),
    [(STEEL, "direct"), (STEEL, "condensed"), (STEEL, "iterative"), (RUBBER, "direct")],
)
def test_a_sector_that_is_drawn_turned(material: Any, strategy: str):
    """A sector of a ring on a plane, stick and slip below it, all turned by 1.36 about an axis.

    Requirement: displacements of all nodes, force and moment are those of the sector about z,
    turned, to 1e-9. Source: objectivity. Tolerance: Newton to 1e-11.
    """
    space = Drawn(True)
    plain, found = ring(Drawn(False), material, "direct"), ring(space, material, strategy)
    assert np.abs(found[0] - (plain[0] @ space.q.T + space.move)).max() < 1e-12
    for one, other in zip(plain[1:], found[1:], strict=True):
        assert np.abs(other - one @ space.q.T).max() < 1e-9 * np.abs(one).max()


def shaft(space: Drawn, plane: bool) -> tuple[Problem, Step]:
    """A quarter of a shaft with its axis, its foot in a plane, pressed on its skin."""
    shape = make_shape("cylinder", radius=1.0, length=1.5, cells=(16, 2, 3), part="quarter")
    model = build_mesh([Body("shaft", shape, space.place)])
    axis, point = space.way(0, 0, 1), space.at(0, 0, -4)
    sector = CyclicSymmetry("shaft.left", "shaft.front", 4, axis=axis, point=point)
    more = {"symmetry": ["shaft.bottom"]} if plane else {}
    problem = Problem(model, {"shaft": STEEL}, cyclic=[sector], **more)
    led = {"shaft.top": Cylindrical({"axial": -0.03}, axis, point)}
    if not plane:
        led["shaft.bottom"] = Cylindrical({"axial": 0.0}, axis, point)
    rim = int(np.argmax(model.space.tabulate_dof_coordinates() @ space.way(1, 1, 0.0)))
    model.name_nodes("shaft.rim", np.array([rim], dtype=np.int32))
    led["shaft.rim"] = Cylindrical({"tangential": 0.0}, axis, point)
    return problem, Step("press", 1, cylindrical=led, pressure={"shaft.outer": 10.0})


@pytest.mark.parametrize("plane", [True, False], ids=["plane", "cylindrical"])
@pytest.mark.parametrize("turned", [False, True])
def test_a_shaft_with_its_axis_in_a_uniform_stress(turned: bool, plane: bool):
    """A quarter of a shaft, pressed along its axis and on its skin.

    Requirement: u = (a x, a y, -0.02 z) along its own axes at every node, on the axis too, to 1e-10
    of the largest; a = -p (1 - nu - 2 nu^2) / E + nu 0.02 of a uniform stress. Source: Hooke. The
    skin is faceted, under a pressure along the normals of the facets. Tolerance: Newton to 1e-11.
    """
    space = Drawn(turned)
    problem, step = shaft(space, plane)
    solved(problem, step)
    x = (problem.model.space.tabulate_dof_coordinates() - space.move) @ space.q
    u = problem.u.x.array.reshape(-1, 3) @ space.q
    across = -10.0 * (1.0 - 0.3 - 2.0 * 0.09) / 1000.0 + 0.3 * 0.02
    assert np.abs(u - x * (across, across, -0.02)).max() < 1e-10 * 0.03


def quarter(**given: Any) -> Problem:
    """A quarter of a shaft along the diagonal of space."""
    turn = Rotation((-1, 1, 0), angle=math.acos(1.0 / math.sqrt(3.0)))
    shape = make_shape("cylinder", radius=1.0, length=1.5, cells=(16, 2, 3), part="quarter")
    model = build_mesh([Body("shaft", shape, Placement(rotate=turn))])
    cut = CyclicSymmetry("shaft.left", "shaft.front", 4, axis=(1, 1, 1))
    return Problem(model, {"shaft": STEEL}, cyclic=[cut], **given)


@pytest.mark.parametrize(
    ("given", "held", "line"),
    [
        ({}, {"shaft.top": {"x": 0.0}}, "hold all three or none, or take `cylindrical`"),
        (
            {},
            {"shaft.top": {"x": 0.1, "y": 0.0, "z": 0.0}},
            "other prescribed|off the axis",
        ),
        ({"symmetry": ["shaft.left"]}, {}, "nodes on the slave.*whose axis is not its normal"),
    ],
)
def test_what_is_not_the_same_in_every_sector(given: Any, held: Any, line: str):
    """Requirement: refused in one line."""
    with pytest.raises(InputError, match=line):
        Solver(quarter(**given), [Step("hold", 1, held)])


@pytest.mark.parametrize("axis", [(0, 0, 0), (0, 1), (math.inf, 0, 0)])
def test_no_direction_is_one_line(axis: tuple[float, ...]):
    """Requirement: one line that says what is needed."""
    with pytest.raises(InputError, match="a direction of three numbers needed"):
        CyclicSymmetry("a.b", "a.c", 3, axis=axis)


def test_what_a_sector_is_free_to_do():
    """Requirement: held by nothing it is free along and about its axis alone."""
    with pytest.raises(InputError) as refused:
        Solver(quarter(), [Step("load", 1, pressure={"shaft.outer": 1.0})])
    said = str(refused.value).replace("-", "")
    line = "translation along (0.577, 0.577, 0.577), rotation about (0.577, 0.577, 0.577);"
    assert line in said
