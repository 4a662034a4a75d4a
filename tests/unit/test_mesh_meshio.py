"""Files of other codes, written by meshio and read back."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)
pytest.importorskip("meshio")

import meshio

from anisocontact.base.errors import InputError
from anisocontact.mesh import MeshFile, build_mesh
from anisocontact.mesh.readers import file_arrays

#: Two cubes beside each other that share no node.
POINTS = np.array(
    [
        [x + shift, y, z]
        for shift in (0.0, 2.0)
        for z in (0.0, 1.0)
        for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))
    ]
)
HEXAHEDRA = np.arange(16).reshape(2, 8)
LOWER = np.array([[0, 1, 2, 3]])
FORMATS = ["vtu", "vtk", "xdmf", "med", "mesh", "bdf", "avs"]


def cubes(number: int = 7) -> meshio.Mesh:
    """The cubes with numbers of their own, and one facet with a number."""
    data = {
        "vtk": "MaterialIds",
        "vtu": "MaterialIds",
        "xdmf": "MaterialIds",
        "med": "cell_tags",
        "mesh": "medit:ref",
        "bdf": "nastran:ref",
        "avs": "avsucd:material",
    }
    cells = [("hexahedron", HEXAHEDRA), ("quad", LOWER)]
    tags = [np.array([3, 4]), np.array([number])]
    return meshio.Mesh(POINTS, cells, cell_data={name: tags for name in set(data.values())})


def plain(suffix: str) -> meshio.Mesh:
    """The cubes with the one name of their numbers that a format knows."""
    mesh = cubes()
    keep = {"med": "cell_tags", "mesh": "medit:ref", "bdf": "nastran:ref", "avs": "avsucd:material"}
    key = keep.get(suffix, "MaterialIds")
    sign = -1 if suffix == "med" else 1  # cells have negative numbers there
    mesh.cell_data = {key: [sign * part for part in mesh.cell_data[key]]}
    if suffix == "med":
        mesh.cell_tags = {-3: ["left"], -4: ["right"], -7: ["lower"]}
    return mesh


@pytest.mark.parametrize("suffix", FORMATS)
@pytest.mark.filterwarnings("ignore")
def test_cells_and_numbers_survive(tmp_path, suffix):
    path = tmp_path / f"cubes.{suffix}"
    plain(suffix).write(path)
    model = build_mesh([MeshFile(path)])
    wanted = ["left", "right"] if suffix == "med" else ["body3", "body4"]
    assert model.body_names() == wanted
    group = "left.lower" if suffix == "med" else "body3.surface7"
    assert model.count_facets(group) == 1
    x = model.mesh.geometry.x
    assert x.shape == (16, 3)
    assert np.allclose(np.sort(x, axis=0), np.sort(POINTS, axis=0), atol=1e-12)


def test_numbers_of_another_name_are_said(tmp_path):
    """Requirement: an array that may number the bodies and is not read is named, one that numbers
    every cell or has no whole numbers is not."""
    points, cells = np.concatenate([POINTS, POINTS + 5.0]), np.arange(32).reshape(4, 8)
    arrays = {"region": [1, 1, 2, 2], "id": [1, 2, 3, 4], "heat": [0.5, 0.5, 1, 2], "one": [1] * 4}
    data = {name: [np.array(values)] for name, values in arrays.items()}
    mesh = meshio.Mesh(points, [("hexahedron", cells)], cell_data=data)
    mesh.write(tmp_path / "cubes.vtu")
    (note,) = file_arrays(tmp_path / "cubes.vtu", field="").notes
    assert note.startswith("are numbered from 1 to 2 by 'region', which is not read; bodies are")
    mesh.cell_data["PartId"] = [np.array([5, 5, 6, 6])]
    mesh.write(tmp_path / "cubes.vtu")
    named = file_arrays(tmp_path / "cubes.vtu", field="")
    assert list(named.bodies) == ["body5", "body6"]
    assert not named.notes


@pytest.mark.parametrize(
    ("numbers", "said"),
    [
        ([1.0, 2.5], "of which 1 of 2 values are no whole numbers, the first 2.5; give whole"),
        ([np.nan, np.inf], "of which 2 of 2 values are no whole numbers, the first nan"),
    ],
)
def test_numbers_of_bodies_are_whole(tmp_path, numbers, said):
    """Requirement: two bodies whose numbers have the same whole part are not one body."""
    data = {"MaterialIds": [np.array(numbers)]}
    mesh = meshio.Mesh(POINTS, [("hexahedron", HEXAHEDRA)], cell_data=data)
    mesh.write(tmp_path / "cubes.vtu")
    with pytest.raises(InputError, match=f"cells are numbered by 'MaterialIds', {said}"):
        file_arrays(tmp_path / "cubes.vtu")
    mesh.cell_data = {"MaterialIds": [np.array([2.0, 3.0])]}  # whole numbers written as floats
    mesh.write(tmp_path / "cubes.vtu")
    assert list(file_arrays(tmp_path / "cubes.vtu").bodies) == ["body2", "body3"]


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("suffix", ["med", "vtu"])
def test_a_facet_in_two_groups_is_in_both(tmp_path, suffix):
    """Requirement: groups that overlap have all of their facets, nodes are groups too; a body of
    two names has one of them, which is said."""
    upper = np.array([[4, 5, 6, 7]])
    mesh = meshio.Mesh(POINTS, [("hexahedron", HEXAHEDRA), ("quad", np.vstack([LOWER, upper]))])
    if suffix == "med":
        mesh.cell_data = {"cell_tags": [np.array([-1, -2]), np.array([-3, -4])]}
        mesh.cell_tags = {-1: ["left"], -2: ["right", "all"], -3: ["ends", "low"], -4: ["ends"]}
        mesh.point_data = {"point_tags": np.array([2, 3, *[0] * 14])}
        mesh.point_tags = {2: ["edge", "corner"], 3: ["edge"]}
    else:
        both, none = np.ones(2, int), np.zeros(2, int)
        mesh.cell_data = {"group:left": [np.array([1, 0]), none], "group:ends": [none, both]}
        mesh.cell_data |= {"group:all": [np.array([0, 1]), none]}
        mesh.cell_data |= {"group:right": [np.array([0, 1]), none]}
        mesh.cell_data |= {"group:low": [none, np.array([1, 0])]}
    mesh.write(tmp_path / f"cubes.{suffix}")
    found = file_arrays(tmp_path / f"cubes.{suffix}", field="")
    assert {name: len(facets) for name, facets in found.facets.items()} == {
        "left.ends": 2,
        "left.low": 1,
    }
    assert list(found.bodies) == ["left", "right"]
    assert "1 cells in all and right: they are of the body 'right'" in found.notes
    if suffix == "med":
        assert {name: len(nodes) for name, nodes in found.nodes.items()} == {
            "left.edge": 2,
            "left.corner": 1,
        }


@pytest.mark.filterwarnings("ignore")
def test_exodus_with_sets_of_nodes(tmp_path):
    mesh = meshio.Mesh(
        POINTS, [("hexahedron", HEXAHEDRA)], point_sets={"held": np.array([0, 1, 2, 3])}
    )
    mesh.write(tmp_path / "cubes.e")
    model = build_mesh([MeshFile(tmp_path / "cubes.e")])
    assert model.body_names() == ["body"]
    assert model.facet_names() == ["body.held"]


@pytest.mark.parametrize(("kind", "nodes", "order"), [("tetra10", 10, 2), ("hexahedron20", 20, 2)])
def test_quadratic_cells_are_in_order(tmp_path, kind, nodes, order):
    """A wrong order of middle nodes makes inverted cells, or other volumes."""
    corners = POINTS[:8] if kind.startswith("hex") else np.array([[0, 0, 0], *np.eye(3)])
    pairs = {
        "tetra10": [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)],
        "hexahedron20": [
            *((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4)),
            *((0, 4), (1, 5), (2, 6), (3, 7)),
        ],
    }[kind]
    points = np.concatenate([corners, [0.5 * (corners[a] + corners[b]) for a, b in pairs]])
    assert len(points) == nodes
    path = tmp_path / "one.vtu"
    meshio.Mesh(points, [(kind, np.arange(nodes)[None])]).write(path)
    arrays = file_arrays(path)
    assert arrays.degree == order
    # straight edges: every node is where the affine map of the corners has it
    from anisocontact.base.fenicsx import cell_nodes

    place = 0.5 * cell_nodes(arrays.cell, 2)
    assert np.allclose(arrays.points[arrays.cells[0]], place)


def test_what_is_wrong_is_one_line(tmp_path, monkeypatch):
    (tmp_path / "broken.vtu").write_text("no mesh")
    meshio.Mesh(np.add(POINTS[:4], (0, 0, 1)), [("quad", LOWER)]).write(tmp_path / "flat.vtu")
    for name, said in (
        ("broken.vtu", "meshio cannot read it"),
        (
            "flat.vtu",
            "no solid cell (tetra, tetra10, hexahedron, hexahedron20, hexahedron27, wedge",
        ),
    ):
        with pytest.raises(InputError) as caught:
            file_arrays(tmp_path / name)
        line = str(caught.value)
        assert line.startswith("mesh.file: mesh file")
        assert said in line
        assert "\n" not in line
    monkeypatch.setitem(__import__("sys").modules, "meshio", None)
    with pytest.raises(InputError, match=r"need meshio: pip install 'anisocontact\[meshes\]'"):
        file_arrays(tmp_path / "flat.vtu")


@pytest.mark.parametrize(
    ("nodes", "points", "said"),
    [
        ([0, 1, 2, 3, 4, 5, 6, 99], POINTS[:8], "a cell names node 99 counted from 0, there are 8"),
        ([0, 1, 2, 3, 4, 5, 6, -1], POINTS[:8], "a cell names node -1 counted from 0, there are 8"),
        (range(8), [*POINTS[:7], [0, np.inf, 1]], r"1 nodes .* not finite, such as \(0, inf, 1\)"),
    ],
)
def test_nodes_that_are_nowhere(tmp_path, nodes, points, said):
    """Requirement: cells of nodes that the file lacks, or that are at no place, are one line; -1
    is not the last node, which a list of Python takes it for."""
    meshio.write(tmp_path / "cube.vtu", meshio.Mesh(points, [("hexahedron", [list(nodes)])]))
    with pytest.raises(InputError, match=said):
        file_arrays(tmp_path / "cube.vtu")
