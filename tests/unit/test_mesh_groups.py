"""Groups named by where their facets are, meshes written for other codes, and what is in them."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.base.errors import InputError
from anisocontact.cli import main
from anisocontact.mesh import (
    Body,
    MeshFile,
    Placement,
    build_mesh,
    make_selector,
    make_shape,
    register_selector,
    selectors,
)
from anisocontact.mesh.described import described
from anisocontact.mesh.merge import lift
from anisocontact.mesh.readers import file_arrays
from anisocontact.mesh.selectors import _SELECTORS, Boundary, with_groups
from anisocontact.mesh.write import write_mesh

RING = {"inner": 1.0, "outer": 2.0, "length": 1.0, "cells": (2, 24, 2)}


def box(cell="hexahedron", order=1):
    shape = make_shape(
        "box", origin=(0, 0, 0), size=(1, 2, 1), cells=(2, 4, 2), cell=cell, order=order
    )
    return Body("box", shape).arrays()


def chosen(mesh, name, **parameters):
    """Area of the facets that a selector chooses."""
    boundary = Boundary.of(mesh)
    corners = boundary.corners[make_selector(name, **parameters)(boundary)]
    first, second = corners[:, -1] - corners[:, 0], corners[:, 2] - corners[:, 1]
    return 0.5 * np.linalg.norm(np.cross(first, second), axis=1).sum()


@pytest.mark.parametrize("cell", ["hexahedron", "tetrahedron"])
@pytest.mark.parametrize(
    ("name", "parameters", "area"),
    [
        ("all", {}, 10.0),
        ("plane", {"point": (5, 5, 1), "normal": (0, 0, 3)}, 2.0),
        ("box", {"low": (0, 0, -1), "high": (1, 1, 0.5)}, 1.0 + 0.5 + 2 * 0.5),
        ("normal", {"direction": (0, 1, 0)}, 1.0),
        ("normal", {"direction": (1, 1, 0), "angle_deg": 50}, 3.0),
        ("nearest", {"point": (1.3, 0.9, 0.6)}, 2.0),
        ("nearest", {"point": (1.3, 0.9, 0.6), "angle_deg": 100}, 10.0),
    ],
)
def test_areas_of_a_box(cell, name, parameters, area):
    """Requirement: the faces of a box 1 x 2 x 1 by their places; round-off of a sum of facets."""
    assert chosen(box(cell), name, **parameters) == pytest.approx(area, rel=1e-12)


def test_bore_of_a_ring():
    """Requirement: corners lie on the cylinder, facets are chords: 24 of them, 2 n r sin(pi/n)."""
    ring = Body("ring", make_shape("ring", **RING)).arrays()
    bore = 2.0 * 24 * math.sin(math.pi / 24)
    given = {"point": (0, 0, 7), "axis": (0, 0, 2), "radius": 1.0}
    assert chosen(ring, "cylinder", **given) == pytest.approx(bore, rel=1e-12)
    # neighbours turn by 15 degrees: the bore is one face, up to the edges at its ends
    assert chosen(ring, "nearest", point=(0.9, 0, 0.5)) == pytest.approx(bore, rel=1e-12)
    assert chosen(ring, "nearest", point=(0.9, 0, 0.5), angle_deg=10) == pytest.approx(bore / 24)


def test_groups_of_several_bodies_and_selectors():
    one, other = (
        make_shape("box", origin=o, size=(1, 1, 1), cells=(2, 2, 2), order=2)
        for o in ((0, 0, 0), (3, 0, 0))
    )
    low = make_selector("plane", point=(0, 0, 0), normal=(0, 0, 1))
    left = make_selector("box", low=(-1, 0, 0), high=(0.5, 1, 1))
    bodies = [Body("a", one), Body("b", other)]
    model = build_mesh(bodies, {"low": [low], "a.part": [low, left]})
    assert [model.count_facets(g) for g in ("a.low", "b.low", "a.part")] == [4, 4, 2]
    for name, said in (
        ("c.low", "no body 'c'; there are: a, b"),
        ("b.none", "no facet at the boundary is chosen"),
        ("a.left", "'a.left' is a group already"),
    ):
        with pytest.raises(InputError, match=said) as caught:
            build_mesh(bodies, {name: [low, left]})
        assert caught.value.field == name


def test_selector_from_outside():
    @register_selector("leaning", "Facets that lean.")
    def leaning(boundary):
        return np.abs(boundary.normals).max(axis=1) < 0.99

    try:
        assert "leaning" in [entry.name for entry in selectors()]
        turned = Body("box", make_shape("box", origin=(0, 0, 0), size=(1, 1, 1), cells=(1, 1, 1)))
        assert chosen(turned.arrays(), "leaning") == 0.0
    finally:
        del _SELECTORS["leaning"]


@pytest.mark.parametrize(
    ("select", "said"),
    [
        (lambda b: b.middle, "the selector <lambda> failed: test_mesh_groups.py, line"),
        (lambda b: None, "returned an array of object of shape (), 6 flags true or false needed"),
        (lambda b: np.array([True]), "returned an array of bool of shape (1,), 6 flags"),
        (lambda b: np.arange(6), "returned an array of int64 of shape (6,), 6 flags"),
    ],
)
def test_a_selector_of_a_user_that_chooses_nothing_meant(select, said):
    """Requirement: what a function of the user's does wrong is one line with the group."""
    box = Body("a", make_shape("box", origin=(0, 0, 0), size=(1, 1, 1), cells=(1, 1, 1)))
    with pytest.raises(InputError) as caught:
        build_mesh([box], {"a.seat": [select]})
    assert str(caught.value).startswith("a.seat: the selector <lambda> ")
    assert said in str(caught.value)


