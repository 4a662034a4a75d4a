"""Temperatures and damage beside a displacement with contact.

Requirement: other fields of a mixed problem are what they are without contact, or in closed form.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from tests.verification import mixed_problems as mixed
from tests.verification.mixed_problems import PRESS_AND_DRAG, WAYS, Held, on_plate, pad

from anisocontact.base.fenicsx import basix, fem, ufl
from anisocontact.contact import Contact
from anisocontact.interface import ContactLaw
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import Model
from anisocontact.solver import ContactProblem

import dolfinx.mesh
from dolfinx.fem import petsc as fem_petsc

ROOT = Path(__file__).parents[2]


def off(one: np.ndarray, other: np.ndarray) -> float:
    """Largest difference over the largest value."""
    return float(np.abs(one - other).max() / np.abs(other).max())


ELASTIC, POISSON, ALPHA = 1e6, 0.3, 1e-4


def _stress(u: Any, heat: Any, alpha: float) -> Any:
    strain = ufl.sym(ufl.grad(u)) - alpha * heat * ufl.Identity(3)
    lame = ELASTIC * POISSON / ((1.0 + POISSON) * (1.0 - 2.0 * POISSON))
    return lame * ufl.tr(strain) * ufl.Identity(3) + ELASTIC / (1.0 + POISSON) * strain


def _thermal(alpha: float, conductivity: Any, n: int = 3) -> tuple[mixed.Given, list[Any], Any]:
    """A pad with a temperature beside its displacement: 0 at the top, 100 at the bottom."""
    g = pad(n, "none", 1)
    mesh = g.space.mesh
    cell = mesh.basix_cell()
    vector, scalar = basix.ufl.element("P", cell, 1, shape=(3,)), basix.ufl.element("P", cell, 1)
    space = fem.functionspace(mesh, basix.ufl.mixed_element([vector, scalar]))
    w, test = fem.Function(space), ufl.TestFunction(space)
    (u, heat), (v, q) = ufl.split(w), ufl.split(test)
    form = ufl.inner(_stress(u, heat, alpha), ufl.sym(ufl.grad(v))) * ufl.dx
    form += ufl.inner(conductivity(heat) * ufl.grad(heat), ufl.grad(q)) * ufl.dx
    own = space.sub(1).collapse()[0]
    bcs = []
    for group, value in (("pad.top", 0.0), ("pad.bottom", 100.0)):
        given = fem.Function(own)
        given.x.array[:] = value
        dofs = fem.locate_dofs_topological((space.sub(1), own), 2, g.facets[group])
        bcs.append(fem.dirichletbc(given, dofs, space.sub(1)))
    model = Model.of(space.sub(0), g.facets)
    return mixed.Given(model, space, space.sub(0), w, form, g.facets), bcs, own


def in_order(held: Held) -> np.ndarray:
    """Displacement of the nodes in the order of their places."""
    places = held.given.model.space.tabulate_dof_coordinates().round(9)
    return held.problem.nodal[np.lexsort(places.T)]


@pytest.mark.parametrize("way", WAYS)
def test_thermoelastic(way: str) -> None:
    """Heated from below and dragged: a temperature that is an unknown, and one that was solved for
    before, give the same forces and displacements.

    Source: conduction does not know of the displacement. Tolerance 1e-7: residuals are solved to
    1e-8 (measured 2e-9).
    """
    g, bcs, _ = _thermal(ALPHA, lambda _: 1.0)
    whole = Held(g, [on_plate(g, **WAYS[way])], bcs)
    forces = whole.go(PRESS_AND_DRAG)
    alone = pad(3, "none", 1)
    heats = fem.functionspace(alone.space.mesh, ("P", 1))
    a, q = ufl.TrialFunction(heats), ufl.TestFunction(heats)
    ends = []
    for group, value in (("pad.top", 0.0), ("pad.bottom", 100.0)):
        dofs = fem.locate_dofs_topological(heats, 2, alone.facets[group])
        ends.append(fem.dirichletbc(value, dofs, heats))
    heat = fem_petsc.LinearProblem(
        ufl.inner(ufl.grad(a), ufl.grad(q)) * ufl.dx,
        fem.Constant(heats.mesh, 0.0) * q * ufl.dx,
        bcs=ends,
        petsc_options_prefix="heat_",
        petsc_options={"ksp_type": "preonly", "pc_type": "lu"},
    ).solve()
    v = ufl.TestFunction(alone.space)
    form = ufl.inner(_stress(alone.w, heat, ALPHA), ufl.sym(ufl.grad(v))) * ufl.dx
    one = mixed.Given(alone.model, alone.space, alone.space, alone.w, form, alone.facets)
    parts = Held(one, [on_plate(one, **WAYS[way])])
    assert off(forces, parts.go(PRESS_AND_DRAG)) < 1e-7
    assert off(in_order(whole), in_order(parts)) < 1e-7


def test_a_field_that_hardly_acts_on_the_body_is_solved_for_all_the_same() -> None:
    """A conductivity `1 + (T/40)^3` and next to no expansion: `T + T (T/40)^3/4` is linear along z.

    Source: Kirchhoff's transformation, of which linear elements have the values at the nodes.
    Tolerance 1e-8: its rows are solved to that by themselves; as forces of expansion they would be
    nothing beside those of contact.
    """
    g, bcs, _ = _thermal(1e-16, lambda heat: 1.0 + (heat / 40.0) ** 3, 6)
    Held(g, [on_plate(g)], bcs).go([(0.0, 0.0, -1e-4)])
    heat = g.w.sub(1).collapse()
    z = heat.function_space.tabulate_dof_coordinates()[:, 2]
    transformed = heat.x.array * (1.0 + (heat.x.array / 40.0) ** 3 / 4.0)
    linear = 100.0 * (1.0 + 2.5**3 / 4.0) * (1.0 - z / mixed.HEIGHT)
    assert transformed == pytest.approx(linear, rel=1e-8, abs=1e-8 * linear.max())


def _damaged(toughness: float) -> tuple[mixed.Given, Any]:
    """A pad with a damage beside its displacement, `(1 - d)^2 W + G_c/2 (d^2/l + l |grad d|^2)`."""
    g = pad(2, "none", 1)
    mesh, cell = g.space.mesh, g.space.mesh.basix_cell()
    vector, scalar = basix.ufl.element("P", cell, 1, shape=(3,)), basix.ufl.element("P", cell, 1)
    space = fem.functionspace(mesh, basix.ufl.mixed_element([vector, scalar]))
    w = fem.Function(space)
    u, d = ufl.split(w)
    stored = 0.5 * ufl.inner(_stress(u, 0.0, 0.0), ufl.sym(ufl.grad(u)))
    length = 0.2
    of_crack = toughness / 2.0 * (d**2 / length + length * ufl.inner(ufl.grad(d), ufl.grad(d)))
    total = ((1.0 - d) ** 2 * stored + of_crack) * ufl.dx
    form = ufl.derivative(total, w, ufl.TestFunction(space))
    model = Model.of(space.sub(0), g.facets)
    return mixed.Given(model, space, space.sub(0), w, form, g.facets), length


def test_damage() -> None:
    """A pad that is pressed without friction and softens all over: `d = 2 W / (G_c/l + 2 W)`,
    `W = E e^2 / 2`, and the pressure `(1 - d)^2 E e`.

    Source: a uniform state of the model of damage by a gradient [Bourdin Francfort Marigo 2000].
    Damage and body know nothing of each other at rest. Tolerance 1e-8: what Newton leaves.
    """
    toughness = 400.0
    g, length = _damaged(toughness)
    smooth = ContactLaw(NormalLaw(penalty=1e9), Adhesion(stiffness=1.0), Friction(coefficients=0.0))
    contact = Contact(g.model, "pad.bottom", mixed.PLATE, smooth, current_area=False, mortar=False)
    space, bcs = g.displacement, []
    lowered = fem.Constant(g.space.mesh, 0.0)
    for i in range(3):
        part = space.sub(i)
        held = (
            g.facets["pad.top"]
            if i == 2
            else dolfinx.mesh.locate_entities_boundary(
                g.space.mesh, 2, lambda x, i=i: np.isclose(x[i], 0.0)
            )
        )
        dofs = fem.locate_dofs_topological(part, 2, held)
        value = lowered if i == 2 else fem.Constant(g.space.mesh, 0.0)
        bcs.append(fem.dirichletbc(value, dofs, part))
    problem = ContactProblem(g.form, g.w, bcs=bcs, contacts=[contact])
    for i in range(1, 5):
        lowered.value = -0.01 * i
        problem.solve()
        pressure = contact.resultant()[0][2]
        strain = (0.01 * i - pressure / 1e9) / mixed.HEIGHT
        twice = ELASTIC * strain**2
        damage = twice / (toughness / length + twice)
        assert g.w.sub(1).collapse().x.array == pytest.approx(damage, rel=1e-8)
        assert pressure == pytest.approx((1.0 - damage) ** 2 * ELASTIC * strain, rel=1e-8)
    assert damage > 0.5
