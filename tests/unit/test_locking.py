"""Which bodies are said to lock."""

from __future__ import annotations

import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.bulk import make_material
from anisocontact.bulk.locking import locking_bodies
from anisocontact.mesh import (
    Body,
    BoxSpec,
    PlaneStrain,
    PlaneStress,
    build_box,
    build_mesh,
    make_shape,
)
from anisocontact.solver import Problem, Step


@pytest.mark.parametrize(
    ("model", "nu", "cell", "order", "said"),
    [
        ("linear-elastic", 0.499, "hexahedron", 1, "-incompressible"),
        ("linear-elastic", 0.47, "hexahedron", 1, ""),
        ("linear-elastic", 0.499, "hexahedron", 2, ""),
        ("linear-elastic-incompressible", 0.5, "hexahedron", 1, ""),
        ("neo-hookean", 0.4999, "hexahedron", 2, "many of them are needed"),
        ("neo-hookean", 0.499, "hexahedron", 2, ""),
        ("neo-hookean", 0.4999, "tetrahedron", 2, "many of them are needed"),
        ("neo-hookean-incompressible", 0.5, "hexahedron", 2, ""),
        ("linear-elastic", 0.4999, "hexahedron", 2, ""),
        ("neo-hookean", 0.49, "hexahedron", 1, "-incompressible"),
        ("linear-elastic-incompressible", 0.5, "tetrahedron", 1, "take order 2"),
        ("linear-elastic-incompressible", 0.5, "tetrahedron", 2, ""),
    ],
)
def test_bodies_that_lock(model: str, nu: float, cell: str, order: int, said: str) -> None:
    """A line with the cure, which `check` of a problem and a run tell."""
    bodies = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1), order=order, cell=cell)})
    soft = {"block": make_material(model, E=1.0, nu=nu)}
    lines = locking_bodies(bodies, soft)
    assert [said in line for line in lines] == ([True] if said else [])
    step = Step("hold", 1, {"block.bottom": {"x": 0.0, "y": 0.0, "z": 0.0}})
    told = Problem(bodies, soft).check([step])
    assert [line for line in told if "lock" in line or "stiff" in line] == lines


@pytest.mark.parametrize(("plane", "count"), [(PlaneStrain(), 1), (PlaneStress(), 0)])
def test_sheets_do_not_lock(plane: PlaneStrain | PlaneStress, count: int) -> None:
    """In plane stress a body gives way through its thickness."""
    square = make_shape("rectangle", origin=(0, 0), size=(1, 1), cells=(2, 2))
    bodies = build_mesh([Body("sheet", square)], idealisation=plane)
    soft = {"sheet": make_material("linear-elastic", E=1.0, nu=0.499)}
    assert len(locking_bodies(bodies, soft)) == count
