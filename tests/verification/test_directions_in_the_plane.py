"""Directions between facets of a plane mesh that differ in the planes it stands for are told."""

from __future__ import annotations

from typing import Any

import pytest

from anisocontact.anisotropy import DirectionField, make_directions
from anisocontact.contact import Contact
from anisocontact.contact.field_hints import doubtful_fields
from anisocontact.interface import ContactLaw
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import Axisymmetric, Body, Idealisation, PlaneStrain, build_mesh, make_shape


def _pair(ideal: Idealisation) -> Any:
    """A ring or bar on another one."""
    upper = make_shape("rectangle", origin=(0.5, 0), size=(1, 1), cells=(4, 2))
    lower = make_shape("rectangle", origin=(0.25, -1), size=(2, 1), cells=(7, 2))
    return build_mesh([Body("b", upper), Body("a", lower)], idealisation=ideal)


def _law(field: DirectionField, coefficients: tuple[float, float]) -> ContactLaw:
    friction = Friction(coefficients=coefficients, directions=field)
    return ContactLaw(NormalLaw(penalty=1e4), Adhesion(stiffness=(1e4, 1e4)), friction)


@pytest.mark.parametrize(
    ("ideal", "kind", "where", "told"),
    [
        (PlaneStrain(lateral=True), "polar", {"axis": ((0, 0, 0), (0, 1, 0))}, "the same along z"),
        (PlaneStrain(lateral=True), "constant", {"vector": (1, 0, 0), "angle": 0.5}, ""),
        (Axisymmetric(), "constant", {"vector": (1, 0, 0)}, "the same of revolution"),
        (Axisymmetric(), "polar", {"axis": ((0, 0, 0), (0, 1, 0)), "angle": 0.5}, ""),
    ],
)
@pytest.mark.parametrize("mortar", [False, True])
def test_directions_that_differ_between_planes_are_told(ideal, kind, where, told, mortar):
    """Requirement: one line, as of a surface. Isotropic friction has no directions, and no line.

    Source: what a plane mesh stands for: the same in every plane along z, or around the axis.
    """
    model, field = _pair(ideal), make_directions(kind, **where)
    for coefficients, said in (((0.3, 0.1), told), ((0.3, 0.3), "")):
        law = _law(field, coefficients)
        found = doubtful_fields([Contact(model, "b.bottom", "a.top", law, mortar=mortar)])
        assert [said in line for line in found] == ([True] if said else [])


def test_directions_at_points_are_those_of_the_plane():
    """Requirement: what is given in the plane that is drawn is taken as it is there."""
    model, points = _pair(Axisymmetric()), (0.5, 0, 0, 1.5, 0, 0, 1, 1, 0)
    given = {"vectors": (1, 0, 0.5) * 3, "interpolation": "nearest"}
    field = make_directions("tabulated-points", points=points, **given)
    contact = Contact(model, "b.bottom", "a.top", _law(field, (0.3, 0.1)), mortar=False)
    assert doubtful_fields([contact]) == []
