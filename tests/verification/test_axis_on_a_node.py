"""Polar and spiral fields whose axis goes through a slave node: that of a disc with its centre."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.anisotropy import make_directions
from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.contact.field_hints import doubtful_fields
from anisocontact.interface import AdhesionAndFriction, ContactLaw, Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import (
    Axisymmetric,
    Body,
    BoxSpec,
    PlaneStrain,
    build_box,
    build_mesh,
    make_shape,
)
from anisocontact.solver import Problem, Solver, Step, Turn
from anisocontact.surfaces import make_surface

pytestmark = pytest.mark.filterwarnings("ignore:.*axis of a direction:anisocontact.ModelWarning")

MU = (0.2, 0.4)
HELD = {"base.bottom": {"x": 0.0, "y": 0.0, "z": 0.0}}
FIELDS = {"polar": {"angle": 0.0}, "spiral": {"pitch": 0.5}}


def _dragged(cells, origin=(0.0, 0.0, 0.0), field="polar", meshed=False):
    """Force and moment about the axis of a block that is pressed and dragged along x."""
    o = np.array(origin)
    boxes = {"block": BoxSpec(tuple(o - (0.5, 0.5, 0.0)), (1, 1, 0.5), (cells, cells, cells // 2))}
    if meshed:
        boxes["base"] = BoxSpec(tuple(o - (1.0, 1.0, 0.5)), (2, 2, 0.5), (cells, cells, 1))
    model, axis = build_box(boxes), (tuple(o), (0, 0, 1))
    directions = make_directions(field, axis=axis, **FIELDS[field])
    plane = make_surface("plane", point=tuple(o), normal=(0, 0, 1))
    friction = Friction(coefficients=MU, directions=directions)
    contact = Contact(model, "block.bottom", "base.top" if meshed else plane, friction)
    rubber = make_material("linear-elastic", E=10.0, nu=0.3)
    top = {"block.top": {"x": 0.0, "y": 0.0, "z": -0.02}}
    drag = {"block.top": {"x": 0.03}}
    steps = [Step("press", 1, top | (HELD if meshed else {})), Step("drag", 2, drag)]
    for _ in Solver(Problem(model, dict.fromkeys(boxes, rubber), [contact]), steps).run():
        pass
    return np.concatenate(contact.resultant(origin))


@pytest.mark.parametrize("meshed", [False, True])
@pytest.mark.parametrize("field", FIELDS)
def test_the_origin_does_not_matter(field, meshed):
    """Requirement: it runs, and forces are those of the same block elsewhere.

    Source: a shift of everything. Tolerance: of equilibrium, 1e-8; rounding that decided on the
    direction of the node, or refused it, would be seen at 1e-2.
    """
    here = _dragged(2, (0.0, 0.0, 0.0), field, meshed)
    there = _dragged(2, (3.0, -2.0, 7.0), field, meshed)
    assert there == pytest.approx(here, abs=1e-8 * abs(here).max())
    assert here[0] < -0.2 * here[2]


@pytest.mark.parametrize("meshed", [False, True])
def test_a_body_of_revolution_anywhere_on_its_axis(meshed):
    """Requirement: what is pressed and twisted has one force and torque wherever the origin is.

    Source: a shift of everything. A body of revolution has a node on the axis, which the friction
    of its neighbours must not feel: at the origin rounding gave that node a direction or none, and
    increments were cut, elsewhere the case was refused. Tolerance: of equilibrium, 1e-8.
    """
    found = []
    for low in (0.0, 3.0):
        bodies = [
            Body("block", make_shape("rectangle", origin=(0, low), size=(1, 1), cells=(4, 4)))
        ]
        if meshed:
            under = make_shape("rectangle", origin=(0, low - 1), size=(2, 1), cells=(7, 3))
            bodies.append(Body("base", under))
        model = build_mesh(bodies, idealisation=Axisymmetric(lateral=not meshed))
        directions = make_directions("polar", axis=((0, low, 0), (0, 1, 0)), angle=0.4)
        friction = Friction(coefficients=MU, directions=directions)
        plane = make_surface("plane", point=(0, low, 0), normal=(0, 1, 0))
        contact = Contact(model, "block.bottom", "base.top" if meshed else plane, friction)
        assert not doubtful_fields([contact])
        rubber = make_material("linear-elastic", E=10.0, nu=0.3)
        held = {"base.bottom": {"x": 0.0, "y": 0.0}} if meshed else {}
        still = {} if meshed else {"z": 0.0}
        steps = [Step("press", 2, held | {"block.top": {"x": 0.0, "y": -0.05} | still})]
        if not meshed:
            steps.append(Step("twist", 2, rotation={"block.top": Turn((0, 1, 0), 0.02)}))
        problem = Problem(model, dict.fromkeys((body.name for body in bodies), rubber), [contact])
        for _ in Solver(problem, steps).run():
            pass
        found.append(np.concatenate(contact.resultant((0.0, low, 0.0))))
    assert found[1] == pytest.approx(found[0], abs=1e-8 * np.abs(found[0]).max())


def test_a_node_on_the_axis_is_told_in_plane_strain():
    """Requirement: what slips there has no direction; only on an axis of revolution it rests."""
    shapes = {"block": ((0, 0), (1, 1), (4, 4)), "base": ((-0.5, -1), (2, 1), (7, 3))}
    bodies = [
        Body(name, make_shape("rectangle", origin=low, size=size, cells=cells))
        for name, (low, size, cells) in shapes.items()
    ]
    model = build_mesh(bodies, idealisation=PlaneStrain(lateral=True))
    directions = make_directions("polar", axis=((0, 0, 0), (0, 1, 0)))
    friction = Friction(coefficients=MU, directions=directions)
    told, another = doubtful_fields([Contact(model, "block.bottom", "base.top", friction)])
    assert "slave points with 0.12 of its area lie on the axis of a direction field" in told
    assert "directions are not the same along z" in another


@pytest.mark.parametrize("cells", [2, 4, 8])
def test_the_node_counts_with_its_area(cells):
    """Requirement: whatever direction the node has, its share of the force falls with its area.

    Source: rings are the same on both sides of the plane of the drag, so that no force is across
    but that of the node, h^2 of the area, at most half the difference of the coefficients times its
    pressure, which is below 1.2 of the mean.
    """
    force = _dragged(cells)[:3]
    assert abs(force[1]) <= 1.2 / cells**2 * 0.5 * (MU[1] - MU[0]) * force[2]


@pytest.mark.parametrize(
    ("slave", "master", "line"),
    [
        (2, 3, "slave points with 0.25 of its area lie"),
        (3, 2, "nodes of the master with 1 of its area lie"),
        (3, 3, ""),
        (40, 3, ""),
    ],
)
def test_an_arbitrary_direction_is_told(slave, master, line):
    """Requirement: who is given a direction that nobody chose hears of it, with its share.

    Source: an even number of facets has a node in the middle; of 2 x 2 a quarter of the area is at
    it, of 3 x 3 none. A node of the master is given a facet: there one is as large as the slave. Of
    1600 facets one is less than a thousandth, of which there is no word.
    """
    boxes = {
        "block": BoxSpec((-0.5, -0.5, 0), (1, 1, 0.5), (slave, slave, 1)),
        "base": BoxSpec((-1, -1, -0.5), (2, 2, 0.5), (master, master, 1)),
    }
    rings = make_directions("polar", axis=((0, 0, 0), (0, 0, 1)), angle=0.0)
    law = Friction(coefficients=MU, directions=rings)
    contact = Contact(build_box(boxes), "block.bottom", "base.top", law)
    told = doubtful_fields([contact])
    assert len(told) == bool(line)
    assert all(f"{line} on the axis of a direction field" in text for text in told)


def test_what_has_no_such_part_stays_as_it_is():
    """Requirement: laws are made anew with another field only where they have it."""
    fields = [make_directions("constant", vector=(1, 0, 0)) for _ in range(3)]
    laws = (
        Adhesion(stiffness=(2, 1), directions=fields[0]),
        Friction(coefficients=MU, directions=fields[1], directions_on="slave"),
    )
    law = ContactLaw(NormalLaw(penalty=1.0), AdhesionAndFriction(*laws))
    interface = Interface(make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1)), law)
    assert interface.with_parts({id(fields[2]): fields[0]}) is interface
    new = interface.with_parts({id(fields[1]): fields[2]})
    assert [one.field for one in new.carried] == [fields[0], fields[2], None]
    assert new.carried[1].on == "slave"
    assert new.surface is interface.surface


@pytest.mark.parametrize(("pitch", "told"), [(6.0, 1), (-6.0, 0)])
def test_a_spiral_along_a_flank_is_told(pitch, told):
    """Requirement: on the flank of a square thread every line has the pitch of the thread, and a
    spiral of that pitch has no direction; one of the other hand has, and what can be done is said.

    Source: the helicoid z = H phi / 2 pi is the surface itself. A flank of facets of 10 degrees had
    the friction across it, without a word.
    """
    sizes = {"inner": 8, "outer": 10, "length": 1, "start": 0.0, "end": 4.0}
    nut = build_mesh([Body("nut", make_shape("ring", cells=(1, 24, 1), **sizes))])
    x = nut.mesh.geometry.x
    x[:, 2] += 6.0 * (np.arctan2(x[:, 1], x[:, 0]) % (2.0 * np.pi)) / (2.0 * np.pi)
    grooves = make_directions("spiral", axis=((0, 0, 0), (0, 0, 1)), pitch=pitch)
    law = ContactLaw(
        NormalLaw(penalty=1e3),
        AdhesionAndFriction(Adhesion(stiffness=1e3), Friction(coefficients=MU, directions=grooves)),
    )
    plane = make_surface("plane", point=(0, 0, -9), normal=(0, 0, 1))
    found = doubtful_fields([Contact(nut, "nut.bottom", plane, law)])
    assert len(found) == told
    assert all("100% of the slave" in text and 'kind = "polar"' in text for text in found)
