"""Boxes, gmsh files, names."""

from pathlib import Path

import numpy as np
import pytest

from anisocontact.base.errors import InputError

EXAMPLE = Path(__file__).parents[2] / "examples" / "milled_block" / "block.msh"
FORMATS = [("4.1", False), ("4.1", True), ("2.2", False), ("2.2", True)]


@pytest.fixture(autouse=True)
def _needs_dolfinx(fe):
    """All tests here need DOLFINx."""


@pytest.fixture(scope="module")
def gmsh():
    """The gmsh package, where the machine has the libraries it needs."""
    return pytest.importorskip("gmsh", exc_type=(ImportError, OSError))


def written(
    gmsh,
    path,
    *,
    version="4.1",
    binary=False,
    order=1,
    hexahedra=False,
    rename=None,
    parts=0,
    ghosts=False,
    save_all=False,
    turned=False,
):
    """A unit cube, volume "block", faces "bottom" and "block.top", and what `rename` says.

    `turned` reverses the face "bottom", and puts an edge and a face into groups without a name.
    """
    names = {"block": "block", "bottom": "bottom", "top": "block.top"} | (rename or {})
    gmsh.initialize()
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        cube = gmsh.model.occ.addBox(0, 0, 0, 1, 1, 1)
        gmsh.model.occ.synchronize()
        if names["block"]:
            gmsh.model.addPhysicalGroup(3, [cube], name=names["block"])
        else:
            gmsh.model.addPhysicalGroup(3, [cube])
        for z, name in ((0.0, names["bottom"]), (1.0, names["top"])):
            box = (-0.1, -0.1, z - 0.1, 1.1, 1.1, z + 0.1)
            tags = [tag for _, tag in gmsh.model.getEntitiesInBoundingBox(*box, 2)]
            turn = -1 if turned and z == 0.0 else 1
            gmsh.model.addPhysicalGroup(2, [turn * tag for tag in tags], name=name)
        if turned:
            gmsh.model.addPhysicalGroup(1, [1], tag=9)
            gmsh.model.addPhysicalGroup(2, tags, tag=77)
        if hexahedra:
            for _, edge in gmsh.model.getEntities(1):
                gmsh.model.mesh.setTransfiniteCurve(edge, 3)
            for dim, tag in gmsh.model.getEntities(2):
                gmsh.model.mesh.setTransfiniteSurface(tag)
                gmsh.model.mesh.setRecombine(dim, tag)
            gmsh.model.mesh.setTransfiniteVolume(cube)
        gmsh.option.setNumber("Mesh.MeshSizeMax", 0.5)
        gmsh.option.setNumber("Mesh.ElementOrder", order)
        gmsh.option.setNumber("Mesh.MshFileVersion", float(version))
        gmsh.option.setNumber("Mesh.Binary", binary)
        gmsh.option.setNumber("Mesh.SaveAll", save_all)
        gmsh.model.mesh.generate(3)
        if parts:
            gmsh.option.setNumber("Mesh.PartitionCreateGhostCells", ghosts)
            gmsh.model.mesh.partition(parts)
        gmsh.write(str(path))
    finally:
        gmsh.finalize()
    return path


def volume_and_areas(model):
    """Volume of the mesh and area of each facet group, by UFL."""
    from anisocontact.base.fenicsx import fem, ufl

    one = fem.Constant(model.mesh, 1.0)
    volume = fem.assemble_scalar(fem.form(one * ufl.dx))
    areas = {}
    for name in model.facet_names():
        sides = fem.compute_integration_domains(
            fem.IntegralType.exterior_facet, model.mesh.topology, model.facets(name)
        )
        ds = ufl.Measure("ds", domain=model.mesh, subdomain_data=[(1, sides)])
        areas[name] = fem.assemble_scalar(fem.form(one * ds(1)))
    return volume, areas


@pytest.mark.parametrize("cell", ["hexahedron", "tetrahedron"])
def test_box_has_its_faces(cell):
    """Requirement: structured box with exact facet groups x-, x+, y-, y+, z-, z+."""
    from anisocontact.mesh import BoxSpec, build_box

    model = build_box({"b": BoxSpec((1.0, 2.0, 3.0), (1.0, 2.0, 0.5), (2, 3, 4), cell)})
    volume, areas = volume_and_areas(model)
    per_cell, per_face = {"hexahedron": (1, 1), "tetrahedron": (6, 2)}[cell]
    assert len(model.cells("b")) == 24 * per_cell
    assert model.count_facets("b.left") == 12 * per_face
    assert volume == pytest.approx(1.0)
    sides = {"left": 1.0, "right": 1.0, "front": 0.5, "back": 0.5, "bottom": 2.0, "top": 2.0}
    assert areas == pytest.approx({f"b.{k}": v for k, v in sides.items()})
    assert model.body_of("b.top") == "b"


