"""Soft bodies on rigid surfaces at finite strain: tractions act on the area of now."""

from __future__ import annotations

import numpy as np
import pytest
from tests.conftest import difference_errors

from anisocontact.anisotropy import make_directions
from anisocontact.bulk import NeoHookean
from anisocontact.contact import Contact
from anisocontact.interface import Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import BoxSpec, Model, build_box
from anisocontact.solver import Problem, Solver, Step
from anisocontact.surfaces import Surface, make_surface

RUBBER = NeoHookean(E=1000.0, nu=0.3)
SHEAR, LAME = 1000.0 / 2.6, 1000.0 * 0.3 / (1.3 * 0.4)  # G = E / 2(1 + nu) and lambda


def _problem(model: Model, surface: Surface, mu: float, stiffness: float = 1e4) -> Problem:
    marks = make_directions("constant", vector=(1, 0, 0), angle=np.pi / 6)
    interface = Interface(
        surface,
        NormalLaw(penalty=1e4),
        Adhesion(stiffness=(stiffness, 0.5 * stiffness), directions=marks),
        Friction(coefficients=(mu, 0.5 * mu), directions=marks),
    )
    contact = Contact(model, "block.bottom", interface, current_area=True, mortar=False)
    return Problem(model, {"block": RUBBER}, [contact])


@pytest.mark.parametrize(
    ("cell", "order"),
    [("hexahedron", 1), ("hexahedron", 2), ("tetrahedron", 1), ("tetrahedron", 2)],
)
@pytest.mark.parametrize(
    "surface",
    [
        make_surface("sphere", centre=(0.4, 0.5, -2.0), radius=2.0),
        make_surface("cylinder", point=(0.0, 0.4, -1.5), axis=(1, 0.2, 0), radius=1.5),
    ],
    ids=["sphere", "cylinder"],
)
def test_tangent_by_order(surface: Surface, cell: str, order: int) -> None:
    """Halving the step quarters the error of central differences (asserted 3.5 to 4.5).

    Source: the derivative of the area, d|x_1 x x_2| = n . (dx_1 x x_2 + x_1 x dx_2), with the
    block of rubber pressed on a curved surface by 8 % of its height, open, sticking and slipping
    points together, from a random state.
    """
    model = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 0.5), (3, 3, 1), cell=cell, order=order)})
    problem = _problem(model, surface, 0.1)
    moved = {"x": 0.03, "y": 0.0, "z": -0.04}
    for _ in Solver(problem, [Step("press", 2, {"block.top": moved})]).run():
        pass
    rng = np.random.default_rng(4)
    x = problem.accepted()
    x.array[:] += rng.normal(0.0, 1e-3, x.getLocalSize())
    problem.set_load_factor(1.0, 1.0)
    problem.evaluate(x)
    assert problem.contacts[0].counts()["slip"] > 3
    direction = x.duplicate()
    direction.array[:] = rng.normal(size=x.getLocalSize())
    errors = difference_errors(problem, x, direction, (1e-6, 5e-7))
    assert 3.5 < errors[0] / errors[1] < 4.5


@pytest.mark.parametrize("order", [1, 2])
def test_pressure_is_the_cauchy_stress(order: int) -> None:
    """A block pressed flat without friction: the pressure is the Cauchy stress, not the nominal.

    Source: homogeneous compression of a compressible neo-Hookean body,
    `sigma_i = (G (s_i^2 - 1) + lambda ln J) / J` with stretches s, `sigma` zero at the sides. The
    area grows by s_1 s_2, 27 % here, which is how wrong the reference area would be. Tolerance
    1e-6: Newton's 1e-8, and friction, which cannot be zero, has the coefficient 1e-9.
    """
    model = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 1), (2, 2, 2), order=order)})
    plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    problem = _problem(model, plane, 1e-9)
    # symmetry planes at two sides take away the rigid motion and leave the deformation homogeneous
    held = {"block.left": {"x": 0.0}, "block.front": {"y": 0.0}, "block.top": {"z": -0.4}}
    for _ in Solver(problem, [Step("press", 8, held)]).run():
        pass
    contact = problem.contacts[0]
    pressure = contact.last.pressure
    s_z = 0.6 - contact.last.gap.mean()
    s_x = float(contact.points[:, 0].max() / contact.quadrature.reference[:, 0].max())
    log_j = np.log(s_x**2 * s_z)
    across = SHEAR * (s_x**2 - 1.0) + LAME * log_j
    stress = (SHEAR * (s_z**2 - 1.0) + LAME * log_j) / (s_x**2 * s_z)
    assert across == pytest.approx(0.0, abs=1e-6 * SHEAR)
    assert pressure == pytest.approx(np.full(len(pressure), -stress), rel=1e-6)
    assert contact.areas.sum() == pytest.approx(s_x**2, rel=1e-9)
    assert s_x**2 > 1.2
    assert contact.resultant()[0][2] == pytest.approx(-stress * s_x**2, rel=1e-6)
