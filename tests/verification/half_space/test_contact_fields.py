"""What a run reports of a round contact, and the fields at slave nodes that ParaView is shown.

Source: Hertz 1882, in K. L. Johnson, Contact Mechanics, eqs. (4.22) and (4.24), with the force P of
the run: a = (3 P R / 4 E*)^(1/3), p0 = 3 P / (2 pi a^2). A quarter is computed.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from anisocontact.bulk import make_material
from anisocontact.contact import Augmentation, Contact
from anisocontact.interface import ContactLaw
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import Model
from anisocontact.results.dataset import DataSet
from anisocontact.results.paraview import slave_points
from anisocontact.results.snapshot import Observer
from anisocontact.solver import Problem, Solver, Step
from anisocontact.surfaces import make_surface

Floats = npt.NDArray[np.float64]

RADIUS, E, NU = 40.0, 1000.0, 0.3
APPROACH = 0.93 / RADIUS
LAW = ContactLaw(
    NormalLaw(penalty=10.0 * E),
    Adhesion(stiffness=(1.0, 1.0)),
    Friction(coefficients=(1e-9, 1e-9)),
)


def pressed(
    half_spaces: Any, n: int, mortar: bool, order: int = 1, **options: Any
) -> tuple[Contact, dict[str, Any]]:
    """A quarter of a block under a rigid sphere, and what the summary says of the contact."""
    model = Model.from_arrays(half_spaces.body("body", n, upper=False, order=order))
    surface = make_surface(
        "sphere", centre=(0, 0, RADIUS), radius=RADIUS, axis=(1, 0, 0), start=(0, 0, 1)
    )
    contact = Contact(
        model,
        "body.contact",
        surface,
        LAW,
        mortar=mortar,
        augmentation=Augmentation(tangential=False),
        **options,
    )
    held: dict[str, Any] = {"body.far": {"z": APPROACH}, "body.x": {"x": 0.0}}
    steps = [Step("press", 1, held)]
    material = make_material("linear-elastic", E=E, nu=NU)
    problem = Problem(model, {"body": material}, [contact], symmetry=["body.y"])
    observer = Observer(problem, steps)
    assert np.isnan(observer.numbers()["contacts"][0]["radius"])
    for accepted in Solver(problem, steps).run():
        last = accepted
    return contact, observer.numbers(last)["contacts"][0]


@pytest.mark.parametrize(
    ("mortar", "n", "peak", "size"),
    [
        (True, 4, 0.04, 0.02),
        pytest.param(True, 8, 0.01, 0.01, marks=pytest.mark.slow),
        pytest.param(False, 8, 0.05, 0.05, marks=pytest.mark.slow),
    ],
)
def test_peak_radius_and_area(
    half_spaces: Any, mortar: bool, n: int, peak: float, size: float
) -> None:
    """Requirement: peak, its place, radius and area of Hertz, of a quarter, for nodes and points.

    Tolerance: of the peak what pressures have, 4 and 1 % at nodes; points alternate by 5 %, so that
    the largest may be anywhere within half a radius. The edge of contact is known to a part of a
    facet, 2 and 1 % of the radius at nodes, 5 % where whole points touch or do not. Areas are those
    of the reference, the radius is that of the places of now: they differ by the strain, 0.5 %.
    """
    _, found = pressed(half_spaces, n, mortar)
    force = 4.0 * abs(found["force"][2])
    radius = (0.75 * force * RADIUS * (1.0 - NU**2) / E) ** (1.0 / 3.0)
    assert found["max_pressure"] == pytest.approx(1.5 * force / (np.pi * radius**2), rel=peak)
    assert np.linalg.norm(found["max_pressure_at"][:2]) < (1e-6 if mortar else 0.5 * radius)
    assert found["radius"] == pytest.approx(radius, rel=size)
    assert 4.0 * found["area"] == pytest.approx(np.pi * radius**2, rel=2.1 * size)


def over_facets(drawn: DataSet, name: str, points: Floats) -> Floats:
    """Integral of a field over the polygons between the nodes, with their shape functions."""
    cells = drawn.cells["Polys"]
    corners = cells["connectivity"].reshape(-1, int(cells["offsets"][1]))
    x, values = points[corners], drawn.point_data[name][corners]
    total = np.zeros(values.shape[2:])
    for a in (0.5 - 0.5 / np.sqrt(3.0), 0.5 + 0.5 / np.sqrt(3.0)):
        for b in (0.5 - 0.5 / np.sqrt(3.0), 0.5 + 0.5 / np.sqrt(3.0)):
            shape = np.array([(1 - a) * (1 - b), a * (1 - b), a * b, (1 - a) * b])
            along = np.array([[b - 1, 1 - b, b, -b], [a - 1, -a, a, 1 - a]])
            tangents = along @ x
            area = 0.25 * np.linalg.norm(np.cross(tangents[:, 0], tangents[:, 1]), axis=1)
            total += np.einsum("m,k,mk...->...", area, shape, values)
    return total


@pytest.mark.parametrize(
    ("order", "current_area", "bound"),
    [
        (1, False, 1e-12),
        (1, True, 2e-4),
        pytest.param(2, False, 0.01, marks=pytest.mark.slow),
    ],
)
def test_total_of_the_field(half_spaces: Any, order: int, current_area: bool, bound: float) -> None:
    """Requirement: tractions integrated over the facets, of the reference or of now, are the force.

    Tolerance: dual weights are the integrals of the shape functions, so that on flat facets of
    order 1 rounding is left. The area of now of a node is that of its mean tangents, which facets
    that turn against each other leave by the square of the angle, here 1/100. Facets of order 2
    are four pieces each, whose own shape functions have other integrals: 0.3 % here, from where
    the pressure begins within a facet.
    """
    contact, found = pressed(half_spaces, 3, True, order, current_area=current_area)
    drawn = slave_points([contact])
    assert drawn is not None
    places = drawn.points if current_area else contact.quadrature.reference
    assert over_facets(drawn, "traction", places)[2] == pytest.approx(found["force"][2], rel=bound)
