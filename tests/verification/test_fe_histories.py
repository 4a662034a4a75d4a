"""Bodies whose material has a history, in runs: closed forms of uniform strain, contact by penalty
and multipliers, cuts, runs that go on, two processes, strategies and the balance of energy."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.bulk import NonlinearBulk, make_material
from anisocontact.cli import main
from anisocontact.mesh import BoxSpec, build_box
from anisocontact.results import Results
from anisocontact.solver import Problem, Solver, Step

#: Sides of a bar that is pulled along z and free to contract.
HELD = {"bar.bottom": {"z": 0.0}, "bar.left": {"x": 0.0}, "bar.front": {"y": 0.0}}
SIDES = ("left", "front", "bottom")
POLYMER = {"E": 3.0, "nu": 0.3, "g": [0.3, 0.2], "tau": [0.5, 4.0], "k": [0.3, 0.2]}


def _bar(name: str, given: dict[str, Any], order: int = 1, cell: str = "hexahedron") -> Problem:
    model = build_box({"bar": BoxSpec((0, 0, 0), (1, 1, 1), (2, 1, 1), cell=cell, order=order)})
    return Problem(model, {"bar": make_material(name, **given)})


def _pull(
    problem: Problem, ways: list[tuple[float, int]], durations: list[float] | None = None
) -> tuple[np.ndarray, list[dict[str, float]]]:
    """Force after each increment of a bar whose end goes to places one after the other."""
    times = durations or [1.0] * len(ways)
    steps = [
        Step(f"way {i}", n, {**HELD, "bar.top": {"z": z}}, duration=t)
        for i, ((z, n), t) in enumerate(zip(ways, times, strict=True))
    ]
    forces, energies = [], []
    for accepted in Solver(problem, steps).run():
        forces.append(problem.reactions()["bar.top"][2])
        energies.append(accepted.energies)
    return np.array(forces), energies


@pytest.mark.parametrize(
    ("cell", "order"),
    [("hexahedron", 1), pytest.param("hexahedron", 2, marks=pytest.mark.slow), ("tetrahedron", 2)],
)
def test_polymer_bar_relaxes(cell: str, order: int) -> None:
    """Requirement: a bar with free sides, pulled in 0.2 and held, follows the relaxation modulus.

    Source: shear and bulk modulus relax alike, so that Poisson's ratio stays and the force is
    `E e (1 - sum g_i) + sum E g_i e tau_i/T (1 - exp(-T/tau_i)) exp(-(t - T)/tau_i)`. Tolerance:
    1e-8, that of Newton's method.
    """
    problem = _bar("viscoelastic", POLYMER, order, cell)
    forces, _ = _pull(problem, [(0.01, 2), (0.01, 3)], [0.2, 6.0])
    t = np.array([2.0, 4.0, 6.0])
    expected = 0.5 * 3.0 * 0.01 * np.ones(3)
    for g, tau in zip(POLYMER["g"], POLYMER["tau"], strict=True):
        kept = tau / 0.2 * -np.expm1(-0.2 / tau) * np.exp(-t / tau)
        expected += 3.0 * g * 0.01 * kept
    np.testing.assert_allclose(forces[2:], expected, rtol=1e-8)


STEEL = {"E": 200.0, "nu": 0.3, "yield_stress": 1.0}
HARD = STEEL | {"hardening": 9.0, "saturation": 0.4, "saturation_rate": 50.0}


@pytest.mark.parametrize(
    ("cell", "order"), [("hexahedron", 1), ("hexahedron", 2), ("tetrahedron", 2)]
)
def test_plastic_bar(cell: str, order: int) -> None:
    """Requirement: a bar with free sides follows the flow curve, whatever the increments.

    Source: `e = s/E + p`, `s = Y + H p + Q (1 - exp(-b p))`. Tolerance: 1e-8, Newton's method.
    """
    forces, _ = _pull(_bar("plastic", HARD, order, cell), [(0.008, 1), (0.02, 2)])
    for z, force in zip((0.008, 0.014, 0.02), forces, strict=True):
        p = z - force / 200.0
        assert force == pytest.approx(1.0 + 9.0 * p - 0.4 * np.expm1(-50.0 * p), rel=1e-8)


def test_plastic_bar_cycles() -> None:
    """Requirement: Prager's hardening moves the elastic range of 2 Y with the stress (Bauschinger).

    Source: from each turn on 2 Y elastic, then the slope `E C/(E + C)`. Tolerance: 1e-8, Newton's
    method.
    """
    bar = _bar("plastic", STEEL | {"kinematic": 10.0})
    forces, _ = _pull(bar, [(0.02, 2), (-0.02, 2), (0.0, 1)])
    slope = 200.0 * 10.0 / 210.0
    top = 1.0 + slope * (0.02 - 0.005)
    bottom = top - 2.0 - slope * (0.04 - 0.01)
    expected = [top, bottom, bottom + 2.0 + slope * (0.02 - 0.01)]
    np.testing.assert_allclose([*forces[1::2][:2].tolist(), forces[4]], expected, rtol=1e-8)


@pytest.mark.parametrize(
    ("model", "more"), [("plastic", {}), ("hill", {"lankford": [1.0, 1.0, 1.0]})]
)
def test_plastic_bar_at_finite_strain(model: str, more: dict[str, Any]) -> None:
    """Requirement: to twice its length and back to pressure in logarithmic strain.

    Source: `ln s = t/E + p` with t the Kirchhoff stress, force `t/s` over the area of before; on
    the way back yield at `-t`, isotropic hardening. Hill's condition with r = 1 is that of von
    Mises. Tolerance: 1e-8, Newton's method.
    """
    given = STEEL | more | {"hardening": 9.0, "strain": "logarithmic"}
    forces, _ = _pull(_bar(model, given), [(1.0, 10), (0.5, 5)])
    slope = 200.0 * 9.0 / 209.0
    top = 1.0 + slope * (np.log(2.0) - 1.0 / 200.0)
    back = -top - slope * (np.log(2.0 / 1.5) - 2.0 * top / 200.0)
    np.testing.assert_allclose(forces[[9, 14]], [top / 2.0, back / 1.5], rtol=1e-8)


@pytest.mark.parametrize("strain", ["small", "logarithmic"])
def test_patch_of_plastic_cells(strain: str) -> None:
    """Requirement: distorted cells under displacements that are linear in place are all strained
    alike, in elastic and plastic range.

    Source: patch test. Tolerance: 1e-9 of the stress, Newton's method.
    """
    model = build_box({"bar": BoxSpec((0, 0, 0), (1, 1, 1), (3, 3, 3), cell="tetrahedron")})
    x = model.mesh.geometry.x
    inside = ((x > 1e-9) & (x < 1.0 - 1e-9)).all(axis=1)
    x[inside] += np.random.default_rng(3).uniform(-0.08, 0.08, size=(inside.sum(), 3))
    law = make_material("plastic", **HARD, strain=strain)
    problem = Problem(model, {"bar": law})
    sides = {"left": 0, "right": 1, "front": 0, "back": 1, "bottom": 0, "top": 1}
    held = {
        f"bar.{side}": {"xyz"[i // 2]: (0.02, -0.008, 0.004)[i // 2] * end}
        for i, (side, end) in enumerate(sides.items())
    }
    for _ in Solver(problem, [Step("strain", 2, held)]).run():
        pass
    _, stress = problem.bulk.histories["bar"].stress()
    flat = stress.reshape(-1, 9)
    assert np.abs(flat - flat[0]).max() < 1e-9 * np.abs(flat).max()
    p = problem.bulk.histories["bar"].variables["equivalent_plastic_strain"].x.array
    assert p.min() > 0.01


MATERIALS = {
    "plastic": 'model = "plastic"\nE = 1000\nnu = 0.3\nyield_stress = 15\nhardening = 50\n'
    "kinematic = 100\nrecovery = 5",
    "plastic-log": 'model = "plastic"\nE = 1000\nnu = 0.3\nstrain = "logarithmic"\n'
    "flow_curve = [[0, 15], [0.1, 20]]",
    "hill": 'model = "hill"\nE = 1000\nnu = 0.3\nyield_stress = 15\nhardening = 50\n'
    'lankford = [1.8, 1.2, 2.1]\nfirst = [1, 1, 0]\nstrain = "logarithmic"',
    "viscoelastic": 'model = "viscoelastic"\nE = 1000\nnu = 0.3\ng = [0.3, 0.2]\ntau = [0.3, 2.0]',
    "viscoelastic-log": 'model = "viscoelastic"\nE = 1000\nnu = 0.3\ng = [0.3]\ntau = [0.3]\n'
    'strain = "logarithmic"',
}
#: Materials in Python with the order of their integration in time.
BALANCED = [
    ("viscoelastic", POLYMER, 2),
    ("viscoelastic", POLYMER | {"strain": "logarithmic"}, 2),
    ("plastic", HARD | {"kinematic": 20.0, "recovery": 5.0}, 1),
    ("plastic", HARD | {"strain": "logarithmic"}, 1),
]
CASE = """
[mesh.box.block]
origin = [0, 0, 0]
size = [1, 1, 0.5]
cells = [3, 3, 2]

