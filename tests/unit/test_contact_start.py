"""Contacts before the first step: overlaps, adjusted points, sides, singular directions."""

from __future__ import annotations

import math
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from anisocontact.anisotropy import DirectionField, make_directions
from anisocontact.base.errors import InputError
from anisocontact.contact import Contact, initial_overlap
from anisocontact.interface import Augmentation, ContactLaw, Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import Body, BoxSpec, GmshFile, Model, build_box, build_mesh, make_shape
from anisocontact.solver.terms.free_modes import bodies
from anisocontact.surfaces import make_surface

dolfinx_mesh = pytest.importorskip("dolfinx.mesh")

#: At slave nodes.
POINTS, MORTAR = (partial(Contact, mortar=nodes) for nodes in (False, True))


SIZE = 0.5


def _blocks(gap: float) -> Model:
    return build_box(
        {
            "block": BoxSpec((0, 0, gap), (1, 1, 0.5), (2, 2, 1)),
            "base": BoxSpec((-0.5, -0.5, -0.5), (2, 2, 0.5), (3, 3, 1)),
        }
    )


def _laws(
    field: DirectionField | None = None, second: DirectionField | None = None
) -> tuple[NormalLaw, Adhesion, Friction]:
    if second is not None:
        friction = Friction(
            "he-curnier", alpha=(0.3, 0.1, 0.1), directions=field, directions_second=second
        )
    else:
        friction = Friction(coefficients=(0.3, 0.3), directions=field)
    return NormalLaw(penalty=1e3), Adhesion(stiffness=(1e3, 1e3)), friction


def _plane(normal: float, height: float = 0.0) -> Any:
    return make_surface("plane", point=(0, 0, height), normal=(0, 0, normal))


def test_overlap_says_how_deep_where_and_how_many() -> None:
    """A block 0.01 deep in a plane that is met by all of its 16 points."""
    contact = Contact(
        _blocks(-0.01), "block.bottom", Interface(_plane(1.0), *_laws()), mortar=False
    )
    found = initial_overlap(contact, SIZE)
    assert found is not None
    assert found.depth == pytest.approx(0.01)
    assert found.count == 16
    assert found.point[2] == pytest.approx(-0.01)


@pytest.mark.parametrize("kind", ["plane", "single", "mortar"])
@pytest.mark.parametrize("gap", [-0.01, 0.004])
def test_adjusted_points_just_touch(kind: str, gap: float) -> None:
    """Overlaps and gaps up to the reach are gone: no force at rest, at once one below.

    The same displacement gives the pressure of a block that was drawn touching.
    """
    down = 1e-3
    pressures = []
    for lowest, adjust in ((gap, 0.005), (0.0, None)):
        model = _blocks(lowest)
        contact: Contact
        if kind == "plane":
            interface = Interface(_plane(1.0), *_laws())
            contact = Contact(model, "block.bottom", interface, adjust=adjust, mortar=False)
        else:
            made = POINTS if kind == "single" else MORTAR
            contact = made(
                model, "block.bottom", "base.top", law=ContactLaw(*_laws()), adjust=adjust
            )
        assert initial_overlap(contact, SIZE) is None
        u = np.zeros_like(model.space.tabulate_dof_coordinates())
        assert np.abs(contact.update(u, 1.0).traction).max() < 1e-9
        u[next(body.nodes for body in bodies(model) if body.name == "block"), 2] = -down
        pressures.append(contact.update(u, 1.0).pressure.max())
    assert pressures[0] == pytest.approx(1e3 * down, rel=1e-6)
    assert pressures[0] == pytest.approx(pressures[1], rel=1e-6)


@pytest.mark.parametrize(
    ("mortar", "place"), [(False, r".*"), (True, r"\(-?[\d.]+, -?[\d.]+, 0\)")]
)
def test_surface_that_points_the_wrong_way_is_named(mortar: bool, place: str) -> None:
    """The normal of the plane points down, as that of the bottom of the block above it.

    Requirement: it is said where, and what is zero but for round-off is zero.
    """
    said = rf"'block.bottom' faces the same way as its master: at {place} the normals .* are "
    said += r"\(0, 0, -1\) and \(0, 0, -1\); turn"
    with pytest.raises(InputError, match=said):
        Contact(_blocks(0.0), "block.bottom", Interface(_plane(-1.0), *_laws()), mortar=mortar)


def test_group_on_the_wrong_side_is_named() -> None:
    """The top of the block is named where its bottom meets the base."""
    model = _blocks(0.0)
    said = r"'(block|base).top' faces the same way .*; name the facets on the other side$"
    for made in (POINTS, MORTAR):
        with pytest.raises(InputError, match=said):
            made(model, "block.top", "base.top", law=ContactLaw(*_laws()), reach=2.0)


def test_halves_of_one_face_are_told_of_self_contact() -> None:
    """The inside of a ring that is to collapse on to itself, given as slave and master.

    Requirement: both halves bend away from each other where they join; what is meant is said.
    """
    ring = make_shape("ring", inner=1.0, outer=1.2, length=1.0, cells=(1, 24, 2))
    whole = build_mesh([Body("ring", ring)])
    inner = whole.facets("ring.inner")
    x = dolfinx_mesh.compute_midpoints(whole.mesh, 2, inner)[:, 0]
    halves = {"ring.left": inner[x < 0.0], "ring.right": inner[x > 0.0], "ring.both": inner}
    model = Model(whole.mesh, {"ring": whole.cells("ring")}, halves)
    said = r"'ring.left' faces the same way .*, or both as one group with self_contact = true where"
    with pytest.raises(InputError, match=said):
        Contact(model, "ring.left", "ring.right", law=ContactLaw(*_laws()))
    Contact(model, "ring.both", "ring.both", law=ContactLaw(*_laws()), self_contact=True)


