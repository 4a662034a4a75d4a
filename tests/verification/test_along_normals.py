"""Places of a master of facets that slave nodes meet along their averaged normals."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from tests.verification.slid_blocks import force_of, linear_force, slid

from anisocontact.anisotropy import make_directions
from anisocontact.contact import Contact
from anisocontact.contact.along_normals import NormalProjections, along_normals
from anisocontact.interface import ContactLaw
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import BoxSpec, Model, build_box
from anisocontact.surfaces.facets import FacetSurface

Floats = npt.NDArray[np.float64]


def _cap(cell: str, n: int = 6) -> FacetSurface:
    """Facets between nodes of a paraboloid over a square of size 2."""
    line = np.linspace(-1.0, 1.0, n + 1)
    x, y = (one.ravel() for one in np.meshgrid(line, line, indexing="ij"))
    nodes = np.stack([x, y, 0.3 - 0.25 * (x**2 + 0.4 * y**2)], axis=1)
    i = np.arange(n)
    first = ((n + 1) * i[:, None] + i).ravel()
    quads = np.stack([first, first + n + 1, first + 1, first + n + 2], axis=1)
    if cell == "quad4":
        return FacetSurface(nodes, quads.astype(np.int32), cell)
    return FacetSurface(nodes, quads[:, [0, 1, 2, 1, 3, 2]].reshape(-1, 3).astype(np.int32), cell)


def _placed(cell: str, x: Floats, normal: Floats) -> tuple[FacetSurface, NormalProjections]:
    surface = _cap(cell)
    master = SimpleNamespace(topology=cell)
    sides: Any = SimpleNamespace(surface=surface, master=master, excluded=None, reach=np.inf)
    return surface, along_normals(sides, x, normal, surface.project(x))


def _nodes(lean: float) -> tuple[Floats, Floats]:
    """Points on both sides of the cap, some beyond its border, and normals about the vertical."""
    rng = np.random.default_rng(2)
    x = rng.uniform(-1.1, 1.1, (400, 3))
    x[:, 2] = 0.3 - 0.25 * (x[:, 0] ** 2 + 0.4 * x[:, 1] ** 2) + rng.uniform(-0.1, 0.1, 400)
    normal = np.array([0, 0, 1.0]) + lean * rng.uniform(-1.0, 1.0, (400, 3))
    return x, normal / np.linalg.norm(normal, axis=1)[:, None]


@pytest.mark.parametrize("cell", ["quad4", "tri3"])
def test_normals_meet_the_surface(cell: str) -> None:
    """The way from a place to its node is along the normal, 1e-12, wherever that meets a facet.

    Source: the definition. Of points that see the surface all are met, those beyond it end on an
    edge of the border where the seen distance is stationary, or at a corner.
    """
    x, normal = _nodes(0.3)
    surface, places = _placed(cell, x, normal)
    jet = surface.jet(places.facet, places.xi)
    way = x - jet.position
    seen = way - np.einsum("ni,ni->n", way, normal)[:, None] * normal
    inside = np.isnan(places.edge[:, 0])
    assert np.abs(seen[inside]).max() < 1e-12
    straight = normal / normal[:, 2:]
    ahead = x - (x[:, 2:] - jet.position[:, 2:]) * straight
    beyond = np.abs(ahead[:, :2]).max(axis=1) > 1.0 + 1e-9
    assert not (inside & beyond).any()
    assert inside.sum() > 250 and (~inside).sum() > 30
    tangent = np.einsum("na,nad->nd", np.nan_to_num(places.edge), jet.d1)
    assert np.abs(np.einsum("ni,ni->n", tangent, seen)).max() < 1e-12


@pytest.mark.parametrize("cell", ["quad4", "tri3"])
def test_places_pass_edges_without_a_jump(cell: str) -> None:
    """Below a convex surface the place moves as far as the node does, also past edges.

    Source: a line along a normal that does not turn meets a continuous surface that it does not
    graze in a place that is continuous; slopes up to 0.7 leave a factor of two. The closest point
    jumps there by twice the depth times the sine of half of the angle of the facets.
    """
    count, step = 20_000, 1e-4
    x = np.zeros((count, 3))
    x[:, 0] = step * (np.arange(count) - count // 2)
    x[:, 1], x[:, 2] = 0.17 + 0.3 * x[:, 0], -0.25
    normal = np.tile([0.1, -0.05, 1.0] / np.linalg.norm([0.1, -0.05, 1.0]), (count, 1))
    surface, places = _placed(cell, x, normal)
    seen = np.isnan(places.edge[:, 0])
    both = seen[1:] & seen[:-1]
    assert both.sum() > 0.8 * count

    def jumps(position: Floats) -> Floats:
        return np.linalg.norm(np.diff(position, axis=0), axis=1)[both]

    assert jumps(surface.jet(places.facet, places.xi).position).max() < 2.0 * step
    assert jumps(surface.project(x).position).max() > 50.0 * step


def _ending(cell: str, order: int) -> Model:
    """A block that hangs over two sides of the one below, on meshes that do not match."""
    upper = BoxSpec((0.1, 0.05, 0), (1, 1, 1), (3, 3, 1), cell=cell, order=order)
    lower = BoxSpec((-0.5, -0.5, -1), (1.55, 1.3, 1), (4, 5, 1), cell=cell, order=order)
    return build_box({"upper": upper, "lower": lower})


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("cell", ["hexahedron", "tetrahedron"])
def test_tangent_where_the_master_ends(cell: str, order: int) -> None:
    """Nodes beyond the border of warped surfaces that lean on each other: error of second order.

    Source: central differences, as of `test_mortar.test_tangent`. The gaps are a tenth of a facet,
    so that how places follow the averaged normals counts.
    """
    model = _ending(cell, order)
    rays = make_directions("polar", axis=((5.0, 3.0, 0.0), (0, 0, 1.0)))
    law = ContactLaw(
        NormalLaw(penalty=100.0),
        Adhesion(stiffness=(60.0, 90.0), directions=rays),
        Friction(coefficients=(0.3, 0.5), directions=rays),
    )
    contact = Contact(model, "upper.bottom", "lower.top", law, mortar=True, current_area=True)
    u = slid(contact, model)
    block = np.unique(model.space.dofmap.list[model.cells("upper")])
    x = model.space.tabulate_dof_coordinates()[block]
    u[block, 2] += -0.03 + 0.08 * (x[:, 0] - 0.6)
    force_of(contact, u)
    edge = contact.answer.at.opposite[0].edge
    acting = contact.answer.which
    assert (~np.isnan(edge[acting, 0]) & (edge[acting] != 0.0).any(axis=1)).any()
    way = np.random.default_rng(5).normal(size=u.shape)
    exact = linear_force(contact, way)
    errors = []
    for h in (1e-5, 1e-6):
        found = (force_of(contact, u + h * way) - force_of(contact, u - h * way)) / (2.0 * h)
        errors.append(np.abs(found - exact).max() / np.abs(exact).max())
    assert errors[1] < max(errors[0] / 50.0, 2e-8)


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_hollow_borders_keep_their_nodes(side: float) -> None:
    """A node in front of a notch of the border stays on its edge until another is clearly nearer.

    Source: both edges of a notch are equally near from its middle, where rounding would choose.
    """
    x, y, z = 0.1, 1.0, 0.0
    nodes = np.array([[-1, -y, z], [-1, 0, z], [-1, y, z], [x, -y, z], [0, 0, z], [x, y, z]])
    quads = np.array([[0, 3, 1, 4], [1, 4, 2, 5]], dtype=np.int32)
    surface = FacetSurface(nodes, quads, "quad4")
    sides: Any = SimpleNamespace(
        surface=surface, master=SimpleNamespace(topology="quad4"), excluded=None, reach=np.inf
    )
    normal = np.array([[0.0, 0.0, 1.0]])

    def place(shift: float, before: NormalProjections | None) -> NormalProjections:
        at = np.array([[1.0, shift, 0.1]])
        return along_normals(sides, at, normal, surface.project(at), before)

    first = place(0.01 * side, None)
    there = place(-1e-9 * side, None)
    assert first.facet[0] != there.facet[0]
    kept = place(-1e-9 * side, first)
    assert kept.facet[0] == first.facet[0]
    assert np.abs(surface.jet(kept.facet, kept.xi).position[0, 1] * side - 0.0990) < 1e-3
    assert place(-0.3 * side, first).facet[0] == there.facet[0]
