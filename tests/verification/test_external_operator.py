"""A return mapping as dolfinx-external-operator has it, as a law of points: the page's example."""

import re
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

PAGE = Path(__file__).parents[2] / "docs" / "howto" / "materials.md"
GIVEN = {"E": 70e3, "nu": 0.3}
LIMIT, HARDENING = 250.0, 700.0


@pytest.fixture(autouse=True)
def _needs_dolfinx(fe):
    """All tests here need DOLFINx."""


def law():
    """The law of the page."""
    (text,) = (
        block
        for block in re.findall(
            r"^```python\n(.*?)^```", PAGE.read_text(), re.DOTALL | re.MULTILINE
        )
        if "class ReturnMapping" in block
    )
    space = {}
    exec(text, space)
    return space["ReturnMapping"](**GIVEN, sigma_0=LIMIT, H=HARDENING)


def own():
    """The same of the project."""
    from anisocontact.bulk import make_material

    return make_material("plastic", **GIVEN, yield_stress=LIMIT, hardening=HARDENING)


def state(strain, before):
    """What happens at points."""
    from anisocontact.bulk import PointState

    return PointState(strain, before, 1.0, np.zeros((len(strain), 3)))


def path(count, steps, seed=7):
    """Random symmetric strains that load beyond the yield limit and turn back."""
    rng = np.random.default_rng(seed)
    way = rng.normal(size=(2, count, 3, 3))
    way = 0.5 * (way + way.swapaxes(2, 3))
    return [3e-3 * (np.sin(3.0 * t) * way[0] + t * way[1]) for t in np.linspace(0.0, 1.0, steps)]


def test_components_are_those_of_an_orthonormal_basis():
    """Requirement: there and back, and products of vectors are those of tensors. Source:
    definition. Tolerance: 1e-14."""
    from anisocontact.bulk import from_mandel, slope_from_mandel, to_mandel

    a, b = path(20, 3)[1:]
    assert from_mandel(to_mandel(a)) == pytest.approx(a, abs=1e-14)
    products = np.einsum("na,na->n", to_mandel(a), to_mandel(b))
    assert products == pytest.approx(np.einsum("nij,nij->n", a, b), abs=1e-14)
    matrix = np.random.default_rng(1).normal(size=(20, 6, 6))
    through = from_mandel(np.einsum("nab,nb->na", matrix, to_mandel(a)))
    tensor = np.einsum("nijkl,nkl->nij", slope_from_mandel(matrix), a)
    assert tensor == pytest.approx(through, abs=1e-14)


def test_tangent():
    """Requirement: central differences come to the tangent with the square of their step. Source:
    definition. Tolerance: rate 1.9."""
    from anisocontact.bulk import UserLaw

    one = UserLaw(law())
    before = {"strain": np.zeros((50, 6)), "stress": np.zeros((50, 6)), "p": np.zeros(50)}
    first, *rest = path(50, 4)[1:]
    before = one.update(state(first, before)).after
    strain, way = rest[0], rest[1]
    slope = np.einsum("nijkl,nkl->nij", one.update(state(strain, before)).tangent, way)
    errors = []
    for h in (2e-2, 1e-2, 5e-3):
        up, down = (one.update(state(strain + k * h * way, before)).stress for k in (1, -1))
        errors.append(np.abs((up - down) / (2.0 * h) - slope).max())
    assert np.log2(np.array(errors[:-1]) / errors[1:]).min() > 1.9


def test_it_is_our_own_law():
    """Random strains that load, turn and unload, at points.

    Requirement: stresses and plastic strain of every increment. Source: the law of the project,
    whose change of volume stands beside its points, `K tr(e)`. Tolerance: 1e-10 of the yield
    stress: both have a closed form.
    """
    from anisocontact.bulk import UserLaw

    given, project = UserLaw(law()), own()
    bulk = GIVEN["E"] / 3.0 / (1.0 - 2.0 * GIVEN["nu"])
    ours = {name: np.zeros((50, *shape)) for name, shape in project.history.items()}
    theirs = {name: np.zeros((50, *shape)) for name, shape in given.history.items()}
    for strain in path(50, 8):
        one, other = project.update(state(strain, ours)), given.update(state(strain, theirs))
        volume = bulk * np.trace(strain, axis1=1, axis2=2)[:, None, None] * np.eye(3)
        assert np.abs(other.stress - one.stress - volume).max() < 1e-10 * LIMIT
        ours, theirs = one.after, other.after
    plastic = ours["equivalent_plastic_strain"]
    assert theirs["p"] == pytest.approx(plastic, abs=1e-13)
    assert plastic.max() > 1e-3


def test_a_bar_is_our_own_law():
    """A bar in tension and back, uniform: both laws are the same at every point.

    Requirement: reactions of all increments. Source: the law of the project. Tolerance: 1e-9,
    Newton's method.
    """
    from anisocontact.bulk import user_material
    from anisocontact.mesh import Body, BoxSpec, build_mesh
    from anisocontact.solver import Problem, Solver, Step

    found = []
    for made in (user_material(law()), own()):
        model = build_mesh([Body("b", BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1)))])
        planes = ["b.left", "b.front", "b.bottom"]
        problem = Problem(model, {"b": made}, symmetry=planes)
        steps = [Step(f"{k}", 3, {"b.top": {"z": z}}) for k, z in enumerate((8e-3, -6e-3, 5e-3))]
        solver = Solver(problem, steps, options={"snes_rtol": 1e-12})
        found.append(np.array([one.reactions["b.top"][2] for one in solver.run()]))
    assert found[0] == pytest.approx(found[1], rel=1e-9)
    assert np.abs(found[1]).max() > LIMIT


def test_it_is_what_the_package_assembles():
    """The same mapping as a `FEMExternalOperator`, where that is installed: forces and tangent.

    Requirement: residual and tangent at a random displacement beyond yield. Source:
    dolfinx-external-operator, which evaluates, differentiates and assembles by itself, in a process
    of its own: it adds a type to UFL, which has to know that before any form. Tolerance: 1e-10,
    rounding: strains of tetrahedra of order 1 are uniform, whatever the quadrature.
    """
    if find_spec("dolfinx_external_operator") is None:
        pytest.skip("dolfinx-external-operator is not installed")
    script = Path(__file__).with_name("external_operator_assembled.py")
    done = subprocess.run([sys.executable, script], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    errors = [float(word) for word in done.stdout.split()]
    assert len(errors) == 2
    assert max(errors) < 1e-10
