"""Elastic energy per volume of cells: uniform states, and the sum over a body in contact."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.bulk import make_material
from anisocontact.bulk.cell_energy import volumes
from anisocontact.cli import main
from anisocontact.mesh import Axisymmetric, Body, build_mesh, make_shape
from anisocontact.results import Results
from anisocontact.results.paraview import BodyGrid
from anisocontact.solver import Problem, Solver, Step

E, NU = 1000.0, 0.3
BULK, SHEAR = E / (3.0 - 6.0 * NU), E / (2.0 + 2.0 * NU)
PLASTIC = {"yield_stress": 1e3, "hardening": 1.0}


def pulled(kind: str, cell: str, order: int, **more: float) -> Problem:
    """A block under uniform tension of 5, on symmetry planes."""
    shape = make_shape(
        "box", origin=(0, 0, 0), size=(2, 1, 1), cells=(2, 1, 2), cell=cell, order=order
    )
    model = build_mesh([Body("block", shape)])
    law = make_material(kind, **({"E": E, "nu": NU} | more))
    planes = ["block.left", "block.front", "block.bottom"]
    problem = Problem(model, {"block": law}, symmetry=planes)
    step = Step("pull", 1, traction={"block.right": {"x": 5.0}})
    list(Solver(problem, [step], options={"snes_rtol": 1e-12}).run())
    return problem


STATES = [
    pytest.param(cell, order, kind, more, marks=pytest.mark.slow if long else [])
    for cell, order in (("hexahedron", 1), ("hexahedron", 2), ("tetrahedron", 2))
    for kind, more in (
        ("linear-elastic", {}),
        ("linear-elastic", {"nu": 0.4999}),
        ("neo-hookean", {}),
        ("neo-hookean-incompressible", {"nu": 0.499}),
    )
    for long in [(cell, order, kind) == ("hexahedron", 2, "neo-hookean-incompressible")]
]


@pytest.mark.parametrize(
    ("cell", "order", "kind", "more"),
    [*STATES, pytest.param("hexahedron", 1, "plastic", PLASTIC, marks=pytest.mark.slow)],
)
def test_of_a_uniform_state(kind: str, more: dict[str, float], cell: str, order: int):
    """Requirement: the same in every cell, and together the energy of the block; at small strain
    sigma^2 / (2 E). Source: Hooke; the energy of the problem, which is assembled otherwise.
    Tolerance: Newton's; of laws at finite strain the strain, 0.5 %, times three.
    """
    problem = pulled(kind, cell, order, **more)
    found = BodyGrid(problem).now().energy_density
    assert found == pytest.approx(np.full(len(found), found.mean()), rel=1e-8)
    assert found @ volumes(problem.model) == pytest.approx(problem.energies()["elastic"], rel=1e-9)
    small = kind in ("linear-elastic", "plastic")
    assert found.mean() == pytest.approx(5.0**2 / (2.0 * E), rel=1e-8 if small else 0.015)


def test_of_a_body_of_revolution():
    """Requirement: volumes are those of rings, and energies with them. Tolerance: rounding."""
    shape = make_shape("rectangle", origin=(1, 0), size=(1, 1), cells=(2, 2), order=2)
    model = build_mesh([Body("ring", shape)], idealisation=Axisymmetric())
    assert volumes(model).sum() == pytest.approx(np.pi * 3.0, rel=1e-12)
    problem = Problem(model, {"ring": make_material("linear-elastic", E=E, nu=NU)})
    held = {"ring.bottom": {"y": 0.0}, "ring.top": {"y": 0.01}}
    list(Solver(problem, [Step("pull", 1, held)], options={"snes_rtol": 1e-12}).run())
    found = BodyGrid(problem).now().energy_density
    assert found == pytest.approx(np.full(4, E * 0.01**2 / 2.0), rel=1e-8)


def test_it_is_written_where_it_is_named(tmp_path: Path):
    case = """
[mesh.box.block]
origin = [0, 0, 0]
size = [1, 1, 1]
cells = [2, 1, 1]
[material.block]
model = "linear-elastic"
E = 1000
nu = 0
[surface.floor]
shape = "plane"
point = [0, 0, -1]
normal = [0, 0, 1]
[[contact]]
slave = "block.bottom"
master = "floor"
friction = { coefficients = 0.3 }
[[step]]
name = "pull"
increments = 1
displacement = { "block.left" = { x = 0, y = 0, z = 0 }, "block.right" = { x = 0.01 } }
[output]
pictures = false
"""
    for more in ("", 'quantities = ["energy_density"]\n'):
        path, out = tmp_path / "case.toml", tmp_path / f"out{len(more)}"
        path.write_text(case + more)
        assert main(["run", str(path), "-o", str(out)]) == 0
        cells = Results(out).fields().cell_data
        assert ("energy_density" in cells) == bool(more)
    assert np.asarray(cells["energy_density"]) == pytest.approx([0.05, 0.05], rel=1e-8)
