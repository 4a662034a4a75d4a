"""Two rings that are led radially onto each other."""

import numpy as np
import pytest
from tests.verification.test_cylindrical import led, run


@pytest.fixture(autouse=True)
def _needs_dolfinx(fe):
    """All tests here need DOLFINx."""


def test_two_rings_pressed_on_each_other():
    """A twelfth of two concentric rings in contact, as in the deck `ringfcontact1` of CalculiX.

    The inner face is led outwards and the outer one inwards, both held along the axis and about it,
    the cut faces follow each other, ends are free.

    Requirement: the contact force of the axisymmetric model, in which rings that stick are one.
    Source: that model, 40 cells through the wall. Tolerance: 0.5 %, of 5 quadratic cells through
    each wall and 2 along the axis.
    """
    from anisocontact.bulk import make_material
    from anisocontact.contact import Contact
    from anisocontact.interface import Augmentation, ContactLaw
    from anisocontact.laws import Adhesion, Friction, NormalLaw
    from anisocontact.mesh import Axisymmetric, Body, RingSpec, build_mesh, make_shape
    from anisocontact.solver import CyclicSymmetry, Problem, Step

    steel, way, angle, height = make_material("linear-elastic", E=210e3, nu=0.3), 5e-3, 30.0, 0.1
    turn = {"start": np.radians(90.0), "end": np.radians(90.0 + angle)}
    walls = {"inside": (1.0, 1.5), "outside": (1.5, 2.0)}
    bodies = [
        Body(name, RingSpec(*wall, height, (5, 5, 2), order=2, **turn))
        for name, wall in walls.items()
    ]
    model = build_mesh(bodies)
    law = ContactLaw(NormalLaw(penalty=1e7), Adhesion(stiffness=1e7), Friction(coefficients=0.2))
    sides = "outside.inner", "inside.outer"
    contact = Contact(model, *sides, law, mortar=True, augmentation=Augmentation())
    cut = [CyclicSymmetry(f"{name}.end", f"{name}.start", 12) for name in walls]
    problem = Problem(model, dict.fromkeys(walls, steel), [contact], cyclic=cut)
    still = {"tangential": 0.0, "axial": 0.0}
    ends = {
        "inside.inner": led(radial=way, **still),
        "outside.outer": led(radial=-way, **still),
    }
    run(problem, Step("press", 2, cylindrical=ends))
    half = 0.5 * np.radians(angle)
    middle = np.radians(90.0) + half
    force = contact.resultant()[0] @ [np.cos(middle), np.sin(middle), 0.0]

    wall = make_shape("rectangle", origin=(1, 0), size=(1, height), cells=(40, 6), order=2)
    flat = build_mesh([Body("ring", wall)], idealisation=Axisymmetric())
    whole = Problem(flat, {"ring": steel})
    hold = {"ring.left": {"x": way, "y": 0.0}, "ring.right": {"x": -way, "y": 0.0}}
    run(whole, Step("press", 1, hold))
    # r * integral of sigma_r along z is that of any section, less hoop stresses: at the middle
    assert force == pytest.approx(2.0 * np.sin(half) * _radial(whole, 1.5), rel=5e-3)


def _radial(problem, radius):
    """Minus r times the integral of the radial stress along z, mean over two cells about r."""
    import ufl

    from dolfinx import fem

    u, x = problem.u, ufl.SpatialCoordinate(problem.model.mesh)
    modulus, shear = 210e3 * 0.3 / 1.3 / 0.4, 210e3 / 2.6
    strain = u[0].dx(0) + u[0] / x[0] + u[1].dx(1)
    near = ufl.conditional(ufl.le(abs(x[0] - radius), 0.025), 1.0, 0.0)
    stress = modulus * strain + 2.0 * shear * u[0].dx(0)
    return -fem.assemble_scalar(fem.form(x[0] * stress * near * ufl.dx)) / 0.05
