"""`Model.of` a user's own space: what does not fit is one line, and facets count once."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

import basix.ufl

from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import MPI, fem
from anisocontact.contact import Contact
from anisocontact.contact.given_twice import shared
from anisocontact.interface import ContactLaw, Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import BoxSpec, Model, build_box
from anisocontact.rigid import MovingSurface, RigidBody
from anisocontact.solver import ContactProblem
from anisocontact.surfaces import make_surface

dolfinx_mesh = pytest.importorskip("dolfinx.mesh")


def _box(kind: str = "hexahedron"):
    cell = getattr(dolfinx_mesh.CellType, kind)
    return dolfinx_mesh.create_box(MPI.COMM_WORLD, [[0, 0, 0], [1, 1, 1]], [2, 2, 2], cell)


def _space(mesh, element=("Lagrange", 1, (3,))):
    return fem.functionspace(mesh, element)


@pytest.fixture(scope="module")
def given():
    mesh = _box()
    bottom = dolfinx_mesh.locate_entities_boundary(mesh, 2, lambda x: np.isclose(x[2], 0.0))
    values = np.full(len(bottom), 3, dtype=np.int32)
    tags = dolfinx_mesh.meshtags(mesh, 2, bottom, values)
    cells = dolfinx_mesh.meshtags(mesh, 3, np.arange(4, dtype=np.int32), values)
    return SimpleNamespace(mesh=mesh, bottom=bottom, tags=tags, cells=cells, space=_space(mesh))


def _interface(height: float = 0.0, normal: float = 1.0) -> Interface:
    plane = make_surface("plane", point=(0, 0, height), normal=(0, 0, normal))
    laws = NormalLaw(penalty=1e3), Adhesion(stiffness=1e3), Friction(coefficients=0.3)
    return Interface(plane, *laws)


SPACES = {
    "mixed": (
        lambda m: _space(
            m,
            basix.ufl.mixed_element(
                [
                    basix.ufl.element("Lagrange", "hexahedron", 2, shape=(3,)),
                    basix.ufl.element("Lagrange", "hexahedron", 1),
                ]
            ),
        ),
        "space: a mixed element given",
    ),
    "prisms": (lambda m: _space(_box("prism")), "space: a mesh of prism cells given"),
    "scalars": (lambda m: _space(m, ("Lagrange", 1)), "with 1 components given"),
    "order 3": (lambda m: _space(m, ("Lagrange", 3, (3,))), "a space of degree 3"),
    "broken": (lambda m: _space(m, ("DG", 1, (3,))), "an element that is discontinuous given"),
    "a mesh": (lambda m: m, "space: Mesh given, a function space"),
}


@pytest.mark.parametrize(("make", "says"), SPACES.values(), ids=list(SPACES))
def test_a_space_that_does_not_fit_is_one_line(given, make, says):
    with pytest.raises(InputError, match=says):
        Model.of(make(given.mesh), {"pad.sole": given.bottom})


FACETS = {
    "tags": (lambda g: {"pad.sole": g.tags}, r"pad\.sole: MeshTags of facets .*find\(value\)"),
    "cells": (lambda g: {"pad.sole": g.cells}, "MeshTags of entities of dimension 3 given"),
    "no names": (lambda g: g.bottom, r'facets: ndarray given, {"body.group": facets} needed'),
    "no body": (lambda g: {"sole": g.bottom}, """'sole' given, "body.group" needed"""),
    "numbers of points": (lambda g: {"pad.sole": g.bottom / 2}, "axes of float64 given"),
    "a mask": (lambda g: {"pad.sole": g.bottom > 0}, "axes of bool given"),
    "a word": (lambda g: {"pad.sole": "bottom"}, "a list of facet numbers needed"),
}


@pytest.mark.parametrize(("make", "says"), FACETS.values(), ids=list(FACETS))
def test_facets_that_are_none_are_one_line(given, make, says):
    with pytest.raises(InputError, match=says):
        Model.of(given.space, make(given))


def test_facets_inside_the_body_are_no_slave(given):
    """All facets of the mesh: 12 of 36 have a cell on either side."""
    model = Model.of(given.space, {"pad.all": np.arange(36)})
    with pytest.raises(InputError, match=r"slave: 12 of 36 facets of 'pad\.all' have a cell on"):
        Contact(model, "pad.all", _interface(), mortar=False)


def test_a_facet_named_twice_counts_once(given):
    model = Model.of(given.space, {"pad.sole": np.repeat(given.bottom, 2)})
    contact = Contact(model, "pad.sole", _interface(), mortar=False)
    assert contact.areas.sum() == pytest.approx(1.0, rel=1e-14)


def test_a_surface_that_points_the_wrong_way_is_refused_in_a_script(given):
    model = Model.of(given.space, {"pad.sole": given.bottom})
    with pytest.raises(InputError, match=r"'pad\.sole' faces the same way as its master"):
        Contact(model, "pad.sole", _interface(normal=-1.0), mortar=False)


@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize("told", [None, False, True])
def test_the_area_is_that_of_the_strain_of_the_form(given, finite, told):
    """Of now where the tangent depends on the displacement; what is told stays."""
    import ufl

    u = fem.Function(given.space)
    v = ufl.TestFunction(given.space)
    strain = ufl.grad(u) + ufl.grad(u).T
    if finite:
        strain = strain + ufl.grad(u).T * ufl.grad(u)
    model = Model.of(given.space, {"pad.sole": given.bottom})
    contact = Contact(model, "pad.sole", _interface(), current_area=told, mortar=False)
    form = ufl.inner(strain, ufl.grad(v)) * ufl.dx
    ContactProblem(form, u, contacts=[contact]).close()
    assert contact.current_area == (finite if told is None else told)


@pytest.mark.parametrize("meshed", [False, True])
def test_a_body_that_nothing_holds_is_one_line(meshed):
    """A pad above its master, pushed by a load alone: its motions, not a residual of inf.

    Its master, another part of the same mesh, is held.
    """
    import ufl

    from anisocontact.contact import Contact
    from anisocontact.interface import ContactLaw
    from anisocontact.mesh import BoxSpec, build_box

    boxes = {"pad": BoxSpec((0, 0, 0.2), (1, 1, 1), (1, 1, 1))}
    if meshed:
        boxes["base"] = BoxSpec((0, 0, -1), (1, 1, 1), (1, 1, 1))
    model = build_box(boxes)
    laws = NormalLaw(penalty=1e3), Adhesion(stiffness=1e3), Friction(coefficients=0.3)
    contact = (
        Contact(model, "pad.bottom", "base.top", law=ContactLaw(*laws), mortar=False)
        if meshed
        else Contact(model, "pad.bottom", _interface(), mortar=False)
    )
    u = fem.Function(model.space)
    v = ufl.TestFunction(model.space)
    form = ufl.inner(ufl.sym(ufl.grad(u)), ufl.sym(ufl.grad(v))) * ufl.dx - v[2] * ufl.ds
    z = model.space.tabulate_dof_coordinates()[:, 2]
    base = np.flatnonzero(z < 0.1).astype(np.int32)
    bcs = [fem.dirichletbc(np.zeros(3), base, model.space)]
    problem = ContactProblem(form, u, bcs=bcs, contacts=[contact])
    said = r"nothing holds the body around \(0\.5, 0\.5, 0\.7\): translation along x, y and z, rot"
    with pytest.raises(InputError, match=said):
        problem.solve()
    problem.close()


def test_a_weak_spring_of_the_form_holds_a_body(given):
    """A bed of 1e-8 of the stiffness is one: nothing is said, and the sums of forces are right."""
    import ufl

    u = fem.Function(given.space)
    v = ufl.TestFunction(given.space)
    bed = 1e-8 * ufl.inner(u, v) * ufl.dx
    strain = ufl.inner(ufl.sym(ufl.grad(u)), ufl.sym(ufl.grad(v))) * ufl.dx
    problem = ContactProblem(strain + bed - 1e-9 * v[2] * ufl.dx, u)
    problem.solve()
    assert u.x.array.reshape(-1, 3)[:, 2] == pytest.approx(0.1, rel=1e-5)
    problem.close()


def test_a_mixed_problem_has_its_contact_on_its_own_displacement(given):
    """A contact on another mixed space, and none at all that says where the displacement is."""
    import ufl

    spaces = [SPACES["mixed"][0](given.mesh) for _ in range(2)]
    w, test = fem.Function(spaces[0]), ufl.TestFunction(spaces[0])
    form = ufl.inner(w, test) * ufl.dx
    model = Model.of(spaces[1].sub(0), {"pad.sole": given.bottom})
    contact = Contact(model, "pad.sole", _interface(), mortar=False)
    with pytest.raises(
        InputError, match=r"contacts: contact .pad\.sole. is defined on another space"
    ):
        ContactProblem(form, w, contacts=[contact])
    with pytest.raises(InputError, match=r"space: a mixed element given, .*name its displacement"):
        ContactProblem(form, w)
    with pytest.raises(InputError, match="with 1 components given"):
        Model.of(spaces[0].sub(1), {"pad.sole": given.bottom})


def test_a_contact_that_is_given_twice_is_one_line(given):
    """It would push and rub twice: two contacts have another slave or another master."""
    import ufl

    u, v = fem.Function(given.space), ufl.TestFunction(given.space)
    form = ufl.inner(ufl.grad(u), ufl.grad(v)) * ufl.dx
    model, low = Model.of(given.space, {"pad.sole": given.bottom}), _interface(-0.1)
    plates = low, _interface(-0.1), _interface()
    one, again, other = (Contact(model, "pad.sole", plate) for plate in plates)
    ContactProblem(form, u, contacts=[one, other])
    said = (
        r"^contacts: contact 'pad\.sole' is given twice: 4 of its facets meet the same master in "
        r"contact 'pad\.sole'$"
    )
    for contacts in ([one, again], [one, other, again]):
        with pytest.raises(InputError, match=said):
            ContactProblem(form, u, contacts=contacts)


def test_contacts_are_the_same_by_their_facets_and_their_master():
    """Not by their laws: other slave facets on one surface, and another master, are others."""
    upper = BoxSpec((0, 0, 0), (1, 1, 1), (2, 1, 1))
    lower = BoxSpec((-1, -1, -1), (3, 3, 1), (2, 2, 1))
    model, plate = build_box({"block": upper, "base": lower}), _interface(-1.0)
    model = _with_half(model)
    friction = Friction(coefficients=0.3)
    laws = [ContactLaw(plate.normal, Adhesion(stiffness=k), friction) for k in (1, 2)]
    on_plate = Contact(model, "block.bottom", plate)
    assert shared(on_plate, Contact(model, "base.bottom", plate)) == 0
    assert shared(on_plate, Contact(model, "block.half", plate)) == 1
    ball = make_surface("sphere", centre=(0.5, 0.5, -9), radius=8)
    others = [make_surface("plane", point=(3, 1, -1), normal=(0, 0, 2)), _interface(-1.1).surface]
    met = [Contact(model, "block.bottom", one, laws[0]) for one in (*others, ball)]
    assert [shared(on_plate, one) for one in met] == [2, 0, 0]
    carried = MovingSurface(plate, RigidBody("plate", (0, 0, 0)))
    assert shared(on_plate, Contact(model, "block.bottom", carried)) == 0
    pairs = [Contact(model, "block.bottom", "base.top", law) for law in laws]
    assert shared(*pairs) == 2
    assert shared(pairs[0], Contact(model, "base.top", "block.bottom", laws[0])) == 0
    assert shared(pairs[0], on_plate) == 0


def _with_half(model: Model) -> Model:
    """With one of the facets of the bottom as a group of its own."""
    facets = {name: model.facets(name) for name in model.facet_names()}
    bodies = {name: model.cells(name) for name in model.body_names()}
    facets["block.half"] = model.facets("block.bottom")[:1]
    return Model(model.mesh, bodies, facets)


def _pressed(box, *, moved: str = ""):
    """A box that is pressed on a plate by 0.01, and who moves its nodes up by 0.1: when."""
    import ufl

    space, up = _space(box), np.array([0.0, 0.0, 0.1])
    bottom, top = (
        dolfinx_mesh.locate_entities_boundary(box, 2, lambda x, z=z: np.isclose(x[2], z))
        for z in (0.0, 1.0)
    )
    held = fem.locate_dofs_topological(space, 2, top)
    model = Model.of(space, {"pad.sole": bottom})
    u, v = fem.Function(space), ufl.TestFunction(space)
    down = fem.Constant(box, np.array([0.0, 0.0, -0.01]))
    form = ufl.inner(ufl.sym(ufl.grad(u)), ufl.grad(v)) * ufl.dx
    if moved == "before":
        box.geometry.x[:] += up
    plate = make_surface("plane", point=box.geometry.x.min(axis=0), normal=(0, 0, 1))
    contact = Contact(model, "pad.sole", plate, Friction(coefficients=0.3))
    if moved == "between contacts":
        box.geometry.x[:] += up
        Contact(model, "pad.sole", plate, Friction(coefficients=0.3))
    if moved == "between":
        box.geometry.x[:] += up
    problem = ContactProblem(form, u, bcs=[fem.dirichletbc(down, held, space)], contacts=[contact])
    if moved == "after":
        problem.solve()
        box.geometry.x[:] += up
    problem.solve()
    return contact.resultant()[0]


@pytest.mark.parametrize("when", ["between contacts", "between", "after"])
def test_nodes_that_move_under_a_contact_are_one_line(when):
    """The form would have gone with them, the contact not: it pressed 3.5 times as hard."""
    with pytest.raises(InputError, match=r"nodes of the mesh were moved by up to 0\.1 since"):
        _pressed(_box(), moved=when)


def test_nodes_that_move_before_contacts_are_made():
    """They are where the contact finds them: forces are those of the mesh that stayed."""
    stayed, moved = (_pressed(_box(), moved=when) for when in ("", "before"))
    np.testing.assert_allclose(moved, stayed, rtol=0.0, atol=1e-9 * abs(stayed[2]))


@pytest.mark.parametrize("other", ["of its own", "of another order", "of another mesh"])
def test_a_condition_on_another_space_is_one_line(other):
    """Its numbers mean other unknowns, of which the wrong ones would be held."""
    import ufl

    mesh = _box()
    space, order = _space(mesh), 2 if other == "of another order" else 1
    elsewhere = _space(_box() if other == "of another mesh" else mesh, ("Lagrange", order, (3,)))
    u, v = fem.Function(space), ufl.TestFunction(space)
    form = ufl.inner(ufl.grad(u), ufl.grad(v)) * ufl.dx
    nodes = np.arange(4, dtype=np.int32)
    one, wrong = (fem.dirichletbc(np.zeros(3), nodes, held) for held in (space, elsewhere))
    part = fem.dirichletbc(0.0, nodes, space.sub(1))
    ContactProblem(form, u, bcs=[one, part])
    with pytest.raises(InputError, match=r"^bcs\[1\]: is defined on another space than u$"):
        ContactProblem(form, u, bcs=[one, wrong])


@pytest.mark.parametrize("mortar", [True, False])
@pytest.mark.parametrize("dt", [0.0, -1.0, np.nan, np.inf])
def test_a_time_increment_that_is_none_is_one_line(mortar, dt):
    """Points that are pressed into facets were open in it, without a word."""
    upper = BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1))
    model = build_box({"block": upper, "base": BoxSpec((-1, -1, -1), (3, 3, 1), (2, 2, 1))})
    law = ContactLaw(NormalLaw(penalty=9.0), Adhesion(stiffness=1), Friction(coefficients=0.3))
    contact = Contact(model, "block.bottom", "base.top", law, mortar=mortar)
    down = np.zeros_like(model.positions)
    down[model.facet_nodes("block.bottom"), 2] = -0.01
    assert contact.update(down, 1.0).pressure.max() > 0.0
    with pytest.raises(InputError, match=rf"^dt: {dt!r} given, must be > 0$"):
        contact.update(down, dt)
