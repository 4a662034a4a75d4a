"""Strategy `condensed` with bodies that are not linear: the answers of a factorisation.

Requirement: with a tight Newton tolerance both strategies solve the same equations, so that forces
and displacements agree to 1e-7 of their size: what is left of Newton's method (1e-11) times how
much the solution answers to it. Source: `direct`, an independent way to solve the same equations.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.base.errors import InputError
from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.interface import Augmentation, ContactLaw, Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import BoxSpec, build_box
from anisocontact.rigid import MovingSurface, RigidBody
from anisocontact.solver import Problem, Solver, Step
from anisocontact.solver.stepping.attempts import Attempts, _Way
from anisocontact.solver.strategies.condensed import bordered, interior, lagged, lagged_newton
from anisocontact.solver.strategies.condensed.factor import singular
from anisocontact.solver.strategies.condensed.lagged import LaggedFactor
from anisocontact.solver.strategies.condensed.lagged_newton import CAREFUL, ROUGH, LaggedNewton
from anisocontact.surfaces import make_surface

pytestmark = pytest.mark.skipif(not bordered.reachable(), reason="a PETSc without MUMPS")

RUBBER = {"model": "neo-hookean", "E": 1000.0, "nu": 0.3}
YEOH = {"model": "yeoh", "C10": 150.0, "C20": -5.0, "C30": 2.0, "bulk_modulus": 2e3}
HARDLY_COMPRESSIBLE = {"model": "neo-hookean-incompressible", "E": 1000.0, "nu": 0.499}
LAWS = (
    NormalLaw(penalty=1e5),
    Adhesion(stiffness=(1e5, 1e5)),
    Friction(coefficients=(0.3, 0.3)),
)
FREE: dict[str, float | None] = {"x": None, "z": None}
CLAMP = {"base.bottom": {"x": 0.0, "y": 0.0, "z": 0.0}}
PRESS = Step("press", 2, {**CLAMP, "block.top": {"x": 0.0, "y": 0.0, "z": -0.04}})
DRAG = Step("drag", 2, {"block.top": {"x": 0.04}})


def _pair(kind: Any = Contact, material: dict[str, Any] = RUBBER, **extra: Any) -> Problem:
    """A block on a wider one whose cells do not match; no slave point is above a rim of facets."""
    model = build_box(
        {
            "block": BoxSpec((0, 0, 0), (1, 1, 0.5), (3, 3, 2)),
            "base": BoxSpec((-0.45, -0.4, -0.5), (2, 2, 0.5), (4, 4, 2)),
        }
    )
    contact = kind(model, "block.bottom", "base.top", law=ContactLaw(*LAWS), **extra)
    made = make_material(**material)
    return Problem(model, {"block": made, "base": made}, [contact])


def _on_plane(
    body: RigidBody | None = None,
    cells: int = 4,
    order: int = 1,
    material: dict[str, Any] = RUBBER,
    **options: Any,
) -> Problem:
    """A block on a rigid plane."""
    model = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 0.5), (cells, cells, 2), order=order)})
    plane = Interface(make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1)), *LAWS)
    contact = Contact(model, "block.bottom", MovingSurface(plane, body), mortar=False)
    return Problem(model, {"block": make_material(**material)}, [contact], **options)


def _run(
    problem: Problem, steps: Sequence[Step], strategy: str
) -> tuple[list[Any], list[str], np.ndarray]:
    notes: list[str] = []
    solver = Solver(problem, steps, options={"snes_rtol": 1e-11}, strategy=strategy)
    accepted = list(solver.run(on_note=notes.append))
    return accepted, notes, problem.u.x.array.copy()


def _same(make: Callable[[], Problem], steps: Sequence[Step]) -> list[str]:
    """Run both ways and compare; the notes of `condensed`."""
    ours, notes, our_u = _run(make(), steps, "condensed")
    theirs, _, their_u = _run(make(), steps, "direct")
    assert len(ours) == len(theirs)
    assert np.abs(our_u - their_u).max() < 1e-7 * np.abs(their_u).max()
    force = max(float(np.abs(f).max()) for a in theirs for f, _ in a.resultants.values())
    for a, b in zip(ours, theirs, strict=True):
        for name, (resultant, _) in b.resultants.items():
            assert np.abs(a.resultants[name][0] - resultant).max() < 1e-7 * force
    spent, needed = (sum(a.iterations for a in run) for run in (ours, theirs))
    assert spent <= 1.15 * needed + 2  # two: small counts are of whole iterations
    return notes


def test_block_on_block() -> None:
    """Pressed and dragged with friction: one factorisation or two for all corrections."""
    notes = _same(_pair, [PRESS, DRAG])
    count, _, _, corrections = notes[-1].split()[:4]
    assert int(count) <= 2
    assert int(corrections) > 10
    # where points change their status, tangents of the bodies of before serve
    assert int(notes[-1].split()[-1]) < 0.9 * int(corrections)


@pytest.mark.parametrize(
    ("given", "material"),
    [
        pytest.param({}, YEOH, marks=pytest.mark.slow),
        pytest.param({}, HARDLY_COMPRESSIBLE, marks=pytest.mark.slow),
        ({"augmentation": Augmentation()}, RUBBER),
    ],
    ids=["yeoh", "nu=0.499", "augmented"],
)
def test_materials_and_multipliers(given: dict[str, Any], material: dict[str, Any]) -> None:
    """What changes in the bodies or in the contact leaves the answers those of `direct`."""
    _same(lambda: _pair(material=material, **given), [PRESS, DRAG])


@pytest.mark.slow
def test_order_2() -> None:
    """Curved cells, whose middle nodes are in contact too."""
    top = {"block.top": {"x": 0.0, "y": 0.0, "z": -0.02}}
    _same(lambda: _on_plane(cells=2, order=2), [Step("press", 2, top), DRAG])


@pytest.mark.slow
def test_held_by_contact_and_load_alone() -> None:
    """A block that lies on the plane, loaded, with springs of stabilisation that fade."""
    press = Step("press", 2, traction={"block.top": {"z": -20.0}})
    _same(_on_plane, [press, Step("push", 2, traction={"block.top": {"x": 2.0, "z": -20.0}})])


def test_follower_pressure() -> None:
    """A pressure on a side that turns with it, away from what contact can couple."""
    press = Step("press", 1, {"block.top": {"x": 0.0, "y": 0.0, "z": -0.02}})
    blow = Step("blow", 2, pressure={"block.left": 60.0})
    _same(_on_plane, [press, blow])


MATERIALS = pytest.mark.parametrize(
    "material", [RUBBER, HARDLY_COMPRESSIBLE], ids=["rubber", "nu=0.499"]
)


@MATERIALS
def test_free_rigid_die(material: dict[str, Any]) -> None:
    """A die on springs, whose unknowns come after those of the mesh."""
    top = {"block.top": {"x": 0.0, "y": 0.0, "z": 0.0}}
    push = Step("push", 2, top, load={"die": {"x": 2.0, "z": 30.0}}, motion={"die": FREE})

    def make() -> Problem:
        body = RigidBody("die", (0.5, 0.5, 0.0), free=True, springs={"x": 50.0})
        return _on_plane(body, material=material)

    _same(make, [push])


@pytest.mark.parametrize(
    "material",
    [RUBBER, pytest.param(HARDLY_COMPRESSIBLE, marks=pytest.mark.slow)],
    ids=["rubber", "nu=0.499"],
)
def test_symmetry_plane(material: dict[str, Any]) -> None:
    """Nodes that stay in a plane, some of them in contact."""
    top = {"block.top": {"x": 0.0, "z": -0.03}}
    drag = Step("drag", 2, {"block.top": {"x": 0.03}})
    steps = [Step("press", 2, top), drag]
    _same(lambda: _on_plane(symmetry=["block.front"], material=material), steps)


@MATERIALS
def test_what_a_tangent_has_missed_is_of_second_order(material: dict[str, Any]) -> None:
    """Forces less those that the last tangent tells fall with the square of the way from there.

    Requirement: a tangent that is written again is that of the first state, not of the last one,
    and its sign is that of the forces: order two by halving, within a tenth, and the same matrix
    to the last bit.
    """
    problem = _pair(material=material)
    x, matrix, once_more = problem.new_vector(), problem.new_tangent(), problem.new_tangent()
    way = np.random.default_rng(3).standard_normal(x.getLocalSize())
    start, bodies = 0.01 * way[::-1], problem.assembly.bodies
    x.array[:] = start
    problem.tangent(x, matrix)
    missed = []
    for step in (2e-3, 1e-3):
        x.array[:] = start + step * way
        problem.evaluate(x)
        missed.append(float(np.linalg.norm(bodies.missed())))
    assert np.log2(missed[0] / missed[1]) == pytest.approx(2.0, abs=0.1)
    bodies.again = True
    bodies.add_tangent(once_more)
    again = once_more.getValuesCSR()[2]
    bodies.again = False
    x.array[:] = start
    problem.evaluate(x)
    bodies.add_tangent(once_more)
    first = once_more.getValuesCSR()[2]
    assert np.array_equal(first, again)


def _corrected(
    problem: Problem, factor: LaggedFactor, distortion: float, shear: float = 0.0
) -> tuple[float, float]:
    """Residual of a correction over its right-hand side, what `direct` leaves.

    The state is one of random displacements on top of simple shear, which keeps the volume.
    """
    x, matrix = problem.new_vector(), problem.new_tangent()
    x.array[:] = distortion * np.random.default_rng(5).standard_normal(x.getLocalSize())
    nodes = problem.model.space.tabulate_dof_coordinates()
    x.array[: nodes.size : 3] += shear * nodes[:, 2]
    b = -problem.evaluate(x)
    problem.tangent(x, matrix)
    found = factor.solve(matrix, b, 1e-6)
    assert found is not None
    y, product = matrix.createVecs()
    y.array[:] = found
    matrix.mult(y, product)
    return float(np.linalg.norm(product.array_r - b) / np.linalg.norm(b))


def test_a_worn_factor_is_made_anew() -> None:
    """Cells distorted by a fifth of their size with the factor of the state at rest.

    Requirement: the residual that is asked for, whatever the factor is worth; one more
    factorisation, then none for the same state again; an old factor that leads nowhere is given up
    before the iterations that it is allowed.
    """
    problem = _on_plane()
    problem.predict_contact([PRESS])
    problem.set_load_factor(1.0, 1.0)
    factor = LaggedFactor(problem, lambda _: None)
    assert _corrected(problem, factor, 1e-9) < 1e-5
    assert factor.factors == 1
    assert _corrected(problem, factor, 0.05) < 1e-5
    made = factor.factors
    assert factor.krylov[-1] < lagged._PATIENCE
    assert _corrected(problem, factor, 0.05) < 1e-5
    assert factor.factors == made <= 2
    factor.close()


@pytest.mark.parametrize("nu", [0.45, 0.499, 0.4999])
def test_volume_that_is_kept_wears_no_factor(nu: float) -> None:
    """Sheared bodies with the factor of the state at rest.

    Requirement: the residual that is asked for, of the displacements alone, with that factor;
    iterations that hardly grow with nu, from 7 to 11 at a residual at which single precision shows.
    Without the mixed form the factor is given up at 0.499.
    """
    problem = _on_plane(cells=6, material=HARDLY_COMPRESSIBLE | {"nu": nu})
    problem.set_load_factor(1.0, 1.0)
    factor = LaggedFactor(problem, lambda _: None)
    assert _corrected(problem, factor, 1e-9) < 1e-6
    assert _corrected(problem, factor, 1e-6, shear=0.1) < 1e-6
    assert factor.factors == 1
    assert factor.krylov[-1] <= 12
    factor.close()


@pytest.mark.parametrize(("material", "count"), [(RUBBER, 2), (HARDLY_COMPRESSIBLE, 1)])
def test_no_attempt_is_made_twice(material: dict[str, Any], count: int) -> None:
    """Where pressures follow there is no line search: the second attempt would be the first.

    Requirement: from an accepted state, with nothing extrapolated, the ways to go differ.
    """
    problem = _pair(material=material)
    newton: Any = None
    attempts = Attempts(problem, newton, newton, newton)
    x = problem.accepted()
    searching, full = _Way(x, full_steps=False), _Way(x)
    assert len(attempts._ways(searching, full, False)) == count
    assert len(attempts._apart(searching, full)) == count  # those with penalties
    assert len(attempts._ways(replace(searching, ratio=1.0), full, False)) == 2


def test_a_factor_that_is_made_again_goes_on_as_the_first_one() -> None:
    """Requirement: a run that goes on finds the same corrections, to the last bit.

    Derivatives of the changes of volume at the state of the factor are kept with it.
    """
    problem = _on_plane(cells=6, material=HARDLY_COMPRESSIBLE)
    problem.set_load_factor(1.0, 1.0)
    first = LaggedFactor(problem, lambda _: None)
    _corrected(problem, first, 1e-9)
    again = LaggedFactor(problem, lambda _: None, first.persistent())
    left = [_corrected(problem, one, 1e-6, shear=0.1) for one in (first, again)]
    assert left[0] == left[1] < 1e-6
    assert again.factors == 0
    assert again.krylov[-1] == first.krylov[-1]
    for one in (first, again):
        one.close()


def test_where_there_is_no_new_factor_the_old_one_goes_on(monkeypatch: pytest.MonkeyPatch) -> None:
    """MUMPS fails at a tangent far from the one that the factor is of.

    Requirement: the factor of before solves, with the iterations that it would have taken.
    """
    problem = _on_plane()
    problem.set_load_factor(1.0, 1.0)
    factor = LaggedFactor(problem, lambda _: None)
    for distortion in (1e-9, 1e-3):
        assert _corrected(problem, factor, distortion) < 1e-5
    used = factor.krylov[-1]
    check, failed = interior.Interior._check, list[Any]()

    def fails(of: interior.Interior) -> None:
        failed.append(of)
        if len(failed) == 1:
            raise singular()
        check(of)

    monkeypatch.setattr(interior.Interior, "_check", fails)
    factor._due = True
    assert _corrected(problem, factor, 1e-3) < 1e-5
    assert (len(failed), factor.factors, factor.krylov[-1]) == (2, 1, used)
    factor.close()


def test_couplings_that_are_in_the_border_need_no_new_factor() -> None:
    """Nodes that slide on couple others, all of which contact could couple before.

    Requirement: the factor there is, as its border has room for them; one where a node is not in
    it. A pair of order 2 at slave nodes took 11 factorisations for 32 corrections, now 3.
    """
    problem = _on_plane()
    problem.set_load_factor(1.0, 1.0)
    factor = LaggedFactor(problem, lambda _: None)
    assert _corrected(problem, factor, 1e-9) < 1e-5
    factor.outgrow()
    assert _corrected(problem, factor, 1e-9) < 1e-5
    assert factor.factors == 1
    assert factor._touched is not None
    factor._touched.unknowns = factor._touched.unknowns[3:]
    factor.outgrow()
    assert _corrected(problem, factor, 1e-9) < 1e-5
    assert factor.factors == 2
    factor.close()


def test_a_factor_in_single_precision_that_is_not_enough(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where Krylov iterations do not get along with one, it is made in double precision."""
    asked = []
    make = bordered.BorderedLU

    def made(matrix: Any, border: Any, single: bool) -> Any:
        asked.append(single)
        factor = make(matrix, border, single)
        if single:  # stands for one that is of no use
            monkeypatch.setattr(factor, "solve", lambda b, x: x.set(0.0))
        return factor

    monkeypatch.setattr(lagged, "BorderedLU", made)
    problem = _on_plane()
    problem.set_load_factor(1.0, 1.0)
    factor = LaggedFactor(problem, lambda _: None)
    assert _corrected(problem, factor, 1e-3) < 1e-5
    assert asked == [True, False]
    factor.close()


