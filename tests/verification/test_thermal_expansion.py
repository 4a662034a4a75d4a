"""Thermal expansion of every kind of material: free, clamped, of a field, in a case file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq
from tests.verification.bulk_tangent import ratio_of_errors

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.base.errors import InputError
from anisocontact.bulk import ThermalExpansion, make_material, materials
from anisocontact.cli import main
from anisocontact.mesh import BoxSpec, build_box
from anisocontact.results import Results
from anisocontact.results.history import read_history
from anisocontact.results.paraview import BodyGrid
from anisocontact.solver import ElasticSupport, Problem, Solver, Step

E, NU, EXPANSION = 200.0, 0.3, 1e-4
HELD = {"bar.bottom": {"z": 0.0}, "bar.left": {"x": 0.0}, "bar.front": {"y": 0.0}}
HOOKE = {"E": E, "nu": NU}
AXES = {"first": [1, 1, 0], "second": [0, 0, 1]}
MATERIALS: dict[str, tuple[str, dict[str, Any]]] = {
    "linear": ("linear-elastic", HOOKE),
    "wood": ("orthotropic", {"E": [9, 3, 2], "nu": [0.3, 0.3, 0.3], "G": [2, 1, 1], **AXES}),
    "nearly incompressible": ("linear-elastic-incompressible", HOOKE | {"nu": 0.4999}),
    "fibres": (
        "transversely-isotropic",
        {
            "E_along": 9,
            "E_across": 2,
            "nu_along": 0.3,
            "nu_across": 0.4,
            "G_along": 1,
            "along": [1, 1, 0],
        },
    ),
    "st. venant": ("st-venant-kirchhoff", HOOKE),
    "neo-hooke": ("neo-hookean", HOOKE),
    "rubber": ("neo-hookean-incompressible", HOOKE | {"nu": 0.4999}),
    "mooney": ("mooney-rivlin", {"C10": 0.4, "C01": 0.1, "bulk_modulus": 50.0}),
    "yeoh": ("yeoh", {"C10": 1.0, "C20": -0.1, "C30": 0.1, "bulk_modulus": 50.0}),
    "ogden": ("ogden", {"mu": [1.0], "alpha": [3.0], "bulk_modulus": 50.0}),
    "polymer": ("viscoelastic", {**HOOKE, "g": [0.3], "tau": [0.4]}),
    "steel": ("plastic", {**HOOKE, "yield_stress": 0.5}),
    "sheet": (
        "hill",
        {**HOOKE, "yield_stress": 0.5, "lankford": [2, 1, 2], "strain": "logarithmic"},
    ),
}


def _heated(name: str, temperature: float, held: dict[str, Any]) -> Problem:
    model = build_box({"bar": BoxSpec((0, 0, 0), (1, 1, 1), (2, 2, 2))})
    model_name, given = MATERIALS[name]
    law = ThermalExpansion(make_material(model_name, **given), EXPANSION)
    problem = Problem(model, {"bar": law})
    step = Step("heat", 2, held, temperature={"bar": temperature})
    for _ in Solver(problem, [step]).run():
        pass
    return problem


def test_every_material_expands() -> None:
    """A registered material is among those that are heated here."""
    assert {name for name, _ in MATERIALS.values()} == {one.name for one in materials()}


#: Materials that share how they expand with another one here.
ALIKE = {"wood": "fibres", "st. venant": "neo-hooke", "mooney": "ogden", "yeoh": "ogden"}


@pytest.mark.parametrize(
    "name",
    [pytest.param(one, marks=pytest.mark.slow if one in ALIKE else []) for one in MATERIALS],
)
def test_free_expansion(name: str) -> None:
    """A body that is free to expand does so by `a dT` in all directions and has no stress.

    Tolerance: 1e-8 of the expansion, Newton's method, and as much of Young's modulus times it.
    """
    problem = _heated(name, 100.0, HELD)
    x = problem.model.space.tabulate_dof_coordinates()
    u = problem.u.x.array.reshape(-1, 3)
    np.testing.assert_allclose(u, 0.01 * x, atol=1e-10)
    stress = BodyGrid(problem).stress()
    assert np.abs(stress).max() < 1e-8 * 0.01 * problem.materials["bar"].young


def _clamped(name: str) -> float:
    """Force on a bar that cannot get longer and is free at its sides."""
    s = 1.01
    if name == "linear":
        return -E * 0.01
    if name == "steel":
        return -0.5
    # neo-Hooke of the stretches left of those of the temperature
    shear, lame = E / 2 / (1 + NU), E * NU / (1 + NU) / (1 - 2 * NU)

    def stress(axial: float, lateral: float, of: float) -> float:
        return shear * (of - 1 / of) + lame * np.log(axial * lateral**2) / of

    lateral = brentq(lambda t: stress(1 / s, t, t), 0.9, 1.2, xtol=1e-15)
    return float(s**2 * stress(1 / s, lateral, 1 / s))


@pytest.mark.parametrize("name", ["linear", "steel", "neo-hooke"])
def test_clamped_bar(name: str) -> None:
    """A bar between rigid ends: `-E a dT`, at most the yield stress, or of neo-Hooke with `F/s`.

    Tolerance: 1e-8, that of Newton's method.
    """
    problem = _heated(name, 100.0, HELD | {"bar.top": {"z": 0.0}})
    force = problem.reactions()["bar.top"][2]
    assert force == pytest.approx(_clamped(name), rel=1e-8)


def test_temperature_that_is_linear_in_place() -> None:
    """Requirement: no stress where the temperature is linear in place.

    Source: it makes a displacement of second order, which cells of order 2 have. Tolerance: 1e-6 of
    `E a dT`, what the soft bed that holds the body along x makes.
    """
    model = build_box({"bar": BoxSpec((0, 0, 0), (1, 1, 1), (2, 2, 2), order=2)})
    law = ThermalExpansion(make_material("linear-elastic", **HOOKE), EXPANSION, lambda x: x[0])
    bed, planes = ElasticSupport("bar.right", 1e-5, 0.0), ["bar.front", "bar.bottom"]
    problem = Problem(model, {"bar": law}, attached=[bed], symmetry=planes)
    for _ in Solver(problem, [Step("heat", 1, temperature={"bar": 100.0})]).run():
        pass
    assert np.abs(problem.u.x.array).max() > 0.004
    assert np.abs(BodyGrid(problem).stress()).max() < 1e-6 * E * 0.01


def test_tangent_is_exact() -> None:
    """Central differences of the force of a hot, strained body: a quarter of the error at half the
    step, of a law of points at finite strain and of an energy."""
    for name in ("ogden", "yeoh"):
        problem = _heated(name, 100.0, HELD | {"bar.top": {"z": 0.2}})
        x = problem.accepted()
        d = np.random.default_rng(1).normal(size=x.getLocalSize())
        assert 3.7 < ratio_of_errors(problem.bulk, x, d) < 4.3


CASE = """
[mesh.box.bar]
origin = [0, 0, 0]
size = [1, 1, 1]
cells = [1, 1, 1]
[material.bar]
model = "linear-elastic"
E = 200
nu = 0.3
expansion = {expansion}
[amplitude.cycle]
kind = "sine"
period = 1.0
[[step]]
name = "heat"
increments = 4
duration = 1.0
temperature = {{ {body} = {{ amplitude = "cycle", value = 100 }} }}
[step.displacement]
"bar.bottom" = {{ z = 0 }}
"bar.left" = {{ x = 0 }}
"bar.front" = {{ y = 0 }}
"bar.top" = {{ z = 0 }}
[output]
pictures = false
"""


def test_case_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A temperature follows an amplitude; a body that does not expand has none."""
    case = tmp_path / "case.toml"
    case.write_text(CASE.format(expansion=1e-4, body="bar"))
    assert main(["run", str(case), "-o", str(tmp_path / "out")]) == 0
    force = Results(tmp_path / "out").history["reactions.bar.top.z"]
    np.testing.assert_allclose(force, [-2.0, 0.0, 2.0, 0.0], rtol=1e-8, atol=1e-8)
    for expansion, body in ((0, "bar"), (1e-4, "ball")):
        case.write_text(CASE.format(expansion=expansion, body=body))
        capsys.readouterr()
        assert main(["check", str(case)]) != 0
        said = f'step[0].temperature: "{body}" given, no such body whose material has an expansion'
        assert said in capsys.readouterr().err


