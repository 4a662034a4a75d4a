"""What contacts are told of their meshes: coarse slaves, overlaps, flat facets, borders, angles."""

from __future__ import annotations

import warnings

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.base.errors import InputError, ModelWarning
from anisocontact.base.fenicsx import fem, ufl
from anisocontact.bulk import make_material
from anisocontact.contact import Contact, coarse_slaves
from anisocontact.contact.hidden_borders import hidden_borders, overlapped
from anisocontact.contact.hints import faceted, overlapping
from anisocontact.contact.sagitta import sagitta
from anisocontact.interface import ContactLaw
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import (
    Body,
    BoxSpec,
    Model,
    PlaneStrain,
    PlaneStress,
    build_box,
    build_mesh,
    make_shape,
)
from anisocontact.results.warnings import at_end
from anisocontact.solver import ContactProblem, Problem, Solver, Step
from anisocontact.surfaces import make_surface

LAW = ContactLaw(NormalLaw(penalty=1e3), Adhesion(stiffness=1e3), Friction(coefficients=0.3))


def _model(unit: float = 1.0, **more) -> Model:
    """A base of one facet of 2 below a pin with facets of 0.1, between the points of the base."""
    base = BoxSpec((-unit, -unit, -unit), (2 * unit, 2 * unit, unit), (1, 1, 1), **more)
    low = -0.1 * unit
    pin = BoxSpec((low, low, -0.001 * unit), (-2 * low, -2 * low, 0.3 * unit), (2, 2, 1), **more)
    return build_box({"base": base, "pin": pin})


@pytest.mark.parametrize("unit", [1.0, 1e-6])
@pytest.mark.parametrize("more", [{}, {"order": 2}, {"cell": "tetrahedron"}])
def test_a_coarse_slave_is_named_with_the_ratio_and_the_cure(unit, more):
    """The pin overlaps the base, and no point of the base meets it: sizes 2 and 0.1."""
    model = _model(unit, **more)
    contact = Contact(model, "base.top", "pin.bottom", law=LAW, mortar=False)
    (line,) = coarse_slaves([contact])
    assert "contact of base.top with pin.bottom" in line
    assert "20 times as large" in line and "swap slave and master" in line
    assert not coarse_slaves([Contact(model, "pin.bottom", "base.top", law=LAW, mortar=False)])


@pytest.mark.parametrize("mortar", [False, True])
def test_of_a_graded_slave_the_facets_below_the_master_count(mortar):
    """Facets of 0.1 below a pin with facets of 0.1 are not coarse, however large those far off are.

    Requirement: no line where the mean of all facets of the slave is more than three times as large
    as those of the master, and a line with the size below the pin, 0.5, where that is.
    """
    pin = make_shape("box", origin=(-0.05, -0.05, 0.0), size=(0.2, 0.2, 0.3), cells=(2, 2, 1))
    for near, said in ((0.1, None), (0.5, "(0.5 and 0.1)")):
        inner = np.arange(-0.5, 0.5 + 1e-9, near)
        planes = np.concatenate([[-20.0, -10.0], inner, [10.0, 20.0]])
        shares = ((planes + 20.0) / 40.0).tolist()
        n = len(planes) - 1
        base = make_shape(
            "box",
            origin=(-20, -20, -1),
            size=(40, 40, 1),
            cells=(n, n, 1),
            planes_x=shares,
            planes_y=shares,
        )
        model = build_mesh([Body("base", base), Body("pin", pin)])
        contact = Contact(model, "base.top", "pin.bottom", law=LAW, mortar=mortar)
        assert contact.facet_size > 3.0 * contact.master_size
        lines = coarse_slaves([contact])
        assert len(lines) == (said is not None)
        assert said is None or said in lines[0]


def test_a_script_gets_a_warning_of_the_package():
    model = _model()
    contact = Contact(model, "base.top", "pin.bottom", law=LAW, mortar=False)
    steel = make_material("linear-elastic", E=100.0, nu=0.3)
    problem = Problem(model, {"base": steel, "pin": steel}, [contact])
    held = {group: dict.fromkeys("xyz", 0.0) for group in ("base.bottom", "pin.top")}
    with pytest.warns(ModelWarning, match="swap slave and master"):
        Solver(problem, [Step("rest", 1, held)])