@pytest.mark.parametrize(
    ("given", "line"),
    [
        ({"size": (1, 0, 1)}, "size: (1, 0, 1) given, must be > 0"),
        ({"cells": (2, 0, 1)}, "cells: (2, 0, 1) given, must be > 0"),
        ({"cells": (2, 1.5, 1)}, "cells: (2, 1.5, 1) given, 3 whole numbers are needed"),
        ({"cells": (2, 1)}, "cells: (2, 1) given, 3 whole numbers are needed"),
        ({"origin": (0, float("nan"), 0)}, "origin: (0, nan, 0) given, finite numbers are needed"),
        ({"size": (1, 1)}, "size: (1, 1) given, three numbers are needed"),
        ({"cell": "prism"}, "cell: 'prism' given, allowed: hexahedron, tetrahedron"),
        ({"order": 3}, "order: 3 given, allowed: 1, 2"),
        (
            {"planes_x": (0, 1), "ratio": (2, 1, 1)},
            "planes_x: given with ratio 2 along x, one of the two",
        ),
        ({"planes_x": (0, 1 - 2e-9)}, "planes_x: [0.0, 0.999999998] given, must rise from 0 to 1"),
        ({"planes_z": (2e-9, 1)}, "planes_z: [2e-09, 1.0] given, must rise from 0 to 1"),
    ],
)
def test_bad_box_is_one_line(given, line):
    """Requirement: one line naming field, what was given, what is allowed."""
    from anisocontact.mesh import BoxSpec

    with pytest.raises(InputError) as caught:
        BoxSpec(**({"origin": (0, 0, 0), "size": (1, 1, 1), "cells": (1, 1, 1)} | given))
    assert str(caught.value) == line


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("off", [3e-13, -3e-13, 9e-10, -9e-10])
def test_planes_that_miss_the_ends_by_rounding_are_there(axis, off):
    """Requirement: planes that a script computed rise from 0 to 1 exactly, those between stay."""
    from anisocontact.mesh import BoxSpec

    given = {f"planes_{'xyz'[axis]}": (off, 0.3, 1.0 - off)}
    cells = np.where(np.arange(3) == axis, 2, 1).tolist()
    box = BoxSpec(origin=(0, 0, 0), size=(1, 1, 1), cells=cells, **given)
    assert box.blocks()[0].planes[axis].tolist() == [0.0, 0.3, 1.0]


def test_boxes_of_different_cells_are_refused():
    """Requirement: one kind of cell in a mesh, said in one line with the bodies and the cure."""
    from anisocontact.mesh import BoxSpec, build_box

    a = BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1))
    b = BoxSpec((0, 0, 2), (1, 1, 1), (1, 1, 1), "tetrahedron")
    with pytest.raises(InputError, match="bodies a and b: all bodies of a mesh need the") as caught:
        build_box({"a": a, "b": b})
    assert str(caught.value).endswith('; cell = "tetrahedron" makes a built-in shape of these')


@pytest.mark.parametrize(("version", "binary"), FORMATS)
@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("hexahedra", [False, True], ids=["tetrahedra", "hexahedra"])
def test_gmsh_file_in_every_format(gmsh, tmp_path, version, binary, order, hexahedra):
    """Requirement: gmsh files with physical names, tetrahedra and hexahedra, order 1 and 2."""
    from anisocontact.mesh import read_gmsh

    path = written(
        gmsh, tmp_path / "a.msh", version=version, binary=binary, order=order, hexahedra=hexahedra
    )
    model = read_gmsh(path)
    volume, areas = volume_and_areas(model)
    assert model.order == order
    assert model.body_names() == ["block"]
    assert volume == pytest.approx(1.0)
    assert areas == pytest.approx({"block.bottom": 1.0, "block.top": 1.0})


