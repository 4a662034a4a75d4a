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


def test_points_on_a_line_are_seen_as_a_strip():
    """Requirement: pictures of contacts of a mesh in the plane, with areas of any thickness."""
    from anisocontact.results.dataset import DataSet, vertices
    from anisocontact.results.report.frame import ContactView

    x = np.array([0.0, 0.1, 0.4, 1.0])
    data = {
        "contact": np.zeros(4, dtype=int),
        "status": np.array([1, 1, 0, 0]),
        "normal": np.tile([0.0, -1.0, 0.0], (4, 1)),
        "area": np.full(4, 100.0),
    }
    view = ContactView(DataSet("PolyData", np.c_[x, 0 * x, 0 * x], vertices(np.arange(4)), data), 0)
    nearest, outside = view._nearest
    assert view.on_line and not outside.any()
    assert view.box[:, 0] == pytest.approx([-0.05, 1.05])
    assert np.all(nearest == nearest[0]) and np.all(np.diff(nearest[0]) >= 0)
