"""Iterative strategy, bodies that all but keep their volume: solved for pressures as well.

Requirement: with a tight Newton tolerance `iterative` and `direct` solve the same equations, and
every displacement and force agrees to 1e-7 of its size, see `test_fe_iterative`; iterations stay
few where volume is kept ever better. Source: `direct`, an independent way.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import scipy
from tests.verification.test_fe_iterative import (
    CLAMP,
    DRAG,
    PRESS,
    _counts,
    _laws,
    _pair,
    _printed,
    _run,
    _same,
)

from anisocontact.base.fenicsx import Mat
from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.interface import Interface
from anisocontact.mesh import Body, BoxSpec, RingSpec, build_box, build_mesh
from anisocontact.solver import Problem, Solver, Step, StoppedError, Tie
from anisocontact.solver.strategies.iterative import levels, mixed, newton
from anisocontact.solver.strategies.iterative.mixed import DisplacementPressureForm
from anisocontact.surfaces import make_surface

RUBBER = {"model": "neo-hookean-incompressible", "E": 1000.0}
GEL = {"model": "linear-elastic-incompressible", "E": 1000.0}
FAR = Step("press", 2, {**CLAMP, "block.top": {"x": 0.0, "y": 0.0, "z": -0.05}})
QUADRATIC = {"cell": "hexahedron", "order": 2}


@pytest.mark.parametrize(
    ("law", "nu", "press"), [(RUBBER, 0.499, FAR), (RUBBER, 0.4999, PRESS), (GEL, 0.4999, FAR)]
)
def test_block_on_block(law: dict[str, Any], nu: float, press: Step) -> None:
    """Pressed and dragged; at 0.4999 180 iterations on displacements alone do not do.

    There rubber is pressed less: far from a solution its tangents take more.
    """
    _same(lambda: _pair(material=law | {"nu": nu}), [press, DRAG], most=60)


def test_four_pressures_in_a_cell() -> None:
    """Hexahedra of order 2, whose pressures are linear."""
    _same(lambda: _pair(2, shape=QUADRATIC, material=GEL | {"nu": 0.499}), [PRESS], most=90)


def test_symmetry_planes_and_ties() -> None:
    """Forces of pressures on nodes that follow others are handed to these."""

    def tube() -> Problem:
        start, end = np.radians((20.0, 80.0))
        model = build_mesh(
            [Body("tube", RingSpec(1.0, 2.0, 0.25, (4, 8, 2), start=start, end=end))]
        )
        cylinder = make_surface("cylinder", point=(0, 0, 0), axis=(0, 0, 1), radius=1.01)
        inside = Contact(model, "tube.inner", Interface(cylinder, *_laws()), mortar=False)
        planes = ["tube.start", "tube.end", "tube.bottom"]
        law = make_material(**GEL, nu=0.499)
        return Problem(model, {"tube": law}, [inside], symmetry=planes)

    def tied() -> Problem:
        boxes = {
            "block": BoxSpec((0, 0, 0), (1, 1, 0.5), (4, 4, 2)),
            "foot": BoxSpec((0, 0, -0.5), (1, 1, 0.5), (3, 3, 2)),
        }
        model = build_box(boxes)
        plane = make_surface("plane", point=(0, 0, -0.5), normal=(0, 0, 1))
        below = Contact(model, "foot.bottom", Interface(plane, *_laws()), mortar=False)
        law = make_material(**RUBBER, nu=0.499)
        ties = [Tie("block.bottom", "foot.top")]
        return Problem(model, dict.fromkeys(boxes, law), [below], ties=ties)

    _same(tube, [Step("press", 2, traction={"tube.outer": {"x": -5.0, "y": -5.0}})], most=60)
    top = {"block.top": {"x": 0.0, "y": 0.0, "z": -0.03}}
    _same(tied, [Step("press", 2, top)], most=60)


def test_iterations_as_bodies_keep_their_volume(monkeypatch: pytest.MonkeyPatch) -> None:
    """From nu = 0.49 to 0.4999, a hundred times the bulk modulus, they less than triple.

    On displacements alone they grow with the root of it. Source: in the mixed form the bulk
    modulus goes out of the spectrum [Benzi Golub Liesen 2005, section 10]. All corrections are
    found to 1e-4, as precise as they are otherwise depends on how near Newton's method has come.
    """
    monkeypatch.setattr(newton.Forcing, "rtol", lambda *_: 1e-4)

    def mean(nu: float) -> float:
        notes = _run(_pair(6, material=GEL | {"nu": nu}), [PRESS], "iterative")[1]
        return _counts(notes)[0]

    soft, hard = mean(0.49), mean(0.4999)
    assert hard < 3.0 * soft
    monkeypatch.setattr(newton, "MIXED", np.inf)
    assert mean(0.499) > 2.0 * hard


@pytest.mark.parametrize("room", [True, False])
def test_corrections_that_are_not_found(monkeypatch: pytest.MonkeyPatch, room: bool) -> None:
    """All unknowns are factorised for them, if there is room, and a line says so, once."""
    monkeypatch.setitem(newton.DEFAULTS, "ksp_max_it", 3)
    full = [] if room else ["no room"]
    for module in (mixed, levels):
        monkeypatch.setattr(module, "too_large", lambda *_: iter(full))
    problem = _pair(material=GEL | {"nu": 0.499})
    notes: list[str] = []
    solver = Solver(problem, [PRESS], strategy="iterative")
    if not room:
        with pytest.raises(StoppedError, match="the Krylov method did not converge in 3"):
            list(solver.run(on_note=notes.append))
        return
    (*_, last) = solver.run(on_note=notes.append)
    theirs, _, _ = _run(_pair(material=GEL | {"nu": 0.499}), [PRESS], "direct")
    assert last.reactions["block.top"] == pytest.approx(theirs[-1].reactions["block.top"], rel=1e-6)
    assert sum("does not find every correction" in note for note in notes) == 1


def test_the_mixed_form_is_the_tangent() -> None:
    """With `s = 0` it gives the forces of J, and `J_0` is J with softer bodies.

    Requirement: for any u and pressures s the rows of displacements are `J u + B^T s`; what J_0
    lacks is `B^T (1 - t) C^-1 B` in rows that nothing prescribes. Source: the sum of matrices by
    SciPy. Tolerance: rounding.
    """
    problem = _pair(3, material=RUBBER | {"nu": 0.499})
    problem.begin(FAR)
    problem.set_load_factor(0.5, 0.5)
    x = problem.accepted()
    tangent: Mat = problem.new_tangent()
    problem.tangent(x, tangent)
    volume = problem.bulk.volume
    form = DisplacementPressureForm(problem, volume)
    form.take(tangent)
    rows = volume.rows()
    free = np.ones(problem.unknowns)
    free[problem.constrained()] = 0.0
    kept = np.minimum(mixed.SOFT / np.maximum(volume.hardnesses, 1e-300), 1.0)
    stiffness = scipy.sparse.diags_array((1.0 - kept) * rows.stiffness.reshape(-1))
    missing = scipy.sparse.diags_array(free) @ (rows.slope.T @ stiffness @ rows.slope)
    lacks = _sparse(tangent) - _sparse(form.softened)
    assert abs(lacks - missing).max() < 1e-12 * abs(_sparse(tangent)).max()
    given, out = form.new_vector(), form.new_vector()
    given.array[:] = np.random.default_rng(3).normal(size=given.getLocalSize())
    form.mult(tangent, given, out)
    n = problem.unknowns
    s = given.array[n:] / form.sizes
    forces = _sparse(tangent) @ given.array[:n] + free * (rows.slope.T @ s)
    assert np.abs(out.array[:n] - forces).max() < 1e-12 * np.abs(forces).max()
    assert np.linalg.norm(free * (rows.slope.T @ s)) <= np.linalg.norm(given.array[n:])


SCRIPT = """
from tests.verification.test_fe_iterative import CLAMP, DRAG, _pair
from tests.verification.test_fe_iterative_mixed import FAR, RUBBER
from anisocontact.solver import Solver
problem = _pair(material=RUBBER | {"nu": 0.499})
solver = Solver(problem, [FAR, DRAG], options={"snes_rtol": 1e-11}, strategy="iterative")
last = list(solver.run())[-1]
if problem.comm.rank == 0:
    print(*map(repr, last.reactions["block.top"].tolist()))
"""


@pytest.mark.mpi
def test_processes_change_nothing() -> None:
    """Requirement: reactions of two processes to 1e-8, as of displacements alone."""
    one, two = (_printed(count, SCRIPT) for count in (1, 2))
    assert np.abs(one - two).max() < 1e-8 * np.abs(one).max()


def _sparse(matrix: Mat) -> scipy.sparse.csr_array:
    starts, columns, values = matrix.getValuesCSR()
    return scipy.sparse.csr_array((values, columns, starts), shape=matrix.getSize())