@pytest.mark.parametrize(("depth", "adjust"), [(0.0, None), (0.02, None), (0.02, 0.0)])
def test_a_script_is_told_of_bodies_that_overlap(depth, adjust):
    """An overlap of the mesh pushes bodies apart: a script hears of it, as a run does; none where
    they just touch, or are adjusted."""
    low = BoxSpec((0, 0, -depth), (1, 1, 1), (2, 2, 2))
    model = build_box({"pad": low})
    plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    contact = Contact(model, "pad.bottom", plane, LAW, adjust=adjust, mortar=False)
    u, v = fem.Function(model.space), ufl.TestFunction(model.space)
    form = ufl.inner(ufl.grad(u), ufl.grad(v)) * ufl.dx
    with warnings.catch_warnings(record=True) as heard:
        warnings.simplefilter("always")
        ContactProblem(form, u, contacts=[contact]).close()
    found = [str(one.message) for one in heard if one.category is ModelWarning]
    said = "contact of pad.bottom: the bodies overlap by 0.02 at the start, 4% of the facet size"
    assert [line.startswith(said) for line in found] == [True] * bool(depth and adjust is None)
    assert {one.filename for one in heard if one.category is ModelWarning} <= {__file__}


@pytest.mark.parametrize(
    ("order", "count", "said"), [(1, 20, True), (1, 160, False), (2, 20, False)]
)
def test_facets_as_flat_as_an_interference_are_told(order, count, said):
    """Two rings with an interference of 0.002: arcs over facets of angle a are r (1 - cos(a / 2))
    high, 0.0016 and 0.0011 here, and the force of order 1 is off by 15 to 19 %; fine or round
    facets have no such line."""
    parts = {"shaft": (1.0, 2.002, 6 * count // 5), "hub": (2.0, 3.0, count)}
    bodies = [
        Body(
            name,
            make_shape(
                "annulus", inner=a, outer=b, start_deg=0.0, end_deg=90.0, cells=(2, n), order=order
            ),
        )
        for name, (a, b, n) in parts.items()
    ]
    model = build_mesh(bodies, idealisation=PlaneStrain())
    contact = Contact(model, "hub.inner", "shaft.outer", LAW, mortar=True)
    (line,) = overlapping([(contact, "fit", contact.facet_size)], "adjust = true")
    sides = ((2.0, count), (2.002, 6 * count // 5))
    heights = [r * (1.0 - np.cos(np.pi / (4.0 * n))) for r, n in sides]
    assert ("round cells (order 2)" in line) is said
    if said:
        height = float(line.partition("arcs over their facets are ")[2].partition(" ")[0])
        assert height == pytest.approx(sum(heights), rel=1e-2)


@pytest.mark.parametrize("straight", [False, True])
def test_arcs_over_facets_that_bend_are_a_quartic_high(straight):
    """Facets of order 2 on a circle: `x^2 (a^2 - x^2) / 8 r^3` is at most `a^4 / 32 r^3`, a half
    the length; with middle nodes on the chords they are flat, `a^2 / 2 r` below their arcs.

    Tolerance 3 %: the next powers of a / r = pi / 32.
    """
    count, radius = 8, 2.0
    shape = make_shape(
        "annulus", inner=1.0, outer=radius, start_deg=0.0, end_deg=90.0, cells=(1, count), order=2
    )
    model = build_mesh([Body("ring", shape)], idealisation=PlaneStrain())
    half = radius * np.pi / (4.0 * count)
    expected = half**4 / (32.0 * radius**3)
    if straight:
        x = np.array(model.positions)
        ends, edge = x[:, :2], np.hypot(x[:, 0], x[:, 1]) > radius - 1e-6
        angle = np.arctan2(ends[:, 1], ends[:, 0]) / (np.pi / (4.0 * count))
        middle = edge & (np.abs(angle % 2.0 - 1.0) < 1e-6)
        x[middle] *= np.cos(np.pi / (4.0 * count))
        model.__dict__["positions"] = x
        expected = half**2 / (2.0 * radius)
    assert sagitta(model, "ring.outer") == pytest.approx(expected, rel=3e-2)


def test_round_cells_are_not_told_to_be_round():
    """A disc and a ring of order 2 that do not match, which overlap by 6e-6 of the radius."""
    bodies = [
        Body("disc", make_shape("disc", radius=1.0, part="quarter", cells=(16, 3), order=2)),
        Body(
            "ring",
            make_shape(
                "annulus", inner=1.0, outer=3.0, start_deg=-90.0, end_deg=0.0, cells=(8, 9), order=2
            ),
        ),
    ]
    model = build_mesh(bodies, idealisation=PlaneStrain())
    contact = Contact(model, "disc.outer", "ring.inner", Friction(coefficients=0.3))
    (line,) = overlapping([(contact, "fit", contact.facet_size)], "adjust = true")
    assert "arcs over their facets" in line
    assert line.endswith("it is wrong by as much, finer facets reduce that")


@pytest.mark.parametrize(
    ("work", "said"), [(50.0, "12% of"), (1e-9, "more than all (6 against 1e-09) of")]
)
def test_stabilisation_is_told_over_the_work_there_is(work: float, said: str) -> None:
    """Without work from outside a share of it says nothing: both are told."""
    (line,) = at_end([], [], {"external": -work, "stabilisation": 6.0, "regularisation": 0.0})
    assert line.startswith(f"stabilisation took up {said} the work from outside")


@pytest.mark.parametrize(
    ("slave", "master"), [("ring.inner", "disc.outer"), ("disc.outer", "ring.inner")]
)
@pytest.mark.parametrize(("load", "told"), [(10.0, 1), (60.0, 0)])
def test_chords_that_scatter_pressures_are_told(slave, master, load, told):
    """A disc in a ring of the same material under pressure all around: it passes as it is.

    Source: uniform stress. 16 and 31 chords of order 1 on a quarter are apart by 0.0015, which
    these bodies close under a pressure of 10; until then every other node of the finer side is
    open and those between them carry twice the load, more than closes the gaps.
    """
    bodies = [
        Body("disc", make_shape("disc", radius=1.0, part="quarter", cells=(64, 3))),
        Body(
            "ring",
            make_shape(
                "annulus", inner=1.0, outer=3.0, start_deg=-90.0, end_deg=0.0, cells=(8, 31)
            ),
        ),
    ]
    model = build_mesh(bodies, idealisation=PlaneStress())
    contact = Contact(model, slave, master, Friction(coefficients=0.0))
    steel = make_material("linear-elastic", E=1000.0, nu=0.3)
    planes = ["disc.left", "disc.top", "ring.start", "ring.end"]
    problem = Problem(model, dict.fromkeys(("disc", "ring"), steel), [contact], symmetry=planes)
    list(Solver(problem, [Step("press", 1, pressure={"ring.outer": load})]).run())
    off = np.abs(contact.last.pressure / load - 1.0).max()
    if slave == "ring.inner":
        assert (off > 0.5) == told
    assert len(faceted([contact])) == told


@pytest.mark.parametrize(
    ("cells", "met"), [(4, 0.5625), (5, 1.44), (6, 1.0), (7, 0.7346938775510204)]
)
def test_a_master_that_ends_inside_slave_facets_is_told(cells, met):
    """A block of 1 x 1 on the middle of a slave of 3 x 3, whose 2 x 2 points meet more or less.

    Requirement: the area that points meet is counted by hand; a quarter missed is told (the force
    of 4 cells is 40 % too small), one met twice only where layers are soft (5 cells: 2 % with stiff
    ones), and nothing at slave nodes, of the smaller side, or where facets end with the master.
    Tolerance: 8 points along a side find what is covered of a facet to a sixteenth of it.
    """
    base = BoxSpec((-1, -1, -1), (3, 3, 1), (cells, cells, 1))
    model = build_box({"base": base, "block": BoxSpec((0, 0, 0), (1, 1, 1), (3, 3, 1))})
    contact = Contact(model, "base.top", "block.bottom", LAW, mortar=False)
    found = overlapped(contact.master.sides, contact.master.positions)
    np.testing.assert_allclose(found.met, met, rtol=1e-12)
    np.testing.assert_allclose(found.covered, 1.0, atol=0.1)
    lines = hidden_borders([contact])
    assert len(lines) == (met < 0.75)
    assert all("ends inside facets of the slave" in line for line in lines)
    for slave, master, mortar in (
        ("base.top", "block.bottom", True),
        ("block.bottom", "base.top", False),
    ):
        assert not hidden_borders([Contact(model, slave, master, LAW, mortar=mortar)])


@pytest.mark.parametrize(("layer", "told"), [(1e-3, 1), (1e3, 0)])
def test_a_fifth_of_the_area_too_much_is_told_of_soft_layers_alone(layer, told):
    """A block of 1.2 x 1 whose 2 x 2 points per facet meet 1.125 of its area, by hand.

    Requirement: the force of a layer much softer than the bodies is off by that share, and by next
    to nothing where the layer is much stiffer.
    """
    base = BoxSpec((-1, 0, -1), (3, 1, 1), (4, 1, 1))
    model = build_box({"base": base, "block": BoxSpec((0.2, 0, 0), (1, 1, 1), (3, 3, 1))})
    law = ContactLaw(
        NormalLaw(penalty=layer), Adhesion(stiffness=layer), Friction(coefficients=0.3)
    )
    contact = Contact(model, "base.top", "block.bottom", law, mortar=False)
    steel = make_material("linear-elastic", E=1.0, nu=0.3)
    Problem(model, {"base": steel, "block": steel}, [contact])
    found = overlapped(contact.master.sides, contact.master.positions)
    np.testing.assert_allclose(found.met, 1.125, rtol=1e-12)
    lines = hidden_borders([contact])
    assert len(lines) == told
    assert all("whose points meet 1" in line for line in lines)


@pytest.mark.parametrize("said", [False, True])
def test_a_border_that_a_slide_has_brought_inside_slave_facets_is_told_at_the_end(said):
    """A block slid from where points meet 1.27 of its area, which stiff layers bear, to 0.56.

    Requirement: the area of the end counts, not that of the start, unless it was told there.
    """
    base = BoxSpec((-1, -1, -1), (3, 3, 1), (4, 4, 1))
    model = build_box({"base": base, "block": BoxSpec((0.2, 0.2, 0), (1, 1, 1), (3, 3, 1))})
    contact = Contact(model, "base.top", "block.bottom", LAW, mortar=False)
    told = hidden_borders([contact])
    assert not told
    u = np.zeros((len(contact.space.tabulate_dof_coordinates()), 3))
    u[fem.locate_dofs_topological(contact.space, 3, model.cells("block")), :2] = -0.2
    contact.update(u, 1.0)
    same = ("worst_penetration", "worst_elastic_slip", "worst_turn")
    entry = dict.fromkeys(same, 0.0) | {"slave": "base.top", "master": "block.bottom"}
    entry |= {"facet_size": 0.75, "points": {"open": 0, "stick": 1, "slip": 0}}
    started = ["contact of base.top with block.bottom: the master ends inside facets of the slave"]
    none = {"external": 1.0, "stabilisation": 0.0, "regularisation": 0.0}
    lines = at_end([contact], [entry], none, told=started if said else [])
    assert ["ends inside facets" in line for line in lines] == ([] if said else [True])


def test_a_master_in_a_symmetry_plane_is_refused_as_a_slave_is():
    """Held along its normal the plane would carry the load, and the body below feel nothing."""
    model = _model()
    contact = Contact(model, "pin.bottom", "base.top", law=LAW, mortar=False)
    steel = make_material("linear-elastic", E=100.0, nu=0.3)
    for group, side in (("base.top", "master"), ("pin.bottom", "slave")):
        with pytest.raises(InputError, match=f"the {side} of contact .*held along its normal"):
            Problem(model, {"base": steel, "pin": steel}, [contact], symmetry=[group])
