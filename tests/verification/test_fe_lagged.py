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
from anisocontact.solver.strategies.condensed import bordered
from anisocontact.solver.strategies.condensed.lagged_newton import LaggedNewton
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
    layers: int = 2,
    order: int = 1,
    material: dict[str, Any] = RUBBER,
    **options: Any,
) -> Problem:
    """A block on a rigid plane."""
    spec = BoxSpec((0, 0, 0), (1, 1, 0.5), (cells, cells, layers), order=order)
    model = build_box({"block": spec})
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


def test_auto_takes_it_beyond_a_number_of_unknowns() -> None:
    """More than 2000 unknowns; below that a factorisation is as cheap."""
    top = {"block.top": {"x": 0.0, "y": 0.0, "z": -0.01}}
    blocks = _on_plane(cells=12, layers=4), _on_plane()
    large, small = (Solver(block, [Step("press", 1, top)]) for block in blocks)
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
    """`auto` says why where few unknowns are left for each, and the run gets to its end."""
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
    assert "2304 unknowns: a factorisation costs no more than iterations" in log
