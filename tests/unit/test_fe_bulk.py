"""Materials by name and the stiffness of the bodies."""

import numpy as np
import pytest

from anisocontact.base.errors import InputError

CELLS = [("hexahedron", 1), ("hexahedron", 2), ("tetrahedron", 1), ("tetrahedron", 2)]


@pytest.fixture(autouse=True)
def _needs_dolfinx(fe):
    """All tests here need DOLFINx."""


def test_registered_materials_describe_themselves():
    """Requirement: parameters with units and bounds come from the registry."""
    from anisocontact.bulk import materials

    (entry,) = [m for m in materials() if m.name == "linear-elastic"]
    assert [(p.name, p.unit) for p in entry.parameters] == [("E", "stress"), ("nu", "1")]


@pytest.mark.parametrize(
    ("parameters", "words"),
    [
        ({"E": 0.0, "nu": 0.3}, ("material.a.E", "0.0", "> 0")),
        ({"E": -1.0, "nu": 0.3}, ("material.a.E", "-1.0", "> 0")),
        ({"E": 1.0, "nu": 0.5}, ("material.a.nu", "0.5", "< 0.5")),
        ({"E": 1.0, "nu": -1.0}, ("material.a.nu", "-1.0", "> -1")),
        ({"E": 1.0, "nu": float("nan")}, ("material.a.nu", "nan", "finite")),
        ({"E": "steel", "nu": 0.3}, ("material.a.E", "steel", "number")),
        ({"E": 1.0}, ("material.a.nu", "Poisson")),
        ({"E": 1.0, "nu": 0.3, "rho": 1.0}, ("material.a.rho", "E, nu")),
    ],
)
def test_bad_parameters_are_one_line(parameters, words):
    """Requirement: one line naming field, what was given and what is allowed."""
    from anisocontact.bulk import make_material

    with pytest.raises(InputError) as caught:
        make_material("linear-elastic", field="material.a", **parameters)
    assert all(word in str(caught.value) for word in words)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("lists", "said"),
    [
        ({"g": [], "tau": [1.0]}, r"a.g: 0 shares given, 1 needed"),
        ({"g": [], "tau": []}, r"a.tau: \[\] given, one relaxation time or more is needed"),
        ({"g": [0.2], "tau": [1.0], "k": [0.1, 0.1]}, r"a.k: 2 shares given, 1 needed"),
    ],
)
def test_shares_that_relax_are_as_many_as_their_times(lists, said):
    """Requirement: only `k` may be left out; lists that are empty let nothing relax."""
    from anisocontact.bulk import make_material

    assert make_material("viscoelastic", E=1.0, nu=0.3, g=[0.0], tau=[1.0], k=[0.1])
    with pytest.raises(InputError, match=said):
        make_material("viscoelastic", field="a", E=1.0, nu=0.3, **lists)


def test_unknown_material_suggests_the_near_one():
    """Requirement: a misspelt name gets the near one."""
    from anisocontact.bulk import make_material

    with pytest.raises(InputError, match=r"material.a.model: .*did you mean 'linear-elastic'"):
        make_material("linear-elastik", field="material.a", E=1.0, nu=0.3)


@pytest.mark.parametrize(("cell", "order"), CELLS)
def test_rigid_motion_costs_nothing_and_uniaxial_stress_is_exact(fe, cell, order):
    """Forces of linear displacement fields.

    Requirement: linear elasticity on every cell and order. Source: a rigid motion is free of
    strain; under uniaxial stress s the energy is s^2 V / 2E. Tolerance: round-off, 1e-12.
    """
    block = fe.block(fe.interface(), cell=cell, order=order)
    points = block.model.space.tabulate_dof_coordinates()
    force = block.problem.new_vector()
    rigid = np.array([0.3, -0.2, 0.1]) + np.cross([0.2, 0.5, -0.4], points)
    force.array[:] = rigid.reshape(-1)
    scale = np.abs(block.problem.bulk.diagonal.array).max()
    assert np.abs(block.problem.bulk.force(force).array).max() < 1e-12 * scale

    young, nu, volume, stress = 1000.0, 0.3, 0.5, 7.0
    strain = stress / young * np.array([-nu, -nu, 1.0])
    force.array[:] = (points * strain).reshape(-1)
    energy = block.problem.bulk.energy(force)
    assert energy == pytest.approx(0.5 * stress**2 / young * volume, rel=1e-12)


def test_bodies_have_their_own_material():
    """Requirement: a material for each body. Source: energy of a uniaxial stretch, per volume."""
    from anisocontact.bulk import LinearBulk, make_material
    from anisocontact.mesh import BoxSpec, build_box

    boxes = {
        "soft": BoxSpec((0, 0, 0), (1, 1, 1), (1, 2, 1)),
        "hard": BoxSpec((0, 0, 2), (1, 1, 2), (2, 1, 1)),
    }
    model = build_box(boxes)
    young = {"soft": 10.0, "hard": 70.0}
    materials = {k: make_material("linear-elastic", E=e, nu=0.0) for k, e in young.items()}
    bulk = LinearBulk(model, materials)
    u = bulk.stiffness.createVecRight()
    points = model.space.tabulate_dof_coordinates()
    u.array[:] = (points * [0.1, 0.0, 0.0]).reshape(-1)
    assert bulk.energy(u) == pytest.approx(0.5 * 0.1**2 * (10.0 * 1.0 + 70.0 * 2.0), rel=1e-12)


def test_a_material_that_forgets_a_variable_is_one_line():
    """Requirement: what `advance` gives are the variables of `history`."""
    import ufl

    from anisocontact.bulk import NonlinearBulk
    from anisocontact.mesh import BoxSpec, build_box

    class Forgets:
        linear, young, history = False, 1.0, {"damage": (), "strain": (3, 3)}

        def advance(self, u, before):
            return {"damage": before["damage"]}

        def piola(self, u, before):
            return (1.0 - before["damage"]) * ufl.grad(u)

    model = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1))})
    said = r"material.block: advance gives damage, history has damage, strain"
    with pytest.raises(InputError, match=said):
        NonlinearBulk(model, {"block": Forgets()})
