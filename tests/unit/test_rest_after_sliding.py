"""How far a body that friction cannot hold slides until shapes or loads hold it."""

from __future__ import annotations

import numpy as np
import pytest

from anisocontact.contact import Contact
from anisocontact.interface import ContactLaw
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import Body, build_mesh, make_shape
from anisocontact.solver.stepping.rest_after_sliding import FAR, SlidingMotion
from anisocontact.surfaces import make_surface

RADIUS, WEIGHT, SIZE = 5.0, 10.0, 0.5
ALONG = np.array([1.0, 0.0, 0.0, 0.0, 0.0, 0.0])
#: About the axis of the bore, which is RADIUS above, with a unit velocity below it.
ROUND = np.array([1.0, 0.0, 0.0, 0.0, -SIZE / RADIUS, 0.0])


def _sliding(name: str, motion: np.ndarray) -> SlidingMotion:
    """A plate pressed on a surface by its weight, which works in the origin of the turn."""
    plate = make_shape("box", origin=(-0.01, -0.5, 0), size=(0.02, 1, 0.1), cells=(1, 1, 1))
    model = build_mesh([Body("plate", plate)])
    high = -RADIUS if name == "drum" else RADIUS
    surface = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    if name != "plane":
        options = {"radius": RADIUS, "inside": name == "bore"}
        surface = make_surface("cylinder", point=(0, 0, high), axis=(0, 1, 0), **options)
    law = ContactLaw(NormalLaw(penalty=1e5), Adhesion(stiffness=1e5), Friction(coefficients=0.3))
    contact = Contact(model, "plate.bottom", surface, law)
    down = np.zeros_like(model.space.tabulate_dof_coordinates())
    down[:, 2] = -WEIGHT / (1e5 * 0.02)
    contact.update(down, 1.0)
    contact.commit()
    loads = np.zeros((3, 4))
    loads[:, 3] = 3.0, 0.0, -WEIGHT
    return SlidingMotion(motion, np.zeros(3), SIZE, loads, [contact], 1.0)


@pytest.mark.parametrize(
    ("name", "motion", "stiffness"),
    [
        ("bore", ALONG, WEIGHT / RADIUS),
        ("bore", ROUND, WEIGHT / RADIUS),
        ("plane", ALONG, 0.0),
        ("drum", ALONG, -WEIGHT / RADIUS),
    ],
)
def test_what_holds_a_body_back_as_it_slides(
    name: str, motion: np.ndarray, stiffness: float
) -> None:
    """A plate slides at the bottom of a bore, on a plane, and on top of a drum, by a unit velocity.

    Requirement and source: a weight on a slope that rises by x / R pulls back with W x / R, whether
    the motion follows the bore or its tangent; a plane and a drum hold nothing back. Tolerance:
    1 %, as points are moved by 1/40 of the radius and lie beside the middle by 1/500 of it.
    """
    slide = _sliding(name, motion)
    way = FAR * SIZE / np.linalg.norm(motion)
    found = [slide.rests(share * abs(stiffness) * way + 1e-9) for share in (0.99, 1.01)]
    assert found == [stiffness > 0.0, False]


def test_a_dent_holds_nothing_back() -> None:
    """A block pressed into another one by 5 % of its height, which then lies in a dent.

    Requirement: the dent moves with the block, so that it does not rest further on, however little
    friction lacks. Source: the same block further along has the same dent.
    """
    below = make_shape("box", origin=(-2, -0.5, -1), size=(4, 1, 1), cells=(8, 1, 2))
    block = make_shape("box", origin=(-0.5, -0.5, 0), size=(1, 1, 1), cells=(2, 1, 1))
    model = build_mesh([Body("base", below), Body("block", block)])
    law = ContactLaw(NormalLaw(penalty=1e3), Adhesion(stiffness=1e3), Friction(coefficients=0.3))
    contact = Contact(model, "block.bottom", "base.top", law)
    x, down = model.space.tabulate_dof_coordinates(), np.zeros((len(model.positions), 3))
    down[(x[:, 2] >= 0.0) & (np.abs(x[:, 0]) <= 0.5), 2] = -0.05
    down[model.facet_nodes("block.bottom"), 2] -= 1e-2
    contact.update(down, 1.0)
    contact.commit()
    assert contact.last.pressure.max() > 0.0
    loads = np.zeros((3, 4))
    loads[:, 3] = 3.0, 0.0, -WEIGHT
    assert not SlidingMotion(ALONG, np.zeros(3), SIZE, loads, [contact], 1.0).rests(1e-9)
