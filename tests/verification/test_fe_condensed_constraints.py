"""Condensed strategy with planes of symmetry, springs, two orders and free rigid bodies."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from tests.verification.test_fe_condensed import ELASTIC, LAWS, MARKS, _same

from anisocontact.contact import Contact
from anisocontact.interface import (
    Interface,
)
from anisocontact.laws import Adhesion, NormalLaw
from anisocontact.mesh import (
    Body,
    BoxSpec,
    Placement,
    Rotation,
    build_box,
    build_mesh,
)
from anisocontact.rigid import MovingSurface, RigidBody
from anisocontact.solver import ElasticSupport, Problem, Spring, Step
from anisocontact.surfaces import make_surface

PLANE = {"point": (0, 0, 0), "normal": (0, 0, 1)}


def _turned(angle: float = 0.0, orders: Sequence[int] = (1,), **held: Any) -> Problem:
    """Blocks beside each other on a plane, turned about its normal."""
    turn = {"rotate": Rotation((0, 0, 1), angle)} if angle else {}
    bodies = [
        Body(
            name,
            BoxSpec((0, 0, 0), (1, 1, 0.5), (3, 3, 2), order=order),
            Placement(move=(x, 0, 0), **turn),
        )
        for name, x, order in zip(("block", "other"), (0.0, 2.0), orders, strict=False)
    ]
    model = build_mesh(bodies)
    interface = Interface(make_surface("plane", **PLANE), *LAWS)
    contacts = [Contact(model, f"{body.name}.bottom", interface, mortar=False) for body in bodies]
    return Problem(model, {body.name: ELASTIC for body in bodies}, contacts, **held)


@pytest.mark.parametrize("angle", [0.0, 0.5], ids=["along the axes", "oblique"])
def test_symmetry_planes(angle: float) -> None:
    """Half a block whose cut also carries the edge of the contact; the plane is slid along."""
    slide = {"x": -0.02 * np.sin(angle), "y": 0.02 * np.cos(angle)}
    steps = [
        Step("press", 2, {"block.top": {"z": -0.01}}, {"block.top": slide}),
        Step("more", 2, {"block.top": {"z": -0.015}}, {"block.back": {"z": 3.0}}),
    ]
    _same(lambda: _turned(angle, symmetry=["block.left", "block.front"]), steps)


def test_elastic_supports_and_springs() -> None:
    """A block on a bed, led by the moving end of a spring, and tied to another one by a spring."""

    def make() -> Problem:
        attached = [
            ElasticSupport("block.top", 300.0, 100.0),
            Spring("pull", "block.right", (50.0, 20.0, 0.0)),
            Spring("link", "block.left", (0.0, 30.0, 10.0), "other.right"),
        ]
        return _turned(orders=(1, 1), attached=attached)

    held = {"other.top": {"x": 0.0, "y": 0.0, "z": -0.005}}
    steps = [
        Step("press", 2, held, {"block.top": {"z": -5.0}}),
        Step("pull", 3, anchor={"pull": {"x": 0.2}}),
    ]
    _same(make, steps)


@pytest.mark.parametrize("symmetry", [[], ["block.left"]])
def test_bodies_of_two_orders(symmetry: list[str]) -> None:
    """The middle nodes of the body of order 1 are tied to its corners."""
    down = {"x": 0.0, "y": 0.0, "z": -0.01}
    if symmetry:
        down.pop("x")
    steps = [Step("press", 2, {"block.top": down, "other.top": {**down, "x": 0.01}})]
    _same(lambda: _turned(orders=(1, 2), symmetry=symmetry), steps)


@pytest.mark.parametrize("symmetry", [[], ["block.left"]])
def test_free_rigid_body(symmetry: list[str]) -> None:
    """A ball under force and moment, some of its components prescribed, held and freed again.

    A plane of symmetry hands forces of the mesh on, those of the ball are none of its matter.
    """

    def make() -> Problem:
        model = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 0.5), (4, 4, 2))})
        surface = make_surface("sphere", centre=(0.5, 0.5, -1.0), radius=1.0)
        springs = {"x": 20.0, "y": 30.0, "z": 10.0, "rx": 4.0, "ry": 5.0, "rz": 6.0}
        ball = RigidBody("ball", (0.4, 0.7, -0.9), free=True, springs=springs)
        adhesion = Adhesion(stiffness=(4e3, 1e3), directions=MARKS)
        interface = Interface(surface, NormalLaw(penalty=1e4), adhesion, LAWS[2])
        contact = Contact(model, "block.bottom", MovingSurface(interface, ball), mortar=False)
        return Problem(model, {"block": ELASTIC}, [contact], symmetry=symmetry)

    along = "y" if symmetry else "x"
    clamp = {"block.top": dict.fromkeys("yz" if symmetry else "xyz", 0.0)}
    components = ("x", "y", "z", "rx", "ry", "rz")
    load = {"x": 0.3, "y": -0.2, "z": 6.0, "rx": 0.3, "ry": -0.2, "rz": 0.25}
    steps = [
        Step("touch", 1, clamp, motion={"ball": {"z": 0.005}}),
        Step("load", 4, motion={"ball": dict.fromkeys(components)}, load={"ball": load}),
        Step("hold", 2, {"block.top": {along: 0.01}}, motion={"ball": {"x": 0.0, "rz": 0.01}}),
    ]
    _same(make, steps)
