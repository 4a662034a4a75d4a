"""Contacts that say twice what meets what, among many: each is looked at once."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.base.errors import InputError
from anisocontact.contact import Contact, given_twice
from anisocontact.contact.given_twice import check_given_once, shared
from anisocontact.interface import ContactLaw
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import BoxSpec, Model, build_box
from anisocontact.surfaces import make_surface

dolfinx_mesh = pytest.importorskip("dolfinx.mesh")

LAW = ContactLaw(NormalLaw(penalty=100), Adhesion(stiffness=100), Friction(coefficients=0.3))
#: Places of small blocks on a strip.
PLACES = range(6)


@pytest.fixture(scope="module")
def strip() -> Model:
    """A strip with blocks on it."""
    boxes = {"strip": BoxSpec((0, 0, 0), (6, 1, 1), (12, 2, 1))}
    return build_box(
        boxes | {f"b{i}": BoxSpec((i + 0.1, 0.1, 1), (0.8, 0.8, 0.5), (1, 1, 1)) for i in PLACES}
    )


def _on_rollers(model: Model, degree: int | None = None) -> list[Contact]:
    """The strip under rollers, each a surface."""
    rollers = [
        make_surface("cylinder", point=(i + 0.5, 0, 3), axis=(0, 1, 0), radius=2) for i in PLACES
    ]
    return [
        Contact(model, "strip.top", one, LAW, name=f"roller {i}", mortar=False, degree=degree)
        for i, one in enumerate(rollers)
    ]


def _refused(contacts: list[Contact]) -> str:
    with pytest.raises(InputError) as refused:
        check_given_once(contacts, "contact")
    return str(refused.value)


def test_the_one_of_many_pairs_that_is_given_twice(strip: Model) -> None:
    """By name, with its facets, also where only the sides are swapped; the others are none."""
    friction = Friction(coefficients=0.3)
    pairs = [Contact(strip, "strip.top", f"b{i}.bottom", friction, name=f"on b{i}") for i in PLACES]
    check_given_once(pairs, "contact")
    again = Contact(strip, "strip.top", "b4.bottom", friction, name="again")
    said = "contact: contact 'again' is given twice: 24 of its facets meet the same master in "
    assert _refused([*pairs, again]) == f"{said}contact 'on b4'"
    swapped = Contact(strip, "b2.bottom", "strip.top", friction, name="swapped")
    said = "1 of its facets are the master of what its master is the slave in, contact 'on b2'"
    assert said in _refused([*pairs, swapped])


def test_surfaces_are_the_same_at_the_slave_points_of_both(strip: Model) -> None:
    """Also where these are others, as the degrees are."""
    rollers, more = _on_rollers(strip), _on_rollers(strip, degree=3)
    check_given_once(rollers, "contact")
    assert "'roller 3' is given twice: 24 of its facets" in _refused([*rollers, more[3]])
    assert [shared(rollers[3], one) for one in more] == [0, 0, 0, 24, 0, 0]


def test_a_part_of_the_slave_that_meets_the_same_surface(strip: Model) -> None:
    """Its facets alone are shared, where the surfaces are the same at all points of both."""
    top = strip.facets("strip.top")
    near = dolfinx_mesh.compute_midpoints(strip.mesh, 2, top)[:, 0] < 1.0
    bodies = {name: strip.cells(name) for name in strip.body_names()}
    model = Model(strip.mesh, bodies, {"strip.top": top, "strip.near": top[near]})
    flat = make_surface("plane", point=(9, 0, 1), normal=(0, 0, -2))
    profile = [(0.1, 0), (2, 0), (3, 1)]  # flat around its middle
    bent = make_surface("revolution", point=(0, 0.5, 1), axis=(0, 0, 1), profile=profile)
    made = [
        Contact(model, group, surface, LAW, mortar=False)
        for group in ("strip.top", "strip.near")
        for surface in (make_surface("plane", point=(0, 0, 1), normal=(0, 0, -1)), flat, bent)
    ]
    met = [[shared(one, two) for two in made] for one in made]
    assert met == [
        [24, 24, 0, 4, 4, 0],
        [24, 24, 0, 4, 4, 0],
        [0, 0, 24, 0, 0, 4],
        [4, 4, 0, 4, 4, 4],
        [4, 4, 0, 4, 4, 4],
        [0, 0, 4, 4, 4, 4],
    ]


def test_closest_points_are_looked_for_once_for_each_contact(
    strip: Model, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Not for each two of them: many surfaces may meet one slave."""
    looked = SimpleNamespace(count=0)
    closest = given_twice._closest

    def counted(*args):
        looked.count += 1
        return closest(*args)

    monkeypatch.setattr(given_twice, "_closest", counted)
    check_given_once(_on_rollers(strip), "contact")
    assert looked.count == len(PLACES)


def test_groups_of_other_meshes_have_no_facets_in_common(strip: Model) -> None:
    """Though they have the same names and numbers."""
    other = build_box({"strip": BoxSpec((0, 0, 0), (6, 1, 1), (12, 2, 1))})
    plane = make_surface("plane", point=(0, 0, 1), normal=(0, 0, -1))
    both = [Contact(model, "strip.top", plane, LAW, mortar=False) for model in (strip, other)]

    assert shared(*both) == 0
