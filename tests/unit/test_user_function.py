"""Energies and stresses of scripts that can be none, and values that are no numbers: one line."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import fem, ufl
from anisocontact.bulk import UserEnergy, UserStress
from anisocontact.contact import Contact
from anisocontact.laws import Friction
from anisocontact.mesh import BoxSpec, build_box
from anisocontact.solver import ContactProblem
from anisocontact.surfaces import make_surface

NAN = float("nan")
WRONG = {
    "tensor": (lambda F: F.T * F, lambda F: ufl.inner(F, F), r"shape \(.*\), \(.*\) needed"),
    "no number": (lambda F: None, lambda F: [F], "failed: .*Invalid type conversion"),
    "constant": (lambda F: 5.0, lambda F: ufl.Identity(3), "does not depend on F, stiffness"),
    "nothing": (lambda F: 0.0 * ufl.tr(F), lambda F: 0.0 * F, "does not depend on F, stiffness"),
    "arguments": (lambda: 1.0, lambda F, G: F, "failed: TypeError: .* argument"),
    "raises": (lambda F: 1 / 0, lambda F: 1 / 0, r"failed: .*line \d+: ZeroDivisionError"),
    "nan": (lambda F: NAN * ufl.tr(F), lambda F: NAN * F, "with nan, finite numbers needed"),
    "complex": (lambda F: 1j * ufl.tr(F), lambda F: 1j * F, "with 1j, finite numbers needed"),
}


@pytest.mark.parametrize("wrong", WRONG)
def test_a_function_that_is_no_energy_or_stress(wrong):
    """Requirement: when the material is made, with the name of what was given."""
    energy, piola, said = WRONG[wrong]
    for kind, function, name in ((UserEnergy, energy, "energy"), (UserStress, piola, "piola")):
        with pytest.raises(InputError, match=f"^{name} .*{said}") as caught:
            kind(function, 100.0)
        assert len(str(caught.value).splitlines()) == 1


def _problem():
    model = build_box({"pad": BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1))})
    plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    contact = Contact(model, "pad.bottom", plane, Friction(coefficients=0.3))
    u, v = fem.Function(model.space), ufl.TestFunction(model.space)
    form = 100.0 * ufl.inner(ufl.sym(ufl.grad(u)), ufl.sym(ufl.grad(v))) * ufl.dx
    down = fem.Constant(model.mesh, (0.0, 0.0, -0.01))
    top = fem.dirichletbc(down, model.nodes("pad.top"), model.space)
    return ContactProblem(form, u, bcs=[top], contacts=[contact]), down, contact


@pytest.mark.parametrize("wrong", [np.nan, np.inf])
def test_values_that_are_not_finite_are_named(wrong):
    """Requirement: the unknown or the condition is named, not a residual or a penalty."""
    problem, down, _ = _problem()
    problem.u.x.array[3] = wrong
    with pytest.raises(InputError, match=r"^u: 1 values that are not finite given$"):
        problem.solve()
    problem.u.x.array[:] = 0.0
    down.value[1:] = wrong
    with pytest.raises(InputError, match=r"^bcs\[0\]: 8 values that are not finite given$"):
        problem.solve()
    down.value[:] = 0.0, 0.0, -0.01
    assert problem.solve() > 0


@pytest.mark.parametrize("given", [np.zeros((3, 3)), np.zeros(24), None, "u"])
def test_displacements_of_other_nodes_are_one_line(given):
    """Requirement: those of all local nodes are needed; other types of numbers are taken."""
    contact = _problem()[2]
    with pytest.raises(InputError, match=r"^u: "):
        contact.update(given, 1.0)
    down = np.tile([0, 0, -1], (8, 1))
    wanted = contact.update(down.astype(float), 1.0).pressure
    for other in (down, down.tolist(), down.astype(np.float32), np.repeat(down, 2, axis=1)[:, ::2]):
        assert np.array_equal(contact.update(other, 1.0).pressure, wanted)
