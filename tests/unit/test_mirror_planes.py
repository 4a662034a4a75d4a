"""Directions of a contact in planes of symmetry, which mirror them."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.anisotropy import make_directions
from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.laws import Friction
from anisocontact.mesh import Body, BoxSpec, PlaneStrain, build_box, build_mesh, make_shape
from anisocontact.solver import Problem, Step
from anisocontact.surfaces import make_surface

MU = (0.3, 0.1)
X, Z = (1, 0, 0), ((0, 0, 0), (0, 0, 1))
PLANE = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
BOXES = {
    "block": BoxSpec((0, 0, 0), (1, 1, 0.5), (3, 3, 1)),
    "base": BoxSpec((0, 0, -0.5), (1, 1, 0.5), (2, 2, 1)),
}


def _told(model, slave, master, planes, kind, mu=MU, **field):
    """What is said of the directions of a contact before the run."""
    law = Friction(coefficients=mu, directions=make_directions(kind, **field))
    contact = Contact(model, slave, master, law)
    steel = make_material("linear-elastic", E=10.0, nu=0.3)
    problem = Problem(model, dict.fromkeys(model.body_names(), steel), [contact], symmetry=planes)
    held = {f"{body}.top": {"x": 0.0, "y": 0.0, "z": 0.0} for body in model.body_names()}
    return [line for line in problem.check([Step("hold", 1, held)]) if "symmetry plane" in line]


@pytest.mark.parametrize("meshed", [False, True])
@pytest.mark.parametrize(
    ("kind", "mu", "field", "told"),
    [
        ("constant", MU, {"vector": X}, 0),
        ("constant", MU, {"vector": X, "angle": np.pi / 2}, 0),
        ("constant", MU, {"vector": X, "angle": 0.5}, 1),
        ("constant", (0.3, 0.3), {"vector": X, "angle": 0.5}, 0),
        ("polar", MU, {"axis": Z}, 0),
        ("polar", MU, {"axis": ((0, 0.5, 0), (0, 0, 1)), "angle": 0.5}, 1),
        ("polar", MU, {"axis": ((0.2, 0.5, 0), (0, 0, 1))}, 1),
        ("from-vectors", MU, {"first": (1, 1, 0), "second": (1, -1, 0)}, 1),
    ],
)
def test_marks_of_the_other_hand_are_told(kind, mu, field, told, meshed):
    """A block and a base of which the plane x = 0 is said to leave a half out.

    Requirement: told where friction is not its own mirror image there, and nowhere else: not along
    and across the plane, nor where both coefficients are one, nor at a node on the axis of a field.
    Source: the mirror image of marks at an angle has the other angle, and pushes the other way, so
    that halves of a press fit with helical marks cannot stand for the whole, which twists.
    """
    model = build_box(BOXES if meshed else {"block": BOXES["block"]})
    planes = [f"{body}.left" for body in model.body_names()]
    master = "base.top" if meshed else PLANE
    lines = _told(model, "block.bottom", master, planes, kind, mu, **field)
    assert len(lines) == told
    assert all("with the normal (-1, 0, 0), tractions differ by" in line for line in lines)


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize(
    ("kind", "field", "told"),
    [
        ("spiral", {"axis": Z, "pitch": 2.0}, 2),
        ("spiral", {"axis": Z, "pitch": 0.01}, 0),
        ("coordinate-lines", {}, 0),
        ("coordinate-lines", {"angle": 0.4}, 2),
    ],
)
def test_the_hand_of_a_thread_is_told(kind, field, told, order):
    """A quarter of a hub on a shaft whose marks are rings, a fine thread, a coarse one.

    Requirement: both cut planes of the coarse one are told. Facets that end there have a normal a
    little off the plane, which is no difference of directions.
    """
    hub = make_shape(
        "ring",
        inner=1.0,
        outer=2.0,
        length=1.0,
        cells=(1, 4, 2),
        start=0.0,
        end=np.pi / 2,
        order=order,
    )
    model = build_mesh([Body("hub", hub)])
    shaft = make_surface("cylinder", point=(0, 0, 0), axis=(0, 0, 1), radius=1.0)
    lines = _told(model, "hub.inner", shaft, ["hub.start", "hub.end"], kind, **field)
    assert len(lines) == told


@pytest.mark.parametrize("lateral", [False, True])
def test_without_displacements_across_a_plane_mesh_no_half_is_wrong(lateral):
    """Requirement: told only where the other half could move the other way out of the plane."""
    shape = make_shape("rectangle", origin=(0, 0), size=(1, 1), cells=(3, 2))
    model = build_mesh([Body("block", shape)], idealisation=PlaneStrain(lateral=lateral))
    floor = make_surface("plane", point=(0, 0, 0), normal=(0, 1, 0))
    marks = {"vector": X, "angle": 0.5}
    lines = _told(model, "block.bottom", floor, ["block.left"], "constant", **marks)
    assert len(lines) == lateral
