"""The grid of the bodies that ParaView is given."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.case import load
from anisocontact.case.build import build
from anisocontact.results.paraview import BodyGrid
from anisocontact.results.stress_invariants import von_mises

# Sums of a few dozen numbers of the size of the result: round-off, no more.
ROUND_OFF = 1e-12


def uniform(tmp_path, case_text, cell, order):
    """A block stretched along z by 0.1 %, sides free: a state known in closed form."""
    data = case_text.replace('cell = "hexahedron"', f'cell = "{cell}"')
    data = data.replace("order = 1", f"order = {order}")
    (tmp_path / "case.toml").write_text(data)
    return build(load(tmp_path / "case.toml")).problem


@pytest.mark.parametrize("cell", ["hexahedron", "tetrahedron"])
@pytest.mark.parametrize("order", [1, 2])
def test_grid_of_every_cell_and_order(tmp_path, case_text, cell, order):
    """VTK sees the same body: its volume 0.5, and a linear field where its nodes are.

    A wrong order of the nodes of a quadratic cell would change the volume. The stress of the
    field `u = (0, 0, 0.001 z)` is that of Hooke, `(lambda, lambda, lambda + 2 G) 0.001`, at every
    node, whatever the cell.
    """
    problem = uniform(tmp_path, case_text, cell, order)
    x = problem.model.space.tabulate_dof_coordinates()
    u = problem.u.x.array.reshape(-1, 3)
    u[:, 2] = 1e-3 * x[: len(u), 2]
    pyvista = pytest.importorskip("pyvista")
    (tmp_path / "grid.vtu").write_bytes(BodyGrid(problem).grid().encoded())
    grid = pyvista.read(tmp_path / "grid.vtu")
    sized = grid.compute_cell_sizes(length=False, area=False)
    assert sized.cell_data["Volume"].sum() == pytest.approx(0.5, rel=ROUND_OFF)
    assert sized.cell_data["Volume"].min() > 0.0
    assert np.array_equal(grid.point_data["displacement"][:, 2], 1e-3 * grid.points[:, 2])
    lame, shear = 1000 * 0.3 / (1.3 * 0.4), 1000 / 2.6
    expected = 1e-3 * np.array([lame, lame, lame + 2 * shear, 0, 0, 0])
    assert np.allclose(grid.point_data["stress"], expected, atol=1e-12 * 1000)
    assert np.allclose(grid.point_data["von_mises"], 2e-3 * shear, rtol=1e-9)


def test_von_mises_of_known_states():
    """Uniaxial tension s gives s, pure shear t gives sqrt(3) t, pressure gives 0."""
    states = np.array([[7.0, 0, 0, 0, 0, 0], [0, 0, 0, 2.0, 0, 0], [5.0, 5, 5, 0, 0, 0]])
    assert von_mises(states) == pytest.approx([7.0, 2.0 * np.sqrt(3.0), 0.0])