@pytest.mark.parametrize("suffix", [".msh", ".vtu", ".vtk"])
@pytest.mark.parametrize(
    ("shape", "order", "cell"),
    [
        ("ring", 1, "hexahedron"),
        ("ring", 2, "hexahedron"),
        ("ring", 1, "tetrahedron"),
        ("ring", 2, "tetrahedron"),
    ],
)
@pytest.mark.filterwarnings("ignore")
def test_written_meshes_are_read_as_they_were(tmp_path, capsys, suffix, shape, order, cell):
    """Requirement: the same bodies, groups, areas and boxes, of curved cells as well."""
    pytest.importorskip("meshio")
    mesh = Body("ring", make_shape(shape, cell=cell, order=order, **RING)).arrays()
    upper = [make_selector("plane", point=(0, 0, 1), normal=(0, 0, 1))]
    mesh = with_groups(mesh, {"upper": upper})
    path = tmp_path / f"ring{suffix}"
    write_mesh(mesh, path)
    again = file_arrays(path)
    assert sorted(described(again)) == sorted(described(mesh))
    model = build_mesh([MeshFile(path, placement=Placement(scale=2.0))])
    assert model.order == order
    assert model.count_facets("ring.upper") == model.count_facets("ring.top") > 0


@pytest.mark.parametrize("told", [OSError(28, "No space left on device"), OSError("3 of 9 items")])
def test_a_file_that_cannot_be_written_whole_is_none(tmp_path, monkeypatch, told):
    """A disk that is full: the file of before stays, and half a mesh has no name."""
    meshio = pytest.importorskip("meshio")
    path = tmp_path / "box.msh"
    path.write_text("of before")

    def written(self, to, **options):
        Path(to).write_text("half")
        raise told

    monkeypatch.setattr(meshio.Mesh, "write", written)
    with pytest.raises(InputError) as caught:
        write_mesh(box(order=1), path)
    assert str(caught.value) == f"'{path}' cannot be written: {told.strerror or told}"
    assert [one.name for one in tmp_path.iterdir()] == ["box.msh"]
    assert path.read_text() == "of before"


def test_command(tmp_path, capsys):
    pytest.importorskip("meshio")
    path = tmp_path / "box.vtu"
    write_mesh(box(order=1), path)
    assert main(["convert", str(path), str(tmp_path / "box.msh")]) == 0
    assert main(["check", str(tmp_path / "box.msh")]) == 0
    said = capsys.readouterr().out
    line = "body      box: 16 hexahedra of order 1, box (0, 0, 0) to (1, 2, 1), edges 0.5 to 0.5\n"
    assert said.count(line) == 2
    assert "group     box.top: 8 facets, area 2\n" in said
    assert main(["convert", str(path), str(tmp_path / "box.stp")]) == 2
    assert "it has to end with one of: .msh, .vtu, .vtk" in capsys.readouterr().err