SHEET = """
[mesh.rectangle.bar]
origin = [0, 0]
size = [2, 1]
cells = [2, 1]
[idealisation]
kind = "plane-stress"
thickness = 0.5
[material.bar]
{material}
expansion = 1e-4
[[step]]
name = "heat"
increments = 1
temperature = {{ bar = 100 }}
displacement = {{ "bar.left" = {{ x = 0 }}, "bar.bottom" = {{ y = 0 }} }}
[[step]]
name = "hold"
increments = 1
temperature = {{ bar = 0 }}
displacement = {{ "bar.right" = {{ x = 0 }} }}
[[step]]
name = "heat again"
increments = 1
temperature = {{ bar = 100 }}
[output]
pictures = false
[output.probe.middle]
point = [1, 0.5, 0]
"""
ISOTROPIC = 'model = "linear-elastic"\nE = 200\nnu = 0.3'
WOOD = 'model = "orthotropic"\nE = [200, 90, 70]\nnu = [0.3, 0.2, 0.4]\nG = [50, 40, 30]'

#: Stiffness of displacements across the plane rounds to 0 with it, or below.
VENEER = 'model = "orthotropic"\nE = [200, 60, 20]\nnu = [0.3, 0.35, 0.3]\nG = [40, 20, 10]'


@pytest.mark.parametrize("material", [ISOTROPIC, WOOD, VENEER], ids=["isotropic", "wood", "veneer"])
def test_a_sheet_in_plane_stress(tmp_path: Path, material: str) -> None:
    """Requirement: a free sheet grows by `a dT` without stress; between rigid ends it has the
    stress `-E_1 a dT` and grows across by `(1 + nu_12) a dT`, with none through its thickness.

    Source: Hooke's law of a bar. Tolerance: rounding of the solution.
    """
    case = tmp_path / "case.toml"
    case.write_text(SHEET.format(material=material))
    assert main(["run", str(case), "-o", str(tmp_path / "out")]) == 0
    table = read_history(tmp_path / "out" / "probes" / "middle.csv")
    np.testing.assert_allclose(table["displacement.x"], [0.01, 0.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(table["displacement.y"], [0.005, 0.0, 0.5 * 1.3 * 0.01], atol=1e-12)
    np.testing.assert_allclose(table["stress.XX"], [0.0, 0.0, -2.0], atol=1e-10)
    for name in ("YY", "ZZ", "XY"):
        np.testing.assert_allclose(table[f"stress.{name}"], 0.0, atol=1e-10)
    force = Results(tmp_path / "out").history["reactions.bar.right.x"]
    np.testing.assert_allclose(force[-1], -1.0, rtol=1e-9)


def test_scripts_are_told_as_well() -> None:
    """A step that heats a body without an expansion is refused before anything is solved."""
    model = build_box({"bar": BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1))})
    problem = Problem(model, {"bar": make_material("linear-elastic", **HOOKE)})
    with pytest.raises(InputError, match=r"temperature\.bar: no such body"):
        Solver(problem, [Step("heat", 1, HELD, temperature={"bar": 1.0})])