def test_where_no_kept_factor_serves(monkeypatch: pytest.MonkeyPatch) -> None:
    """A correction to which none leads comes from a factorisation of all unknowns."""
    make = bordered.BorderedLU

    def made(*given: Any) -> Any:
        factor = make(*given)
        monkeypatch.setattr(factor, "solve", lambda b, x: x.set(0.0))  # of no use
        return factor

    monkeypatch.setattr(lagged, "BorderedLU", made)
    problem = _on_plane()
    problem.set_load_factor(1.0, 1.0)
    factor = LaggedFactor(problem, lambda _: None)
    assert _corrected(problem, factor, 1e-3) < 1e-12
    factor.close()


def test_where_a_factorisation_of_all_unknowns_costs_less(monkeypatch: pytest.MonkeyPatch) -> None:
    """Corrections that old factors make dearer are those of `direct`, but for a try now and then.

    Requirement: `condensed` costs hardly more than `direct` where a factorisation costs little, as
    in the plane. Here it is said to cost nothing; the tolerance of forces is that of Newton's
    method. Without it all 10 or so corrections take Krylov iterations; here two do in the
    beginning, and one after every two, four ... that do not.
    """
    made: list[LaggedFactor] = []

    class Free(LaggedFactor):
        _whole_cost = 0.0

        def __init__(self, *given: Any) -> None:
            super().__init__(*given)
            made.append(self)

    monkeypatch.setattr(lagged_newton, "LaggedFactor", Free)
    _same(_pair, [PRESS, DRAG])
    (factor,) = made
    tried = np.array(factor.krylov) > 0
    assert len(tried) > 8
    np.testing.assert_array_equal(tried[:7], [True, True, False, False, True, False, False])


