"""Slave nodes on rigid surfaces: bars, poles, nodes that cannot move."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from tests.verification.test_mortar import CELLS, PENALTY, YOUNG, _law

from anisocontact.anisotropy import make_directions
from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.interface import ContactLaw
from anisocontact.interface.augmentation import Augmentation
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import BoxSpec, build_box
from anisocontact.solver import Problem, Solver, Step
from anisocontact.surfaces import Surface, make_surface

DOWN = {"x": 0.0, "y": 0.0, "z": -0.06}


def _on_rigid(master: Any, augmented: bool, top: dict[str, float], **held: Any) -> Contact:
    """A block on a surface, its top led."""
    model = build_box({"block": BoxSpec((-0.5, -0.5, 0), (1, 1, 0.5), (4, 4, 2))})
    augmentation = Augmentation() if augmented else None
    contact = Contact(model, "block.bottom", master, _law(), mortar=True, augmentation=augmentation)
    problem = Problem(model, {"block": make_material("linear-elastic", E=YOUNG, nu=0.3)}, [contact])
    for _ in Solver(problem, [Step("press", 2, {"block.top": top, **held})]).run():
        pass
    return contact


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("cell", CELLS)
def test_on_a_plane(cell: str, order: int) -> None:
    """Every kind of facet pressed on a rigid plane and left to spread: p = E strain, 1e-5.

    Source: a bar under uniform compression but for a friction of 1e-6; the tangent has a place for
    every block.
    """
    model = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 1), (2, 2, 1), cell=cell, order=order)})
    plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    law = ContactLaw(
        NormalLaw(penalty=PENALTY), Adhesion(stiffness=(1e-3, 1e-3)), Friction(coefficients=1e-6)
    )
    augmentation = Augmentation(tangential=False)
    contact = Contact(
        model,
        "block.bottom",
        plane,
        law,
        mortar=True,
        current_area=False,
        augmentation=augmentation,
    )
    problem = Problem(model, {"block": make_material("linear-elastic", E=YOUNG, nu=0.3)}, [contact])
    held = {"block.left": {"x": 0.0}, "block.front": {"y": 0.0}, "block.top": {"z": -0.01}}
    for _ in Solver(problem, [Step("press", 1, held)], options={"snes_rtol": 1e-10}).run():
        pass
    np.testing.assert_allclose(contact.last.pressure, 0.01 * YOUNG, rtol=1e-5)


def test_a_node_below_a_pole() -> None:
    """A sphere whose pole is on a node presses like one with its pole elsewhere, 1e-9.

    Source: coordinates of the sphere do not matter; at a pole there are none.
    """
    down = {"x": 0.0, "y": 0.0, "z": -0.01}
    forces = []
    for axis in ((0, 0, 1), (1, 0, 0)):
        ball = make_surface("sphere", centre=(0, 0, -2.0), radius=2.0, axis=axis, start=(0, 1, 0))
        forces.append(_on_rigid(ball, False, down).resultant()[0])
    assert forces[0][2] > 1.0
    np.testing.assert_allclose(forces[0], forces[1], atol=1e-9 * forces[0][2])


def _ellipsoid(pole_below: bool) -> Surface:
    """With its pole on the middle of the block, or at its side."""
    more: dict[str, Any] = (
        {"semi_axes": (6, 5, 4), "axis": (0, 0, 1), "start": (1, 0.4, 0)}
        if pole_below
        else {"semi_axes": (4, 6, 5), "axis": (0.4, -1, 0), "start": (0, 0, 1)}
    )
    return make_surface("ellipsoid", centre=(0, 0, -4), **more)


def _dome(pole_below: bool) -> Surface:
    """A ball as an arc turned about the vertical, far above its point, or the sphere."""
    if not pole_below:
        return make_surface("sphere", centre=(0, 0, -4), radius=4, axis=(1, 0, 0))
    arc: dict[str, Any] = {"profile": [(4, 96), (0, 100)], "arcs": [np.pi / 2]}
    return make_surface("revolution", point=(0, 0, -100), axis=(0, 0, 1), **arc)


def _spline_dome(pole_below: bool) -> Surface:
    """The same arc as a spline from the axis on, or the sphere."""
    if not pole_below:
        return _dome(False)
    angle = np.linspace(0.0, 0.3, 20)
    points = np.stack([4.0 * np.sin(angle), 4.0 * np.cos(angle) - 4.0], axis=1)
    turned: dict[str, Any] = {"profile": points, "spline": True, "inside": True}
    return make_surface("revolution", point=(0, 0, 0), axis=(0, 0, 1), **turned)


@pytest.mark.parametrize("tool", [_ellipsoid, _dome, _spline_dome])
def test_a_node_that_sticks_below_a_pole(tool: Callable[[bool], Surface]) -> None:
    """A surface with its pole on a node that sticks presses like one with it elsewhere.

    Requirement: the same force to 1e-7, ten times what Newton's method leaves of it, in four
    increments of at most 15 corrections. The place of contact went around the pole at 1e-8 of the
    size, so that no increment converged: the adhesion felt a slip of that size.
    Source: coordinates of the surface do not matter.
    """
    model = build_box({"block": BoxSpec((-0.5, -0.5, 0), (1, 1, 0.5), (4, 4, 1))})
    along = make_directions("constant", vector=(1.0, 0.3, 0.0))
    law = ContactLaw(
        NormalLaw(penalty=4e4),
        Adhesion(stiffness=(2e4, 4e3), directions=along),
        Friction(coefficients=0.2),
    )
    forces = []
    for pole_below in (True, False):
        master = tool(pole_below)
        augmentation = Augmentation(tangential=False)
        contact = Contact(
            model, "block.bottom", master, law, mortar=True, augmentation=augmentation
        )
        bodies = {"block": make_material("linear-elastic", E=YOUNG, nu=0.3)}
        solver = Solver(Problem(model, bodies, [contact]), [Step("press", 4, {"block.top": DOWN})])
        assert max(part.iterations for part in solver.run()) <= 15
        forces.append(contact.resultant()[0])
    np.testing.assert_allclose(forces[0], forces[1], atol=1e-7 * forces[0][2])


def test_a_support_that_overlaps() -> None:
    """Nodes that a support holds below the surface keep their penalty; the others come to no gap.

    Source: no multiplier can move them; with one the increment would have no solution.
    """
    plane = make_surface("plane", point=(0, 0, 0.001), normal=(0, 0, 1))
    still = {"x": 0.0, "y": 0.0, "z": 0.0}
    contact = _on_rigid(plane, True, {"z": 0.0}, **{"block.left": still})
    held = contact.points[:, 0] < -0.5 + 1e-9
    np.testing.assert_allclose(contact.state["gap"][held], -0.001, rtol=1e-6)
    assert np.abs(contact.state["gap"][~held]).max() < 1e-6 / 4.0