@pytest.mark.parametrize(
    ("profile", "said"),
    [
        (lambda x: x / "2", "the function failed: test_thermal_expansion.py, line"),
        (lambda: 1.0, "the function failed: TypeError"),
        (lambda x: None, "None given by the function, an array of real numbers needed"),
        (lambda x: x[0] + 1j, "an array of real numbers needed"),
        (lambda x: 1.0, "an array of shape () for 64 positions given, (64,) needed"),
        (lambda x: x[0, :-1], "an array of shape (63,) for 64 positions given, (64,) needed"),
        (lambda x: np.log(x[0] - x[0]), "-inf at ("),
    ],
)
@pytest.mark.filterwarnings("ignore:divide by zero")
def test_a_profile_that_is_none(profile: Any, said: str) -> None:
    """Requirement: what a function of the user's does wrong is one line that names it."""
    model = build_box({"bar": BoxSpec((0, 0, 0), (1, 1, 1), (2, 2, 2))})
    law = ThermalExpansion(make_material("neo-hookean", E=E, nu=NU), EXPANSION, profile)
    with pytest.raises(InputError) as error:
        Problem(model, {"bar": law}, [])
    assert str(error.value).startswith("material.bar.profile: ")
    assert said in str(error.value)
    assert "\n" not in str(error.value)
