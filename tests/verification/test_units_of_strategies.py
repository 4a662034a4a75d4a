"""Whatever the units, every strategy gives the same answers in as many iterations.

Requirement: a problem whose stresses are all 2^k times as large has 2^k times the forces, to 1e-12,
in as many Newton iterations, with the same lines in the log and as many Krylov iterations. Source:
the equations are homogeneous in the stresses. Tolerance: a power of two rounds nothing; measured
4e-15, where a coarse factor is that of a multiple. Single precision ends at 3e38 and 1e-38, MUMPS
takes pivots below 1e-16 for zero where it looks for none, and PETSc residuals below 1e-50.
"""

from __future__ import annotations

import numpy as np
import pytest

from anisocontact.anisotropy import make_directions
from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.laws import Friction
from anisocontact.mesh import BoxSpec, build_box
from anisocontact.solver import Problem, Solver, Step
from anisocontact.surfaces import make_surface

PRESS = Step("press", 1, {"block.top": {"x": 0.0, "y": 0.0, "z": -0.01}})
DRAG = Step("drag", 2, {"block.top": {"x": 0.02}})


def _run(strategy: str, model: str, stress: float) -> tuple[np.ndarray, list[int], list[str]]:
    """Forces of a dragged block over the stress, its Newton iterations, and the log."""
    mesh = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 1), (3, 3, 4))})
    marks = make_directions("constant", vector=(1.0, 0.3, 0.0))
    plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    law = Friction(coefficients=(0.2, 0.4), directions=marks)
    contact = Contact(mesh, "block.bottom", plane, law=law)
    material = make_material(model, E=10.0 * stress, nu=0.3)
    problem = Problem(mesh, {"block": material}, [contact])
    notes: list[str] = []
    solver = Solver(problem, [PRESS, DRAG], strategy=strategy)
    accepted = list(solver.run(on_note=notes.append))
    force = [next(iter(one.resultants.values()))[0] for one in accepted]
    return np.array(force) / stress, [one.iterations for one in accepted], notes


@pytest.mark.parametrize(
    ("strategy", "model", "exponents"),
    [
        ("condensed", "linear-elastic", (-133, -66, 120)),
        ("condensed", "neo-hookean", (-66, 66)),
        ("iterative", "linear-elastic", (-133, -66, 120)),
        ("iterative", "neo-hookean", (-133, 120)),
    ],
)
def test_stresses(strategy: str, model: str, exponents: tuple[int, ...]) -> None:
    """See the module."""
    usual, iterations, notes = _run(strategy, model, 1.0)
    for exponent in exponents:
        force, same, told = _run(strategy, model, 2.0**exponent)
        np.testing.assert_allclose(force, usual, atol=1e-12 * np.abs(usual).max(), rtol=0.0)
        assert same == iterations
        assert told == notes
