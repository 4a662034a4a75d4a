"""Directions of meshed bodies from functions of the position and from DOLFINx functions."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.anisotropy import make_directions
from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import fem
from anisocontact.contact import Contact, facet_directions
from anisocontact.interface import ContactLaw
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import Body, BoxSpec, Model, build_box, build_mesh, make_shape
from anisocontact.surfaces import make_surface

Floats = npt.NDArray[np.float64]


def blocks(n: int, cell: str = "hexahedron") -> Model:
    """A block on a plate of n x n facets, beside the origin."""
    return build_box(
        {
            "block": BoxSpec((1.2, 1.2, 0), (0.6, 0.6, 0.3), (3, 3, 1), cell),
            "plate": BoxSpec((1, 1, -0.3), (1, 1, 0.3), (n, n, 1), cell),
        }
    )


def rings(x: Floats) -> Floats:
    """Along circles about the origin."""
    return np.cross((0.0, 0.0, 1.0), x)


def axes(model: Model, directions: Any) -> tuple[Floats, Floats]:
    """First axes and positions of the block's slave points, pressed a little into the plate."""
    law = ContactLaw(
        NormalLaw(penalty=1.0),
        Adhesion(stiffness=(1.0, 1.0)),
        Friction(coefficients=(0.3, 0.1), directions=directions),
    )
    contact = Contact(model, "block.bottom", "plate.top", law=law, degree=4)
    down = np.zeros_like(model.space.tabulate_dof_coordinates())
    down[fem.locate_dofs_topological(model.space, 3, model.cells("block")), 2] = -1e-3
    response = contact.update(down, 1.0)
    assert np.all(response.status > 0)
    return response.directions_friction[:, 0], contact.current.points


@pytest.mark.parametrize("cell", ["hexahedron", "tetrahedron"])
def test_a_function_of_the_position(cell: str) -> None:
    """Circles about an axis beside the plate against their closed form.

    Requirement: directions from a callable, for meshed bodies. The moving least-squares fit is of
    second order in the size of the facets: the error falls by 4 when they are halved; 3 is asked
    for, since the points do not lie alike on both meshes.
    """
    errors = []
    for n in (6, 12):
        model = blocks(n, cell)
        found, x = axes(model, facet_directions(model, "plate.top", rings))
        exact = rings(x) / np.linalg.norm(rings(x), axis=1)[:, None]
        errors.append(np.abs(np.cross(found, exact)).max())
    assert errors[0] < 1e-2
    assert errors[1] < errors[0] / 3.0


@pytest.mark.parametrize("cell", ["hexahedron", "tetrahedron"])
def test_a_dolfinx_function(cell: str) -> None:
    """A DOLFINx function gives what the callable it was interpolated from gives.

    Source: `rings` is linear in the position, which Lagrange functions hold exactly: rounding.
    """
    model = blocks(4, cell)
    function = fem.Function(model.space)
    function.interpolate(lambda x: rings(x.T).T)
    found, _ = axes(model, facet_directions(model, "plate.top", function))
    expected, _ = axes(model, facet_directions(model, "plate.top", rings))
    assert np.abs(found - expected).max() < 1e-12


def ring() -> Model:
    """A ring of 24 curved facets around z, of outer radius 2."""
    shape = make_shape("ring", inner=1.5, outer=2.0, length=1.0, cells=(1, 24, 3), order=2)
    return build_mesh([Body("ring", shape)])


def test_lines_of_coordinates_on_a_meshed_ring() -> None:
    """Helices at 30 degrees on the facets against their closed form.

    Requirement: fields in the coordinates of a surface, for meshed bodies. Source: the tangent of a
    helix at the same positions, sampled as a callable: the two tables differ by rounding.
    """
    model = ring()
    bar = make_surface("cylinder", point=(0, 0, 0), axis=(0, 0, 1), radius=2.0, start=(1, 0, 0))
    lines = make_directions("coordinate-lines", angle=np.pi / 6)
    sampled = facet_directions(model, "ring.outer", lines, surface=bar)

    def helix(x: Floats) -> Floats:
        around = rings(x) / np.linalg.norm(rings(x), axis=1)[:, None]
        along = np.array((0.0, 0.0, 1.0))
        first = np.cos(np.pi / 6) * around + np.sin(np.pi / 6) * along
        return np.stack([first, np.cos(np.pi / 6) * along - np.sin(np.pi / 6) * around], axis=1)

    expected = facet_directions(model, "ring.outer", helix)
    xi = np.random.default_rng(1).uniform((0.0, 0.1), (6.0, 0.9), (50, 2))
    found, valid = sampled.axes(bar, xi)
    assert valid.all()
    assert np.abs(found - expected.axes(bar, xi)[0]).max() < 1e-12


