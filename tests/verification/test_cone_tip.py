"""A node on the tip of a cone: an indenter that is pressed into a block, as in a hardness test."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.contact.tips import points_on_tips
from anisocontact.interface import ContactLaw, Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import (
    Axisymmetric,
    Body,
    BoxSpec,
    Placement,
    build_box,
    build_mesh,
    make_shape,
)
from anisocontact.rigid import MovingSurface, RigidBody
from anisocontact.solver import Problem, Solver, Step
from anisocontact.surfaces import make_surface

FRICTION = Friction(coefficients=0.2)
LAW = ContactLaw(NormalLaw(penalty=1e4), Adhesion(stiffness=1e4), FRICTION)


def _pressed(height, law):
    """Forces on the block along the axis after every increment: of the cone, of the supports."""
    block = make_shape("rectangle", origin=(0, height - 1), size=(1, 1), cells=(8, 8))
    model = build_mesh([Body("block", block)], idealisation=Axisymmetric())
    die = RigidBody("die", (0, height, 0))
    cone = make_surface("cone", apex=(0, height, 0), axis=(0, 1, 0), angle=np.radians(70))
    if isinstance(law, ContactLaw):
        contact = Contact(model, "block.top", MovingSurface(Interface(cone, law), die))
    else:
        contact = Contact(model, "block.top", MovingSurface(cone, die), law)
    rubber = make_material("neo-hookean", E=1000.0, nu=0.3)
    held = {"block.bottom": {"x": 0.0, "y": 0.0}}
    steps = [Step("press", 6, held, motion={"die": {"y": -0.05}})]
    return [
        (contact.resultant()[0][1], accepted.reactions["block.bottom"][1])
        for accepted in Solver(Problem(model, {"block": rubber}, [contact]), steps).run()
    ]


@pytest.mark.parametrize("law", [FRICTION, LAW], ids=["multipliers", "penalty"])
def test_the_block_is_in_balance_wherever_the_tip_is(law):
    """Requirement: supports carry what the cone presses, and the same at any place of the axis.

    Source: equilibrium, and a shift of everything. Normals of a cone turn with the distance from
    its tip, which is rounding at a node on the axis. Forces over that length counted as the
    rounding of forces, and states were accepted in which a fiftieth of the force was not carried,
    another one at another place. Tolerance: what counts as rounding now, 1e-6 of the force at the
    tip, twice, as the increments add up.
    """
    here, there = (np.array(_pressed(height, law)) for height in (0.0, 3.0))
    for cone, support in (*here, *there):
        assert cone + support == pytest.approx(0.0, abs=2e-6 * support)
    assert there[-1] == pytest.approx(here[-1], rel=2e-6)
    assert here[-1, 1] > 2.0


def test_a_node_on_the_axis_has_a_force_along_it_alone():
    """Requirement: no radial force of a contact that has its node on the axis alone; exactly zero.

    Source: by symmetry forces across the axis cancel. The normal there is one of those around the
    tip, by rounding, and the radial force was as large as 0.3 of that along the axis.
    """
    ball = make_shape("disc", radius=0.5, part="quarter", cells=(8, 3))
    placed = Body("ball", ball, Placement(move=(0, 0.499, 0)))
    model = build_mesh([placed], idealisation=Axisymmetric())
    cone = make_surface("cone", apex=(0, 0, 0), axis=(0, -1, 0), angle=np.radians(70))
    contact = Contact(model, "ball.outer", Interface(cone, LAW))
    solid = make_material("linear-elastic", E=1000.0, nu=0.3)
    steps = [Step("press", 2, {"ball.top": {"x": 0.0, "y": -0.005}})]
    for _ in Solver(Problem(model, {"ball": solid}, [contact]), steps).run():
        assert np.count_nonzero(contact.last.status) == 1
        force, moment = contact.resultant()
        assert force[1] > 0.1
        assert (force[[0, 2]] == 0.0).all() and (moment == 0.0).all()


def _tool(lean, at, arcs=False):
    """A profile that comes to the axis at an angle, upwards, through a place of the axis."""
    high = np.tan(np.radians(lean))
    profile = {"profile": [[0, 0], [1, high]], "arcs_deg": [2 * lean]} if arcs else None
    profile = profile or {"profile": [[0, 0], [1, high]]}
    return make_surface("revolution", point=at, axis=(0, 0, 1), **profile)


@pytest.mark.parametrize(
    ("surface", "share"),
    [
        (lambda at: make_surface("cone", apex=at, axis=(0, 0, 1), angle=np.radians(70)), "34%"),
        (lambda at: _tool(20.0, at), "34%"),
        (lambda at: _tool(5.0, at), "9%"),
        (lambda at: _tool(0.5, at), ""),
        (lambda at: _tool(20.0, at, arcs=True), ""),
        (lambda at: make_surface("sphere", centre=(*at[:2], at[2] + 1), radius=1.0), ""),
    ],
    ids=["cone", "profile", "slight", "flat", "round", "sphere"],
)
def test_a_point_of_a_body_in_space_on_a_tip_is_told(surface, share):
    """Requirement: a tip on a slave point is told with the share of its force to the side.

    Source: normals of a cone make the angle of its slope with the axis, and the sine of that is
    their part across. A round end has one normal, and a tip between points meets none.
    """
    model = build_box({"block": BoxSpec((2, 2, -1), (2, 2, 1), (4, 4, 2))})

    def told(at):
        interface = Interface(surface(at), LAW)
        return points_on_tips([Contact(model, "block.top", interface, mortar=True)])

    if share:
        (line,) = told((3, 3, 0))
        assert "at (3, 3, 0), where it has no normal" in line
        assert f"presses the point aside, by {share} of its force" in line
    else:
        assert told((3, 3, 0)) == []
    assert told((3.2, 3.2, 0)) == []