@pytest.mark.parametrize("height", [0.8, 0.05])
def test_back_of_the_body_of_the_slave_is_refused(height: float) -> None:
    """The top of a block is behind its bottom: in front of it, the block would be inside out.

    Requirement: one line that names both and the body, for a block and for a plate that is thinner
    than a facet is wide. The ends of a ring with a gap between them face each other: that stands.
    """
    model = build_box({"block": BoxSpec((0, 0, 0), (1, 1, height), (2, 2, 1))})
    said = r"'block.bottom' has it behind itself, across body 'block'"
    for made in (POINTS, MORTAR):
        with pytest.raises(InputError, match=said):
            made(model, "block.bottom", "block.top", law=ContactLaw(*_laws()))
    ring = make_shape(
        "ring", inner=1.0, outer=2.0, length=1.0, cells=(2, 12, 2), start_deg=5, end_deg=355
    )
    split = build_mesh([Body("ring", ring)])
    assert len(Contact(split, "ring.start", "ring.end", law=ContactLaw(*_laws())).points)


def test_pieces_of_a_body_may_overlap(tmp_path: Path) -> None:
    """A section of a deck may hold a ring and the shaft that it is pressed on.

    Requirement: two cubes of one section that share no node and overlap by a hundredth of an edge
    are in contact there, by 0.01 of 1 at every point; nothing is behind anything.
    """
    low = [(x, y, z) for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
    high = [(x, y, z + 0.99) for x, y, z in low]
    nodes = "\n".join(f"{n}, {x}, {y}, {z}" for n, (x, y, z) in enumerate(low + high, 1))
    path = tmp_path / "cubes.inp"
    path.write_text(
        f"*NODE\n{nodes}\n*ELEMENT, TYPE=C3D8, ELSET=ALL\n1, 1, 2, 3, 4, 5, 6, 7, 8\n"
        "2, 9, 10, 11, 12, 13, 14, 15, 16\n*SURFACE, NAME=DECK\n1, S2\n*SURFACE, NAME=SOLE\n2, S1\n"
        "*SOLID SECTION, ELSET=ALL\n"
    )
    model = build_mesh([GmshFile(path)])
    for made in (POINTS, MORTAR):
        found = initial_overlap(made(model, "all.sole", "all.deck", law=ContactLaw(*_laws())), 1.0)
        assert found is not None
        assert found.depth == pytest.approx(0.01)
        assert found.count == 4


def test_bodies_that_face_each_other_pass() -> None:
    """Nothing is said of a block above a plane or a base, near or far."""
    for gap in (0.0, 0.3, -0.01):
        model = _blocks(gap)
        Contact(model, "block.bottom", Interface(_plane(1.0), *_laws()), mortar=False)
        Contact(model, "block.bottom", "base.top", law=ContactLaw(*_laws()), mortar=False)


@pytest.mark.parametrize("meshed", [False, True])
@pytest.mark.parametrize("which", ["directions", "directions_second"])
def test_singular_directions_in_the_contact_are_found(meshed: bool, which: str) -> None:
    """A field along the normal has no direction on the slave, at any of its points."""
    model = _blocks(0.0)
    plain = make_directions("constant", vector=(1, 0, 0))
    probe = Contact(model, "block.bottom", Interface(_plane(1.0), *_laws()), mortar=False)
    x, y, _ = probe.points[0]
    upright = make_directions("constant", vector=(0, 0, 1))
    laws = _laws(upright) if which == "directions" else _laws(plain, upright)
    with pytest.raises(InputError, match=f"no direction at {len(probe.points)} slave") as error:
        if meshed:
            Contact(model, "block.bottom", "base.top", law=ContactLaw(*laws), mortar=False)
        else:
            Contact(model, "block.bottom", Interface(_plane(1.0), *laws), mortar=False)
    assert error.value.field == f"friction.{which}"
    assert f"({x:.4g}, {y:.4g}" in str(error.value)


def test_augmentation_needs_penalties() -> None:
    """Laws with a time, and a tolerance that is none, are refused with the field."""
    normal, adhesion, friction = _laws()
    viscous = NormalLaw("maxwell", stiffness=1.0, relaxation_time=1.0)
    law = Interface(_plane(1.0), viscous, adhesion, friction)
    with pytest.raises(InputError, match=r"normal\.model: \"maxwell\" given"):
        Contact(_blocks(0.0), "block.bottom", law, augmentation=Augmentation(), mortar=False)
    maxwell = Adhesion("maxwell", stiffness=(1.0, 1.0), relaxation_time=(1.0, 1.0))
    law = Interface(_plane(1.0), normal, maxwell, friction)
    with pytest.raises(InputError, match=r"adhesion\.model"):
        Contact(_blocks(0.0), "block.bottom", law, augmentation=Augmentation(), mortar=False)
    Contact(
        _blocks(0.0), "block.bottom", law, augmentation=Augmentation(tangential=False), mortar=False
    )
    for tolerance in (0.0, 1.0, math.nan):
        with pytest.raises(InputError, match="tolerance"):
            Augmentation(tolerance)
