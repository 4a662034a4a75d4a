"""Files of meshes in the plane: gmsh's surfaces are bodies, curves facet groups."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.mesh import Body, PlaneStrain, build_mesh, make_shape, read_gmsh
from anisocontact.mesh.gmsh import gmsh_arrays
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


def gmsh_file(path, points: list[tuple[float, float]], elements: list[str]):
    """A file of format 2.2 with nodes by their places, and group 1, "a.low", group 2, "a"."""
    sections = {
        "MeshFormat": ["2.2 0 8"],
        "PhysicalNames": ["2", '1 1 "a.low"', '2 2 "a"'],
        "Nodes": [f"{len(points)}", *(f"{k} {x} {y} 0" for k, (x, y) in enumerate(points, 1))],
        "Elements": [f"{len(elements)}", *elements],
    }
    lines = [line for name, rows in sections.items() for line in (f"${name}", *rows, f"$End{name}")]
    path.write_text("\n".join([*lines, ""]))
    return path


def test_quadrilaterals_beside_triangles_are_cut(tmp_path):
    """Requirement: what gmsh recombines but for a few triangles is read as triangles, and so said,
    with its groups; the area is that of the file, a strip of 3 x 1, to rounding."""
    points = [(0, 0), (1, 0), (2, 0), (3, 0), (0, 1), (1, 1), (2, 1), (3, 1)]
    elements = ["1 1 2 1 1 1 2", "2 1 2 1 1 2 3", "3 3 2 2 1 1 2 6 5", "4 3 2 2 1 2 3 7 6"]
    elements += ["5 2 2 2 1 3 4 8", "6 2 2 2 1 3 8 7"]
    strip = gmsh_arrays(gmsh_file(tmp_path / "a.msh", points, elements))
    told = "quadrilaterals of 4 nodes and triangles of 3 nodes are taken as 6 triangles"
    assert strip.notes == (told,)
    assert strip.cell == "triangle" and len(strip.facets["a.low"]) == 2
    x = strip.points[strip.cells][:, :, :2]
    area = 0.5 * np.abs(np.linalg.det(x[:, 1:] - x[:, :1])).sum()
    assert area == pytest.approx(3.0, rel=1e-14)


def test_quadrilaterals_of_8_nodes_get_a_middle(tmp_path):
    """Requirement: cells of `Mesh.SecondOrderIncomplete`, one with a curved side, are of order 2;
    their middle is where the shape functions of eight nodes have it, to rounding."""
    points = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0.4), (2, 1), (1, 2), (0, 1)]
    elements = ["1 8 2 1 1 1 2 5", "2 16 2 2 1 1 2 3 4 5 6 7 8"]
    cell = gmsh_arrays(gmsh_file(tmp_path / "a.msh", points, elements))
    assert cell.degree == 2 and len(cell.facets["a.low"]) == 1
    middle = [p for p in cell.points[:, :2] if not any(np.allclose(p, q) for q in points)]
    np.testing.assert_allclose(middle, [(1.0, 1.2)], atol=1e-14)


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