[material.block]
{material}

[surface.plate]
shape = "plane"
point = [0, 0, 0]
normal = [0, 0, 1]

[[contact]]
slave = "block.bottom"
master = "plate"
method = "{method}"
normal = {{ penalty = 1e4 }}
adhesion = {{ stiffness = 4e3 }}
friction = {{ coefficients = 0.3 }}

[[step]]
name = "press"
increments = {press}
displacement = {{ "block.top" = {{ x = 0, y = 0, z = -0.02 }} }}

[[step]]
name = "drag"
increments = {drag}
displacement = {{ "block.top" = {{ x = 0.02, y = 0.01 }} }}

[output]
pictures = false

[solver]
strategy = "{strategy}"
"""


def _written(
    folder: Path, material: str, method: str = "penalty", strategy: str = "direct", n: int = 1
) -> Path:
    case = folder / "case.toml"
    text = CASE.format(
        material=MATERIALS[material], method=method, strategy=strategy, press=2 * n, drag=3 * n
    )
    case.write_text(text)
    return case


def _forces(folder: Path) -> np.ndarray:
    history = Results(folder).history
    return np.stack([history[f"reactions.block.top.{axis}"] for axis in "xyz"], axis=1)


@pytest.mark.parametrize(
    ("material", "method"),
    [
        pytest.param(one, how, marks=pytest.mark.slow if seldom else [])
        for one in MATERIALS
        for how in ("penalty", "augmented")
        # multipliers and histories do not know of each other: one of each sort has both
        for seldom in [how == "augmented" and one not in ("plastic", "viscoelastic")]
    ],
)
def test_goes_on_bit_by_bit(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, material: str, method: str
) -> None:
    """A run under contact that was halted in its middle is the whole one, to the last bit."""
    from anisocontact.results.writer import Writer

    case, keep = _written(tmp_path, material, method), Writer.keep

    def interrupted(self: Any, *arguments: Any) -> None:
        keep(self, *arguments)
        if self.summary["steps"] == 3:
            os.kill(os.getpid(), signal.SIGINT)

    assert main(["run", str(case), "-o", str(tmp_path / "whole")]) == 0
    with monkeypatch.context() as patch:
        patch.setattr(Writer, "keep", interrupted)
        assert main(["run", str(case), "-o", str(tmp_path / "out")]) == 3
    assert main(["run", str(case), "-o", str(tmp_path / "out"), "--restart"]) == 0
    first, second = ((tmp_path / f / "history.csv").read_bytes() for f in ("whole", "out"))
    assert first == second


@pytest.mark.parametrize("material", MATERIALS)
def test_strategies_agree(tmp_path: Path, material: str) -> None:
    """`iterative` gives the forces of `direct` to 1e-6 of the largest, the tolerance of both with
    what an increment hands on to the next."""
    found = []
    for strategy in ("direct", "iterative"):
        case = _written(tmp_path, material, strategy=strategy)
        assert main(["run", str(case), "-o", str(tmp_path / strategy)]) == 0
        found.append(_forces(tmp_path / strategy))
    np.testing.assert_allclose(found[0], found[1], atol=1e-6 * np.abs(found[0]).max())


@pytest.mark.parametrize("material", MATERIALS)
def test_energy_balance_under_friction(tmp_path: Path, material: str) -> None:
    """Requirement: work is what is stored, dissipated in the body and by friction.

    Source: balance of energy. Tolerance: 2 % of the work at twenty increments: friction and yield
    conditions book what is dissipated to first order. What is dissipated never falls.
    """
    case = _written(tmp_path, material, n=4)
    assert main(["run", str(case), "-o", str(tmp_path / "out")]) == 0
    history = Results(tmp_path / "out").history
    assert abs(history["energy.residual"][-1]) < 0.02 * history["energy.external"][-1]
    lost = history["energy.inelastic"]
    assert lost[-1] > 0.0
    strain = Results(tmp_path / "out").fields().cell_data["plastic_strain"]
    assert (strain.max() > 1e-3) == ("plastic" in material or material == "hill")
    assert np.diff(lost).min() >= -1e-12 * lost[-1]


@pytest.mark.parametrize(("name", "given", "order"), BALANCED)
def test_energy_balance_by_order(name: str, given: dict[str, Any], order: int) -> None:
    """A bar that is pulled and pressed: what is left of the work falls with the increments.

    Source: the trapezoidal rule of the work is of order two; a yield condition that is met at the
    end of an increment is of order one. Asserted 0.8 of it in powers of two.
    """
    left = []
    for n in (8, 16, 32):
        _, energies = _pull(_bar(name, given), [(0.02, n), (-0.01, n)])
        last = energies[-1]
        left.append(abs(last["residual"]) / (last["elastic"] + last["inelastic"]))
    assert left[1] < 0.5 ** (0.8 * order) * left[0]
    assert left[2] < 0.5 ** (0.8 * order) * left[1]


@pytest.mark.slow
@pytest.mark.mpi
@pytest.mark.parametrize("material", MATERIALS)
def test_two_processes(tmp_path: Path, material: str) -> None:
    """Two processes give the forces of one, to the tolerance of Newton's method, 1e-7."""
    if shutil.which("mpirun") is None:
        pytest.skip("no mpirun")
    case, found = _written(tmp_path, material, "augmented"), []
    for ranks in (1, 2):
        out = tmp_path / f"on{ranks}"
        script = "import sys; from anisocontact.cli import main; sys.exit(main(sys.argv[1:]))"
        command = ["timeout", "200", "mpirun", "-n", str(ranks), sys.executable, "-c", script]
        command += ["run", str(case), "-o", str(out)]
        subprocess.run(command, check=True, capture_output=True)
        found.append(_forces(out))
    np.testing.assert_allclose(found[0], found[1], atol=1e-7 * np.abs(found[0]).max())