def test_a_correction_after_one_without_gain_is_more_precise() -> None:
    """Corrections are as precise as the theory page says: 1e-3, and 1e-4 where nothing was gained.

    Source: docs/theory/condensation.md; both are the bounds themselves, without rounding. The
    system stands for one far out of balance, whose forces have not fallen by half since.
    """
    problem = _pair()
    problem.balance = replace(problem.balance, force_scale=1.0)
    solver = LaggedNewton(problem, "lagged_", {}, lambda *_: None, lambda _: None, {})
    solver._forcing.begin()
    asked = [solver._forcing.rtol(problem, size) for size in (1.0, 0.6, 0.1)]
    solver.close()
    assert asked == [ROUGH, CAREFUL, ROUGH]


def test_auto_takes_it_beyond_a_number_of_unknowns() -> None:
    """More than 2000 unknowns; below that a factorisation is as cheap."""
    top = {"block.top": {"x": 0.0, "y": 0.0, "z": -0.01}}
    large, small = (Solver(_on_plane(cells=n), [Step("press", 1, top)]) for n in (15, 4))
    assert large.choice.name == "condensed"
    assert large.choice.reason.startswith("bodies change little, linear ones not at all")
    assert small.choice.name == "direct"
    assert small.choice.reason == "225 unknowns: a factorisation costs no more than iterations"
    assert isinstance(
        large.choice.strategy.solver(large._task, lambda *_: None, lambda _: None, {}), LaggedNewton
    )