@pytest.mark.parametrize(("version", "binary"), FORMATS)
@pytest.mark.parametrize("ghosts", [False, True], ids=["alone", "ghosts"])
def test_gmsh_file_of_a_partitioned_mesh(gmsh, tmp_path, version, binary, ghosts):
    """Requirement: a mesh that gmsh has partitioned is the mesh that it was, also with ghost cells.

    Source: its elements are in parts of entities, whose groups stand in $PartitionedEntities.
    """
    from anisocontact.mesh import read_gmsh

    model = read_gmsh(
        written(gmsh, tmp_path / "a.msh", version=version, binary=binary, parts=3, ghosts=ghosts)
    )
    volume, areas = volume_and_areas(model)
    assert volume == pytest.approx(1.0)
    assert areas == pytest.approx({"block.bottom": 1.0, "block.top": 1.0})


@pytest.mark.parametrize(
    ("made", "words"),
    [
        ({"order": 3}, r"given, those of orders 1 and 2 are read \(gmsh -order 2\)"),
        ({"version": "2.2", "save_all": True}, "volume group 'block' has no cells; in format 2.2"),
    ],
)
def test_gmsh_files_that_are_told_how_to_write(gmsh, tmp_path, made, words):
    """Requirement: what gmsh has to be told to write is in the line that refuses a file."""
    from anisocontact.mesh import read_gmsh

    with pytest.raises(InputError, match=words):
        read_gmsh(written(gmsh, tmp_path / "a.msh", **made))


def test_example_mesh_is_what_its_script_says():
    """The committed mesh: at least 5,000 nodes, names, area of the sole without rounded edges."""
    from anisocontact.mesh import read_gmsh

    model = read_gmsh(EXAMPLE)
    assert model.mesh.geometry.index_map().size_global >= 5000
    volume, areas = volume_and_areas(model)
    # Sole: 60 x 40 with corners of radius 8, less 2 of the rounded edge all around.
    sole = 56.0 * 36.0 - (4.0 - np.pi) * 6.0**2
    assert areas["block.bottom"] == pytest.approx(sole, rel=1e-3)
    assert areas["block.top"] == pytest.approx(np.pi * (13.0**2 - 6.0**2), rel=1e-3)
    assert 2.7e4 < volume < 3.1e4


@pytest.mark.parametrize(
    ("rename", "words"),
    [
        ({"block": ""}, "no named volume group"),
        ({"block": "a.b"}, "volume group 'a.b': the name of a body has no dot; give it"),
    ],
)
def test_groups_that_make_no_body(gmsh, tmp_path, rename, words):
    """Requirement: a mesh without a usable volume group is refused in one line."""
    from anisocontact.mesh import read_gmsh

    with pytest.raises(InputError, match=words):
        read_gmsh(written(gmsh, tmp_path / "a.msh", rename=rename))


@pytest.mark.parametrize("version", ["2.2", "4.1"])
def test_reversed_groups_and_those_without_a_name(gmsh, tmp_path, version):
    """Requirement: a group of elements the other way round has all of them, one without a name is
    told of.

    Source: gmsh writes a minus before the number of such a group in format 4.1. Half of a face
    that was given with its other half reversed was left out of its group without a word.
    """
    from anisocontact.mesh.gmsh import gmsh_arrays

    path = written(gmsh, tmp_path / "a.msh", version=version, turned=True)
    mesh = gmsh_arrays(path)
    assert len(mesh.facets["block.bottom"]) == len(mesh.facets["block.top"])
    told = "physical groups without a name are left out: curve 9, surface 77"
    assert mesh.notes == (told,)


def test_surfaces_of_a_solid_alone_make_no_body(gmsh, tmp_path):
    """Requirement: where volumes have not been meshed this is said, not names of volumes."""
    from anisocontact.mesh import read_gmsh

    path = written(gmsh, tmp_path / "a.msh", version="2.2")
    head, tail = path.read_text().split("$Elements\n")
    rows = [row for row in tail.splitlines()[1:-1] if row.split()[1] == "2"]
    path.write_text("\n".join([f"{head}$Elements", str(len(rows)), *rows, "$EndElements", ""]))
    with pytest.raises(InputError, match=r"has no volumes, and surface group 'block\.top'"):
        read_gmsh(path)


def test_body_that_is_not_in_the_file(gmsh, tmp_path):
    """Requirement: an absent group suggests the near one."""
    from anisocontact.mesh import read_gmsh

    with pytest.raises(InputError, match="no volume group 'blok'; did you mean 'block'"):
        read_gmsh(written(gmsh, tmp_path / "a.msh"), bodies=["blok"])


