"""Files of meshes in the plane: gmsh's surfaces are bodies, curves facet groups."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.mesh import Body, PlaneStrain, build_mesh, make_shape, read_gmsh
from anisocontact.mesh.write import write_mesh
from anisocontact.results.dataset import DataSet, vertices
from anisocontact.results.report import maps
from anisocontact.results.report.along import pressure_along, traction_along
from anisocontact.results.report.frame import ContactView
from anisocontact.results.report.run_data import Moment

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


def line_view(x: np.ndarray, traction: float = 0.0) -> ContactView:
    """Points on a line, the first two touching."""
    touching = np.arange(len(x)) < 2
    data = {
        "contact": np.zeros(len(x), dtype=int),
        "status": touching.astype(int),
        "normal": np.tile([0.0, -1.0, 0.0], (len(x), 1)),
        "area": np.full(len(x), 100.0),
        "pressure": np.where(touching, 3.0, 0.0),
        "traction_principal": np.full((len(x), 2), traction),
        "direction_friction_1": np.tile([0.0, 0.0, 1.0], (len(x), 1)),
        "direction_friction_2": np.tile([1.0, 0.0, 0.0], (len(x), 1)),
    }
    points = np.c_[x, 0 * x, 0 * x]
    return ContactView(DataSet("PolyData", points, vertices(np.arange(len(x))), data), 0)


def test_points_on_a_line_are_seen_as_a_strip():
    """Requirement: pictures of contacts of a mesh in the plane, with areas of any thickness."""
    view = line_view(np.array([0.0, 0.1, 0.4, 1.0]))
    nearest, outside = view._nearest
    assert view.on_line and not outside.any()
    assert view.box[:, 0] == pytest.approx([-0.05, 1.05])
    assert np.all(nearest == nearest[0]) and np.all(np.diff(nearest[0]) >= 0)


def test_values_on_a_line_are_curves():
    """Requirement: pressure and traction in the plane are drawn over the place, 0 where points are
    open, axes of friction by their names; points above each other, of a strip in space, are not."""
    places = np.array([0.1, 0.0, 1.0, 0.4])
    view, moment = line_view(places, 0.5), Moment("press, increment 2", 0, 0)
    assert view.one_curve
    assert not line_view(np.append(places, 0.4)).one_curve
    (axes,) = pressure_along([(view, moment)]).axes
    assert axes.lines[0].get_xydata() == pytest.approx(
        np.array([[0, 3], [0.1, 3], [0.4, 0], [1, 0]])
    )
    (axes,) = traction_along(view, moment, 0.5).axes
    assert [line.get_label() for line in axes.lines] == [
        "along the first axis of friction, z",
        "along the second axis of friction, x",
    ]
    assert axes.lines[1].get_ydata() == pytest.approx([0.5, 0.5, 0, 0])


def test_titles_of_panels_are_no_wider_than_them():
    """Requirement: a long name of a step is read whole."""
    title = maps._title(
        Moment("press both pads down onto the sheet until they sit, increment 2", 0, 0)
    )
    assert max(map(len, title.splitlines())) <= maps.LETTERS
    assert (
        title.replace("\n", " ")
        == "press both pads down onto the sheet until they sit, increment 2"
    )
