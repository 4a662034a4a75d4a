"""Files of meshes in the plane: gmsh's surfaces are bodies, curves facet groups."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.mesh import Body, PlaneStrain, build_mesh, make_shape, read_gmsh
from anisocontact.mesh.write import write_mesh

pytest.importorskip("meshio")


@pytest.mark.parametrize("cell", ["quadrilateral", "triangle"])
@pytest.mark.parametrize("order", [1, 2])
def test_a_file_of_gmsh_gives_the_same_mesh(tmp_path, cell, order):
    """Requirement: names, curved cells and facets of a half disc come back from a file."""
    half = make_shape("disc", radius=2.0, cells=(8, 2), part="half", cell=cell, order=order)
    arrays = Body("ball", half).arrays()
    write_mesh(arrays, tmp_path / "half.msh")
    written = read_gmsh(tmp_path / "half.msh", idealisation=PlaneStrain())
    built = build_mesh([Body("ball", half)], idealisation=PlaneStrain())
    assert written.facet_names() == built.facet_names() == ["ball.left", "ball.outer"]
    assert [written.count_facets(n) for n in ("ball.left", "ball.outer")] == [6, 4]
    assert written.order == order
    nodes = [
        np.unique(m.space.tabulate_dof_coordinates().round(9), axis=0) for m in (written, built)
    ]
    assert np.array_equal(*nodes)
