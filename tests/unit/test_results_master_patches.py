"""Patches of analytic masters for ParaView."""

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.anisotropy import make_directions
from anisocontact.contact import Contact
from anisocontact.interface import Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.results.master_patches import POINTS, MasterPatches
from anisocontact.rigid import MovingSurface, RigidBody
from anisocontact.surfaces import make_surface

# Surface below the block [0, 1]^2 x [0, 0.5], and the bounds of its patch.
SHAPES = {
    "plane": ({"point": (0, 0, 0), "normal": (0, 0, 1)}, None),
    "sphere": ({"centre": (0.5, 0.5, -1), "radius": 1}, (-0.5, 1.5, -0.5, 1.5, -2, 0)),
    "torus": (
        {"centre": (0.5, 0.5, -1), "axis": (0, 0, 1), "radius": 2, "tube": 1},
        (-2.5, 3.5, -2.5, 3.5, -2, 0),
    ),
    "cylinder": ({"point": (0, 0.5, -1), "axis": (1, 0, 0), "radius": 1}, None),
    "revolution": (
        {"point": (0.5, 0.5, 0), "axis": (0, 0, 1), "profile": [(1.5, 0), (0.1, 0), (0.1, -1)]},
        (-1, 2, -1, 2, -1, 0),
    ),
    "helicoid": (
        {
            "point": (0.5, 0.5, -1.05),
            "axis": (0, 0, 1),
            "lead": 0.1,
            "inner": 0.01,
            "outer": 1.5,
        },
        None,
    ),
    "cone": ({"apex": (-1, 0.5, -1), "axis": (1, 0, 0), "angle": 0.5}, None),
}


def patch(fe, shape, body=None, **friction):
    block = fe.block(fe.interface())
    law = Interface(
        make_surface(shape, **SHAPES[shape][0]),
        NormalLaw(penalty=1.0),
        Adhesion(stiffness=(1.0, 1.0)),
        Friction(**({"coefficients": (0.1, 0.1)} | friction)),
    )
    contact = Contact(block.model, "block.bottom", MovingSurface(law, body), mortar=False)
    return contact, MasterPatches([block.contact, contact], block.model.mesh.comm)


@pytest.mark.parametrize("shape", SHAPES)
def test_points_lie_on_the_surface(fe, shape):
    """All of a closed surface; of an endless one what is below the slave points."""
    contact, surfaces = patch(fe, shape)
    mesh = surfaces.mesh()
    own = mesh.points[mesh.point_data["contact"] == 1].astype(float)
    assert len(own) == POINTS**2
    assert np.isfinite(own).all()
    projection = contact.interface.surface.project(own)
    assert np.abs(projection.gap).max() < 1e-6
    bounds = np.column_stack([own.min(axis=0), own.max(axis=0)])
    expected = SHAPES[shape][1]
    if expected is not None:
        assert np.allclose(bounds.reshape(-1), expected, atol=0.02)
    assert (bounds[:2, 0] < 0.0).all()
    assert (bounds[:2, 1] > 1.0).all()


def test_a_patch_moves_with_its_body(fe):
    """Points and directions go with the accepted pose; a surface without directions has none."""
    die = RigidBody("die", (0, 0, 0))
    marks = make_directions("constant", vector=(1, 0, 0))
    _, surfaces = patch(fe, "plane", die, coefficients=(0.1, 0.2), directions=marks)
    before = surfaces.mesh()
    die.move(z=0.5, rz=np.pi / 2)
    die.commit()
    after = surfaces.mesh()
    mine = after.point_data["contact"] == 1
    turned = before.points[mine][:, [1, 0, 2]] * [-1, 1, 1] + [0, 0, 0.5]
    assert np.allclose(after.points[mine], turned, atol=1e-6)
    assert np.allclose(after.point_data["direction_friction_1"][mine], [0, 1, 0], atol=1e-12)
    assert np.array_equal(after.points[~mine], before.points[~mine])
    _, plain = patch(fe, "plane")
    mesh = plain.mesh()
    assert not mesh.point_data["direction_friction_1"][mesh.point_data["contact"] == 1].any()


def test_no_analytic_master(fe):
    block = fe.block(fe.interface())
    assert MasterPatches([], block.model.mesh.comm).mesh() is None
