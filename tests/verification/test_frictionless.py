"""Contact without friction: coefficients of 0 with every rule, master, method and strategy."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from anisocontact.anisotropy import make_directions
from anisocontact.base import registry
from anisocontact.base.errors import InputError
from anisocontact.interface import ContactLaw, Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.surfaces import make_surface

RULES = [entry.name for entry in registry.sliding_rules()]
FORMS = [entry.name for entry in registry.evolution_forms()]


def _rule(name: str) -> dict[str, Any]:
    return {"sliding_rule": name} | ({"slip_axes": 1} if name == "slip-ellipse" else {})


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("rule", RULES)
def test_a_point_without_friction_carries_pressure_alone(rule, form):
    """|T| <= 0 leaves T = 0 and no elastic slip; nothing is stored or dissipated in the tangent.

    The Kuhn-Tucker conditions with mu = 0. On a cylinder, along a path askew to its lines; the
    tangent against central differences, whose error at steps of 1e-6 of a radius is some 1e-6.
    """
    surface = make_surface("cylinder", point=(0, 0, 0), axis=(0, 1, 0), radius=2.0)
    friction = Friction(coefficients=0, **_rule(rule))
    law = Interface(
        surface, NormalLaw(penalty=1e3), Adhesion(stiffness=300.0), friction, evolution=form
    )
    x = np.array([[0.1, 0.3, 1.98]])
    state = law.initial_state(x)
    for _ in range(3):
        before, x = state, x + np.array([[0.05, 0.1, -0.001]])
        found = law.update(before, x)
        state = found.state
        assert not found.failed.any() and found.status.tolist() == [2]
        friction_force = found.traction - found.pressure[:, None] * found.normal
        assert np.abs(friction_force).max() <= 1e-13 * found.pressure[0]
        for name in ("stored", "elastic", "dissipation", "energy_adhesion"):
            assert np.all(state[name] == 0.0)
        assert state["slip_accumulated"][0] > 0.0
        sides = [
            [law.update(before, x + sign * 1e-6 * e).traction[0] for sign in (1, -1)]
            for e in np.eye(3)
        ]
        numerical = np.array([(plus - minus) / 2e-6 for plus, minus in sides]).T
        assert found.tangent[0] == pytest.approx(numerical, abs=1e-5 * 1e3)


@pytest.mark.parametrize("adhesion", [e.name for e in registry.adhesion_models()])
def test_without_friction_no_adhesion_holds(adhesion):
    """Whatever the adhesion, the limit of the force is zero.

    Also where the gap closes within the step, so that the time in contact depends on the gap: the
    tangent is that of the penalty, eps n (x) n, to rounding.
    """
    values = {"relaxation_time": 2, "viscosity": 3, "stiffness_maxwell": 4, "relaxation": 1}
    values |= {"stiffness": 100, "stiffness_instant": 50}
    (entry,) = (e for e in registry.adhesion_models() if e.name == adhesion)
    given = {p.name: values[p.name] for p in entry.parameters if p.required}
    plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    law = Interface(
        plane, NormalLaw(penalty=10), Adhesion(adhesion, **given), Friction(coefficients=0)
    )
    found = law.update(law.initial_state([[0, 0, -0.1]]), [[0.3, 0.2, -0.1]], 0.5)
    assert found.traction[0].tolist() == [0.0, 0.0, 1.0]
    closing = law.update(law.initial_state([[0, 0, 0.1]]), [[0.3, 0.2, -0.1]], 0.5)
    assert closing.traction[0].tolist() == [0.0, 0.0, 1.0]
    assert closing.tangent[0] == pytest.approx(np.diag([0.0, 0.0, -10.0]), abs=1e-12)


def test_what_has_no_ellipse_is_refused():
    """A force that is limited along one axis and zero along the other, F not a number."""
    marks = make_directions("constant", vector=(1, 0, 0))
    for given in ((0.3, 0.0), (0.0, 0.3)):
        with pytest.raises(InputError, match=r"friction\.coefficients: .* both > 0, or both 0"):
            Friction(coefficients=given, directions=marks)
    for small in (1e-200, (0.3, 1e-200)):
        with pytest.raises(InputError, match=r"coefficients: .* must be 0, or from 1e-50"):
            Friction(coefficients=small, directions=marks)
    with pytest.raises(InputError, match="infinite without friction"):
        Friction(coefficients=0).tensor(
            make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1)), [[0, 0]]
        )


def test_one_number_is_isotropic_everywhere():
    """One number stands for what is the same in all directions, in Python as in case files."""
    assert Friction(coefficients=0.3).named == Friction(coefficients=(0.3, 0.3)).named
    assert Adhesion(stiffness=5).named == Adhesion(stiffness=(5, 5)).named
    maxwell = Adhesion("maxwell", stiffness=5, relaxation_time=np.array(2.0))
    assert maxwell.named[1]["relaxation_time"] == (2.0, 2.0)
    two = Friction("he-curnier", alpha=0.3)
    assert two.named[1]["alpha"] == (0.3, 0.0, 0.0) and two.directions is None
    assert Friction("he-curnier", alpha=0).frictionless
    full = Adhesion("general-linear", relaxation=1, stiffness_instant=7)
    assert full.named[1]["stiffness_instant"] == (7.0, 0.0, 0.0, 7.0)
    rule = Friction(coefficients=1, sliding_rule="slip-ellipse", slip_axes=2).rule
    assert rule[1]["slip_axes"] == (2.0, 2.0)


def test_two_surfaces_that_are_the_same_all_around_give_coulomb():
    """C = mu I of two surfaces is the circle of one, so that no direction counts."""
    plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    laws = [Friction("he-curnier", alpha=0.3), Friction(coefficients=0.3)]
    one, other = (law.tensor(plane, [[0.0, 0.0]]) for law in laws)
    assert one == pytest.approx(other, rel=1e-14)


def test_full_tensors_with_axes_need_directions():
    """Tensors that differ along two axes would silently be along the coordinates."""
    with pytest.raises(InputError, match=r"adhesion\.directions: .* stiffness_instant"):
        Adhesion("general-linear", relaxation=1, stiffness_instant=(2, 0, 0, 1))


YOUNG, SIZE, PRESS = 1000.0, 0.5, 0.02
PENALTY = 10.0 * YOUNG / 0.5

BODIES = [
    pytest.param(kind, method, strategy, id=f"{kind}-{method}-{strategy}")
    for kind in ("rigid", "tilted", "tetrahedra", "order 2", "facets", "mortar")
    for method in ("penalty", "newton", "uzawa")
    for strategy in ("direct", "condensed", "iterative")
    if not (kind == "mortar" and method != "penalty")
    if strategy == "direct" or kind in ("rigid", "facets")
]


@pytest.mark.parametrize(("kind", "method", "strategy"), BODIES)
def test_a_block_on_a_frictionless_table_is_in_uniaxial_stress(kind, method, strategy):
    """Pressed by d, free to widen: p = d / (L/E + 1/eps), and not a force along the table.

    Hooke's law with the penalty in series; with multipliers 1/eps is 0 but for the tolerance of
    1e-6 of a facet, a share SIZE 1e-6 / PRESS = 2.5e-5 of the way. Newton's method ends at 1e-10
    of the forces. At slave nodes nu = 0: what widens comes to lie on further facets.
    """
    pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)
    series = 1.0 / PENALTY if method == "penalty" else 0.0
    pressure = PRESS / (SIZE / YOUNG + series)
    force, normal = _pressed(kind, method, strategy, pressure)
    along = force @ normal
    assert along == pytest.approx(pressure, rel=1e-7 if method == "penalty" else 2.5e-5)
    assert np.linalg.norm(force - along * normal) <= 1e-8 * pressure


def _pressed(
    kind: str, method: str, strategy: str, pressure: float
) -> tuple[np.ndarray, np.ndarray]:
    """Force on the slave and normal of the table; a tilted block is pressed by the pressure."""
    from anisocontact.bulk import make_material
    from anisocontact.mesh import Body, BoxSpec, Placement, Rotation, build_mesh
    from anisocontact.solver import Problem, Solver, Step

    turn = Rotation((0, 1, 0), angle_deg=30.0 if kind == "tilted" else 0.0)
    normal = turn.matrix() @ (0.0, 0.0, 1.0)
    cell = "tetrahedron" if kind == "tetrahedra" else "hexahedron"
    order = 2 if kind == "order 2" else 1
    block = BoxSpec((0, 0, 0), (1, 1, SIZE), (2, 2, 2), cell=cell, order=order)
    bodies = [Body("block", block, Placement(rotate=turn))]
    elastic = make_material("linear-elastic", E=YOUNG, nu=0.0 if kind == "mortar" else 0.3)
    step: dict[str, Any] = {"displacement": {"block.top": {"z": -PRESS}}}
    if kind == "tilted":
        step = {"traction": {"block.top": dict(zip("xyz", -pressure * normal, strict=True))}}
    if kind in ("facets", "mortar"):
        # a table of facets: a base without a node that is not held
        base = BoxSpec((-0.5, -0.5, -0.5), (2, 2, 0.5), (4, 4, 1))
        bodies.append(Body("base", base))
        for face in ("bottom", "top"):
            step["displacement"][f"base.{face}"] = dict.fromkeys("xyz", 0.0)
    model = build_mesh(bodies)
    contact = _contact(kind, method, model, normal)
    materials = dict.fromkeys(model.body_names(), elastic)
    problem = Problem(model, materials, [contact], symmetry=["block.left", "block.front"])
    solver = Solver(
        problem, [Step("press", 1, **step)], strategy=strategy, options={"snes_rtol": 1e-10}
    )
    for _ in solver.run():
        pass
    return contact.resultant()[0], normal


def _contact(kind: str, method: str, model: Any, normal: np.ndarray) -> Any:
    from anisocontact.contact import Contact
    from anisocontact.interface import Augmentation

    laws = NormalLaw(penalty=PENALTY), Adhesion(stiffness=PENALTY), Friction(coefficients=0)
    if kind == "mortar":
        law = ContactLaw(*laws)
        return Contact(model, "block.bottom", "base.top", law=law, current_area=False, mortar=True)
    augmented = None if method == "penalty" else Augmentation(multipliers=method)
    options: dict[str, Any] = {"augmentation": augmented, "current_area": False, "mortar": False}
    if kind == "facets":
        return Contact(model, "block.bottom", "base.top", law=ContactLaw(*laws), **options)
    plane = make_surface("plane", point=(0, 0, 0), normal=normal)
    return Contact(model, "block.bottom", Interface(plane, *laws), **options)