def test_what_each_body_has_dissipated() -> None:
    """Of bars that are pulled by 1 and 2 %, without contact between them.

    Source: what each dissipates alone, four times as much where it is pulled twice as far; the sum
    is that of all. Tolerance: that of Newton's method.
    """
    names = ("bar", "other")
    model = build_box(
        {n: BoxSpec((0, 3 * i, 0), (1, 1, 1), (2, 1, 1)) for i, n in enumerate(names)}
    )
    problem = Problem(model, dict.fromkeys(names, make_material("viscoelastic", **POLYMER)))
    held = {f"other.{side}": {axis: 0.0} for side, axis in zip(SIDES, "xyz", strict=True)}
    ends = {"bar.top": {"z": 0.01}, "other.top": {"z": 0.02}}
    (*_, last) = Solver(problem, [Step("pull", 2, {**HELD, **held, **ends})]).run()
    alone = _pull(_bar("viscoelastic", POLYMER), [(0.01, 2)])[1][-1]["inelastic"]
    found = problem.bulk.dissipated_by_body()
    assert found == pytest.approx({"bar": alone, "other": 4.0 * alone}, rel=1e-8)
    assert last.energies["inelastic"] == pytest.approx(5.0 * alone, rel=1e-8)


def test_a_process_without_a_cell_of_a_body_keeps_nothing() -> None:
    """Small bodies lie on one process alone; on the others a checkpoint was an internal error."""
    model = build_box({"b": BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1))})
    steel = make_material("plastic", E=200.0, nu=0.3, yield_stress=1.0)
    (body,) = NonlinearBulk(model, {"b": steel}).histories.values()
    whole = body.persistent()
    body._owned = 0
    none = body.persistent()
    assert {name: (0, *values.shape[1:]) for name, values in whole.items()} == {
        name: values.shape for name, values in none.items()
    }
    body.restore(none)