def test_missing_file():
    """Requirement: a missing mesh file is one line with its name."""
    from anisocontact.mesh import read_gmsh

    with pytest.raises(InputError, match=r"^mesh.file: mesh file 'none.msh' does not exist$"):
        read_gmsh("none.msh")


def test_a_name_at_which_the_system_does_not_look():
    """Requirement: whatever keeps a file from being read is one line, here a name too long."""
    from anisocontact.mesh import read_gmsh

    name = "m" * 300 + ".msh"
    with pytest.raises(InputError, match=rf"^mesh.file: mesh file '{name}' cannot be looked at: "):
        read_gmsh(name)


def test_triangles_on_hexahedra(tmp_path):
    """Requirement: facets of another kind than those of the cells are refused in one line."""
    from anisocontact.mesh import read_gmsh

    corners = [(x, y, z) for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
    nodes = "\n".join(f"{i} {x} {y} {z}" for i, (x, y, z) in enumerate(corners, 1))
    path = tmp_path / "a.msh"
    path.write_text(
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"
        '$PhysicalNames\n2\n2 1 "a.low"\n3 2 "a"\n$EndPhysicalNames\n'
        f"$Nodes\n8\n{nodes}\n$EndNodes\n"
        "$Elements\n2\n1 2 2 1 1 1 2 3\n2 5 2 2 2 1 2 3 4 5 6 7 8\n$EndElements\n"
    )
    with pytest.raises(InputError, match=r"'a.low': 1 of 1 facets belong to no cell of a body"):
        read_gmsh(path)


def test_names_in_another_encoding(gmsh, tmp_path):
    """Requirement: names of groups that are no UTF-8, as Latin-1 is, are told as that."""
    from anisocontact.mesh import read_gmsh

    path = written(gmsh, tmp_path / "a.msh", rename={"block": "größe"})
    path.write_bytes(path.read_text("utf-8").encode("latin-1"))
    with pytest.raises(InputError, match=r"a name in \$PhysicalNames is not in UTF-8"):
        read_gmsh(path)


def test_facets_off_the_boundary(gmsh, tmp_path):
    """Requirement: facets that do not bound a body are refused, with their number."""
    from anisocontact.mesh import read_gmsh

    path = written(gmsh, tmp_path / "a.msh", version="2.2")
    lines = path.read_text().splitlines()
    start = lines.index("$Elements") + 2
    facet = next(i for i in range(start, len(lines)) if lines[i].split()[1:2] == ["2"])
    words = lines[facet].split()
    # The last corner of one triangle moves to a node of the opposite face.
    lines[facet] = " ".join([*words[:-1], "8" if words[-1] != "8" else "7"])
    path.write_text("\n".join(lines))
    with pytest.raises(InputError, match="facets belong to no cell of a body"):
        read_gmsh(path)


@pytest.mark.parametrize(("version", "binary"), FORMATS)
def test_damaged_files_are_one_line(gmsh, tmp_path, version, binary):
    """Cut, overwritten and doubled bytes: an InputError in one line, or a mesh, nothing else.

    Requirement: a corrupt mesh file is one line. Source: random damage, fixed seed.
    """
    from anisocontact.mesh.gmsh import gmsh_arrays

    data = written(gmsh, tmp_path / "a.msh", version=version, binary=binary).read_bytes()
    rng = np.random.default_rng(5)
    refused = 0
    for trial in range(100):
        damaged = bytearray(data)
        if trial % 2:
            del damaged[rng.integers(len(data)) :]
        else:
            for place in rng.integers(len(data), size=rng.integers(1, 20)):
                damaged[place] = rng.integers(256)
        path = tmp_path / "b.msh"
        path.write_bytes(damaged)
        try:
            gmsh_arrays(path)
        except InputError as error:
            refused += 1
            assert "\n" not in str(error)
            assert error.field == "mesh.file"
    assert refused > 50


@pytest.mark.parametrize("text", ["", "not a mesh", "$MeshFormat\n3.0 0 8\n$EndMeshFormat\n"])
def test_something_else_than_a_mesh(tmp_path, text):
    """Requirement: a file of another kind is one line that says what is wrong."""
    from anisocontact.mesh import read_gmsh

    path = tmp_path / "a.msh"
    path.write_text(text)
    with pytest.raises(InputError, match="is not a readable gmsh file"):
        read_gmsh(path)