def test_a_grid_of_directions_on_a_meshed_plate() -> None:
    """A table over the coordinates of a plane, in contact of two bodies.

    Source: the table holds one direction, which is constant in space: rounding.
    """
    model = blocks(3)
    plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1), tangent=(0, 1, 0))
    grid = make_directions(
        "tabulated-grid", lower=(0, -3), upper=(3, 3), counts=(5, 5), vectors=[1.0, 2.0, 0.0] * 25
    )
    found, _ = axes(model, facet_directions(model, "plate.top", grid, surface=plane))
    assert np.abs(np.cross(found, np.array([1.0, 2.0, 0.0]) / np.sqrt(5.0))).max() < 1e-12


def test_fields_that_lie_on_no_surface_or_beside_it() -> None:
    """A field needs a surface, and a direction at every sample."""
    rays = make_directions("coordinate-lines")
    with pytest.raises(InputError, match="surface: missing"):
        facet_directions(blocks(2), "plate.top", rays)
    plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1), tangent=(1, 0, 0))
    small = make_directions(
        "tabulated-grid", lower=(0, 0), upper=(1, 1), counts=(5, 5), vectors=[1.0, 0.0, 0.0] * 25
    )
    with pytest.raises(InputError, match="no direction at"):
        facet_directions(blocks(2), "plate.top", small, surface=plane)


def test_two_directions_are_oblique_axes() -> None:
    """Two directions at each position are the axes, however they lie to each other."""
    model = blocks(4)

    def both(x: Floats) -> Floats:
        return np.broadcast_to(np.array([(1.0, 0.0, 0.0), (1.0, 1.0, 0.0)]), (len(x), 2, 3))

    found, _ = axes(model, facet_directions(model, "plate.top", both, interpolation="nearest"))
    assert np.abs(found - (1.0, 0.0, 0.0)).max() < 1e-12


def test_the_field_is_that_of_scattered_points() -> None:
    """Between a table made by hand at the same points and this one there is no difference."""
    model = blocks(2)
    points = []

    def f(x: Floats) -> Floats:
        points.append(x)
        return rings(x)

    found, _ = axes(model, facet_directions(model, "plate.top", f))
    by_hand = make_directions(
        "tabulated-points", points=points[0].reshape(-1), vectors=rings(points[0]).reshape(-1)
    )
    assert np.array_equal(found, axes(model, by_hand)[0])


@pytest.mark.parametrize(
    ("group", "f", "text"),
    [
        ("plate.lid", rings, "no facet group 'plate.lid'"),
        ("plate.top", lambda x: x[:, :2], "(144, 2) for 144 positions given, (144, 3)"),
        ("plate.top", lambda x: np.full_like(x, np.nan), "f: [nan, nan, nan] at ("),
        ("plate.top", lambda x: x / "2", "f: the function failed: test_facet_directions.py, line"),
        ("plate.top", lambda x: "along", "f: 'along' given by the function, an array of real"),
        ("plate.top", lambda x: x + 1j, "an array of real numbers needed"),
    ],
)
def test_bad_input(group: str, f: Any, text: str) -> None:
    with pytest.raises(InputError) as error:
        facet_directions(blocks(4), group, f)
    assert text in str(error.value)


def test_a_function_that_changes_what_it_is_given() -> None:
    """Requirement: samples stay where they are on the facets, whatever a function writes."""

    def away(x: Floats) -> Floats:
        x -= (0.3, 0.2, 0.0)
        return x

    model = blocks(4)
    found, _ = axes(model, facet_directions(model, "plate.top", away))
    same, _ = axes(model, facet_directions(model, "plate.top", lambda x: x - (0.3, 0.2, 0.0)))
    assert np.array_equal(found, same)
