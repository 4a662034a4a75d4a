"""Radius of what touches, where it is round, and the facets between slave nodes."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.base.fenicsx import MPI
from anisocontact.contact import Contact
from anisocontact.interface import ContactLaw
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import BoxSpec, build_box
from anisocontact.mesh.idealisation import make_idealisation
from anisocontact.results.paraview import slave_points
from anisocontact.results.round_area import FEWEST, SymmetryImages, round_radius
from anisocontact.surfaces import make_surface

WHOLE = SimpleNamespace(
    share=1.0,
    fewest=FEWEST,
    maps=[(np.eye(3), np.zeros(3))],
    of=lambda x: x,
    of_vectors=lambda v: v,
)


def radius_of(inside, count=21, normal=(0.0, 0.0, 1.0)):
    """That of the points of a lattice of `count` a side, two wide, for which this holds."""
    line = np.linspace(-1.0, 1.0, count)
    x, y = (one.reshape(-1) for one in np.meshgrid(line, line))
    there = inside(x, y)
    area = (line[1] - line[0]) ** 2
    contact = SimpleNamespace(
        space=SimpleNamespace(mesh=SimpleNamespace(comm=MPI.COMM_SELF)),
        points=np.column_stack([x, y, 0.0 * x]),
        last=SimpleNamespace(normal=np.tile(np.array(normal), (len(x), 1))),
        touching=lambda: area * there,
        counted=lambda: np.ones(len(x), dtype=bool),
    )
    return round_radius(contact, WHOLE)


@pytest.mark.parametrize("radius", [0.4, 0.63, 0.9])
def test_a_disc_is_round(radius):
    found = radius_of(lambda x, y: np.hypot(x - 0.03, y) < radius)
    assert found == pytest.approx(radius, rel=0.03)


@pytest.mark.parametrize(
    "inside",
    [
        lambda x, y: np.maximum(abs(x), abs(y)) < 0.71,
        lambda x, y: np.hypot(x, 1.3 * y) < 0.9,
        lambda x, y: (np.hypot(x, y) < 0.9) & (np.hypot(x, y) > 0.5),
        lambda x, y: np.hypot(x - 1.0, y) < 0.9,
        lambda x, y: np.hypot(x, y) < 0.08,
        lambda x, y: x > 2.0,
    ],
    ids=["square", "ellipse", "ring", "half", "a point", "nothing"],
)
def test_others_are_not(inside):
    assert np.isnan(radius_of(inside))


@pytest.mark.parametrize("rings", [3, 6, 9, 20])
def test_a_disc_of_revolution_is_known_from_eight_facets_on(rings):
    """A point of a section is a ring: with few of them half a ring is more than 6 % of the radius.

    The disc ends in the middle between two nodes, so that the area of its rings is exact: the
    radius is met to rounding.
    """
    width = 0.1
    at = width * np.arange(rings)
    inner, outer = np.maximum(at - 0.5 * width, 0.0), at + 0.5 * width
    areas = np.pi * (outer**2 - inner**2)
    contact = SimpleNamespace(
        space=SimpleNamespace(mesh=SimpleNamespace(comm=MPI.COMM_SELF)),
        points=np.column_stack([at, 0.0 * at, 0.0 * at]),
        last=SimpleNamespace(normal=np.tile([0.0, 1.0, 0.0], (rings, 1))),
        touching=lambda: areas,
        counted=lambda: np.ones(rings, dtype=bool),
    )
    model = SimpleNamespace(idealisation=make_idealisation("axisymmetric"))
    found = round_radius(contact, SymmetryImages(SimpleNamespace(model=model), contact))
    assert np.isnan(found) if rings < 8 else found == pytest.approx(outer[-1], rel=1e-12)


@pytest.mark.parametrize("cell", ["tetrahedron", "hexahedron"])
@pytest.mark.parametrize("order", [1, 2])
def test_facets_between_slave_nodes_cover_the_slave(cell, order):
    """Their area and outward direction are those of the facets; loose points have none."""
    box = BoxSpec((0, 0, 0), (2, 1, 1), (2, 2, 1), order=order, cell=cell)
    model = build_box({"block": box})
    plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    friction = Friction(coefficients=(0.3, 0.3))
    law = ContactLaw(NormalLaw(penalty=1.0), Adhesion(stiffness=(1.0, 1.0)), friction)
    loose = Contact(model, "block.bottom", plane, law, name="loose", mortar=False)
    drawn = slave_points([loose, Contact(model, "block.bottom", plane, law, mortar=True)])
    cells = drawn.cells["Polys"]
    assert len(drawn.cells["Verts"]["connectivity"]) == len(loose.areas)
    corners = drawn.points[cells["connectivity"].reshape(-1, int(cells["offsets"][1]))]
    first, second = corners[:, 1:-1] - corners[:, :1], corners[:, 2:] - corners[:, :1]
    areas = 0.5 * np.cross(first, second).sum(axis=1)
    assert np.all(areas[:, 2] < 0.0)
    assert areas.sum(axis=0) == pytest.approx([0.0, 0.0, -2.0])
    assert drawn.points[cells["connectivity"], 2] == pytest.approx(0.0)
    assert set(drawn.point_data["contact"][cells["connectivity"]].tolist()) == {1}
