"""Rings in the plane: shrink fits, and thin ones of any radius."""

from __future__ import annotations

import numpy as np
import pytest
from tests.verification.test_two_dimensions import NU, RUBBER, STEEL, E, run

from anisocontact.base.errors import InputError
from anisocontact.contact import Contact
from anisocontact.interface import ContactLaw
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import (
    Axisymmetric,
    Body,
    PlaneStrain,
    build_mesh,
    make_shape,
)
from anisocontact.solver import Problem, Step


def test_shrink_fit_converges_to_lame():
    """Requirement: contact of two bodies of revolution.

    Source: Lame in plane strain, a tube from 1 to 2 in one from 2 - d to 3, p of the sum of both
    displacements at 2 = d. The error falls with h^2, asked is 0.9 of that rate; penalties of 1000
    layers of cells leave less.
    """
    gap, errors = 1e-4, []
    young, nu = E / (1.0 - NU**2), NU / (1.0 - NU)
    exact = gap * young / (2.0 * ((9.0 + 4.0) / 5.0 + nu + (4.0 + 1.0) / 3.0 - nu))
    for n in (4, 8):
        inner = make_shape("rectangle", origin=(1.0, 0.0), size=(1.0, 0.5), cells=(n, 2))
        outer = make_shape("rectangle", origin=(2.0 - gap, 0.0), size=(1.0, 0.5), cells=(n, 3))
        bodies = [Body("inner", inner), Body("outer", outer)]
        model = build_mesh(bodies, idealisation=Axisymmetric())
        law = ContactLaw(
            NormalLaw(penalty=1e3 * E * n), Adhesion(stiffness=1.0), Friction(coefficients=0)
        )
        contact = Contact(model, "outer.left", "inner.right", law, mortar=False)
        problem = Problem(model, {"inner": STEEL, "outer": STEEL}, [contact])
        ends = {
            f"{one}.{end}": {"y": 0.0} for one in ("inner", "outer") for end in ("bottom", "top")
        }
        run(problem, Step("fit", 1, ends))
        errors.append(
            abs(contact.areas @ contact.last.pressure / contact.areas.sum() / exact - 1.0)
        )
    assert np.log2(errors[0] / errors[1]) > 1.8
    assert errors[1] < 0.01


@pytest.mark.parametrize("radius", [1e2, 1e4, 1e6])
def test_a_thin_ring_is_a_strip(radius: float) -> None:
    """Rings of far larger radius than section, pressed on each other and dragged, are plane strain.

    Source: per length of the circumference they differ by the section over the radius. The foot of
    the lower one is held: no motion is told to be free.
    """
    forces = []
    for ideal, start in ((PlaneStrain(), 0.0), (Axisymmetric(), radius)):
        upper = make_shape("rectangle", origin=(start + 0.3, 0.0), size=(1.0, 0.5), cells=(4, 2))
        lower = make_shape("rectangle", origin=(start, -0.5), size=(1.6, 0.5), cells=(5, 2))
        model = build_mesh([Body("upper", upper), Body("lower", lower)], idealisation=ideal)
        contact = Contact(model, "upper.bottom", "lower.top", Friction(coefficients=0.2))
        problem = Problem(model, {"upper": RUBBER, "lower": RUBBER}, [contact])
        foot = {"lower.bottom": {"x": 0.0, "y": 0.0}}
        press = Step("press", 1, foot | {"upper.top": {"x": 0.0}}, pressure={"upper.top": 20.0})
        run(problem, press, Step("drag", 2, {"upper.top": {"x": 0.05}}))
        length = 2.0 * np.pi * start if start else 1.0
        forces.append(contact.resultant()[0] / length)
    strip, ring = forces
    assert strip[1] > 19.0
    np.testing.assert_allclose(ring, strip, atol=2.0 / radius * strip[1])


def test_what_is_free_of_a_thin_ring_is_told() -> None:
    """Requirement: without a support it moves along its axis and turns about it, no more."""
    shape = make_shape("rectangle", origin=(1e6, 0.0), size=(1.0, 1.0), cells=(2, 2))
    model = build_mesh([Body("b", shape)], idealisation=Axisymmetric(lateral=True))
    problem = Problem(model, {"b": STEEL})
    with pytest.raises(InputError, match="free to move: translation along y and z; it is in no"):
        run(problem, Step("push", 1, {}, pressure={"b.top": 1.0}))