def test_petsc_without_mumps(monkeypatch: pytest.MonkeyPatch) -> None:
    """It is said, and `auto` takes `direct`."""
    monkeypatch.setattr(bordered, "reachable", lambda: False)
    said = "material.block is not linear, and this PETSc has no MUMPS for that"
    with pytest.raises(InputError, match=said):
        Solver(_on_plane(), [DRAG], strategy="condensed")


@pytest.mark.skipif(shutil.which("mpirun") is None, reason="no mpirun")
@pytest.mark.slow
def test_two_processes_take_another_strategy(tmp_path: Path) -> None:
    """`auto` says why, and the run gets to its end."""
    text = f"""
[mesh.box.block]
origin = [0, 0, 0]
size = [1, 1, 0.5]
cells = [15, 15, 2]

[material.block]
model = "neo-hookean"
E = {RUBBER["E"]}
nu = {RUBBER["nu"]}

[surface.plane]
shape = "plane"
point = [0, 0, 0]
normal = [0, 0, 1]

[[contact]]
slave = "block.bottom"
master = "plane"
normal = {{ penalty = 1e4 }}
adhesion = {{ stiffness = 1e4 }}
friction = {{ coefficients = 0.3 }}

[[step]]
name = "press"
increments = 1
displacement = {{ "block.top" = {{ x = 0, y = 0, z = -0.01 }} }}

[output]
pictures = false
"""
    (tmp_path / "case.toml").write_text(text)
    run = [sys.executable, "-m", "anisocontact", "run", "case.toml", "-o", "out"]
    done = subprocess.run(
        ["mpirun", "-n", "2", *run], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    log = (tmp_path / "out" / "run.log").read_text()
    assert "direct" in log
    assert "it runs in one process, 2 given" in log