CASE = """
[mesh.box.block]
origin = [0, 0, 0]
size = [1, 1, 0.5]
cells = [4, 4, 2]

[group."block.seat"]
by = "nearest"
point = [0.5, 0.5, 0]

[[group.patch]]
by = "plane"
point = [0, 0, 0.5]
normal = [0, 0, 1]

[[group.patch]]
by = "box"
low = [0, 0, 0]
high = [0.5, 0.5, 1]

[join]
"block.skin" = ["block.seat", "block.left", "block.patch", "block.top"]

[material.block]
model = "linear-elastic"
E = 1000
nu = 0.3

[surface.plate]
shape = "plane"
point = [0, 0, 0]
normal = [0, 0, 1]

[[contact]]
slave = "block.seat"
master = "plate"
friction = { coefficients = 0.3 }

[[step]]
name = "press"
increments = 2
displacement = { "block.patch" = { x = 0, y = 0, z = -0.01 } }
"""


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("", "", None),
        ('"nearest"', '"nearst"', "group.\"block.seat\"[0].by: 'nearst' given; did you mean"),
        ("point = [0, 0, 0.5]", "point = [0, 0, 0.4]", "group.patch: no facet at the boundary"),
        ('group."block.seat"', 'group."blok.seat"', "group.blok.seat: no body 'blok'"),
        ('"block.left"', '"block.lift"', "did you mean 'block.left'?"),
        ('"block.left"', '"block.wood"', "'block.wood' in the mesh; the mesh has: block.left,"),
        ('"block.left"', '"left"', "join.block.skin: no facet group 'left' in the mesh"),
        ('"block.skin"', '"block.top"', "join.block.top: 'block.top' is a group already"),
        ('"block.skin"', '"skin"', "join.skin: 'block.seat' given, groups of the body of 'skin'"),
    ],
)
def test_groups_of_a_case(tmp_path, capsys, old, new, said):
    path = tmp_path / "case.toml"
    path.write_text(CASE.replace(old, new))
    assert main(["check", str(path)]) == (2 if said else 0)
    found = capsys.readouterr()
    if said:
        (line,) = found.err.splitlines()
        assert said in line
    else:
        assert "group     block.seat: 16 facets, area 1" in found.out
        assert "group     block.patch: 4 facets, area 0.25" in found.out
        # the patch is a part of the top: its facets count once
        assert "group     block.skin: 40 facets, area 2.5" in found.out


@pytest.mark.filterwarnings("ignore")
def test_hexahedra_of_20_nodes_of_gmsh(tmp_path):
    """Requirement: curved cells of 20 nodes have the volume of the shape functions of 20 nodes.

    A quarter of a ring, of which VTK's file of 20 nodes is read by another reader.
    """
    meshio = pytest.importorskip("meshio")
    shape = make_shape("ring", order=2, end_deg=90, **(RING | {"cells": (1, 2, 1)}))
    mesh = Body("ring", shape).arrays()
    write_mesh(mesh, tmp_path / "ring.vtu")
    full = meshio.read(tmp_path / "ring.vtu")
    cells = [b.data[:, :20] for b in full.cells if b.type == "hexahedron27"]
    quads = [b.data[:, :8] for b in full.cells if b.type == "quad9"]
    blocks = [("hexahedron20", np.concatenate(cells)), ("quad8", quads[0])]
    numbers = [np.full(len(rows), k) for k, (_, rows) in enumerate(blocks, 1)]
    given = meshio.Mesh(
        full.points,
        blocks,
        cell_data={"gmsh:physical": numbers, "gmsh:geometrical": numbers},
        field_data={"ring": np.array([1, 3]), "one": np.array([2, 2])},
    )
    given.write(tmp_path / "ring.msh", file_format="gmsh22", binary=False)
    meshio.Mesh(full.points, blocks[:1]).write(tmp_path / "twenty.vtu")
    found, other = file_arrays(tmp_path / "ring.msh"), file_arrays(tmp_path / "twenty.vtu")
    assert found.degree == 2
    assert list(found.facets) == ["ring.one"]
    assert np.allclose(found.points[found.cells], other.points[other.cells], atol=1e-14)


@pytest.mark.parametrize("suffix", ["msh", "vtu", "inp"])
@pytest.mark.parametrize(("cell", "order"), [("hexahedron", 1), ("tetrahedron", 2)])
def test_points_and_edges_of_files_are_groups_of_nodes(tmp_path, suffix, cell, order):
    """The nodes of an edge and of a corner keep their names, also where the body is put."""
    path = tmp_path / f"box.{suffix}"
    if suffix == "inp":
        path.write_text(TWO_CUBES)
    else:
        pytest.importorskip("meshio")
        mesh = lift(box(cell, order)) if order == 2 else box(cell)
        on = np.all(mesh.points[:, [0, 2]] == 0.0, axis=1)
        edge = mesh.points[on]
        groups = {"box.edge": edge, "box.corner": np.array([[1.0, 2.0, 1.0]])}
        write_mesh(replace(mesh, nodes=groups), path)
    file = MeshFile(path, rename={"box": "part"}, placement=Placement(2.0, move=(0, 0, 5.0)))
    model = build_mesh([file])
    x = model.space.tabulate_dof_coordinates()
    edge = x[model.nodes("part.edge")]
    assert len(edge) == (3 if suffix == "inp" else 4 * order + 1)
    assert np.ptp(edge, axis=0) == pytest.approx([0.0, 4.0, 0.0])
    assert edge[:, [0, 2]] == pytest.approx(np.tile([0.0, 5.0], (len(edge), 1)))
    assert x[model.nodes("part.corner")] == pytest.approx(np.array([[2.0, 4.0, 7.0]]))
    lines = described(file.arrays())
    assert "nodes     part.corner: 1, box (2, 4, 7) to (2, 4, 7)" in lines


#: Two cubes in a row along y.
TWO_CUBES = """\
*NODE
 1, 0., 0., 0.
 2, 1., 0., 0.
 3, 1., 1., 0.
 4, 0., 1., 0.
 5, 0., 0., 1.
 6, 1., 0., 1.
 7, 1., 1., 1.
 8, 0., 1., 1.
 9, 1., 2., 0.
 10, 0., 2., 0.
 11, 1., 2., 1.
 12, 0., 2., 1.
*ELEMENT, TYPE=C3D8, ELSET=BOX
 1, 1, 2, 3, 4, 5, 6, 7, 8
 2, 4, 3, 9, 10, 8, 7, 11, 12
*NSET, NSET=EDGE
 1, 4, 10
*NSET, NSET=CORNER
 11
*NSET, NSET=BELOW
 1, 2, 3, 4
*SOLID SECTION, ELSET=BOX, MATERIAL=STEEL
"""


def test_a_group_of_facets_is_none_of_nodes(tmp_path):
    path = tmp_path / "box.inp"
    path.write_text(TWO_CUBES)
    mesh = file_arrays(path)
    assert sorted(mesh.nodes) == ["box.corner", "box.edge"]
    assert list(mesh.facets) == ["box.below"]


def _two_boxes(path, group, lost, wedges):
    """Boxes "a" and "b" of four hexahedra each, or eight wedges, with a group on top of both.

    The first `lost` facets of the group have nodes of their own, which lie on those of the cells.
    """
    meshio = pytest.importorskip("meshio")
    x, y = (k.reshape(-1) for k in np.mgrid[0:3.0, 0:3.0])
    one = np.concatenate([np.stack([x, y, 0 * x + z], axis=1) for z in (0.0, 1.0)])
    points = np.concatenate([one, one + np.array([5, 0, 0])])
    quads = np.array([[k, k + 3, k + 4, k + 1] for k in (0, 1, 3, 4)])
    flat = np.concatenate([quads[:, :3], quads[:, [0, 2, 3]]]) if wedges else quads
    kinds = ("wedge", "triangle") if wedges else ("hexahedron", "quad")
    cells = np.hstack([flat, flat + 9])
    top = np.concatenate([flat + 9, flat + 27])
    top[:lost] += len(points)
    blocks = [(kinds[0], cells), (kinds[0], cells + 18), (kinds[1], top)]
    numbers = [np.full(len(rows), k) for k, (_, rows) in enumerate(blocks, 1)]
    meshio.Mesh(
        np.concatenate([points, points]),
        blocks,
        cell_data={"gmsh:physical": numbers, "gmsh:geometrical": numbers},
        field_data={"a": np.array([1, 3]), "b": np.array([2, 3]), group: np.array([3, 2])},
    ).write(path, file_format="gmsh22", binary=False)
    return path


@pytest.mark.parametrize("wedges", [False, True])
def test_facets_with_nodes_of_their_own_are_told(tmp_path, wedges):
    """Requirement: a group does not lose the facets whose nodes are not those of the cells.

    A surface that is no body's may stand in the file, and bodies may be left out of it.
    """
    count = 16 if wedges else 8
    path = _two_boxes(tmp_path / "m.msh", "top", 3, wedges)
    said = f"'top': 3 of {count} facets have nodes that no cell has; merge nodes"
    with pytest.raises(InputError, match=said):
        file_arrays(path)
    with pytest.raises(InputError, match=said):
        file_arrays(path, ["b"])
    _two_boxes(path, "a.top", count, wedges)
    with pytest.raises(InputError, match=f"'a.top': {count} of {count} facets have nodes"):
        file_arrays(path)
    _two_boxes(path, "tool", count, wedges)
    assert file_arrays(path).facets == {}
    _two_boxes(path, "top", 0, wedges)
    assert list(file_arrays(path).facets) == ["a.top", "b.top"]
    alone = file_arrays(path, ["b"]).facets
    assert {name: len(facets) for name, facets in alone.items()} == {"b.top": count // 2}
